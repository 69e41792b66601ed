"""The check of what a call of the page holds: known functions, plain values, and files that were uploaded here.

Gradio copies any file that a value names as ``{"path": …, "meta": {"_type": "gradio.FileData"}}`` into the
folder that it serves, whatever component the value is for, and fetches addresses of other hosts.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gradio as gr
from gradio.blocks import Blocks

from webdemo.server.store.personal_files import owns

from .body_limits import Refused

_FOREIGN = "A file must be uploaded before it can be used: choose it again."
_NOT_TEXT = "One of the values is neither text nor a number: reload the page, or see /gradio_api/info."


class Payloads:
    """The functions of a page and what each takes.

    Args:
        page: the page.
    """

    def __init__(self, page: Blocks) -> None:
        self._inputs = {number: list(fn.inputs) for number, fn in page.fns.items()}
        self._numbers = {
            str(fn.api_name): number for number, fn in page.fns.items() if fn.api_visibility == "public"
        }

    def number_of(self, endpoint: str) -> int:
        """The API function of this name; raises Refused if there is none."""
        if endpoint not in self._numbers:
            raise Refused(404, "There is no endpoint of this name: see /gradio_api/info.", "forged")
        return self._numbers[endpoint]

    def check(self, fields: dict[str, Any], endpoint: int | None, person: str) -> None:
        """Raises Refused for a call that the page's own components would not make.

        Args:
            fields: the request's body.
            endpoint: the function that its address names, if it does.
            person: who sends it; files must be theirs.
        """
        for text in _texts(fields):
            if not text.isascii() and any("\ud800" <= c <= "\udfff" for c in text):
                raise Refused(400, "The text contains an incomplete character: write it again.", "bad body")
        function = fields.get("fn_index")
        if function is None:
            function = endpoint
        elif type(function) is not int or function not in self._inputs:
            raise Refused(404, "The page has no such function: reload it.", "forged")
        if fields.get("batched"):
            raise Refused(
                400, "Batched calls are not supported: send one call at a time, without batched.", "forged"
            )
        data = fields.get("data")
        if data is None:
            return
        if not isinstance(data, list):
            raise Refused(400, "The data of a call is a list of values.", "bad body")
        inputs = self._inputs[function] if function is not None else []
        if len(inputs) != len(data):  # programs leave out what is kept for them
            inputs = [block for block in inputs if not block.skip_api]
        if len(inputs) != len(data):
            raise Refused(
                400,
                f"The call has {len(data)} values and takes {len(inputs)}: see /gradio_api/info.",
                "bad body",
            )
        for value, component in zip(data, inputs, strict=True):
            _check_value(value, component, person)


def _check_value(value: Any, component: Any, person: str) -> None:
    if value is None:
        return
    if isinstance(component, gr.File | gr.UploadButton):
        for file in value if isinstance(value, list) else [value]:
            _check_file(file, person)
        return
    text = isinstance(component, gr.Textbox)
    plain = value if isinstance(value, list) and not text else [value]
    kinds = (str,) if text else (str, int, float, type(None))
    if not all(isinstance(each, kinds) for each in plain):
        raise Refused(400, _NOT_TEXT, "forged")


def _check_file(file: Any, person: str) -> None:
    path = file.get("path") if isinstance(file, dict) else None
    if not isinstance(path, str) or not isinstance(file.get("meta", {}), dict):
        raise Refused(400, _FOREIGN, "forged")
    if not owns(person, path):
        raise Refused(403, _FOREIGN, "forged")


def _texts(value: Any) -> Iterator[str]:
    waiting = [value]
    while waiting:
        match waiting.pop():
            case str() as text:
                yield text
            case dict() as fields:
                waiting += [*fields, *fields.values()]
            case list() as items:
                waiting += items
