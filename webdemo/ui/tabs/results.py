"""A result as every tab shows it: the player, over it what can be done with the result, and its figures."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from functools import partial, wraps
from pathlib import Path
from threading import Event
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.run import Cancelled
from webdemo.ui.components.exports import (
    KINDS,
    PURPOSES,
    Record,
    file_name,
    for_download,
    offered,
    without_place,
    write_record,
)
from webdemo.ui.components.fields import address_field
from webdemo.ui.components.film import READ_PLAYER, link_address, make_figure, make_film
from webdemo.ui.components.player import MotionPlayer
from webdemo.ui.context import PageContext
from webdemo.ui.places import FILMS
from webdemo.ui.text.panels import method_line, status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line, link_line
from webdemo.ui.visitor import visitor
from webdemo.view.payload import Payload

QUIET: dict[str, Any] = {"api_visibility": "private", "show_progress": "hidden", "show_progress_on": []}
"""Options of events that are the page's own: no endpoint, no spinner over what they change.

Without the empty list the browser would still note the state of a run at every component that it may change, once
an update, and count the seconds of each in every frame."""

_TAKE_PICTURE = """() => {
  const shown = [...document.querySelectorAll(".pdd")].find((each) => each.clientWidth);
  shown?.querySelector("[data-act=picture]")?.click();
}"""
"""JavaScript that presses the picture button of the player in view."""
_NO_FILES = '() => Array(%d).fill({ __type__: "update", interactive: false })'
"""JavaScript that gives no file, for so many buttons, until those of the motion that is shown are there."""
_SAVE = """() => {
  const button = document.getElementById(%s);
  setTimeout(() => button?.disabled === false && button.click(), 50);
}"""
"""JavaScript that presses a download button that has a file; to be filled with its id as JSON."""
PRESS = """() => {
  const press = (left) => {
    const button = document.getElementById(%s);
    if (button?.offsetParent && !button.disabled) button.click();
    else if (left) setTimeout(press, 100, left - 1);
  };
  press(100);
}"""
"""JavaScript that presses a button once it is in view and can be pressed; to be filled with its id as JSON."""
DRAWN = {"result.film": make_film, "result.figure": make_figure}
"""What is drawn of a result when its button is pressed, by the key of the button's text."""

Updates = tuple[Any, ...]
Parts = dict[Any, Any]
"""Updates by the components that they change; the others stay."""


def said(event: Callable[..., Parts]) -> Callable[..., Parts]:
    """A method that answers an event and whose failure becomes a sentence on its ``line``."""

    @wraps(event)
    def answer(self: Any, *given: Any) -> Parts:
        try:
            return event(self, *given)
        except Exception as error:
            return {self.line: status(error_line(error), tone="error")}

    return answer


class Results:
    """The player with the actions on a result, and all its figures.

    Args:
        page: what the tabs share.
        prefix: before the ids of the elements.
    """

    own: gr.State
    """Keeps the result on this stage."""

    def __init__(self, page: PageContext, prefix: str) -> None:
        self.page, self.prefix = page, prefix
        self._buttons: dict[str, gr.DownloadButton] = {}

    def _id(self, name: str) -> str:
        return self.prefix + name

    def build_stage(
        self,
        *,
        compare: Callable[[], None],
        below: Callable[[], None] = lambda: None,
        first: Payload | None = None,
        another: bool = True,
    ) -> None:
        """The player, over it what can be done with its motion, and under it what ``below`` lays out.

        Args:
            compare: lays out the menu of grids.
            below: lays out more under the player.
            first: is played before anything is asked for.
            another: offers one more take of a result.
        """
        self.own = gr.State(None, time_to_live=3600)
        with gr.Column(elem_classes="pd-results", min_width=0):
            with gr.Column(elem_classes="pd-panel pd-stage", min_width=0):
                with gr.Row(elem_classes="pd-actions", visible=False) as self.under:
                    self.back = self._button("result.undo", "undo", visible=False)
                    self.another = self._button("result.another", "another", visible=another)
                    self.onward = self._button("result.next", "continue")
                    compare()
                    self.share = self._button("result.share", "share")
                    self._export()
                    self.address = address_field("result.link", self._id("address"), visible=False)
                self.player = MotionPlayer(first, elem_id=self._id("player"))
            below()

    def build_readouts(self) -> None:
        """All figures of a result; nothing until there is one."""
        self.readouts = gr.HTML(elem_id=self._id("readouts"), elem_classes="pd-panel pd-under")

    def _button(self, text: str, name: str, **options: Any) -> gr.Button:
        return gr.Button(say(text), size="sm", min_width=0, elem_id=self._id(name), **options)

    def _saved(self, label: str, name: str, **options: Any) -> gr.DownloadButton:
        return gr.DownloadButton(
            label, size="sm", interactive=False, min_width=0, elem_id=self._id(f"download-{name}"), **options
        )

    def _export(self) -> None:
        """Files of a result, by what they are for."""
        name = self._id("downloads")
        with gr.Accordion(say("result.export"), open=False, elem_id=name, elem_classes="pd-menu") as self.menu:
            for purpose, keys in PURPOSES.items():
                gr.HTML(method_line(purpose), padding=False)
                with gr.Row(elem_classes="pd-downloads"):
                    for key in keys:
                        named = say(f"files.{key}"), key.replace(".", "-")
                        self._buttons[key] = self._saved(*named, visible=offered(key))
                    if "png" in keys:
                        self.picture = self._button("result.picture", "picture")
                        self.drawn = {key: self._button(key, key.split(".")[1]) for key in DRAWN}
            self.saved = self._saved(say("files.film"), "drawn", elem_classes="pd-drawn")
            self.player_state = gr.Textbox(visible=False)

    @property
    def downloads(self) -> list[gr.DownloadButton]:
        """The buttons of all kinds of files, in the order of :data:`KINDS`."""
        return [self._buttons[kind] for kind in KINDS]

    def wire(self, line: gr.HTML) -> None:
        """Wires what hands the result out; ``line`` says how that went."""
        drawn: dict[str, Any] = {"concurrency_limit": FILMS, "concurrency_id": "film", "trigger_mode": "once", **QUIET}
        shown: dict[str, Any] = {"inputs": [self.own, self.player_state], "js": READ_PLAYER}
        for key, button in self.drawn.items():
            made = button.click(partial(self.draw, key), outputs=[line, button, self.saved], **shown, **drawn)
            made.then(None, js=_SAVE % json.dumps(self.saved.elem_id), **QUIET)
        opened = self.menu.expand(None, outputs=self.downloads, js=_NO_FILES % len(KINDS), **QUIET)
        opened.then(self.export, inputs=self.own, outputs=[line, *self.downloads], concurrency_limit=2, **QUIET)
        self.picture.click(None, js=_TAKE_PICTURE, **QUIET)
        self.line = line
        self.share.click(self.make_link, outputs=[line, self.address], **shown, **QUIET)

    def draw(self, key: str, record: Record | None, shown: str) -> Iterator[Updates]:
        """Draws the result as the player shows it, as one of :data:`DRAWN`, and hands the file out.

        Its button says how much of it is drawn.
        """
        label = say(key)
        off = gr.update(value=None, interactive=False)
        done, left = [0.0], Event()
        folder = Path()

        def drawn(number: int, frames: int) -> None:
            done.append(number / frames)
            if left.is_set():
                raise Cancelled

        pool = ThreadPoolExecutor(1)
        try:
            if record is None:
                raise InputError("There is no motion yet: make one first.")
            folder = self.page.shelf.folder()
            drawing = pool.submit(DRAWN[key], record, shown, folder, drawn)
            while not drawing.done():
                yield gr.skip(), gr.update(value=f"{label} {100 * done[-1]:.0f} %"), off
                wait([drawing], timeout=0.5)
            path = drawing.result()
        except Exception as error:
            line = error_line(without_place(error, folder))
            yield status(line, tone="error"), gr.update(value=label), gr.skip()
            return
        finally:  # Gradio closes this on its event loop where the page was left: nobody waits for the drawing
            left.set()
            pool.shutdown(wait=False)
        yield gr.skip(), gr.update(value=label), gr.update(value=path, interactive=True)

    @said
    def make_link(self, record: Record | None, shown: str) -> Parts:
        """Makes a link to the shown run, at the moment and from the side that the player shows."""
        if record is None or not record.result.run:
            raise InputError("This motion is not in your history: make it once more.")
        key, until = self.page.history.link(record.result.run, visitor().owner)
        address = link_address(visitor().base, key, shown)
        return {self.line: status(link_line(until), tone="done"), self.address: gr.update(value=address, visible=True)}

    def export(self, record: Record | None) -> Updates:
        """Writes the files of the result on the stage, once, and hands them to the download buttons."""
        if record is None:
            return (gr.skip(),) * (1 + len(KINDS))
        try:
            if not all(file.exists() for file in record.files.values()) or not record.files:
                files = write_record(record, self.page.shelf.folder())
                record.files = for_download(files, file_name(record.prompt, record.result.manifest))
        except Exception as error:
            off = gr.update(value=None, interactive=False)
            line = status(f"The motion is ready, but its files are not. {error_line(error)}", tone="error")
            return line, *(off for _ in KINDS)
        given = (record.files.get(kind) for kind in KINDS)
        return (gr.skip(), *(gr.update(value=file, interactive=file is not None) for file in given))

    @staticmethod
    def fresh() -> dict[str, Any]:
        """Updates as another motion comes: the menu of files, which are written as it opens, and the link are gone."""
        return {"menu": gr.update(open=False), "address": gr.update(visible=False)}
