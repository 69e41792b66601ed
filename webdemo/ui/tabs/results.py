"""The results of a tab: the player, and beside it files, a film, a link and read-outs."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.ui.components.address import link_address
from webdemo.ui.components.exports import (
    ALL,
    KINDS,
    PURPOSES,
    RIG,
    WORN,
    Record,
    Worn,
    file_name,
    for_download,
    write_character,
    write_on_rig,
    write_record,
)
from webdemo.ui.components.film import READ_PLAYER, make_figure, make_film
from webdemo.ui.components.film import suffix as film_suffix
from webdemo.ui.components.own_thing import FILE_TYPES, bring
from webdemo.ui.components.player import EMPTY_TEXT, MotionPlayer, show, wear
from webdemo.ui.components.show import result_payload
from webdemo.ui.context import PageContext
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say, worded
from webdemo.ui.text.words import error_line, link_line, seconds
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
_SAVE = """() => {
  const button = document.getElementById(%s);
  setTimeout(() => button?.disabled === false && button.click(), 50);
}"""
"""JavaScript that presses a download button that has a file; to be filled with its id as JSON."""
_CHANGED = (*WORN, ALL)
"""The downloads that change when a character is put on."""

Updates = tuple[Any, ...]


class ResultsTab:
    """The part of a tab that shows a result and hands it out.

    Args:
        page: what the tabs share.
    """

    prefix = ""
    """Before the ids of the tab's elements."""
    record: gr.State
    """Keeps the session's last result."""
    line: gr.HTML
    """Says how a run went."""

    def __init__(self, page: PageContext) -> None:
        self.page = page
        self._buttons: dict[str, gr.DownloadButton] = {}

    def _id(self, name: str) -> str:
        return self.prefix + name

    def _results(
        self, empty_text: str = EMPTY_TEXT, below: Callable[[], None] = lambda: None, first: Payload | None = None
    ) -> None:
        """The player, and under it what ``below`` lays out. ``first`` is played before anything is asked for."""
        with gr.Column(elem_classes="pd-results", min_width=0):
            with gr.Column(elem_classes="pd-panel pd-stage", min_width=0):
                self.player = MotionPlayer(first, elem_id=self._id("player"), empty_text=empty_text)
            below()

    def _handed_out(self, below: Callable[[], None] = lambda: None) -> None:
        """The panel of a result: how it came out, *Share*, *Export* and what ``below`` lays out."""
        with gr.Column(elem_classes="pd-panel pd-under", min_width=0, visible=False) as self.under:
            self.readouts = gr.HTML(elem_id=self._id("readouts"))
            with gr.Column(elem_classes="pd-menus", min_width=0):
                self._share()
                self._export()
            with gr.Row(elem_classes="pd-chips"):
                self.another = gr.Button(
                    say("result.another"), size="sm", min_width=0, elem_id=self._id("another"), elem_classes="pd-onward"
                )
                self.onward = gr.Button(
                    say("result.next"), size="sm", min_width=0, elem_id=self._id("continue"), elem_classes="pd-onward"
                )
        below()

    def _share(self) -> None:
        """Ways to show a result to somebody, the likeliest first."""
        with gr.Accordion(say("result.share"), open=False, elem_id=self._id("share"), elem_classes="pd-menu"):
            with gr.Row(elem_classes="pd-downloads"):
                self.link = gr.Button(
                    say("result.link_to_view"),
                    size="sm",
                    min_width=0,
                    elem_id=self._id("link"),
                    elem_classes="pd-onward",
                    visible=self.page.history is not None,
                )
                self.film = gr.Button(say("result.make_film"), size="sm", min_width=0, elem_id=self._id("film"))
                self.filmed = gr.DownloadButton(
                    f"{say('files.film')} {film_suffix()}",
                    size="sm",
                    interactive=False,
                    min_width=0,
                    elem_id=self._id("download-film"),
                )
                self.picture = gr.Button(say("result.picture"), size="sm", min_width=0, elem_id=self._id("picture"))
                self._download("png")
                self.player_state = gr.Textbox(visible=False)
            self.address = gr.Textbox(
                label=say("result.link"),
                interactive=False,
                visible=False,
                buttons=["copy"],
                elem_id=self._id("address"),
            )

    def _export(self) -> None:
        """Files of a result, by what they are for."""
        with gr.Accordion(say("result.export"), open=False, elem_id=self._id("downloads"), elem_classes="pd-menu"):
            for purpose, keys in PURPOSES.items():
                gr.HTML(f'<p class="pd-purpose">{worded("purpose", purpose)}</p>', padding=False)
                with gr.Row(elem_classes="pd-downloads"):
                    for key in keys:
                        self._download(key)
                    if "npz" in keys:
                        self._figure()
                    if RIG in keys:
                        self.character = gr.UploadButton(
                            say("result.character"),
                            file_types=[".glb", ".vrm"],
                            size="sm",
                            min_width=0,
                            elem_id=self._id("character"),
                            elem_classes="pd-character",
                        )
                        self.thing = gr.UploadButton(
                            say("result.thing"),
                            file_types=FILE_TYPES,
                            size="sm",
                            min_width=0,
                            elem_id=self._id("thing"),
                            elem_classes="pd-character",
                        )
            self.worn = gr.State(None, time_to_live=3600)

    def _figure(self) -> None:
        """The button that makes a figure and a mesh, and theirs."""
        self.figure = gr.Button(say("result.figure"), size="sm", min_width=0, elem_id=self._id("figure"))
        self.figured = [
            gr.DownloadButton(label, size="sm", interactive=False, min_width=0, elem_id=self._id(name))
            for label, name in ((say("files.figure"), "download-html"), (say("files.mesh"), "download-ply"))
        ]

    def _download(self, key: str) -> None:
        """The button of one kind of file."""
        kind = next(kind for kind in KINDS if kind.key == key)
        self._buttons[key] = gr.DownloadButton(
            worded("files", kind.label),
            size="sm",
            interactive=False,
            min_width=0,
            visible=kind.offered(),
            elem_id=self._id(f"download-{key.replace('.', '-')}"),
        )

    @property
    def downloads(self) -> list[gr.DownloadButton]:
        """The buttons of all kinds of files, in the order of :data:`KINDS`."""
        return [self._buttons[kind.key] for kind in KINDS]

    def _wire_results(self) -> None:
        self.film.click(
            self.make_film,
            inputs=[self.record, self.player_state],
            outputs=[self.line, self.filmed],
            js=READ_PLAYER,
            concurrency_limit=1,
            concurrency_id="film",
            trigger_mode="once",
            **QUIET,
        ).then(None, js=_SAVE % json.dumps(self._id("download-film")), **QUIET)
        self.figure.click(
            self.make_figure,
            inputs=[self.record, self.player_state],
            outputs=[self.line, *self.figured],
            js=READ_PLAYER,
            concurrency_limit=1,
            concurrency_id="film",
            trigger_mode="once",
            **QUIET,
        )
        self.picture.click(None, js=_TAKE_PICTURE, **QUIET)
        self.link.click(
            self.make_link,
            inputs=[self.record, self.player_state],
            outputs=[self.line, self.address],
            js=READ_PLAYER,
            **QUIET,
        )

        self.character.upload(
            self.put_on,
            inputs=[self.character, self.record],
            outputs=[self.line, self.worn, self.player, *(self._buttons[key] for key in _CHANGED)],
            concurrency_limit=1,
            concurrency_id="character",
            trigger_mode="once",
            **QUIET,
        )

        self.thing.upload(
            self.bring,
            inputs=[self.thing, self.record, self.worn],
            outputs=[self.line, self.player, *self.downloads],
            concurrency_limit=1,
            concurrency_id="character",
            trigger_mode="once",
            **QUIET,
        )

    def bring(self, path: str | None, record: Record | None, worn: Worn | None) -> Updates:
        """Puts an uploaded thing into this result, as the first thing of its words, here and in its files."""
        try:
            result = bring(record, path)
            assert record is not None
            record.result, record.exported = result, False
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * (1 + len(KINDS)))
        line, *files = self.export(record, worn)
        name = Path(str(path)).name[:60]
        if line == gr.skip():
            line = status(f"{name} is in the scene, in films and in the files as well.", tone="done")
        return line, show(result_payload(result, title=record.prompt)), *files

    def put_on(self, path: str | None, record: Record | None) -> Updates:
        """Puts an uploaded character on both people, here and in the files of this result and of later ones."""
        try:
            if not path:
                raise InputError("There is no character: choose a skinned .glb.")
            worn = Worn.read(Path(path), self.page.shelf.folder())
            files: dict[str, Path] = {}
            if record is not None:
                record.worn = worn
                record.files = {**record.files, **write_character(record, self.page.shelf.folder())}
                files = for_download(record.files, file_name(record.prompt, record.result.manifest))
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * (2 + len(_CHANGED)))
        sentence = (
            f"Both wear {worn.body.name}, in films, in the .glb and on the contact sheet as well. "
            "The figure button of the player shows bodies again."
        )
        offered = (_offered(key, files[key]) if key in files else gr.skip() for key in _CHANGED)
        return status(sentence, tone="done"), worn, wear(worn.body), *offered

    def make_film(self, record: Record | None, shown: str) -> Iterator[Updates]:
        """Films the last result as the player shows it and hands the film to its download button."""
        yield status("Drawing the film …", tone="busy"), gr.update(value=None, interactive=False)
        began = time.perf_counter()
        try:
            path = make_film(record, shown, self.page.shelf.folder())
        except Exception as error:
            yield status(error_line(error), tone="error"), gr.skip()
            return
        line = f"The film is saved, drawn in {seconds(time.perf_counter() - began)}. Film {path.suffix} saves it again."
        yield status(line, tone="done"), gr.update(value=path, interactive=True)

    def make_figure(self, record: Record | None, shown: str) -> Iterator[Updates]:
        """Makes a plotly figure of the last result, and a mesh of the moment that the player shows."""
        off = gr.update(value=None, interactive=False)
        yield status("Making the figure and the mesh …", tone="busy"), off, off
        try:
            paths = make_figure(record, shown, self.page.shelf.folder())
        except Exception as error:
            yield status(error_line(error), tone="error"), gr.skip(), gr.skip()
            return
        line = "Ready: Figure .html plays offline in any browser; Mesh .ply is the moment that the player shows."
        yield status(line, tone="done"), *(gr.update(value=path, interactive=True) for path in paths)

    def make_link(self, record: Record | None, shown: str) -> Updates:
        """Makes a link to the shown run, at the moment and from the side that the player shows."""
        try:
            if self.page.history is None or record is None or not record.result.run:
                raise InputError("This motion is not in your history: make it once more.")
            key, until = self.page.history.link(record.result.run, visitor().owner)
        except Exception as error:
            return status(error_line(error), tone="error"), gr.update(visible=False)
        address = link_address(visitor().base, key, shown)
        return status(link_line(until), tone="done"), gr.update(value=address, visible=True)

    @property
    def handed_out(self) -> list[gr.DownloadButton]:
        """The buttons of all files of a result: :attr:`downloads`, its film, and its figure and mesh."""
        return [*self.downloads, self.filmed, *self.figured]

    def withhold(self, record: Record | None) -> Updates:
        """Takes the last result's files from the buttons where a new result's are still to be written."""
        new = record is not None and not record.exported
        return tuple(gr.update(value=None, interactive=False) if new else gr.skip() for _ in self.handed_out)

    def export(self, record: Record | None, worn: Worn | None = None) -> Updates:
        """Writes the files of a new result and hands them to the download buttons; both people wear ``worn``."""
        unchanged = (gr.skip(),) * (1 + len(KINDS))
        if record is None or record.exported:
            return unchanged
        record.exported, record.worn = True, worn
        try:
            files = write_record(record, self.page.shelf.folder())
            name = file_name(record.prompt, record.result.manifest)
            line, on_rig = self._on_rig(record)
            record.files = files | ({RIG: on_rig} if on_rig else {})
            found = for_download(record.files, name)
        except Exception as error:
            off = gr.update(value=None, interactive=False)
            return (
                status(f"The motion is ready, but its files are not. {error_line(error)}", tone="error"),
                *(off for _ in KINDS),
            )
        return (line, *(_offered(kind.key, found.get(kind.key)) for kind in KINDS))

    def _on_rig(self, record: Record) -> tuple[Any, list[Path]]:
        """A change of the status line, and the partner on the uploaded rig; the others of its files do not need it."""
        try:
            return gr.skip(), write_on_rig(record, self.page.shelf.folder())
        except Exception as error:
            sentence = f"The motion is ready, but not on the rig of your file. {error_line(error)}"
            return status(sentence, tone="warning"), []


def _offered(kind: str, file: Path | None) -> dict[str, Any]:
    """An update of a download's button; that of the uploaded rig is seen only where there is one."""
    if kind == RIG:
        return gr.update(value=file, interactive=file is not None, visible=file is not None)
    return gr.update(value=file, interactive=file is not None)
