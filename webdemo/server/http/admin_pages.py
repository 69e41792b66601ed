"""``/admin``: the page of administrators. Plain HTML with forms, without scripts."""

from __future__ import annotations

import html
import shutil
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import RedirectResponse, Response

from motion import InputError
from webdemo.server.activity import Item, work_of
from webdemo.server.admin import Administration, versions
from webdemo.server.audit import audit
from webdemo.server.http.error_pages import never_kept
from webdemo.server.logs import LAST_ERRORS
from webdemo.server.store.people import ADMIN, MOST_ANNOUNCED
from webdemo.ui.visitor import visitor_of

from .admin_html import page, table
from .body_limits import Refused

if TYPE_CHECKING:
    from webdemo.server.lab import Lab

_DONE = {
    "end-run": "The run was ended.",
    "end-stream": "The stream was ended.",
    "room": "The room was set.",
    "suspend": "The account was suspended and signed out.",
    "let-in": "The account can sign in again.",
    "sign-out": "The account was signed out everywhere.",
    "delete": "The account was deleted with all its data.",
    "announce": "The announcement was changed.",
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
        _check_admin(lab, request)
        body = _page(lab, _DONE.get(done, ""))
        return never_kept(body)

    @router.post("/admin")
    async def act(request: Request) -> Response:
        _check_admin(lab, request)
        if not request.headers.get("origin"):  # the guard has compared it with the host
            raise Refused(403, "Open the page /admin in a browser, or use `python -m webdemo admin`.", "admin")
        form = await request.form()
        given = {name: value for name, value in form.items() if isinstance(value, str)}
        done = given.get("act", "")
        try:
            await run_in_threadpool(_act, lab, done, given)
        except InputError as error:
            raise Refused(422, str(error), "admin") from None
        return RedirectResponse(f"{root}/admin?done={done}", status_code=303)

    return router


def _check_admin(lab: Lab, request: Request) -> None:
    """Raises Refused for everybody but administrators."""
    who = visitor_of(request)
    if not who.account or lab.people.of(who.owner.removeprefix("user ")).role != ADMIN:
        audit("admin-page", ok=False)
        raise Refused(403, "This page is for administrators.", "admin")


def _act(lab: Lab, act: str, given: Mapping[str, str]) -> None:
    name, admin = given.get("name", ""), lab.administration
    assert admin is not None  # the routes are only there with accounts
    acts: dict[str, Callable[[], Any]] = {
        "end-run": lambda: _end(lab, "admin-end-run", given.get("id", "")),
        "end-stream": lambda: _end(lab, "admin-end-stream", given.get("id", "")),
        "room": lambda: admin.set_room(name, _megabytes(given.get("megabytes", ""))),
        "suspend": lambda: admin.suspend(name, suspended=True),
        "let-in": lambda: admin.suspend(name, suspended=False),
        "sign-out": lambda: admin.sign_out(name),
        "delete": lambda: _delete(lab, admin, name, given.get("confirm", "")),
        "announce": lambda: admin.announce(given.get("text", "")),
        "make-admin": lambda: admin.set_role(name, admin=True),
        "end-admin": lambda: admin.set_role(name, admin=False),
    }
    if act not in acts:
        raise InputError("There is no such act: use the buttons of the page.")
    acts[act]()


def _end(lab: Lab, act: str, key: str) -> None:
    if lab.end(key):
        audit(act, id=key)
    elif any(item.id == key for item in _elsewhere(lab)):
        lab.activity.end(key)
    else:
        audit(act, ok=False, id=key)
        raise InputError("It has ended already: go back and reload the page.")


def _megabytes(text: str) -> float | None:
    try:
        return float(text) if text.strip() else None
    except ValueError:
        raise InputError("The room must be a number of megabytes, or empty to lift it.") from None


def _delete(lab: Lab, admin: Administration, name: str, confirm: str) -> None:
    if confirm != name:
        raise InputError(f"Type the name {name!r:.60} into the field beside Delete to confirm.")
    for item in (*work_of(lab.name, lab.queue, lab.streams), *_elsewhere(lab)):
        if item.person == f"user {admin.key(name)}" and not lab.end(item.id):
            lab.activity.ask(item.id)
    admin.delete(name)


# ---- the page --------------------------------------------------------------------------------------


def _page(lab: Lab, done: str) -> str:
    assert lab.administration is not None
    lab.people.write()
    action = f"{lab.settings.root_path}/admin"
    parts = [
        ("People", _people(lab, lab.administration, action)),
        ("Runs and streams", _runs_and_streams(lab, action)),
        ("Announcement", _announcement(lab, action)),
        ("Health", _health(lab)),
        ("Last errors", _errors()),
    ]
    return page(parts, done=done, home=f"{lab.settings.root_path}/")


def _button(action: str, act: str, label: str, fields: str = "", **hidden: str) -> str:
    given = {"act": act, **hidden}
    inputs = "".join(
        f'<input type="hidden" name="{name}" value="{html.escape(value, quote=True)}">' for name, value in given.items()
    )
    target = html.escape(action, quote=True)
    return f'<form method="post" action="{target}">{inputs}{fields}<button>{label}</button></form>'


def _people(lab: Lab, admin: Administration, action: str) -> str:
    work = _work(lab)
    waiting = [item.person for item in work if item.state == "waits"]
    streams = [item.person for item in work if item.state == "open"]
    rows = []
    for row in admin.rows():
        name, owner = html.escape(row.name), f"user {admin.key(row.name)}"
        room = (
            f'<input name="megabytes" inputmode="decimal" size="6" aria-label="Room of {name} in megabytes" '
            f'placeholder="default" value="{f"{row.room:g}" if row.own_room else ""}">'
        )
        confirm = f'<input name="confirm" size="8" placeholder="{name}" aria-label="Type {name} to delete the account">'
        state = " ".join(filter(None, (row.role, "suspended" if row.suspended else "")))
        share = f"{row.megabytes:,.1f} of {row.kept:,.1f} MB" + (" <strong>full</strong>" if row.full else "")
        acts = [
            _button(action, "room", "Set room", room, name=row.name),
            _button(action, *(("let-in", "Let in") if row.suspended else ("suspend", "Suspend")), name=row.name),
            _button(action, "sign-out", "Sign out everywhere", name=row.name),
            _button(action, *(("end-admin", "No admin") if row.role else ("make-admin", "Make admin")), name=row.name),
            _button(action, "delete", "Delete with all data", confirm, name=row.name),
        ]
        rows.append(
            [
                f"<strong>{name}</strong> {state}",
                f"{row.runs:,}",
                f"{row.computed:,}",
                f"{row.minutes:.1f}",
                share,
                str(waiting.count(owner)),
                str(streams.count(owner)),
                f'<div class="acts">{"".join(acts)}</div>',
            ]
        )
    heads = (
        "Account",
        "Runs kept",
        "Runs computed",
        "Minutes computed",
        "Runs and studies",
        "Waiting",
        "Streams",
        "Acts",
    )
    return table(heads, rows, "no accounts")


def _work(lab: Lab) -> list[Item]:
    """Everything that runs, waits or is open: here as it is now, in other processes as they said last."""
    return work_of(lab.name, lab.queue, lab.streams) + _elsewhere(lab)


def _elsewhere(lab: Lab) -> list[Item]:
    return [item for item in lab.activity.items() if item.node != lab.name]


def _runs_and_streams(lab: Lab, action: str) -> str:
    now, several = time.time(), len(lab.activity.states()) > 1
    rows = [
        [
            _name(item.person),
            html.escape(item.what),
            item.state,
            f"{now - item.since:.0f} s",
            *([html.escape(item.node)] if several else []),
            _button(action, "end-stream" if item.state == "open" else "end-run", "End", id=item.id),
        ]
        for item in _work(lab)
    ]
    heads = ("Person", "Model", "State", "For", *(["Process"] if several else []), "Act")
    return table(heads, rows, "Nothing runs or waits.")


def _name(person: str) -> str:
    """A person as the table of people names them."""
    return html.escape(person.removeprefix("user ").partition("#")[0])


def _moment(line: Mapping[str, Any]) -> str:
    """The time of a line to the second, for people; its date and time may break apart and nothing else."""
    day, _, time_of_day = str(line.get("time", ""))[:19].partition("T")
    return f"{html.escape(day).replace('-', '&#8209;')} {html.escape(time_of_day)}"


def _announcement(lab: Lab, action: str) -> str:
    text = html.escape(lab.people.announced(), quote=True)
    field = (
        f'<label>Everybody is shown this line on the page; empty: none <input name="text" maxlength="{MOST_ANNOUNCED}" '
        f'value="{text}"></label>'
    )
    return _button(action, "announce", "Announce", field)


def _health(lab: Lab) -> str:
    _, report = lab.health.report()
    disk = shutil.disk_usage(lab.settings.data)
    rows = [["state", html.escape(str(report["status"]))]]
    rows += [[html.escape(name), html.escape(state)] for name, state in report["checks"].items()]
    rows += [
        ["disk space", f"{disk.free / 2**30:,.1f} of {disk.total / 2**30:,.1f} GB free"],
        ["queue", f"{lab.queue.waiting} wait, {lab.queue.running} run"],
        ["live streams", str(lab.streams.count)],
    ]
    rows += [[html.escape(name), html.escape(version)] for name, version in versions().items()]
    return table(("Part", "State"), rows, "")


def _errors() -> str:
    rows = [
        [
            _moment(line),
            html.escape(str(line["message"])),
            html.escape(str(line.get("error", ""))),
            html.escape(str(line.get("request", ""))),
        ]
        for line in reversed(LAST_ERRORS.lines)
    ]
    return table(("Time (UTC)", "Message", "Error", "Request"), rows, "No errors since this process started.")
