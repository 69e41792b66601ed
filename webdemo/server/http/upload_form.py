"""The form of an upload, looked at while it passes: Gradio takes it for granted that it is whole."""

from __future__ import annotations

from pathlib import PurePath

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from .refused import Refused

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
