"""The given person of the tab React: who of a motion, which part of it, and how the file was read."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gradio as gr

from motion import Duet
from motion.formats.recording import AXES, ORDERS
from webdemo.inference.method import SECONDS
from webdemo.inference.methods import methods
from webdemo.inference.requests.actor import ROLES
from webdemo.ui.components.actors import AUTO, Source, offered_animations
from webdemo.ui.components.fields import FittedSlider, slider
from webdemo.ui.components.player import show
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say

from .results import QUIET, Parts, said
from .source import SourcePanel

_DETECTED = say("actor.detect")
_SHORTEST = 0.1
"""Seconds: the least that the trim's sliders differ in."""


class ActorPanel(SourcePanel):
    """One person of a motion, trimmed."""

    named = "react.file"

    def build_trim(self) -> None:
        """Who is given and which part of their motion; seen once there is a motion."""
        with gr.Column(visible=False, min_width=0, elem_classes="pd-settings") as self.trim:
            self.build_animation()
            self.person = gr.Radio(
                [(say("react.person_a"), "a"), (say("react.person_b"), "b")],
                value="a",
                label=say("react.which"),
                elem_id="react-person",
                visible=False,
            )
            with gr.Row(elem_classes="pd-trim"):
                span: dict[str, Any] = {"bounds": (0, SECONDS[1]), "step": 0.1, "kind": FittedSlider}
                self.begin = slider("react.start", value=0, elem_id="react-start", elem_classes="pd-trim-start", **span)
                self.end = slider("react.end", value=SECONDS[1], elem_id="react-end", **span)
            self._import_choices()

    def _import_choices(self) -> None:
        """The line on how the file was read, and its settings."""

        def choice(label: str, name: str, choices: list[tuple[str, str]]) -> gr.Dropdown:
            return gr.Dropdown(
                [(_DETECTED, AUTO), *choices], value=AUTO, label=label, elem_id=f"react-{name}", min_width=0
            )

        with gr.Accordion(say("actor.read"), open=False, visible=False, elem_id="react-import") as self.reading:
            with gr.Row(elem_classes="pd-pair"):
                self.up = choice(say("actor.up"), "up", [(axis, axis) for axis in AXES])
                self.fps = gr.Number(
                    value=None, label=say("actor.fps"), placeholder=_DETECTED, elem_id="react-fps", min_width=0
                )
                self.order = choice(say("actor.order"), "order", [(label, name) for name, label in ORDERS.items()])
            self.found = gr.HTML(elem_id="react-found")
        self.known = [self.up, self.fps, self.order]

    def wire(self, tab: Any) -> None:
        """Also what shows the chosen person and part."""
        super().wire(tab)
        self.file.upload(lambda: (AUTO, None, AUTO), outputs=list(self.known), queue=False, **QUIET)
        self.state.change(self.settings_of, inputs=self.state, outputs=self.reading, queue=False, **QUIET)
        gr.on(
            [self.person.input, self.begin.release, self.end.release],
            self.preview,
            inputs=[self.state, self.person, self.begin, self.end],
            outputs=[self.line, self.results.player, *self.bare],
            trigger_mode="always_last",
            **QUIET,
        )

    # ---- what is shown ---------------------------------------------------------------------------

    def settings_of(self, source: Source | None) -> dict[str, Any]:
        """Shows how a file was read where it is somebody's own, opened where something had to be assumed."""
        own = self.own(source)
        return gr.update(visible=own, open=own and source is not None and source.asks)

    def payload(self, source: Source) -> dict[str, Any]:
        """The chosen person, from the beginning to where they are used at most."""
        return source.preview(source.chosen, 0.0, source.end)

    def more(self) -> list[gr.components.Component]:
        """The trim, the person, both ends and how the file was read."""
        return [self.trim, self.person, self.begin, self.end, self.found]

    def gone(self) -> Parts:
        """The trim is hidden as well."""
        return super().gone() | {self.trim: gr.update(visible=False)}

    def described(self, source: Source, *, at_end: bool) -> Parts:
        """The line on the part that is used, and the updates of :meth:`more`."""
        return {self.line: self._part_line(source, 0.0, source.end), **self._chosen(source, 0, round(source.end, 1))}

    def _chosen(self, source: Source, begin: float, end: float) -> Parts:
        last = max(round(source.seconds, 1), _SHORTEST)
        detected = source.found or "Taken from a result or the history, so there was nothing to detect."
        return {
            self.trim: gr.update(visible=True),
            self.person: gr.update(choices=source.choices, visible=len(source.people) > 1, value=source.chosen),
            self.begin: gr.update(maximum=last, value=begin),
            self.end: gr.update(maximum=last, value=min(end, last)),
            self.found: status(detected),
        }

    @said
    def preview(self, source: Source | None, person: str, start: float, end: float) -> Parts:
        """Shows the actor as trimmed."""
        if source is None:
            return {self.line: gr.skip()}
        player = show(source.preview(person, start, end))
        return {self.line: self._part_line(source, start, end), self.results.player: player, **self.bare}

    @staticmethod
    def _part_line(source: Source, start: float, end: float) -> str:
        end = min(end, source.seconds)
        shortest, longest = SECONDS
        part = "" if end - start > source.seconds - 0.05 else f"{start:.1f} to {end:.1f} s of "
        used = f"{source.name}: {part}{source.seconds:.1f} s."
        if end - start < shortest - 1e-6:
            return status(f"{used} Take {shortest:g} s or more.", tone="warning")
        if end - start > longest + 0.05:
            takers = [each.label for each in methods("react") if end - start <= each.seconds[1] + 0.05]
            advice = f"Choose {' or '.join(takers)}, or take" if takers else "Take"
            return status(f"{used} {advice} {longest:g} s or less.", tone="warning")
        return status(" ".join((used, *source.notes)), tone="warning" if source.notes else "quiet")

    def opened(self, run: Opened) -> Parts:
        """Updates by component: who of the people of the chosen file and which part; or the given person alone."""
        controls = run.kept.controls
        source = actor_source(run)
        begin, end = 0.0, round(source.end, 1)
        if people := run.kept.people:
            source = replace(source, people=people)
            letters = [letter for _, letter in source.choices]
            source = replace(source, chosen=controls["person"] if controls.get("person") in letters else "a")
            begin, end = float(controls.get("start", 0.0)), float(controls.get("end", end))
        return {
            self.file: None,
            self.state: source,
            self.animation: offered_animations(source),
            **dict(zip(self.known, source.read_with[:3], strict=True)),
            **self._chosen(source, begin, end),
        }


def actor_source(opened: Opened) -> Source:
    """The given person of a kept reaction, whom its result holds unchanged."""
    asked = opened.entry.request
    place = ROLES.index(asked.get("role", ROLES[0]))
    duet = opened.result.duets[0]
    assert isinstance(duet, Duet)  # as every reaction is
    return Source(asked.get("actor", {}).get("name") or opened.entry.title, (duet.people[place],))
