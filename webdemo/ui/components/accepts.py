"""Values that a browser or a program may send for each component of the page.

A component of ours declares it in its class, as ``accepts`` for its value and ``accepts_event`` for the data of its
events; Gradio's own are declared here. The server's guard refuses everything else before Gradio sees it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

import gradio as gr
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

Finite: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-(2.0**53), le=2.0**53)]
"""A number that JavaScript can count to; neither infinite nor NaN."""
Text: TypeAlias = Annotated[str, Field(strict=True)]
"""A text; the server's limit for bodies bounds its length."""
Flag: TypeAlias = Annotated[bool, Field(strict=True)]
Scalar: TypeAlias = Flag | Finite | Text


class Sent(BaseModel):
    """An object with these fields and no others, so that nothing can be hidden in it."""

    model_config = ConfigDict(extra="forbid", strict=True)


class FileMark(Sent):
    """By this Gradio knows that an object names a file."""

    mark: Literal["gradio.FileData"] = Field(alias="_type")


class Upload(Sent):
    """A file as Gradio's upload names it; the guard checks that it is the sender's own."""

    path: Text
    url: Text | None = None
    size: Finite | None = None
    orig_name: Text | None = None
    mime_type: Text | None = None
    is_stream: Flag = False
    meta: FileMark = FileMark(_type="gradio.FileData")


class SentPath(Sent):
    """A path as the browser sends it; a point is [seconds or null, x, z] with or without a heading."""

    person: Text
    points: list[list[Finite | None]]


SentPaths: TypeAlias = Annotated[list[SentPath], Field(default_factory=list)]


_OF_GRADIO: dict[type, TypeAdapter[Any]] = {
    gr.Textbox: TypeAdapter(Text | None),
    gr.Number: TypeAdapter(Finite | None),
    gr.Slider: TypeAdapter(Finite),
    gr.Checkbox: TypeAdapter(Flag | None),
    gr.State: TypeAdapter(None),
    gr.File: TypeAdapter(Upload | None),
}
_FILES: TypeAdapter[Any] = TypeAdapter(list[Upload] | None)
_BY_DEFAULT: TypeAdapter[Any] = TypeAdapter(Scalar | None)


def accepts(component: Any) -> TypeAdapter[Any]:
    """The type of the component's value; a text, a number or null where nothing is declared."""
    if (declared := getattr(type(component), "accepts", None)) is not None:
        return declared
    if getattr(component, "file_count", "single") != "single":
        return _FILES
    return next((_OF_GRADIO[kind] for kind in type(component).__mro__ if kind in _OF_GRADIO), _BY_DEFAULT)


def accepts_event(component: Any) -> TypeAdapter[Any]:
    """The type of the data of the component's events; a text, a number or null where nothing is declared."""
    return getattr(type(component), "accepts_event", _BY_DEFAULT)
