"""Small self-contained pages: the sign-in form, and error pages for browsers."""

from __future__ import annotations

import html

from starlette.responses import HTMLResponse

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,"><title>Pas de Deux</title><style>
:root {{ color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif; --ink: #1e2733; --soft: #566275;
  --ground: #f4f6fa; --card: #fff; --line: #c3cad5; --error: #b42318; --accent: #2368dc; }}
@media (prefers-color-scheme: dark) {{ :root {{ --ink: #e6eaf0; --soft: #a4afbf; --ground: #0f131a;
  --card: #181d27; --line: #3a4454; --error: #ff9c92; --accent: #2f74e8; }} }}
body {{ margin: 0; min-height: 100vh; display: grid; place-items: center; background: var(--ground);
  color: var(--ink); }}
main {{ width: min(22rem, 90vw); box-sizing: border-box; padding: 2rem; border-radius: 14px;
  background: var(--card); box-shadow: 0 1px 4px #0002; }}
h1 {{ display: flex; align-items: center; gap: .55rem; margin: 0 0 .5rem; font-size: 1.35rem; }}
h1 svg {{ width: 1.7rem; height: .95rem; }}
p {{ margin: 0 0 1rem; color: var(--soft); }} p:last-child {{ margin-bottom: 0; }}
p[role=alert] {{ color: var(--error); }} small {{ color: var(--soft); }} a {{ color: var(--accent); }}
label {{ display: block; margin: 0 0 .9rem; font-weight: 600; font-size: .9rem; }}
input {{ display: block; width: 100%; box-sizing: border-box; margin-top: .3rem; padding: .55rem .7rem;
  font: inherit; font-size: 1rem; font-weight: 400; border: 1px solid var(--line); border-radius: 10px;
  background: transparent; color: inherit; }}
input[hidden] {{ display: none; }}
input:focus-visible, button:focus-visible {{ outline: 2px solid var(--accent); outline-offset: 1px; }}
button {{ width: 100%; margin: .3rem 0 1.1rem; padding: .65rem; border: 0; border-radius: 10px; font: inherit;
  font-weight: 600; background: var(--accent); color: #fff; cursor: pointer; }}
button:hover {{ filter: brightness(1.08); }}
</style></head><body><main><h1><svg viewBox="0 0 34 18" aria-hidden="true"><circle cx="9" cy="9" r="9"
fill="#2368dc"/><circle cx="25" cy="9" r="9" fill="#c2661a"/></svg>Pas de Deux</h1>{body}</main></body>
</html>"""


def card(body: str) -> str:
    """A whole page around a piece of HTML."""
    return _PAGE.format(body=body)


def never_kept(page: str, status: int = 200) -> HTMLResponse:
    """A page that no browser keeps."""
    return HTMLResponse(page, status_code=status, headers={"Cache-Control": "no-store"})


def message_card(sentence: str, *, home: str, reference: str) -> str:
    """A page with one sentence, a link to the lab, and the request's id for a search in the log."""
    return card(
        f'<p role="alert">{html.escape(sentence)}</p>'
        f'<p><a href="{html.escape(home, quote=True)}">Open the lab</a></p>'
        f"<p><small>Request {html.escape(reference)}</small></p>"
    )


def sign_in_card(*, action: str, wanted: str, name: str = "", error: str = "") -> str:
    """The form by which people sign in.

    Args:
        action: where it is sent.
        wanted: the path that is opened then.
        name: who tried before.
        error: what went wrong then.
    """
    alert = f'<p role="alert">{html.escape(error)}</p>' if error else ""
    why = (
        "to see the motion that you were sent"
        if wanted.startswith("/?run=")
        else "to vote in the study that you were invited to"
        if wanted.startswith("/study/")
        else "to generate motion of two people"
    )
    shown = html.escape(name, quote=True)
    name_more, password_more = ("", " autofocus") if name else (" autofocus", "")
    return card(
        f'<p>Sign in {why}.</p>{alert}<form method="post" action="{html.escape(action, quote=True)}">'
        f'<input type="hidden" name="next" value="{html.escape(wanted, quote=True)}">'
        '<label>Name<input name="username" autocomplete="username" required maxlength="40" autocapitalize="none" '
        f'value="{shown}"{name_more}></label><label>Password<input name="password" type="password" '
        f'autocomplete="current-password" required{password_more}></label><button>Sign in</button></form>'
        "<p><small>No account, or forgotten your password? Ask the person who runs this server."
        "</small></p>"
    )
