"""The form of a given motion, on the tabs React and Predict: a file, an example, a film or a result, read and shown."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.ui.components.actors import Source, offered_animations, read_source, result_source
from webdemo.ui.components.camera import CameraPanel, film_source
from webdemo.ui.components.exports import Record
from webdemo.ui.components.fields import animation_field, chip, file_field
from webdemo.ui.components.player import ROUNDS, busy, show
from webdemo.ui.text.examples import example_clips
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line

from .results import QUIET, Parts, Results


class SourcePanel(ABC):
    """Takes somebody's motion and shows it; the tab uses what is in ``state``.

    Args:
        results: where the motion is shown.
        prefix: before the ids of the elements, such as "react-".
    """

    named: str
    """Key of the text of the field for a file."""
    take_at_end = False
    """Whether a result is taken as a past, up to its end."""
    known: Sequence[Any] = ()
    """Controls of how a file is read: up axis, frames a second and order of joints, where the panel has them."""

    def __init__(self, results: Results, prefix: str) -> None:
        self.results, self.prefix = results, prefix
        self.examples = example_clips()

    # ---- what a panel says -----------------------------------------------------------------------

    @abstractmethod
    def payload(self, source: Source) -> dict[str, Any]:
        """The payload with which the player shows a source."""

    @abstractmethod
    def described(self, source: Source, *, at_end: bool) -> Parts:
        """Updates of the line on a source, and of :meth:`more`."""

    @abstractmethod
    def more(self) -> list[gr.components.Component]:
        """Further components that follow from the source."""

    def gone(self) -> Parts:
        """Updates where there is no source."""
        return {self.state: None, self.results.player: show(None), **self.bare}

    def own(self, source: Source | None) -> bool:
        """Whether a source is a visitor's own file."""
        return source is not None and source.path not in (None, *dict(self.examples).values())

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, cameras: Callable[[], None] = lambda: None) -> None:
        """Lays out where a motion can come from; ``cameras`` lays out more beside the camera's panel."""
        self.file = file_field(self.named, elem_id=f"{self.prefix}file")
        with gr.Row(elem_classes="pd-chips pd-sources"):
            self.chips = [chip(name) for name, _ in self.examples]
            self.take = chip(say("source.take"), elem_id=f"{self.prefix}take")
            self.camera = CameraPanel(elem_id=f"{self.prefix}camera")
            cameras()
        self.state = gr.State(None, time_to_live=3600)

    def build_animation(self) -> None:
        """The list of a file's animations."""
        self.animation = animation_field(f"{self.prefix}animation")

    def wire(self, tab: Any) -> None:
        """Wires what a motion can be taken from, also the last result; while it is read, nothing can be run on it.

        Args:
            tab: a ``JobTab``, which says on its line what was taken, and what is left of a result beside it.
        """
        self.line, self.go = tab.line, tab.go
        self.bare: Parts = {tab.outputs[name]: update for name, update in tab.bare().items()}
        shown = [self.state, self.line, self.results.player, *self.bare, *self.more(), self.file, self.go]
        self.load_options: dict[str, Any] = {
            "outputs": shown,
            "concurrency_limit": 2,
            "concurrency_id": f"{self.prefix}read",
            **QUIET,
        }
        load = self.load_options
        self.file.upload(self.upload, inputs=self.file, **load)
        self.camera.submit(self.read_film, inputs=self.camera, **load)
        for button, (name, path) in zip(self.chips, self.examples, strict=True):
            button.click(partial(self.load, partial(read_source, path, name)), **load)
        self.take.click(self.take_result, inputs=tab.record, **load)
        self.state.change(offered_animations, inputs=self.state, outputs=self.animation, queue=False, **QUIET)
        self.file.clear(self.forget, outputs=shown, queue=False, **QUIET)
        chosen = [*self.known, self.animation]
        changed = [part.blur if isinstance(part, gr.Number) else part.input for part in chosen]
        changed += [part.submit for part in self.known if isinstance(part, gr.Number)]
        gr.on(
            changed,
            self.read_again,
            inputs=[self.state, *chosen],
            trigger_mode="always_last",
            **{**load, "outputs": [*shown, *chosen]},
        )

    def wire_arrival(self, tab: gr.Tab, record: gr.State, kind: str) -> None:
        """Lets the tab, which makes results of a kind, begin with the last result of another, or an example."""
        arrive = partial(self.arrive, kind.lower())
        tab.select(arrive, inputs=[self.state, record], **self.load_options)

    # ---- events ----------------------------------------------------------------------------------

    def arrive(self, kind: str, source: Source | None, record: Record | None) -> Parts:
        """Shows the last result of another kind, or else the first example, which plays and then rests."""
        made = record is not None and record.result.manifest.get("request", {}).get("kind") == kind
        if source is not None or made or not (record or self.examples):
            return {self.state: gr.skip()}
        if record is not None:
            *_, taken = self.take_result(record)
            return taken
        name, path = self.examples[0]
        *_, updates = self.load(partial(read_source, path, name))
        player = updates[self.results.player]
        return updates | {self.results.player: {**player, "value": {**player["value"], "rounds": ROUNDS}}}

    def upload(self, path: str | None) -> Iterator[Parts]:
        """Reads an uploaded file and shows its motion; one that cannot be read leaves no motion."""
        if path is not None:
            yield from self.load(partial(read_source, path), fresh=True)

    def read_film(self, landmarks: str | None) -> Iterator[Parts]:
        """Takes the person of a film."""
        yield from self.load(partial(film_source, landmarks))

    def take_result(self, record: Record | None) -> Iterator[Parts]:
        """Takes the session's last result."""

        def read() -> Source:
            if record is None:
                raise InputError("There is no result yet: make one in any tab first.")
            return result_source(record.result, record.prompt)

        yield from self.load(read, at_end=self.take_at_end)

    def load(self, read: Callable[[], Source], *, at_end: bool = False, fresh: bool = False) -> Iterator[Parts]:
        """Updates of the state, the line, the player, :meth:`more` and the button while a motion is read.

        Where it is ``fresh`` and cannot be read, an earlier motion is forgotten.
        """
        waiting, player = "Reading the motion …", self.results.player
        yield {self.line: status(waiting, tone="busy"), player: busy(waiting), self.go: gr.update(interactive=False)}
        try:
            source = read()
            updates = {self.state: source, player: show(self.payload(source)), **self.bare}
            updates |= self.described(source, at_end=at_end) | ({} if self.own(source) else {self.file: None})
        except Exception as error:
            updates = {player: busy(""), **(self.gone() if fresh else {})}
            updates[self.line] = status(error_line(error), tone="error")
        yield {**updates, self.go: gr.update(interactive=True)}

    def forget(self) -> Parts:
        """The tab without a motion; a result of it is in the history."""
        return {**self.gone(), self.line: status()}

    def read_again(self, source: Source | None, *chosen: Any) -> Iterator[Parts]:
        """Reads the source's file anew as its settings and its animation are, or takes those back where it cannot."""
        if source is None or source.path is None:
            return
        *known, animation = chosen
        read_with: Any = (*(known or source.read_with[:3]), animation)
        back = dict(zip(self.known, source.read_with, strict=False)) | {self.animation: offered_animations(source)}
        for updates in self.load(partial(read_source, source.path, source.name, read_with)):
            yield updates | (back if "pd-error" in updates[self.line] else {})
