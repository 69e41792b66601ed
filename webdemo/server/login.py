"""Signing in and out: one small page, and the same address for programs."""

from __future__ import annotations

import html
from urllib.parse import urlsplit

from fastapi import APIRouter, Form, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response

from webdemo.motion import InputError

from .accounts import SignIns
from .guard import cookie_header
from .settings import Settings
from .visitors import SESSION_COOKIE, Visitors

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Pas de Deux</title><style>
:root {{ color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif; }}
body {{ margin: 0; min-height: 100vh; display: grid; place-items: center;
  background: #f4f6fa; color: #1e2733; }}
main {{ width: min(22rem, 90vw); padding: 2rem; border-radius: 12px; background: #fff;
  box-shadow: 0 1px 4px #0002; }}
h1 {{ margin: 0 0 1rem; font-size: 1.3rem; }}
label {{ display: block; margin: 0 0 .9rem; font-weight: 600; font-size: .9rem; }}
input {{ display: block; width: 100%; box-sizing: border-box; margin-top: .3rem;
  padding: .55rem .7rem; font: inherit;
  border: 1px solid #c3cad5; border-radius: 8px; background: transparent; color: inherit; }}
button {{ width: 100%; padding: .6rem; border: 0; border-radius: 8px; font: inherit; font-weight: 600;
  background: #2563eb; color: #fff; cursor: pointer; }}
p {{ margin: 0 0 1rem; color: #b42318; }}
@media (prefers-color-scheme: dark) {{
  body {{ background: #0f131a; color: #e6eaf0; }} main {{ background: #181d27; }}
  input {{ border-color: #3a4454; }} p {{ color: #ff9c92; }} }}
</style></head><body><main><h1>Pas de Deux</h1>{error}
<form method="post" action="{action}"><input type="hidden" name="next" value="{next}">
<label>Name<input name="username" autocomplete="username" autofocus required maxlength="40"></label>
<label>Password<input name="password" type="password" autocomplete="current-password" required></label>
<button>Sign in</button></form></main></body></html>"""


def login_routes(settings: Settings, sign_ins: SignIns, visitors: Visitors) -> APIRouter:
    """``/login`` (the page, and POST for it and for gradio_client) and ``/logout``."""
    router = APIRouter()
    root = settings.root_path

    def page(wanted: str, error: str = "", status: int = 200) -> HTMLResponse:
        told = f'<p role="alert">{html.escape(error)}</p>' if error else ""
        body = _PAGE.format(error=told, action=f"{root}/login", next=html.escape(wanted, quote=True))
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
                page(_own_path(next), error, status)
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
