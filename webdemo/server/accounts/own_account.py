"""A person's own account: another password, and signing out in every browser."""

from __future__ import annotations

from fastapi import APIRouter, Form, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, RedirectResponse, Response

from motion import InputError
from webdemo.server.accounts.quotas import network_of
from webdemo.server.audit import audit
from webdemo.server.http.cookies import set_cookie
from webdemo.server.http.error_pages import account_card, never_kept
from webdemo.server.http.refused import Refused
from webdemo.server.settings import Settings
from webdemo.ui.visitor import visitor_of

from .throttle import TooManyTries
from .users import SignIns
from .visitors import NO_ACCOUNTS, SESSION_COOKIE, Visitors

_DIFFER = "The two new passwords differ: type them again."
_WRONG = "The password that you have now is another one: try again."
_CHANGED = "Your password is changed, and you are signed out everywhere else."


def account_routes(settings: Settings, sign_ins: SignIns, visitors: Visitors) -> APIRouter:
    """``/account`` (the page), and POST to ``/account/password`` and ``/account/sign-out``."""
    router = APIRouter()
    root = settings.root_path

    def page(request: Request, *, error: str = "", done: str = "", status: int = 200) -> HTMLResponse:
        body = account_card(home=f"{root}/", name=_account(request), error=error, done=done)
        return never_kept(body, status)

    @router.get("/account")
    def account(request: Request) -> Response:
        return page(request)

    @router.post("/account/password")
    async def change(
        request: Request,
        now: str = Form("", max_length=1000),
        new: str = Form("", max_length=1000),
        again: str = Form("", max_length=1000),
    ) -> Response:
        name, address = _account(request), network_of(request.client.host if request.client else "")
        if new != again:
            return page(request, error=_DIFFER, status=422)
        try:
            token = await run_in_threadpool(sign_ins.change, name, now, new, address)
        except TooManyTries as reason:
            return page(request, error=str(reason), status=429)
        except InputError as error:
            return page(request, error=str(error), status=422)
        audit("password-changed", ok=token is not None, person=name)
        if token is None:
            return page(request, error=_WRONG, status=401)
        visitors.forget_person(name)
        response = page(request, done=_CHANGED)
        _keep(response, request, token, sign_ins.seconds)
        return response

    @router.post("/account/sign-out")
    async def sign_out(request: Request) -> Response:
        name = _account(request)
        count = await run_in_threadpool(sign_ins.end_all, name)
        visitors.forget_person(name)
        audit("sign-out-everywhere", person=name, count=count)
        response = RedirectResponse(f"{root}/login", status_code=303)
        _keep(response, request, "", 0)
        return response

    def _keep(response: Response, request: Request, token: str, seconds: float) -> None:
        secure = request.url.scheme == "https"
        set_cookie(response, SESSION_COOKIE, token, seconds=seconds, root=root, secure=secure)

    return router


def _account(request: Request) -> str:
    account = visitor_of(request).account
    if not account:
        raise Refused(503, NO_ACCOUNTS, "accounts")
    return account
