"""``/admin``: the small page of administrators. Plain HTML with forms, without scripts."""

from __future__ import annotations

import html
from collections.abc import Sequence

from fastapi import APIRouter, Form, Request
from starlette.responses import RedirectResponse, Response

from motion import InputError
from webdemo.server.accounts.administration import Administration, Row
from webdemo.server.accounts.people import ADMIN
from webdemo.server.audit import audit
from webdemo.ui.visitor import visitor_of

from .error_pages import never_kept
from .routes import Refused

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,"><title>Administration · Pas de Deux</title><style>
:root {{ color-scheme: light dark; font: 15px/1.5 system-ui, sans-serif; --line: #8886; }}
body {{ margin: 0; padding: 1.2rem clamp(.8rem, 3vw, 2.5rem); }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.1rem; }} section {{ overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }}
th, td {{ text-align: left; vertical-align: top; padding: .4rem .9rem .4rem 0; border-bottom: 1px solid var(--line); }}
td:last-child {{ display: flex; flex-wrap: wrap; gap: .4rem .9rem; min-width: 9rem; }}
form {{ display: inline-flex; gap: .4rem; }}
input, button {{ font: inherit; font-size: .9rem; padding: .25rem .6rem; border: 1px solid var(--line);
  border-radius: 8px; background: transparent; color: inherit; }}
button {{ cursor: pointer; }}
@media (max-width: 48rem) {{ /* a row becomes a card, each cell behind the name of its column */
  thead {{ display: none; }} tr {{ display: block; padding: .5rem 0; border-bottom: 1px solid var(--line); }}
  td {{ display: flex; gap: .8rem; padding: .15rem 0; border: 0; overflow-wrap: anywhere; }}
  td::before {{ content: attr(data-head); flex: 0 0 7.5rem; font-size: .85rem; }}
}}
</style></head><body><h1>Administration</h1><p><a href="{home}">Open the lab</a></p>{done}<main>
<section><h2>People</h2>{people}</section></main></body></html>"""
_DONE = {"suspend": "The account was suspended and signed out.", "let-in": "The account can sign in again."}
"""The acts, and the sentence after each."""
HEADS = ("Account", "Runs kept", "Runs and studies", "Act")


def admin_routes(root: str, admin: Administration) -> APIRouter:
    """``/admin`` (the page), and POST to it for its forms.

    Args:
        root: path under which the lab is.
        admin: what administrators do.
    """
    router = APIRouter()

    @router.get("/admin")
    def show(request: Request, done: str = "") -> Response:
        _check(admin, request)
        said = f'<p role="status">{_DONE[done]}</p>' if done in _DONE else ""
        rows = [_row(row, html.escape(f"{root}/admin", quote=True)) for row in admin.rows()]
        return never_kept(_PAGE.format(home=html.escape(f"{root}/"), done=said, people=table(rows)))

    @router.post("/admin")
    def act(request: Request, act: str = Form("", max_length=20), name: str = Form("", max_length=100)) -> Response:
        _check(admin, request)
        if not request.headers.get("origin"):  # the guard has compared it with the host
            raise Refused(403, "Open the page /admin in a browser, or use `python -m webdemo admin`.", "admin")
        if act not in _DONE:
            raise Refused(422, "There is no such act: use the buttons of the page.", "admin")
        try:
            admin.suspend(name, suspended=act == "suspend")
        except InputError as error:
            raise Refused(422, str(error), "admin") from None
        return RedirectResponse(f"{root}/admin?done={act}", status_code=303)

    return router


def _check(admin: Administration, request: Request) -> None:
    """Raises Refused for everybody but administrators."""
    who = visitor_of(request)
    if not who.account or admin.people.of(who.owner.removeprefix("user ")).role != ADMIN:
        audit("admin-page", ok=False)
        raise Refused(403, "This page is for administrators.", "admin")


def _row(row: Row, action: str) -> list[str]:
    """The cells of a person, the last with the button that suspends them or lets them in."""
    name = html.escape(row.name, quote=True)
    state = " ".join(filter(None, (row.role, "suspended" if row.suspended else "")))
    act, label = ("let-in", "Let in") if row.suspended else ("suspend", "Suspend")
    form = (
        f'<form method="post" action="{action}"><input type="hidden" name="act" value="{act}">'
        f'<input type="hidden" name="name" value="{name}"><button>{label}</button></form>'
    )
    return [f"<strong>{name}</strong> {state}", f"{row.runs:,}", f"{row.megabytes:,.1f} MB", form]


def table(rows: Sequence[Sequence[str]]) -> str:
    """A table of HTML cells."""
    head = "".join(f'<th scope="col">{name}</th>' for name in HEADS)
    lines = [
        "".join(f'<td data-head="{name}">{cell}</td>' for name, cell in zip(HEADS, row, strict=True)) for row in rows
    ]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
