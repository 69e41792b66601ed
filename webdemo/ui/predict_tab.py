"""What comes next: a motion, a marker where the past ends, and what is predicted after it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gradio as gr

from webdemo.inference.predict_request import (
    LONGEST,
    METHODS,
    PAST_SECONDS,
    PREDICT_SECONDS,
    PredictRequest,
    PredictResult,
)
from webdemo.inference.requests import Result
from webdemo.motion import Clip, Duet, InputError
from webdemo.view.payload import player_payload

from .actors import Source, read_source, result_source
from .context import PageContext
from .examples import example_clips
from .exports import Record
from .job_tab import QUIET, JobTab, Updates
from .panels import status
from .player import busy, show
from .prediction_view import curves_figure, prediction_payload, without_name
from .react_tab import FILE_TYPES
from .words import error_line

EMPTY_TEXT = "Drop a motion file, or take an example"


def motion_of(source: Source) -> Clip | Duet:
    """All people of a source, the first called after it."""
    first = replace(source.people[0], name=source.name)
    return Duet(first, source.people[1]) if len(source.people) > 1 else first


class PredictTab(JobTab):
    """A past → its future.

    Args:
        page: what the tabs share.
        examples: (name, file) of example motions; those that are shipped by default.
    """

    label = "Predict"
    prefix = "predict-"

    def __init__(self, page: PageContext, examples: list[tuple[str, Path]] | None = None) -> None:
        super().__init__(page)
        self.examples = example_clips() if examples is None else examples

    def request(self, fields: Mapping[str, Any]) -> Any:
        """A :class:`PredictRequest`; raises InputError where none can be made of the fields."""
        source: Source | None = fields["source"]
        if source is None:
            raise InputError("There is no motion yet: drop a file, or take an example or the last result.")
        return PredictRequest(
            motion=motion_of(source), marker=fields["marker"], seconds=fields["seconds"],
            model=fields["model"],
        )  # fmt: skip

    def title(self, request: PredictRequest) -> str:
        name = request.motion.name if isinstance(request.motion, Clip) else request.motion.a.name
        return f"After {request.marker:.1f} s of {name}"

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, demo: gr.Blocks, record: gr.State | None = None) -> None:
        """Lays out the tab inside ``demo`` and wires its events.

        Args:
            demo: the page.
            record: keeps the session's last result, of this tab or another.
        """
        with gr.Row(elem_classes="pd-lab", equal_height=False):
            with gr.Column(elem_classes="pd-controls", min_width=0):
                self._ask()
                with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
                    self.marker = gr.Slider(
                        0, 10, value=PAST_SECONDS, step=0.1, label="The past ends at (s)",
                        info="Everything before is given; what really follows is shown as a pale ghost.",
                        elem_id="predict-marker",
                    )  # fmt: skip
                    self.seconds = gr.Slider(
                        *PREDICT_SECONDS, value=PredictRequest.seconds, step=0.5, label="Seconds to predict",
                        elem_id="predict-seconds",
                    )  # fmt: skip
                    self.model = gr.Radio(
                        [(label, name) for name, label in METHODS.items()], value=PredictRequest.model,
                        label="Method", elem_id="predict-method",
                    )  # fmt: skip
            with gr.Column(elem_classes="pd-results", min_width=0):
                self._results(EMPTY_TEXT)
                with gr.Column(elem_classes="pd-panel", min_width=0, visible=False) as self.curves:
                    self.plot = gr.Plot(show_label=False, elem_id="predict-curves")
        self.source = gr.State(None, time_to_live=3600)
        self._wire_run(
            self.start, [self.go.click], (self.source, self.marker, self.seconds, self.model), record
        )
        self._wire_source()

    def _ask(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.file = gr.File(
                label="A motion of one person or two: .bvh, .npz or .npy", file_types=FILE_TYPES,
                height=112, elem_id="predict-file", elem_classes="pd-file",
            )  # fmt: skip
            with gr.Row(elem_classes="pd-chips"):
                self.chips = [
                    gr.Button(name, size="sm", elem_classes="pd-chip", min_width=0)
                    for name, _ in self.examples
                ]
                self.take = gr.Button(
                    "Continue the last result", size="sm", elem_classes="pd-chip", elem_id="predict-take",
                    min_width=0,
                )  # fmt: skip
            self._go("Predict")

    def more_outputs(self) -> dict[str, gr.components.Component]:
        return {"curves": self.curves, "plot": self.plot}

    # ---- events ----------------------------------------------------------------------------------

    def _wire_source(self) -> None:
        changed = [self.source, self.line, self.player, self.marker]
        load = {"outputs": changed, "concurrency_limit": 2, "concurrency_id": "predict-read", **QUIET}
        self.file.upload(self.upload, inputs=self.file, **load)
        for chip, (name, path) in zip(self.chips, self.examples, strict=True):
            chip.click(partial(self.load, partial(read_source, path, name)), **load)
        self.take.click(self.take_result, inputs=self.record, **load)
        for button in (*self.chips, self.take):  # the file is no longer what is used
            button.click(None, outputs=self.file, js="() => null", **QUIET)
        self.file.clear(self.forget, outputs=changed, queue=False, **QUIET)

    def upload(self, path: str | None) -> Iterator[Updates]:
        """Reads an uploaded file and shows its motion."""
        if path is not None:
            yield from self.load(partial(read_source, path))

    def take_result(self, record: Record | None) -> Iterator[Updates]:
        """Makes the session's last result the past: the marker stands at its end."""

        def read() -> Source:
            if record is None:
                raise InputError("There is no result yet: generate one first.")
            return result_source(record.result, record.prompt, "a")

        yield from self.load(read, at_end=True)

    def load(self, read: Callable[[], Source], *, at_end: bool = False) -> Iterator[Updates]:
        """Updates of source, line, player and marker while a motion is read."""
        yield gr.skip(), status("Reading the motion …", tone="busy"), busy("Reading the motion …"), gr.skip()
        try:
            source = read()
            payload = player_payload(without_name(motion_of(source)), title=source.name)
        except Exception as error:
            yield gr.skip(), status(error_line(error), tone="error"), busy(""), gr.skip()
            return
        last = max(int(source.seconds * 10) / 10, PAST_SECONDS)
        marker = last if at_end else max(PAST_SECONDS, round(last / 2, 1))
        yield (
            source,
            self._told(source),
            show(payload),
            gr.update(minimum=PAST_SECONDS, maximum=max(last, PAST_SECONDS + 0.1), value=marker),
        )

    @staticmethod
    def _told(source: Source) -> str:
        people = "two people" if len(source.people) > 1 else "one person"
        told = f"{source.name}: {people}, {source.seconds:.1f} s."
        if source.seconds < PAST_SECONDS:
            return status(f"{told} Give {PAST_SECONDS:g} s or more.", tone="warning")
        if source.seconds > LONGEST:
            return status(f"{told} Cut it to {LONGEST:g} s or less.", tone="warning")
        return status(told)

    @staticmethod
    def forget() -> Updates:
        """The tab without a motion."""
        return None, status(), show(None), gr.skip()

    def start(
        self, source: Source | None, marker: float, seconds: float, model: str, request: gr.Request
    ) -> Iterator[Updates]:
        """Runs what the controls ask for; yields updates of the page."""
        fields = {"source": source, "marker": marker, "seconds": seconds, "model": model, "seed": 0}
        yield from self.run(str(request.session_hash), fields)

    def _shown(self, result: Result, title: str) -> dict[str, Any]:
        shown = super()._shown(result, title)
        assert isinstance(result, PredictResult)
        return {
            **shown,
            "player": show(prediction_payload(result, title=title)),
            "curves": gr.update(visible=True),
            "plot": curves_figure(result),
        }
