"""``/admin``: the small page of administrators. Plain HTML with forms, without scripts."""

from __future__ import annotations

import html
from collections.abc import Sequence

from fastapi import APIRouter, Form, Request
from starlette.responses import RedirectResponse, Response

from webdemo.server.accounts.accounts import ADMIN, Accounts
from webdemo.server.accounts.administration import Administration, Row
from webdemo.server.audit import audit
from webdemo.ui.visitor import visitor_of

from .error_pages import card, never_kept
from .routes import Refused

_STYLE = """<style>body { display: block; } main { width: auto; margin: 1rem; overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .4rem .9rem .4rem 0; border-bottom: 1px solid var(--line); }
form button { width: auto; margin: 0; padding: .25rem .8rem; }
@media (max-width: 48rem) { /* a row becomes a card, each cell behind the name of its column */
  thead { display: none; } tr { display: block; padding: .5rem 0; border-bottom: 1px solid var(--line); }
  td { display: flex; gap: .8rem; padding: .15rem 0; border: 0; overflow-wrap: anywhere; }
  td::before { content: attr(data-head); flex: 0 0 7.5rem; font-size: .85rem; }
}</style>"""
_DONE = {"suspend": "The account was suspended and signed out.", "let-in": "The account can sign in again."}
"""The acts, and the sentence after each."""
HEADS = ("Account", "Runs kept", "Runs and studies", "Act")


def admin_routes(root: str, admin: Administration, accounts: Accounts) -> APIRouter:
    """``/admin`` (the page), and POST to it for its forms.

    Args:
        root: path under which the lab is.
        admin: what administrators do.
        accounts: whose roles say who is one.
    """
    router = APIRouter()

    @router.get("/admin")
    def show(request: Request, done: str = "") -> Response:
        _check(accounts, request)
        said = f'<p role="status">{_DONE[done]}</p>' if done in _DONE else ""
        rows = [_row(row, html.escape(f"{root}/admin", quote=True)) for row in admin.rows()]
        home = f'<p><a href="{html.escape(f"{root}/")}">Open the lab</a></p>'
        return never_kept(card(f"{_STYLE}{home}{said}<h2>People</h2>{table(rows)}"))

    @router.post("/admin")
    def act(request: Request, act: str = Form("", max_length=20), name: str = Form("", max_length=100)) -> Response:
        _check(accounts, request)
        if not request.headers.get("origin"):  # the guard has compared it with the host
            raise Refused(403, "Open the page /admin in a browser, or use `python -m webdemo admin`.", "admin")
        if act not in _DONE:
            raise Refused(422, "There is no such action: use the buttons of the page.", "admin")
        admin.suspend(name, suspended=act == "suspend")
        return RedirectResponse(f"{root}/admin?done={act}", status_code=303)

    return router


def _check(accounts: Accounts, request: Request) -> None:
    """Raises Refused for everybody but administrators."""
    account = accounts.of(visitor_of(request).account)
    if account is None or account.role != ADMIN:
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
