"""Signing in and out: one small page, and the same address for programs."""

from __future__ import annotations

from urllib.parse import urlsplit

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import APIRouter, Form, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response

from webdemo.server.accounts.quotas import network_of
from webdemo.server.audit import audit
from webdemo.server.http.error_pages import never_kept, sign_in_card
from webdemo.server.http.routes import Refused
from webdemo.server.settings import Settings

from .accounts import Accounts
from .visitors import KNOWN_COOKIE, SESSION_COOKIE, YEAR, set_cookie

AT_ONCE = 2
"""Passwords that are checked at a time, so that guesses cannot take all memory and cores; further ones wait. One more
is that of a browser in which somebody has signed in before, which waits for no guess of strangers."""
WRONG = "The name or the password is wrong: try again."


def login_routes(settings: Settings, accounts: Accounts) -> APIRouter:
    """``/login`` (the page, and POST for it and for gradio_client) and ``/logout``."""
    router = APIRouter()
    root = settings.root_path
    places, known_places = CapacityLimiter(AT_ONCE), CapacityLimiter(1)

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
        known = request.cookies.get(KNOWN_COOKIE, "")
        admitted = await run_in_threadpool(accounts.admit, name, address, known)  # who is refused waits for nobody
        token = await run_sync(accounts.begin, admitted, password, limiter=known_places if admitted[2] else places)
        if token is None:
            if in_browser:
                return page(_own_path(next), name=username, error=WRONG, status=401)
            return JSONResponse({"detail": WRONG}, status_code=401)
        opened = RedirectResponse(f"{root}{_own_path(next)}", status_code=303)
        response: Response = opened if in_browser else JSONResponse({"success": True})
        keep(response, request, SESSION_COOKIE, token, accounts.seconds)
        keep(response, request, KNOWN_COOKIE, await run_in_threadpool(accounts.known_browser, name), YEAR)
        return response

    @router.get("/logout")
    def sign_out_first() -> Response:
        raise Refused(405, "A link cannot sign you out: use the button on the page.", "bad method")

    @router.post("/logout")
    async def sign_out(request: Request) -> Response:
        if token := request.cookies.get(SESSION_COOKIE, ""):
            await run_in_threadpool(accounts.end, token)
            audit("sign-out")
        response = RedirectResponse(f"{root}/login", status_code=303)
        keep(response, request, SESSION_COOKIE, "", 0)
        return response

    return router


def _own_path(wanted: str) -> str:
    """A path on this server: an address of another host, or a header's line break, becomes the page."""
    parts = urlsplit(wanted)
    plain = wanted.isprintable() and wanted.isascii() and not any(c in wanted for c in "\\ \"'<>")
    return wanted if plain and wanted.startswith("/") and not wanted.startswith("//") and not parts.netloc else "/"
