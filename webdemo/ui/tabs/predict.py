"""The tab of predictions: a motion, a marker where the past ends, and what is predicted after it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import gradio as gr
import numpy as np

from motion import FPS, Clip, Duet, InputError
from webdemo.inference.methods import installed, method
from webdemo.inference.requests.predict import LONGEST, PAST_SECONDS, PredictRequest, PredictResult
from webdemo.inference.requests.sampling import SAMPLES
from webdemo.inference.run import Result
from webdemo.ui.components.actors import Source, offered_animations
from webdemo.ui.components.fields import FittedSlider, looked_up, method_list, slider
from webdemo.ui.components.prediction_view import error_lines, without_name
from webdemo.ui.components.sweep import Kind, grid_table, real
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import method_line, prediction_lines, status
from webdemo.ui.text.texts import say
from webdemo.view.payload import player_payload

from .grids import methods_kind
from .job import JobTab
from .results import PRESS, QUIET, Parts, Results
from .sampling import seed_field
from .source import SourcePanel


def predict_choices() -> list[tuple[str, str]]:
    """(label, name) of the methods of prediction whose weights are there, or that need none."""
    return [(method.label, method.name) for method in installed("predict")]


def _draws(model: str) -> bool:
    """True of a method that draws its futures, which needs two people."""
    return "two people" in method(model, "predict").takes


def motion_of(source: Source) -> Clip | Duet:
    """All people of a source, the first called after it."""
    people = source.whole(LONGEST)
    first = replace(people[0], name=source.name)
    return Duet(first, people[1]) if len(people) > 1 else first


def _liveliest(source: Source) -> float:
    """The second at which most is moving, with two seconds behind it: what comes next is seen best there."""
    speeds = sum(np.linalg.norm(np.diff(clip.positions, axis=0), axis=-1).mean(axis=1) for clip in source.people)
    half = round(FPS / 2)
    moved = np.convolve(np.asarray(speeds), np.ones(half), mode="valid")  # moved[k]: up to frame k + half
    first = round(PAST_SECONDS * FPS) - half
    latest = max(round((source.seconds - PredictRequest.seconds) * FPS) - half, first)
    return (
        round((first + int(np.argmax(moved[first : latest + 1])) + half) / FPS, 1)
        if len(moved) > first
        else PAST_SECONDS
    )


def _last_marker(source: Source) -> float:
    """The latest second at which the past can end, in tenths."""
    return max(int(source.seconds * 10 + 1e-6) / 10, PAST_SECONDS)


class PastPanel(SourcePanel):
    """The motion of one person or two that is to go on, and the marker where its past ends."""

    named = "predict.file"
    take_at_end = True
    marker: gr.Slider

    def more(self) -> list[gr.components.Component]:
        """The marker."""
        return [self.marker]

    def payload(self, source: Source) -> dict[str, Any]:
        """All people of the motion."""
        return player_payload(without_name(motion_of(source)), title=source.name)

    def described(self, source: Source, *, at_end: bool) -> Parts:
        """The line on its people and its length; the marker."""
        last = _last_marker(source)
        marker = self.marked(source, last if at_end else min(_liveliest(source), last))
        return {self.line: _found_line(source), self.marker: marker}

    @staticmethod
    def marked(source: Source, value: float) -> Any:
        """The marker's slider as long as a motion."""
        return gr.update(minimum=PAST_SECONDS, maximum=max(_last_marker(source), PAST_SECONDS + 0.1), value=value)


class PredictTab(JobTab):
    """A past → its future."""

    label = "Predict"
    named = "tabs.predict"
    prefix = "predict-"

    def __init__(self, page: PageContext) -> None:
        super().__init__(page)
        self.past = PastPanel(self.results, self.prefix)

    def request(self, fields: Mapping[str, Any]) -> Any:
        """A :class:`PredictRequest`; raises InputError where none can be made of the fields."""
        source: Source | None = fields["source"]
        if source is None:
            raise InputError("There is no motion yet: drop a file, or pick an example or the last result.")
        return PredictRequest(
            motion=motion_of(source),
            marker=fields["marker"],
            seconds=fields["seconds"],
            **{name: fields[name] for name in ("seed", "samples") if name in fields},  # older grids have neither
            model=fields["model"],
        )

    def title(self, request: PredictRequest) -> str:
        """The time at which the prediction begins, and the name of the motion."""
        name = request.motion.name if isinstance(request.motion, Clip) else request.motion.a.name
        return f"After {request.marker:.1f} s of {name}"

    def kinds(self) -> Sequence[Kind]:
        """Methods, where the past ends, and the length."""
        marker = Kind("marker", "Past ends at (s)", "from", real, named=lambda value: f"{value:g} s")
        length = Kind("seconds", "Seconds to predict", read=real, named=lambda value: f"{value:g} s")
        return (methods_kind("model", {name: label for label, name in predict_choices()}), marker, length)

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """All methods beside each other."""
        listed = [label for label, name in predict_choices() if not _draws(name)]
        return {"Method beside method": ("model", "; ".join(listed))}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """The errors of all cells over their read-outs."""
        results = [result for result in made.values() if isinstance(result, PredictResult)]
        if len(results) < len(made):
            return {"readouts": grid_table(made)}
        lines = prediction_lines(dict(zip(made, error_lines(*results), strict=True)))
        return {"readouts": lines + grid_table(made)}

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, record: gr.State) -> None:
        """See :meth:`JobTab.build`."""
        self.lay_out(self._ask, self._settings, another=False)
        self.controls = {
            "source": self.past.state,
            "marker": self.past.marker,
            "seconds": self.seconds,
            "model": self.model,
            "seed": self.seed,
            "samples": self.samples,
        }
        self.wire([self.go.click], record)
        self.past.wire(self)
        self.model.input(
            None,
            inputs=self.model,
            outputs=self._of_model,
            js=looked_up({name: self._of_method(name) for _, name in predict_choices()}),
            **QUIET,
        )

    def _ask(self) -> None:
        self.past.build()
        self.past.build_animation()
        self.build_go(say("predict.go"))

    def _settings(self) -> None:
        marker: dict[str, Any] = {"kind": FittedSlider, "elem_id": "predict-marker"}
        self.past.marker = slider("predict.marker", (0, 10), PAST_SECONDS, 0.1, **marker)
        bounds = method(PredictRequest.model).seconds
        self.seconds = slider("predict.seconds", bounds, PredictRequest.seconds, 0.5, elem_id="predict-seconds")
        self.model = method_list(predict_choices(), PredictRequest.model, "predict-method")
        self.about = gr.HTML(method_line(method(PredictRequest.model).summary), elem_id="predict-about")
        drawn: dict[str, Any] = {"elem_id": "predict-samples", "visible": "hidden"}
        self.samples = slider("predict.samples", SAMPLES, PredictRequest.samples, **drawn)
        self.seed = seed_field(self.prefix, "predict.seed_info", visible="hidden")
        self._of_model = [self.about, self.samples, self.seed]

    def restored(self) -> Sequence[Any]:
        """The file, its animation, and the line on the method."""
        return [self.past.file, self.past.animation, self.about]

    # ---- events ----------------------------------------------------------------------------------

    def wire_page(self, tab: gr.Tab, tabs: gr.Tabs, stages: Sequence[Results]) -> None:
        """Wires what happens as the tab is opened.

        Args:
            tab: this one, among ``tabs``.
            tabs: of the page.
            stages: of all tabs, whose results can be taken here, as a past that goes on at once.
        """
        load = self.past.load_options
        self.past.wire_arrival(tab, self.record, self.label)
        for stage in stages:
            taken = stage.onward.click(self.past.take_result, inputs=stage.own, **load)
            # Only now is the tab opened, which finds the result on it.
            chosen = taken.then(lambda: gr.update(selected=self.label.lower()), outputs=tabs, queue=False, **QUIET)
            chosen.then(None, js=PRESS % json.dumps(self.go.elem_id), **QUIET)

    @staticmethod
    def _of_method(model: str) -> list[Any]:
        """The line on a method, and whether the number of futures and the seed are shown."""
        shown = gr.update(visible=_draws(model) or "hidden")
        return [gr.update(value=method_line(method(model).summary)), shown, shown]

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the motion that was asked about, so that the marker can be moved on it."""
        updates, result, past = super().opened(run), run.result, self.past
        if not isinstance(result, PredictResult):
            return updates
        for part, update in zip(self._of_model, self._of_method(run.entry.request["model"]), strict=True):
            updates[part] = updates.get(part, {}) | update
        given = result.given
        named = result.manifest.get("request", {}).get("motion", {}).get("name") or run.entry.title
        source = Source(named, given.people)
        return updates | {
            past.file: None,
            past.animation: offered_animations(source),
            past.state: source,
            past.marker: past.marked(source, result.past_frames / result.duets[0].fps),
        }

    def shown(self, result: Result, title: str) -> dict[str, Any]:
        """Also the error in a sentence."""
        shown = super().shown(result, title)
        if not isinstance(result, PredictResult):  # of a history that did not keep what followed
            return shown
        return {**shown, "readouts": prediction_lines({"": error_lines(result)[0]}) + str(shown["readouts"])}


def _found_line(source: Source) -> str:
    sentence = f"{source.name}: {'two people' if len(source.people) > 1 else 'one person'}, {source.seconds:.1f} s."
    if source.seconds < PAST_SECONDS:
        return status(f"{sentence} Give {PAST_SECONDS:g} s or more.", tone="warning")
    if source.seconds > LONGEST:
        return status(f"{sentence} Cut it to {LONGEST:g} s or less.", tone="warning")
    return status(" ".join((sentence, *source.notes)), tone="warning" if source.notes else "quiet")
