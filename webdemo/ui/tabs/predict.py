"""The tab of predictions: a motion, a marker where the past ends, and what is predicted after it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gradio as gr
import numpy as np

from motion import FPS, Clip, Duet, InputError
from webdemo.inference.methods import installed, label_of, method
from webdemo.inference.requests.predict import LONGEST, PAST_SECONDS, PredictRequest, PredictResult
from webdemo.inference.run import Result
from webdemo.ui.components.actors import Source, given_again, offered_animations
from webdemo.ui.components.animations import animation_field, kept_animation
from webdemo.ui.components.camera import CameraPanel
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import show
from webdemo.ui.components.prediction_view import (
    curves_figure,
    error_lines,
    method_name,
    prediction_payload,
    without_name,
)
from webdemo.ui.components.settings import looked_up
from webdemo.ui.components.sweep import BETWEEN_SENTENCES, Kind, grid_table, real
from webdemo.ui.components.upload import chip, example_chips, file_field
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import comparison_panel, method_line, prediction_lines, status
from webdemo.ui.text.texts import say
from webdemo.view.payload import player_payload

from .generate import named_method
from .job import QUIET, Updates
from .source import SourceTab

EMPTY_TEXT = "player.empty_predict"


def predict_choices(weights: Path | None = None) -> list[tuple[str, str]]:
    """(label, name) of the methods of prediction whose weights are there, or that need none."""
    return [(method.label, method.name) for method in installed("predict", weights)]


def _draws(model: str) -> bool:
    """True of a method that draws its futures, which needs two people."""
    return "two people" in method(model, "predict").takes


def motion_of(source: Source) -> Clip | Duet:
    """All people of a source, the first called after it."""
    people = source.whole(LONGEST)
    first = replace(people[0], name=source.name)
    return Duet(first, people[1]) if len(people) > 1 else first


def given_source(result: PredictResult, name: str) -> Source:
    """The motion of a prediction's request, as a source again."""
    given = result.given
    named = result.manifest.get("request", {}).get("motion", {}).get("name")
    return Source(named or name, given.people if isinstance(given, Duet) else (given,))


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


class PredictTab(SourceTab):
    """A past → its future; see :class:`SourceTab`."""

    label = "Predict"
    named = "tabs.predict"
    prefix = "predict-"
    restored = ("file", "given", "about", "animation")

    def request(self, fields: Mapping[str, Any]) -> Any:
        """A :class:`PredictRequest`; raises InputError where none can be made of the fields."""
        source: Source | None = fields["source"]
        if source is None:
            raise InputError("There is no motion yet: drop a file, or pick an example or the last result.")
        return PredictRequest(
            motion=motion_of(source),
            marker=fields["marker"],
            seconds=fields["seconds"],
            seed=fields.get("seed", PredictRequest.seed),
            model=fields["model"],  # older grids have no seed
        )

    def title(self, request: PredictRequest) -> str:
        """The time at which the prediction begins, and the name of the motion."""
        name = request.motion.name if isinstance(request.motion, Clip) else request.motion.a.name
        return f"After {request.marker:.1f} s of {name}"

    def kinds(self) -> Sequence[Kind]:
        """Methods, where the past ends, and the length."""
        known = {label.lower(): name for label, name in predict_choices()}
        models = Kind("model", "Methods", read=partial(named_method, known), split=BETWEEN_SENTENCES, named=label_of)
        marker = Kind("marker", "Past ends at (s)", "from", real, named=lambda value: f"{value:g} s")
        length = Kind("seconds", "Seconds to predict", read=real, named=lambda value: f"{value:g} s")
        return (models, marker, length)

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """All methods beside each other."""
        listed = [label for label, name in predict_choices() if not _draws(name)]
        return {"Method beside method": ("model", "; ".join(listed))}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """The errors of all cells over their read-outs; the curves of one prediction are hidden."""
        results = [result for result in made.values() if isinstance(result, PredictResult)]
        errors = dict(zip(made, error_lines(*results), strict=True)) if len(results) == len(made) else {}
        return {"curves": gr.update(visible=False), "readouts": prediction_lines(errors) + grid_table(made)}

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
                self._handed_out(self._curves)
                with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
                    self.marker = gr.Slider(
                        0,
                        10,
                        value=PAST_SECONDS,
                        step=0.1,
                        label=say("predict.marker"),
                        info=say("predict.marker_info"),
                        elem_id="predict-marker",
                    )
                    self.seconds = gr.Slider(
                        *method(PredictRequest.model).seconds,
                        value=PredictRequest.seconds,
                        step=0.5,
                        label=say("predict.seconds"),
                        elem_id="predict-seconds",
                    )
                    with gr.Row(elem_classes="pd-rows"):
                        self.model = gr.Dropdown(
                            predict_choices(),
                            value=PredictRequest.model,
                            label=say("react.method"),
                            elem_id="predict-method",
                            min_width=0,
                            filterable=False,
                        )
                    self.about = gr.HTML(self.method_about(PredictRequest.model), elem_id="predict-about")
                    self.seed = gr.Number(
                        value=PredictRequest.seed,
                        label=say("sampling.seed"),
                        info=say("predict.seed_info"),
                        elem_id="predict-seed",
                        min_width=0,
                        visible="hidden",
                    )
                    self._sweeps(self._beside)
            self._results(EMPTY_TEXT)
        self.source = gr.State(None, time_to_live=3600)
        self.given = gr.Textbox("", visible=False)
        self.controls = {
            "source": self.source,
            "given": self.given,
            "marker": self.marker,
            "seconds": self.seconds,
            "model": self.model,
            "other": self.other,
            "seed": self.seed,
        }
        self._wire_run([self.go.click], record)
        self._wire_sweeps()
        self._wire_motion()

    def _ask(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.file = file_field("predict.file", elem_id="predict-file")
            with gr.Row(elem_classes="pd-chips"):
                self.chips = example_chips(self.examples)
                self.take = chip(say("predict.take"), elem_id="predict-take")
            self.camera = CameraPanel(elem_id="predict-camera")
            self.animation = animation_field("predict-animation")
            self._go(say("predict.go"))

    def _beside(self) -> None:
        """A second method, whose prediction is shown beside the first one's."""
        with gr.Row(elem_classes="pd-rows"):
            self.other = gr.Dropdown(
                [(say("sweeps.nothing"), ""), *predict_choices()],
                value="",
                label=say("sweeps.compare_with"),
                elem_id="predict-other",
                min_width=0,
                filterable=False,
            )

    def _curves(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-curves", min_width=0, visible=False) as self.curves:
            self.plot = gr.Plot(show_label=False, elem_id="predict-curves")

    def more_outputs(self) -> dict[str, gr.components.Component]:
        """The curves under the player."""
        return {"curves": self.curves, "plot": self.plot}

    # ---- events ----------------------------------------------------------------------------------

    def _wire_motion(self) -> None:
        self.loaded = [self.source, self.given, self.line, self.player, self.marker]
        load = self._wire_source(self.loaded, {self.take: self.take_result})
        self.model.input(
            None,
            inputs=self.model,
            outputs=[self.about, self.seed],
            js=looked_up({name: self._of_method(name) for _, name in predict_choices()}),
            **QUIET,
        )
        self.animation.input(
            self.read_again,
            inputs=[self.source, self.animation],
            trigger_mode="always_last",
            **{**load, "outputs": [*self.loaded, self.animation]},
        ).then(None, **self.compare)

    def read_again(self, source: Source | None, animation: int | None) -> Iterator[Updates]:
        """Reads another animation of the source's file, or takes that back where it cannot."""
        if source is None or source.path is None:
            return
        yield from self.again(source, (*source.read_with[:4], animation), [offered_animations(source)])

    def take_result(self, record: Record | None) -> Iterator[Updates]:
        """Makes the session's last result the past: the marker stands at its end."""
        yield from self.of_result("a", record, at_end=True)

    def payload(self, source: Source) -> dict[str, Any]:
        """All people of the motion."""
        return player_payload(without_name(motion_of(source)), title=source.name)

    def described(self, source: Source, *, at_end: bool) -> tuple[str, list[Any]]:
        """The line on its people and its length; the marker."""
        last = _last_marker(source)
        marker = last if at_end else min(_liveliest(source), last)
        return self._found_line(source), [self._marker(source, marker)]

    @staticmethod
    def _marker(source: Source, value: float) -> Any:
        """The marker's slider as long as a motion."""
        last = _last_marker(source)
        return gr.update(minimum=PAST_SECONDS, maximum=max(last, PAST_SECONDS + 0.1), value=value)

    def continues(self, button: gr.Button, tabs: gr.Tabs, tab: str) -> None:
        """Makes a button of any tab take the last result here, as a past that is to go on.

        Args:
            button: of the tab that shows the result.
            tabs: of the page.
            tab: this one's id among them.
        """
        shown = button.click(lambda: gr.update(selected=tab), outputs=tabs, queue=False, **QUIET)
        shown.then(
            self.take_result,
            inputs=self.record,
            outputs=self.loaded,
            concurrency_limit=2,
            concurrency_id="predict-read",
            **QUIET,
        ).then(None, **self.compare)
        shown.then(None, outputs=self.file, js="() => null", **QUIET)

    @staticmethod
    def _found_line(source: Source) -> str:
        length = f"{source.seconds:.1f} s."
        alone, two = f"{source.name}: one person, {length}", f"{source.name}: two people, {length}"
        sentence = two if len(source.people) > 1 else alone
        if source.seconds < PAST_SECONDS:
            return status(f"{sentence} Give {PAST_SECONDS:g} s or more.", tone="warning")
        if source.seconds > LONGEST:
            return status(f"{sentence} Cut it to {LONGEST:g} s or less.", tone="warning")
        return status(" ".join((sentence, *source.notes)), tone="warning" if source.notes else "quiet")

    def forget(self) -> Updates:
        """The tab without a motion."""
        return None, "", status(), show(None), gr.skip()

    @staticmethod
    def method_about(model: str) -> str:
        """One line on a method."""
        return method_line(method(model).summary)

    @classmethod
    def _of_method(cls, model: str) -> list[Any]:
        """The line on a method, and whether the seed is shown."""
        return [cls.method_about(model), {"__type__": "update", "visible": _draws(model) or "hidden"}]

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs one method, or two side by side."""
        if fields.get("other") and not fields.get("grid"):
            yield from self._answer_both(session, fields)
        else:
            yield from super().answer(session, fields)

    def _answer_both(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Continues the same past by two methods, one after the other, and shows both on one clock."""
        models = (fields["model"], fields["other"])
        if models[0] == models[1]:
            raise InputError("Both methods are the same: choose another one to compare with.")
        wanted = {model: self.request({**fields, "model": model}) for model in models}
        yield from self.answer_beside(session, wanted, {model: label_of(model) for model in models})

    def shown_beside(self, named: Mapping[str, Result], title: str) -> dict[str, Any]:
        """Predictions of one past, with their errors and the curves of these."""
        results = [result for result in named.values() if isinstance(result, PredictResult)]
        lines = dict(zip(named, error_lines(*results), strict=True))
        return {
            "record": Record(results[0], title, compared=named),
            "player": show(prediction_payload(*results, title=title)),
            "readouts": prediction_lines(lines) + comparison_panel(named),
            "curves": gr.update(visible=True),
            "plot": curves_figure(*results),
        }

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the motion that was asked about, so that the marker can be moved on it."""
        found, result = super().opened(run), run.result
        if isinstance(result, PredictResult):
            source = given_source(result, run.entry.title)
            source = replace(source, read_with=(*source.read_with[:4], kept_animation(run.kept.controls)))
            source, found[self.file], note = given_again(source, run.kept.original, self.page.shelf.folder())
            found[self.animation] = offered_animations(source)
            found[self.source], found[self.given] = source, source.key
            found[self.line] += status(note) if note else ""
            found[self.marker] = self._marker(source, result.past_frames / result.duets[0].fps)
        beside = () if "grid" in run.kept.controls else run.beside[:1]
        others = [each.result for each in beside if isinstance(each.result, PredictResult)]
        found[self.other] = gr.update(value=run.kept.controls.get("other") if others else "")
        if others and isinstance(result, PredictResult):
            found |= {
                self.outputs[name]: update
                for name, update in self.shown_beside(
                    {method_name(each): each for each in (result, *others)}, run.entry.title
                ).items()
            }
        return found

    def _shown(self, result: Result, title: str) -> dict[str, Any]:
        shown = super()._shown(result, title)
        if not isinstance(result, PredictResult):  # of a history that did not keep what followed
            return {**shown, "curves": gr.update(visible=False)}
        return {
            **shown,
            "player": show(prediction_payload(result, title=title)),
            "readouts": prediction_lines({"": error_lines(result)[0]}) + str(shown["readouts"]),
            "curves": gr.update(visible=True),
            "plot": curves_figure(result),
        }
