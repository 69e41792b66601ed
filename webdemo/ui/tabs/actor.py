"""The given person of the React tab: a file, an example or a result, read, trimmed and shown."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import gradio as gr

from motion.formats.recording import AXES, ORDERS, UNITS
from webdemo.inference.method import SECONDS
from webdemo.inference.methods import methods
from webdemo.ui.again import actor_source
from webdemo.ui.components.actors import AUTO, ReadWith, Source, given_again, offered_animations
from webdemo.ui.components.animations import kept_animation
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import busy, show
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line, text

from .job import QUIET, Updates
from .source import SourceTab

_DETECTED = say("actor.detect")
_SHORTEST = 0.1
"""Seconds: the least that the trim's sliders differ in."""


class ActorTab(SourceTab):
    """The part of the React tab that chooses who is given; see :class:`SourceTab`."""

    take: dict[str, gr.Button]
    trim: gr.Column
    reading: gr.Accordion
    person: gr.Radio
    begin: gr.Slider
    end: gr.Slider
    keep: gr.Checkbox

    def _import_choices(self) -> None:
        """The line on how the file was read, and its settings."""
        with gr.Accordion(say("actor.read"), open=False, elem_id="react-import") as self.reading:
            with gr.Row(elem_classes="pd-pair"):
                self.up = gr.Dropdown(
                    [(_DETECTED, AUTO), *AXES], value=AUTO, label=say("actor.up"), elem_id="react-up", min_width=0
                )
                self.unit = gr.Dropdown(
                    [(_DETECTED, AUTO), *UNITS], value=AUTO, label=say("actor.unit"), elem_id="react-unit", min_width=0
                )
                self.fps = gr.Number(
                    value=None, label=say("actor.fps"), placeholder=_DETECTED, elem_id="react-fps", min_width=0
                )
                self.order = gr.Dropdown(
                    [(_DETECTED, AUTO), *((label, name) for name, label in ORDERS.items())],
                    value=AUTO,
                    label=say("actor.order"),
                    elem_id="react-order",
                    min_width=0,
                )
            self.found = gr.HTML(elem_id="react-found")

    def _opened_actor(self, run: Opened, line: str) -> dict[Any, Any]:
        """The file that was chosen, who in it and which part; or the given person alone, where that was not kept.

        ``line`` is the status line, to which is added that another file stands in the place of the chosen one.
        """
        controls = run.kept.controls
        source = actor_source(run)
        begin, end = 0.0, round(source.end, 1)
        file, note = None, ""
        if people := run.kept.people:
            source = replace(source, people=people)
            letters = [letter for _, letter in source.choices]
            source = replace(source, chosen=controls["person"] if controls.get("person") in letters else "a")
            begin, end = float(controls.get("start", 0.0)), float(controls.get("end", end))
            source = replace(source, read_with=_known_choices(controls))
            source, file, note = given_again(source, run.kept.original, self.page.shelf.folder())
        last = max(round(source.seconds, 1), _SHORTEST)
        return {
            self.file: file,
            self.line: line + (status(note) if note else ""),
            self.found: _found(source),
            **dict(zip((self.up, self.unit, self.fps, self.order), source.read_with[:4], strict=True)),
            self.animation: offered_animations(source),
            self.source: source,
            self.given: source.key,
            self.trim: gr.update(visible=True),
            self.person: gr.update(choices=source.choices, visible=len(source.people) > 1, value=source.chosen),
            self.begin: gr.update(maximum=last, value=begin),
            self.end: gr.update(maximum=last, value=min(end, last)),
        }

    # ---- events ----------------------------------------------------------------------------------

    def _wire_actor(self) -> None:
        changed = [
            self.source,
            self.given,
            self.line,
            self.player,
            self.trim,
            self.person,
            self.begin,
            self.end,
            self.found,
        ]
        takes = {button: partial(self.take_result, person) for person, button in self.take.items()}
        load = self._wire_source(changed, takes)
        known = [self.up, self.unit, self.fps, self.order]
        self.file.upload(lambda: (AUTO, AUTO, None, AUTO), outputs=known, queue=False, **QUIET)
        choices = [*known, self.animation]
        gr.on(
            [self.up.input, self.unit.input, self.order.input, self.fps.submit, self.fps.blur, self.animation.input],
            self.read_again,
            inputs=[self.source, *choices],
            trigger_mode="always_last",
            **{**load, "outputs": [*changed, *choices]},
        ).then(None, **self.compare)
        self.source.change(
            lambda source: gr.update(visible=source is not None and len(source.people) == 2, value=False),
            inputs=self.source,
            outputs=self.keep,
            queue=False,
            **QUIET,
        )
        self.source.change(
            lambda source: gr.update(open=True) if source is not None and source.asks else gr.skip(),
            inputs=self.source,
            outputs=self.reading,
            queue=False,
            **QUIET,
        )
        trim = [self.source, self.person, self.begin, self.end]
        gr.on(
            [self.person.input, self.begin.release, self.end.release],
            self.preview,
            inputs=trim,
            outputs=[self.line, self.player],
            trigger_mode="always_last",
            **QUIET,
        )

    def read_again(
        self,
        source: Source | None,
        up: str,
        unit: str,
        fps: float | None,
        order: str = AUTO,
        animation: int | None = None,
    ) -> Iterator[Updates]:
        """Reads the source's file anew with what the visitor knows of it, or takes that back where it cannot."""
        if source is None or source.path is None:
            return
        back = (*source.read_with[:4], offered_animations(source))
        yield from self.again(source, (up, unit, fps, order, animation), back)

    def take_result(self, person: str, record: Record | None) -> Iterator[Updates]:
        """Makes a person of the session's last result the actor."""
        yield from self.of_result(person, record)

    def payload(self, source: Source) -> dict[str, Any]:
        """The chosen person, from the beginning to where they are used at most."""
        return source.preview(source.chosen, 0.0, source.end)

    def described(self, source: Source, *, at_end: bool) -> tuple[str, list[Any]]:
        """The line on the part that is used; trim, person, start, end and found."""
        last = max(round(source.seconds, 1), _SHORTEST)
        return self._part_line(source, 0.0, source.end), [
            gr.update(visible=True),
            gr.update(choices=source.choices, visible=len(source.people) > 1, value=source.chosen),
            gr.update(maximum=last, value=0),
            gr.update(maximum=last, value=min(round(source.end, 1), last)),
            _found(source),
        ]

    def forget(self) -> Updates:
        """The tab without an actor; a result stays in the downloads."""
        return None, "", status(), show(None), gr.update(visible=False), *(gr.skip(),) * 4

    def preview(self, source: Source | None, person: str, start: float, end: float) -> Updates:
        """Shows the actor as trimmed."""
        if source is None:
            return gr.skip(), gr.skip()
        try:
            payload = source.preview(person, start, end)
        except Exception as error:
            return status(error_line(error), tone="error"), busy("")
        return self._part_line(source, start, end), show(payload)

    @staticmethod
    def _part_line(source: Source, start: float, end: float) -> str:
        end = min(end, source.seconds)
        shortest, longest = SECONDS
        used = f"{source.name}: {start:.1f} to {end:.1f} s of {source.seconds:.1f} s."
        if end - start < shortest - 1e-6:
            return status(f"{used} Take {shortest:g} s or more.", tone="warning")
        if end - start > longest + 0.05:
            takers = [found.label for found in methods("react") if end - start <= found.seconds[1] + 0.05]
            advice = f"Choose {' or '.join(takers)}, or take" if takers else "Take"
            return status(f"{used} {advice} {longest:g} s or less.", tone="warning")
        return status(" ".join((used, *source.notes)), tone="warning" if source.notes else "quiet")


def _known_choices(controls: Mapping[str, Any]) -> ReadWith:
    """The settings with which a kept run's file was read; what its control does not offer is found anew."""

    def offered(name: str, values: Collection[str]) -> str:
        value = controls.get(name)
        return value if isinstance(value, str) and value in values else AUTO

    fps = controls.get("fps")
    return (
        offered("up", AXES),
        offered("unit", UNITS),
        float(fps) if isinstance(fps, (int, float)) else None,
        offered("order", ORDERS),
        kept_animation(controls),
    )


def _found(source: Source) -> str:
    """Describes as HTML how a source's file was read: one line, then its joints beside SMPL's."""
    if source.found is None and source.path is not None:
        return status("Opened from the history. Change a setting here to read the file anew.")
    if source.found is None:
        return status("Taken from a result or the history, so there was nothing to detect.")
    pairs = " · ".join(f"{text(theirs)} → {text(ours)}" for theirs, ours in source.found.joints)
    return f'{status(source.found.line)}<p class="pd-timings">{pairs}</p>'
