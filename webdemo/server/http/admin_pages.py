"""``/admin``: the small page of administrators. Plain HTML with forms, without scripts."""

from __future__ import annotations

import html
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import RedirectResponse, Response

from motion import InputError
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.people import ADMIN
from webdemo.server.audit import audit
from webdemo.ui.visitor import visitor_of

from .error_pages import never_kept
from .routes import Refused

if TYPE_CHECKING:
    from webdemo.server.lab import Lab

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
<section><h2>People</h2>{people}</section><section><h2>Runs and streams</h2>{work}</section></main></body></html>"""
_DONE = {
    "end": "It was ended.",
    "room": "The room was set.",
    "suspend": "The account was suspended and signed out.",
    "let-in": "The account can sign in again.",
    "sign-out": "The account was signed out everywhere.",
    "delete": "The account was deleted with all its data.",
    "make-admin": "The account is an administrator.",
    "end-admin": "The account is no administrator any more.",
}
"""The acts, and the sentence after each."""


def admin_routes(lab: Lab) -> APIRouter:
    """``/admin`` (the page), and POST to it for its forms."""
    router = APIRouter()
    root = lab.settings.root_path

    @router.get("/admin")
    def show(request: Request, done: str = "") -> Response:
        admin = _administration(lab, request)
        said = f'<p role="status">{_DONE[done]}</p>' if done in _DONE else ""
        people, work = _people(lab, admin, f"{root}/admin"), _work(lab, f"{root}/admin")
        return never_kept(_PAGE.format(home=html.escape(f"{root}/"), done=said, people=people, work=work))

    @router.post("/admin")
    async def act(request: Request) -> Response:
        admin = await run_in_threadpool(_administration, lab, request)
        if not request.headers.get("origin"):  # the guard has compared it with the host
            raise Refused(403, "Open the page /admin in a browser, or use `python -m webdemo admin`.", "admin")
        form = await request.form()
        given = {name: value for name, value in form.items() if isinstance(value, str)}
        try:
            await run_in_threadpool(_act, lab, admin, given)
        except InputError as error:
            raise Refused(422, str(error), "admin") from None
        return RedirectResponse(f"{root}/admin?done={given['act']}", status_code=303)

    return router


def _administration(lab: Lab, request: Request) -> Administration:
    """The acts of administrators; raises Refused for everybody else."""
    who = visitor_of(request)
    admin = lab.administration
    if admin is None or not who.account or admin.people.of(who.owner.removeprefix("user ")).role != ADMIN:
        audit("admin-page", ok=False)
        raise Refused(403, "This page is for administrators.", "admin")
    return admin


def _act(lab: Lab, admin: Administration, given: Mapping[str, str]) -> None:
    name = given.get("name", "")
    acts: dict[str, Callable[[], Any]] = {
        "end": lambda: _end(lab, given.get("id", "")),
        "room": lambda: admin.set_room(name, _megabytes(given.get("megabytes", ""))),
        "suspend": lambda: admin.suspend(name, suspended=True),
        "let-in": lambda: admin.suspend(name, suspended=False),
        "sign-out": lambda: admin.sign_out(name),
        "delete": lambda: _delete(lab, admin, name, given.get("confirm", "")),
        "make-admin": lambda: admin.set_role(name, admin=True),
        "end-admin": lambda: admin.set_role(name, admin=False),
    }
    if given.get("act") not in acts:
        raise InputError("There is no such act: use the buttons of the page.")
    acts[given["act"]]()


def _end(lab: Lab, key: str) -> None:
    ended = lab.end(key)
    audit("admin-end", ok=ended, id=key)
    if not ended:
        raise InputError("It has ended already: go back and reload the page.")


def _megabytes(text: str) -> float | None:
    try:
        return float(text) if text.strip() else None
    except ValueError:
        raise InputError("The room must be a number of megabytes, or empty to lift it.") from None


def _delete(lab: Lab, admin: Administration, name: str, confirm: str) -> None:
    if confirm != name:
        raise InputError(f"Type the name {name!r:.60} into the field beside Delete to confirm.")
    for item in lab.work():
        if item.person == f"user {admin.key(name)}":
            lab.end(item.id)
    admin.delete(name)


# ---- the page --------------------------------------------------------------------------------------


def _people(lab: Lab, admin: Administration, action: str) -> str:
    rows = []
    for row in admin.rows():
        name = html.escape(row.name, quote=True)
        room = (
            f'<input name="megabytes" inputmode="decimal" size="6" aria-label="Room of {name} in megabytes" '
            f'placeholder="default" value="{f"{row.room:g}" if row.own_room else ""}">'
        )
        confirm = f'<input name="confirm" size="8" placeholder="{name}" aria-label="Type {name} to delete the account">'
        state = " ".join(filter(None, (row.role, "suspended" if row.suspended else "")))
        acts = [
            _button(action, "room", "Set room", room, name=row.name),
            _button(action, *(("let-in", "Let in") if row.suspended else ("suspend", "Suspend")), name=row.name),
            _button(action, "sign-out", "Sign out everywhere", name=row.name),
            _button(action, *(("end-admin", "No admin") if row.role else ("make-admin", "Make admin")), name=row.name),
            _button(action, "delete", "Delete with all data", confirm, name=row.name),
        ]
        used = f"{row.megabytes:,.1f} of {row.room:,.1f} MB"
        rows.append([f"<strong>{name}</strong> {state}", f"{row.runs:,}", used, "".join(acts)])
    return table(("Account", "Runs kept", "Runs and studies", "Acts"), rows, "no accounts")


def _work(lab: Lab, action: str) -> str:
    now = time.monotonic()
    rows = [
        [
            html.escape(item.person.removeprefix("user ").partition("#")[0]),  # as the table of people names them
            html.escape(item.what),
            item.state,
            f"{now - item.since:.0f} s",
            _button(action, "end", "End", id=item.id),
        ]
        for item in lab.work()
    ]
    return table(("Person", "Model", "State", "For", "Act"), rows, "Nothing runs or waits.")


def _button(action: str, act: str, label: str, fields: str = "", **hidden: str) -> str:
    given = {"act": act, **hidden}
    inputs = "".join(
        f'<input type="hidden" name="{name}" value="{html.escape(value, quote=True)}">' for name, value in given.items()
    )
    target = html.escape(action, quote=True)
    return f'<form method="post" action="{target}">{inputs}{fields}<button>{label}</button></form>'


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
