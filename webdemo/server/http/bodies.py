"""Limits of size and time for request bodies."""

from __future__ import annotations

import asyncio
import time
from pathlib import PurePath
from typing import Any

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.types import Message, Receive

from .routes import Refused


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


# ---- the form of an upload --------------------------------------------------------------------------


MOST_FILES = 16
"""Files in one upload."""


class UploadForm:
    """Reads the heads of a form's parts.

    Args:
        content_type: the request's.

    Raises:
        Refused: if it is no form with files.
    """

    def __init__(self, content_type: bytes) -> None:
        kind, options = parse_options_header(content_type)
        boundary = options.get(b"boundary", b"")
        if kind != b"multipart/form-data" or not boundary or len(boundary) > 200:
            raise _malformed("it is not multipart/form-data")
        if options.get(b"charset", b"utf-8").lower() not in (b"utf-8", b"utf8"):
            raise _malformed("its character set is not UTF-8")
        self._name, self._value = b"", b""
        self._disposition = b""
        self._files, self._ended = 0, False
        self._parser = MultipartParser(
            boundary,
            {
                "on_header_field": self._on_name,
                "on_header_value": self._on_value,
                "on_header_end": self._on_header,
                "on_headers_finished": self._on_part,
                "on_end": self._on_end,
            },
        )

    def feed(self, chunk: bytes, *, last: bool) -> None:
        """Takes what came of the body; raises Refused if its form is wrong."""
        try:
            self._parser.write(chunk)
        except FormParserError:
            raise _malformed("its form is damaged") from None
        if last and not (self._ended and self._files):
            raise _malformed("its form is cut short" if self._files else "no file is in it")

    def _on_name(self, data: bytes, start: int, end: int) -> None:
        self._name += data[start:end]

    def _on_value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]
        if len(self._value) > 8192:
            raise _malformed("the head of a file is too long")

    def _on_header(self) -> None:
        if self._name.lower() == b"content-disposition":
            self._disposition = self._value
        self._name, self._value = b"", b""

    def _on_part(self) -> None:
        _, options = parse_options_header(self._disposition)
        self._disposition = b""
        name = options.get(b"filename", b"").decode("utf-8", "replace")
        if options.get(b"name") != b"files" or b"filename" not in options:
            raise _malformed('its files must be called "files"')
        if not any(letter.isalnum() for letter in PurePath(name).name):
            raise _malformed("a file has no name")
        self._files += 1
        if self._files > MOST_FILES:
            raise _malformed(f"it has more than {MOST_FILES} files")

    def _on_end(self) -> None:
        self._ended = True


def _malformed(reason: str) -> Refused:
    return Refused(400, f"The upload cannot be read, {reason}: choose the file again.", "bad body")
