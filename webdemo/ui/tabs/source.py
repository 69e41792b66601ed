"""The given motion of the tabs React and Predict: a file, an example, a film or a result, read and shown."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.ui.components.actors import Source, offered_animations, read_source, result_source
from webdemo.ui.components.camera import CameraPanel, film_source
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import busy, show
from webdemo.ui.context import PageContext
from webdemo.ui.text.examples import example_clips
from webdemo.ui.text.panels import status
from webdemo.ui.text.words import error_line

from .job import QUIET, Updates
from .sweeps import SweepTab


class SourceTab(SweepTab):
    """A tab that begins with somebody's motion.

    Args:
        page: what the tabs share.
        examples: (name, file) of example motions; those that are shipped by default.
    """

    source: gr.State
    given: gr.Textbox
    file: gr.File
    camera: CameraPanel
    chips: list[gr.Button]
    animation: gr.Dropdown

    def __init__(self, page: PageContext, examples: list[tuple[str, Path]] | None = None) -> None:
        super().__init__(page)
        self.examples = example_clips() if examples is None else examples

    @abstractmethod
    def forget(self) -> Updates:
        """The tab without a motion: source, its key, line, player and what else depends on it."""

    @abstractmethod
    def payload(self, source: Source) -> dict[str, Any]:
        """The payload with which the player shows a source."""

    @abstractmethod
    def described(self, source: Source, *, at_end: bool) -> tuple[str, list[Any]]:
        """The line on a source, and the updates behind the player's."""

    def _wire_source(self, shown: Sequence[Any], takes: Mapping[gr.Button, Callable[..., Any]]) -> dict[str, Any]:
        """Wires what a motion can be taken from.

        Args:
            shown: the components that :meth:`load` updates.
            takes: buttons that take the last result, and what each calls with it.

        Returns:
            arguments of further events that read a motion.
        """
        load: dict[str, Any] = {
            "outputs": shown,
            "concurrency_limit": 2,
            "concurrency_id": f"{self.prefix}read",
            **QUIET,
        }
        self.file.upload(self.upload, inputs=self.file, **load).then(None, **self.compare)
        self.camera.submit(self.read_film, inputs=self.camera, **load).then(None, **self.compare)
        for button, (name, path) in zip(self.chips, self.examples, strict=True):
            read = partial(self.load, partial(read_source, path, name))
            button.click(read, **load).then(None, **self.compare)
        for button, take in takes.items():
            button.click(take, inputs=self.record, **load).then(None, **self.compare)
        others = [self.camera.submit, *(button.click for button in (*self.chips, *takes))]
        gr.on(others, None, outputs=self.file, js="() => null", **QUIET)  # the file is no longer what is used
        self.source.change(offered_animations, inputs=self.source, outputs=self.animation, queue=False, **QUIET)
        self.file.clear(self.forget, outputs=shown, queue=False, **QUIET)
        return load

    def upload(self, path: str | None) -> Iterator[Updates]:
        """Reads an uploaded file and shows its motion; one that cannot be read leaves no motion."""
        if path is not None:
            yield from self.load(partial(read_source, path), fresh=True)

    def read_film(self, landmarks: str | None) -> Iterator[Updates]:
        """Takes the people of a film."""
        yield from self.load(partial(film_source, landmarks))

    def of_result(self, person: str, record: Record | None, *, at_end: bool = False) -> Iterator[Updates]:
        """Takes the session's last result, with this person in front."""

        def read() -> Source:
            if record is None:
                raise InputError("There is no result yet: generate one first.")
            return result_source(record.result, record.prompt, person)

        yield from self.load(read, at_end=at_end)

    def load(self, read: Callable[[], Source], *, at_end: bool = False, fresh: bool = False) -> Iterator[Updates]:
        """Updates, as of :meth:`forget`, while a motion is read.

        Where it is ``fresh`` and cannot be read, an earlier motion is forgotten.
        """
        nobody = self.forget()
        same, rest = (gr.skip(),) * 2, (gr.skip(),) * (len(nobody) - 4)
        yield *same, status("Reading the motion …", tone="busy"), busy("Reading the motion …"), *rest
        try:
            source = read()
            payload = self.payload(source)
        except Exception as error:
            note = status(error_line(error), tone="error")
            yield (*nobody[:2], note, *nobody[3:]) if fresh else (*same, note, busy(""), *rest)
            return
        line, updates = self.described(source, at_end=at_end)
        yield source, source.key, line, show(payload), *updates

    def again(self, source: Source, asked: Any, back: Sequence[Any]) -> Iterator[Updates]:
        """Reads a source's file anew as ``asked``; ``back`` are updates that take that back where it cannot."""
        assert source.path is not None
        for updates in self.load(partial(read_source, source.path, source.name, asked)):
            failed = updates[0] == gr.skip() and "pd-error" in updates[2]
            yield *updates, *(back if failed else (gr.skip(),) * len(back))
