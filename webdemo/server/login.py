"""Signing in and out: one small page, and the same address for programs."""

from __future__ import annotations

from urllib.parse import urlsplit

from fastapi import APIRouter, Form, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response

from webdemo.motion import InputError

from .accounts import SignIns
from .cards import sign_in_card
from .guard import cookie_header
from .settings import Settings
from .visitors import SESSION_COOKIE, Visitors


def login_routes(settings: Settings, sign_ins: SignIns, visitors: Visitors) -> APIRouter:
    """``/login`` (the page, and POST for it and for gradio_client) and ``/logout``."""
    router = APIRouter()
    root = settings.root_path

    def page(wanted: str, *, name: str = "", error: str = "", status: int = 200) -> HTMLResponse:
        body = sign_in_card(action=f"{root}/login", wanted=wanted, name=name[:40], error=error)
        return HTMLResponse(body, status_code=status, headers={"Cache-Control": "no-store"})

    def cookie(request: Request, token: str, seconds: float) -> str:
        secure = request.url.scheme == "https"
        return cookie_header(SESSION_COOKIE, token, seconds=seconds, root=root, secure=secure)

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
        address = request.client.host if request.client else ""
        error, status, token = "Name and password do not fit: try again.", 401, None
        try:
            token = await run_in_threadpool(sign_ins.begin, username.strip().lower(), password, address)
        except InputError as reason:
            error, status = str(reason), 429
        if token is None:
            return (
                page(_own_path(next), name=username, error=error, status=status)
                if in_browser
                else JSONResponse({"detail": error}, status_code=status)
            )
        response: Response = (
            RedirectResponse(f"{root}{_own_path(next)}", status_code=303)
            if in_browser
            else JSONResponse({"success": True})
        )
        response.headers["Set-Cookie"] = cookie(request, token, sign_ins.seconds)
        return response

    @router.post("/logout")
    @router.get("/logout")
    async def sign_out(request: Request) -> Response:
        token = request.cookies.get(SESSION_COOKIE, "")
        if token and request.headers.get("sec-fetch-site", "same-origin") in ("same-origin", "none"):
            await run_in_threadpool(sign_ins.end, token)
            visitors.forget(token)
        response = RedirectResponse(f"{root}/login", status_code=303)
        response.headers["Set-Cookie"] = cookie(request, "", 0)
        return response

    return router


def _own_path(wanted: str) -> str:
    """A path on this server: an address of another host, or a header's line break, becomes the page."""
    parts = urlsplit(wanted)
    plain = wanted.isprintable() and wanted.isascii() and not any(c in wanted for c in "\\ \"'<>")
    return (
        wanted
        if plain and wanted.startswith("/") and not wanted.startswith("//") and not parts.netloc
        else "/"
    )
