"""Parts of the page that scripts of our own draw.

A part is a ``gr.HTML`` with constant templates: what a user typed travels as data, and the script sets it as text.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar
from urllib.parse import quote

import gradio as gr

from webdemo.ui.text.texts import STATIC

_SCRIPT = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const module = root + (config.api_prefix || "/gradio_api") + "/file=" + %s;
const loaded = window.pdModules?.[module] ?? import(module);
Promise.resolve(loaded).then((part) => part.mount(element, props, watch, trigger));
"""
"""JavaScript that gives a part that appears to its module, which may be here already; to be filled with its path."""


class Part(gr.HTML):
    """A part of the page; what it sends and shows goes through Gradio unchanged.

    A subclass declares what differs; its ``template`` is the HTML file that is called like its folder. ``accepts`` and
    ``accepts_event`` say what a browser may send, see :mod:`webdemo.ui.components.accepts`.

    Args:
        value: shown at first.
        elem_id: id of the element in the page.
        kwargs: props and options that replace the declared ones.
    """

    folder: ClassVar[str]
    """The folder of ``static`` with its files, all of which become reachable over the network."""
    template: ClassVar[Path]
    module: ClassVar[str] = "main.js"
    """The script in that folder whose ``mount`` gets the element, its props, ``watch`` and ``trigger``."""
    styled: ClassVar[bool] = False
    """Whether the page gets the folder's style sheet with the part; otherwise the script loads what it needs."""
    style: ClassVar[str] = ""
    """CSS that the page gets with the part."""
    declared: ClassVar[dict[str, Any]] = {}
    """Props beside the value, as they are at first."""

    def __init_subclass__(cls) -> None:
        cls.template = STATIC / cls.folder / f"{cls.folder}.html"
        if cls.styled:
            cls.style = scoped(cls.template.with_suffix(".css"))
        gr.set_static_paths([cls.template.parent])

    def __init__(self, value: Any = None, *, elem_id: str | None = None, **kwargs: Any) -> None:
        kwargs = {
            "html_template": self.template.read_text(encoding="utf-8"),
            "css_template": self.style,
            "js_on_load": _SCRIPT % json.dumps(quote((self.template.parent / self.module).as_posix())),
            "apply_default_css": False,
            **self.declared,
            **kwargs,
        }
        super().__init__(value, elem_id=elem_id, **kwargs)


def scoped(path: Path) -> str:
    """The rules of a style sheet, each for what lies inside the part only."""
    return ("\n" + path.read_text(encoding="utf-8")).replace("\n.", "\n& .")
