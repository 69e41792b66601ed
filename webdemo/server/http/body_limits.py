"""Limits of size and time for request bodies."""

from __future__ import annotations

import asyncio
import time
from typing import Any

from starlette.types import Message, Receive

from .refused import Refused
from .upload_form import UploadForm


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
        form: checks the parts of an upload on the way.
    """

    def __init__(self, receive: Receive, *, most: float, seconds: float, form: UploadForm | None = None) -> None:
        self._receive, self.most, self._form = receive, most, form
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
            if self._form is not None:
                self._form.feed(message.get("body", b""), last=self._ended)
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
