"""The frame of the administrators' page, in light and dark."""

from __future__ import annotations

import html
from collections.abc import Sequence

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,"><title>Administration · Pas de Deux</title><style>
:root {{ color-scheme: light dark; font: 15px/1.5 system-ui, sans-serif; --ink: #1e2733; --soft: #566275;
  --ground: #f4f6fa; --card: #fff; --line: #c3cad5; --accent: #2368dc; }}
@media (prefers-color-scheme: dark) {{ :root {{ --ink: #e6eaf0; --soft: #a4afbf; --ground: #0f131a; --card: #181d27;
  --line: #3a4454; --accent: #6ca6ff; }} }}
body {{ margin: 0; padding: 1.2rem clamp(.8rem, 3vw, 2.5rem); background: var(--ground); color: var(--ink); }}
header {{ display: flex; gap: 1.2rem; align-items: baseline; flex-wrap: wrap; }} a {{ color: var(--accent); }}
h1 {{ font-size: 1.5rem; margin: 0; }} h2 {{ font-size: 1.1rem; margin: 0 0 .6rem; }}
section {{ margin: 1rem 0; padding: 1rem 1.2rem; background: var(--card); border: 1px solid var(--line);
  border-radius: 12px; overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }}
th, td {{ text-align: left; vertical-align: top; padding: .4rem .9rem .4rem 0; border-bottom: 1px solid var(--line); }}
th {{ color: var(--soft); font-weight: 600; font-size: .85rem; }}
td:last-child {{ overflow-wrap: anywhere; min-width: 9rem; }}
.acts {{ display: flex; flex-wrap: wrap; gap: .4rem .9rem; }}
form {{ display: inline-flex; flex-wrap: wrap; gap: .4rem; align-items: end; }}
label {{ color: var(--soft); }} label input {{ display: block; }}
label input:not([size]) {{ width: min(40rem, 75vw); }}
input, button {{ font: inherit; font-size: .9rem; padding: .25rem .6rem; border: 1px solid var(--line);
  border-radius: 8px; background: transparent; color: inherit; }}
button {{ cursor: pointer; }} button:hover {{ border-color: var(--accent); }}
input:focus-visible, button:focus-visible, a:focus-visible {{ outline: 2px solid var(--accent); outline-offset: 1px; }}
@media (max-width: 48rem) {{ /* a row becomes a card, each cell behind the name of its column */
  thead {{ display: none; }} tr {{ display: block; padding: .5rem 0; border-bottom: 1px solid var(--line); }}
  td {{ display: flex; gap: .8rem; padding: .15rem 0; border: 0; overflow-wrap: anywhere; }}
  td:empty {{ display: none; }}
  td::before {{ content: attr(data-head); flex: 0 0 7.5rem; color: var(--soft); font-size: .85rem; }}
}}
p {{ margin: .3rem 0; color: var(--soft); }} p[role=status] {{ color: var(--ink); font-weight: 600; }}
</style></head><body><header><h1>Administration</h1><a href="{home}">Open the lab</a></header><main>{body}</main></body>
</html>"""


def page(parts: Sequence[tuple[str, str]], *, done: str, home: str) -> str:
    """The whole page: headed parts of HTML, below a sentence about what was done."""
    said = f'<p role="status">{html.escape(done)}</p>' if done else ""
    body = "".join(f"<section><h2>{title}</h2>{part}</section>" for title, part in parts)
    return _PAGE.format(body=said + body, home=html.escape(home, quote=True))


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], none: str) -> str:
    """A table of HTML cells, or a sentence if it has no rows."""
    if not rows:
        return f"<p>{none}</p>"
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    lines = [
        "".join(f'<td data-head="{name}">{cell}</td>' for name, cell in zip(heads, row, strict=True)) for row in rows
    ]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
