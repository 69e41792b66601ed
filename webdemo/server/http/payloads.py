"""The check of what a call of the page holds: known functions, declared values, and files that were uploaded here.

Gradio copies any file that a value names as ``{"path": …, "meta": {"_type": "gradio.FileData"}}`` into the
folder that it serves, whatever component the value is for, and fetches addresses of other hosts. What each
component takes is declared beside it, see :mod:`webdemo.ui.components.accepts`.
"""

from __future__ import annotations

import json
from typing import Any

import gradio as gr
from gradio.blocks import Blocks
from pydantic import TypeAdapter, ValidationError

from webdemo.server.store.scratch import owns
from webdemo.ui.components.accepts import Upload, accepts, accepts_event

from .routes import Refused

_FOREIGN = "A file must be uploaded before it can be used: choose it again."


class Payloads:
    """The functions of a page and what each takes.

    Args:
        page: the page.
    """

    def __init__(self, page: Blocks) -> None:
        self._inputs = {number: list(fn.inputs) for number, fn in page.fns.items() if fn.fn is not None}
        self._numbers = {str(fn.api_name): number for number, fn in page.fns.items() if fn.api_visibility == "public"}
        self._events = {
            number: [page.blocks[target] for target, _ in fn.targets if target is not None]
            for number, fn in page.fns.items()
            if fn.collects_event_data
        }

    def number_of(self, endpoint: str) -> int:
        """The API function of this name; raises Refused if there is none."""
        if endpoint not in self._numbers:
            raise Refused(404, "There is no endpoint of this name: see /gradio_api/info.", "forged")
        return self._numbers[endpoint]

    def check(self, fields: dict[str, Any], endpoint: int | None, person: str, *, brief: bool = False) -> None:
        """Raises Refused for a call that the page's own components would not make.

        Args:
            fields: the request's body.
            endpoint: the function that its address names, if it does.
            person: who sends it; files must be theirs.
            brief: whether what is kept for a program may be left out.
        """
        try:
            json.dumps(fields, ensure_ascii=False).encode()
        except (UnicodeEncodeError, RecursionError):
            raise Refused(400, "The text contains an incomplete character: write it again.", "bad body") from None
        function = fields.get("fn_index")
        if function is None:
            function = endpoint
        elif type(function) is not int or function not in self._inputs:
            raise Refused(404, "The page has no such function: reload it.", "forged")
        if fields.get("batched"):
            raise Refused(400, "Batched calls are not supported: send one call at a time, without batched.", "forged")
        self._check_data(fields.get("data"), function, person, brief)
        for component in self._events.get(function, ()) if function is not None else ():
            _validated(fields.get("event_data"), accepts_event(component), component)

    def _check_data(self, data: Any, function: int | None, person: str, brief: bool) -> None:
        if data is None:
            return
        if not isinstance(data, list):
            raise Refused(400, "The data of a call is a list of values.", "bad body")
        inputs = self._inputs[function] if function is not None else []
        if brief and len(inputs) != len(data):
            inputs = [block for block in inputs if not block.skip_api]
        if len(inputs) != len(data):
            raise Refused(
                400, f"The call has {len(data)} values and takes {len(inputs)}: see /gradio_api/info.", "bad body"
            )
        for value, component in zip(data, inputs, strict=True):
            check_value(value, component, person)


def check_value(value: Any, component: Any, person: str) -> None:
    """Raises Refused for a value that a component does not take, or that names a file of somebody else.

    Args:
        value: from JSON.
        component: of the page.
        person: who sends it.
    """
    taken = _validated(value, accepts(component), component)
    for file in taken if isinstance(taken, list) else [taken]:
        if isinstance(file, Upload) and not owns(person, file.path):
            raise Refused(403, _FOREIGN, "forged")


def _validated(value: Any, declared: TypeAdapter[Any], component: Any) -> Any:
    try:
        return declared.validate_python(value)
    except ValidationError:
        name = component.label or type(component).__name__
        sentence = f"“{name}” does not take such a value: reload the page, or see /gradio_api/info."
        if isinstance(component, gr.File):
            sentence = _FOREIGN
        raise Refused(400, sentence, "forged") from None
