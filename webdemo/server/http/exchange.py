"""One request, its body within limits of size and time, and the answer to it."""

from __future__ import annotations

import asyncio
import json
import random
import time
from typing import Any

from starlette.datastructures import MutableHeaders
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.types import Message, Receive, Scope, Send

from webdemo.server.settings import on_a_space

from .error_pages import message_card
from .routes import EMBED, NOTHING, Refused, is_public_page, is_upload

_FROM_HERE = (
    "default-src 'none'",
    "worker-src 'self' blob:",
    "style-src 'self' 'unsafe-inline'",
    "img-src 'self' data: blob:",
    "connect-src 'self' data: blob:",
)
_POLICY = (
    *_FROM_HERE,
    # Gradio starts by scripts within the page and compiles those of its events; WebGL drawing does as well.
    "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",
    "media-src 'self' data: blob:",
    "font-src 'self' data:",
    "manifest-src 'self'",
    "form-action 'self'",
    "base-uri 'self'",
)
"""Content security policy: the page loads everything from this server, nothing from other hosts."""
_PUBLIC_POLICY = (*_FROM_HERE, "script-src 'self' 'unsafe-eval' blob:", "form-action 'none'", "base-uri 'none'")
"""That of public pages, which run no script within the page and send nothing; drawing by WebGL compiles."""
_NOT_FRAMED = "frame-ancestors 'self'"
"""Not on a Space, which shows its page in a frame."""
BACK_OFF = 1.0
"""Seconds before anybody is told of a mistake of theirs, and a quarter of those before they are told that they ask too
often. A program would ask again at once, and to refuse costs as much as to serve: so a connection that does nothing
else costs one refusal in that time."""
BAD_UPLOAD = "The upload cannot be read: choose the file again."


class Exchange:
    """A request, and what is sent for it: an id and safe headers on every answer, sentences for errors.

    Args:
        scope: the request's.
        send: where the answer goes.
        root: path under which the page is.

    Attributes:
        reference: the request's id.
        headers: the request's; the last of several of one name.
        status: of the answer; 0 while none was sent.
        first_byte: seconds until the answer began.
        body: the request's; a refusal of it is the answer, whatever its reader makes of that.
        cookie: a Set-Cookie header that the answer gets.
        path: below ``root``; "" until the guard has read it.
    """

    def __init__(self, scope: Scope, send: Send, *, root: str) -> None:
        self.scope, self._send, self._root = scope, send, root
        self.path = ""
        self.reference = f"{random.getrandbits(48):012x}"
        self.headers: dict[bytes, bytes] = dict(scope["headers"])
        self.status, self.first_byte = 0, 0.0
        self.body: BoundedBody | None = None
        self.cookie = ""
        self._began = time.perf_counter()
        self._held: list[Message] = []

    @property
    def in_browser(self) -> bool:
        """True if somebody looks at the answer."""
        return b"text/html" in self.headers.get(b"accept", b"")

    @property
    def seconds(self) -> float:
        """Seconds since the request arrived."""
        return time.perf_counter() - self._began

    async def answer(self, message: Message) -> None:
        """Sends a part of the page's answer, or holds it where there may be something better to say."""
        if self.body is not None and self.body.refused is not None and not self.status:
            return
        if self._held or (message["type"] == "http.response.start" and self._is_replaced(message["status"])):
            self._held.append(message)
            return
        await self._pass_on(message)

    def _is_replaced(self, status: int) -> bool:
        return status == 500 or (status == 404 and self.in_browser) or (status in (400, 413) and is_upload(self.path))

    async def finish(self) -> None:
        """Sends what was held; raises Refused for a place or an upload that is none, or a body that was refused."""
        if self.body is not None and self.body.refused is not None:
            raise self.body.refused
        if self._held and self._held[0]["status"] == 404:
            raise Refused(404, NOTHING, "not found")
        if self._held and self._held[0]["status"] in (400, 413):
            raise Refused(400, BAD_UPLOAD, "bad body")
        if self._held and _is_sentence(self._held):
            self._held[0]["status"] = 422
        for message in self._held:
            await self._pass_on(message)

    async def refuse(self, refused: Refused) -> None:
        """Answers with a sentence, where no answer has begun."""
        if not self.status:
            await self.respond(self._refusal(refused))

    async def respond(self, response: Response) -> None:
        """Answers with a response of ours."""
        await response(self.scope, _nothing, self._pass_on)

    async def _pass_on(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            if 400 <= message["status"] < 500:
                await asyncio.sleep(BACK_OFF * (4 if message["status"] == 429 else 1))
            self.status, self.first_byte = message["status"], self.seconds
            self._dress(MutableHeaders(scope=message))
        await self._send(message)

    def _dress(self, headers: MutableHeaders) -> None:
        headers["X-Request-ID"] = self.reference
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "same-origin"  # the address of an opened run is its key
        headers["Content-Security-Policy"] = "; ".join(self._policy())
        if self.cookie:
            headers.append("Set-Cookie", self.cookie)

    def _policy(self) -> tuple[str, ...]:
        """The content security policy of the answer."""
        if self.path.startswith(EMBED):
            return *_PUBLIC_POLICY, "frame-ancestors *"
        policy = _PUBLIC_POLICY if is_public_page(self.path) else _POLICY
        return policy if on_a_space() else (*policy, _NOT_FRAMED)

    def _refusal(self, refused: Refused) -> Response:
        if self.in_browser:
            page = message_card(refused.sentence, home=f"{self._root}/", reference=self.reference)
            return HTMLResponse(page, status_code=refused.status)
        content = {"detail": refused.sentence, "request": self.reference}
        return JSONResponse(content, status_code=refused.status)


def _is_sentence(answer: list[Message]) -> bool:
    """True if a response is Gradio's error about a value, which has status 500."""
    try:
        content = json.loads(b"".join(message.get("body", b"") for message in answer))
    except ValueError:
        return False
    return isinstance(content, dict) and isinstance(content.get("error"), str) and "title" in content


async def _nothing() -> Message:
    return {"type": "http.disconnect"}


# ---- limits of size and time for request bodies --------------------------------------------------


def declared_length(headers: dict[bytes, bytes]) -> int:
    """The value of Content-Length, 0 without one; raises Refused if it is not a number."""
    value = headers.get(b"content-length", b"0")
    if not value.isdigit() or len(value) > 15:
        raise Refused(400, "The request's Content-Length is not a number.", "bad head")
    return int(value)


class BoundedBody:
    """Forwards a body while it is within its limits.

    Args:
        receive: source of the body.
        most: most bytes.
        seconds: time from now in which it must arrive.
    """

    def __init__(self, receive: Receive, *, most: float, seconds: float) -> None:
        self._receive, self.most = receive, most
        self._until = time.monotonic() + seconds
        self._size = 0
        self._ended = False
        self._kept: list[Message] = []
        self.refused: Refused | None = None
        """Why the body was refused, if it was; the application may have turned that into another response."""

    async def __call__(self) -> Message:
        """The next message; raises Refused for a body that is too large or too slow."""
        if self._kept:
            return self._kept.pop(0)
        try:
            return await self._next()
        except Refused as refused:
            self.refused = refused
            raise

    async def _next(self) -> Message:
        if self._ended:  # only the disconnection can follow, at any time
            return await self._receive()
        try:
            message = await asyncio.wait_for(self._receive(), max(0.0, self._until - time.monotonic()))
        except TimeoutError:
            raise Refused(408, "The request's body did not arrive in time: send it again.", "slow") from None
        if message["type"] == "http.request":
            self._size += len(message.get("body", b""))
            self._ended = not message.get("more_body", False)
            if self._size > self.most:
                raise too_large(self.most)
        else:
            self._ended = True
        return message

    async def whole(self) -> bytes:
        """Reads the whole body; the application can read it again afterwards."""
        messages: list[Any] = []
        while not self._ended:
            messages.append(await self())
        self._kept = messages
        return b"".join(message.get("body", b"") for message in messages)


def too_large(most: float) -> Refused:
    """The refusal of a body above ``most`` bytes."""
    return Refused(413, f"The request has more than the {most / 2**20:g} MB allowed: send less.", "too large")
