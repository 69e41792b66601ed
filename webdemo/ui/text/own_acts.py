"""The acts that the lab added, at the foot of the page; every text is escaped."""

from __future__ import annotations

from acts import Lexicon

from .panels import status
from .words import text

MOST_LISTED = 200
"""Acts in the table, at most."""


def own_acts(known: Lexicon) -> str:
    """HTML on what the lab added to the lexicon and what of it was left out; empty where it added nothing."""
    if not known.own and not known.problems:
        return ""
    rows = []
    for name in known.own[:MOST_LISTED]:
        entry = known.entries[name]
        cells = (name.replace("-", " "), entry.reads[0], f"{entry.group}.toml")
        rows.append("<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in cells) + "</tr>")
    left_out = "".join(status(f"Left out: {problem}", tone="warning") for problem in known.problems)
    heads = "".join(f"<th>{head}</th>" for head in ("Act", "For example", "File"))
    table = f"<table><thead><tr>{heads}</tr></thead>"
    listed = f"{table}<tbody>{''.join(rows)}</tbody></table>" if rows else ""
    head = f"This lab's own acts: {len(known.own)}"
    if known.problems:
        head += f" (left out: {len(known.problems)})"
    return f'<details class="pd-own"><summary>{text(head)}</summary>{left_out}{listed}</details>'
