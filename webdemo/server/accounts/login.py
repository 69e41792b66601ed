"""Signing in and out: one small page, and the same address for programs."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from urllib.parse import urlsplit

from fastapi import APIRouter, Form, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response

from motion import InputError
from webdemo.server.accounts.quotas import network_of
from webdemo.server.audit import audit
from webdemo.server.http.error_pages import never_kept, sign_in_card
from webdemo.server.http.routes import Refused
from webdemo.server.settings import Settings

from .users import SignIns, Suspended, TooManyTries
from .visitors import KNOWN_COOKIE, NO_ACCOUNTS, SESSION_COOKIE, set_cookie

AT_ONCE = 2
"""Passwords that are checked at a time; further tries wait without holding a thread."""
WRONG = "The name or the password is wrong: try again."
KNOWN_SECONDS = 365 * 86_400
"""How long a browser is remembered as one in which somebody has signed in."""


def login_routes(settings: Settings, sign_ins: SignIns) -> APIRouter:
    """``/login`` (the page, and POST for it and for gradio_client) and ``/logout``."""
    router = APIRouter()
    root = settings.root_path
    places = asyncio.Semaphore(AT_ONCE)

    def page(wanted: str, *, name: str = "", error: str = "", status: int = 200) -> HTMLResponse:
        body = sign_in_card(action=f"{root}/login", wanted=wanted, name=name[:40], error=error)
        return never_kept(body, status)

    def keep(response: Response, request: Request, cookie: str, value: str, seconds: float) -> None:
        secure = request.url.scheme == "https"
        set_cookie(response, cookie, value, seconds=seconds, root=root, secure=secure)

    @router.get("/login")
    def ask(next: str = "/") -> Response:
        return page(_own_path(next))

    @router.post("/login")
    async def sign_in(
        request: Request,
        username: str = Form("", max_length=200),
        password: str = Form("", max_length=1000),
        next: str = Form("/", max_length=4096),
    ) -> Response:
        in_browser = "text/html" in request.headers.get("accept", "")
        address, name = network_of(request.client.host if request.client else ""), username.strip().lower()
        error, status, token = WRONG, 401, None
        try:
            async with places:
                known = request.cookies.get(KNOWN_COOKIE, "")
                token = await run_in_threadpool(sign_ins.begin, name, password, address, known)
        except (TooManyTries, Suspended) as reason:
            error, status = str(reason), 429 if isinstance(reason, TooManyTries) else 403
        except InputError:
            raise Refused(503, NO_ACCOUNTS, "accounts") from None
        await run_in_threadpool(_note, sign_ins, name, token, status)
        if token is None:
            if in_browser:
                return page(_own_path(next), name=username, error=error, status=status)
            return JSONResponse({"detail": error}, status_code=status)
        opened = RedirectResponse(f"{root}{_own_path(next)}", status_code=303)
        response: Response = opened if in_browser else JSONResponse({"success": True})
        keep(response, request, SESSION_COOKIE, token, sign_ins.seconds)
        keep(response, request, KNOWN_COOKIE, sign_ins.known_browser(name), KNOWN_SECONDS)
        return response

    @router.get("/logout")
    def sign_out_first() -> Response:
        raise Refused(405, "A link cannot sign you out: use the button on the page.", "bad method")

    @router.post("/logout")
    async def sign_out(request: Request) -> Response:
        if token := request.cookies.get(SESSION_COOKIE, ""):
            await run_in_threadpool(sign_ins.end, token)
            audit("sign-out")
        response = RedirectResponse(f"{root}/login", status_code=303)
        keep(response, request, SESSION_COOKIE, "", 0)
        return response

    return router


def _note(sign_ins: SignIns, name: str, token: str | None, status: int) -> None:
    """Writes a try into the audit log. A name that is none may be a password in the wrong field: it is left out."""
    known = token is not None
    with suppress(InputError):  # the accounts cannot be read any more
        known = known or sign_ins.users.entry(name) is not None
    whys = {401: "wrong name or password", 403: "suspended", 429: "too many tries"}
    why = None if token else whys[status]
    audit("sign-in", ok=token is not None, person=name if known else "(unknown)", how="password", reason=why)


def _own_path(wanted: str) -> str:
    """A path on this server: an address of another host, or a header's line break, becomes the page."""
    parts = urlsplit(wanted)
    plain = wanted.isprintable() and wanted.isascii() and not any(c in wanted for c in "\\ \"'<>")
    return wanted if plain and wanted.startswith("/") and not wanted.startswith("//") and not parts.netloc else "/"
