"""Request bodies within a size and a time."""

from __future__ import annotations

import asyncio
import time
from typing import Any

from starlette.types import Message, Receive


class Refused(Exception):
    """A request that is not passed on.

    Attributes:
        status: the HTTP status.
        sentence: what the client is told.
        reason: by which it is counted.
    """

    def __init__(self, status: int, sentence: str, reason: str) -> None:
        super().__init__(sentence)
        self.status, self.sentence, self.reason = status, sentence, reason


def declared_length(headers: dict[bytes, bytes]) -> int:
    """What Content-Length says, 0 without one; raises Refused where it is no number."""
    value = headers.get(b"content-length", b"0")
    if not value.isdigit() or len(value) > 15:
        raise Refused(400, "The request's Content-Length is not a number.", "bad head")
    return int(value)


class BoundedBody:
    """Passes a body on while it is within its limits.

    Args:
        receive: where it comes from.
        most: bytes that it may have.
        seconds: time from now in which it must be there.
    """

    def __init__(self, receive: Receive, *, most: float, seconds: float) -> None:
        self._receive, self.most = receive, most
        self._until = time.monotonic() + seconds
        self._size = 0
        self._ended = False
        self._kept: list[Message] = []
        self.refused: Refused | None = None
        """Why the body was not passed on; whoever read it may have made another answer of that."""

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
        if self._ended:  # what comes now is the disconnection, however late
            return await self._receive()
        try:
            message = await asyncio.wait_for(self._receive(), max(0.0, self._until - time.monotonic()))
        except asyncio.TimeoutError:
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
        """All of the body; it is passed on afterwards as if it had not been read."""
        messages: list[Any] = []
        while not self._ended:
            messages.append(await self())
        self._kept = messages
        return b"".join(message.get("body", b"") for message in messages)


def too_large(most: float) -> Refused:
    """The refusal of a body above ``most`` bytes."""
    return Refused(413, f"The request has more than the {most / 2**20:g} MB allowed: send less.", "too large")
