"""Reads and sets cookies."""

from __future__ import annotations

from starlette.requests import cookie_parser
from starlette.responses import Response

from webdemo.server.settings import on_a_space


def set_cookie(response: Response, name: str, value: str, *, seconds: float, root: str, secure: bool) -> None:
    """Sets a cookie that scripts cannot read and other sites' forms do not send.

    Args:
        response: carries it.
        name: of the cookie.
        value: of the cookie.
        seconds: how long the browser keeps it.
        root: path below which it is sent; empty for all.
        secure: whether it is sent over TLS only.
    """
    space = on_a_space()  # there the page is in a frame of another site's
    response.set_cookie(
        name,
        value,
        max_age=int(seconds),
        path=root or "/",
        httponly=True,
        secure=secure or space,
        samesite="none" if space else "lax",
    )


def read_cookies(headers: dict[bytes, bytes]) -> dict[str, str]:
    """The cookies of a request, by their names."""
    return cookie_parser(headers.get(b"cookie", b"").decode("latin-1"))
