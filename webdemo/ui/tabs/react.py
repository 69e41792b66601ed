"""Give it one person, get the other: an uploaded actor, a trim, and a second person who reacts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from motion.formats.importing import AXES, ORDERS, UNITS
from webdemo.inference.actor import SECONDS
from webdemo.inference.live import LiveRequest
from webdemo.inference.methods import AUTOMATIC, variants
from webdemo.inference.requests import ReactRequest, Result
from webdemo.ui.components.actors import (
    AUTO,
    Source,
    chosen_actor,
    live_variant,
    react_choices,
    reactor,
    read_source,
    result_source,
    with_method,
)
from webdemo.ui.components.camera import CameraPanel, film_source
from webdemo.ui.components.compare import comparison_payload
from webdemo.ui.components.exports import Record
from webdemo.ui.components.live import LiveView
from webdemo.ui.components.player import busy, show
from webdemo.ui.components.settings import looked_up
from webdemo.ui.components.show import result_payload
from webdemo.ui.components.upload import chip, example_chips, file_field
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.examples import example_clips
from webdemo.ui.text.panels import comparison_panel, method_line, notes_lines, status
from webdemo.ui.text.words import error_line, seconds, text

from .job import QUIET, JobTab, Updates, total

EMPTY_TEXT = (
    "Choose one person: drop a motion file or pick an example\n"
    "React adds a second person who answers. Live does so while the first one plays."
)
_DETECTED = "detect"
_AUTOMATIC = (
    "With words, InterGen answers them; without words, the virtual agent recognises the gesture itself."
)
_WORDS = "What do the two people do? (optional)"
_SHORTEST = 0.1
"""Seconds: the least that the trim's sliders differ in."""


class ReactTab(JobTab):
    """One person → two people.

    Args:
        page: what the tabs share.
        examples: (name, file) of the example actors; those that are shipped by default.
    """

    label = "React"
    prefix = "react-"
    restored = ("method", "other", "about", "given", "person", "folded")

    def __init__(self, page: PageContext, examples: list[tuple[str, Path]] | None = None) -> None:
        super().__init__(page)
        self.examples = example_clips() if examples is None else examples

    def request(self, fields: Mapping[str, Any]) -> ReactRequest:
        """See :meth:`JobTab.request`."""
        return ReactRequest(**chosen_actor(fields))

    def title(self, request: ReactRequest) -> str:
        """The words, or whose reaction it is."""
        return request.prompt.strip() or f"Reaction to {request.actor.name}"

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the method, with what it lets be set."""
        asked = run.entry.request
        known = variants("react")
        its = (asked.get("model"), asked.get("mode"))
        method = next((key for key, v in known.items() if (v.method.name, v.mode) == its), next(iter(known)))
        names = ("role", "steps", "guidance", "damping", "prompt", "about")
        fitted = zip((getattr(self, name) for name in names), self.fit_method(method), strict=True)
        kept = (asked.get(name) for name in names)
        return super().opened(run) | {
            self.method: gr.update(value=method),
            self.other: gr.update(value=""),
            **{
                part: fit if value is None else {**fit, "value": value}
                for (part, fit), value in zip(fitted, kept, strict=True)
            },
        }

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
                    self.samples = self._samples()
                    self._sampling()
            self._results(EMPTY_TEXT)
        self.source = gr.State(None, time_to_live=3600)
        self.given = gr.Textbox("", visible=False)
        self.controls = {
            "source": self.source, "given": self.given, "person": self.person, "start": self.begin, "end": self.end,
            "role": self.role, "prompt": self.prompt, "seed": self.seed, "samples": self.samples,
            "guidance": self.guidance, "steps": self.steps, "damping": self.damping, "method": self.method,
            "other": self.other, "keep": self.keep,
        }  # fmt: skip
        self._wire_run([self.go.click, self.prompt.submit], record)
        self._wire_start(self.start_live, [self.live.click])
        self._wire_actor()
        self._wire_methods()

    def _wire_methods(self) -> None:
        """What can be set follows the chosen methods, in the browser: a late answer would undo what was set."""
        keys = [key for _, key in react_choices()]
        fits = {f"{key}/{other}": self.fit_method(key, other) for key in keys for other in ("", *keys)}
        chosen = [self.method, self.other]
        fitted = [self.role, self.steps, self.guidance, self.damping, self.prompt, self.about]
        fit = self.method.input(None, inputs=chosen, outputs=fitted, js=looked_up(fits), **QUIET)
        fit.then(None, **self.tell_advanced)
        heard = {pair: (fit[0], fit[4]) for pair, fit in fits.items()}
        self.other.input(None, inputs=chosen, outputs=[self.role, self.prompt], js=looked_up(heard), **QUIET)

    def _ask(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.file = file_field("Given person", elem_id="react-file")
            with gr.Row(elem_classes="pd-chips"):
                self.chips = example_chips(self.examples)
                self.take = {
                    person: chip(f"{person.upper()} of the last result", elem_id=f"react-take-{person}")
                    for person in ("a", "b")
                }
            self.camera = CameraPanel(elem_id="react-camera")
            with gr.Column(visible=False, min_width=0, elem_classes="pd-settings") as self.trim:
                self.person = gr.Radio(
                    [("Person A", "a"), ("Person B", "b")], value="a", label="Which person",
                    elem_id="react-person", visible=False,
                )  # fmt: skip
                with gr.Row(elem_classes="pd-trim"):
                    self.begin = gr.Slider(0, SECONDS[1], value=0, step=0.1, label="Start",
                                           elem_id="react-start", elem_classes="pd-trim-start")  # fmt: skip
                    self.end = gr.Slider(0, SECONDS[1], value=SECONDS[1], step=0.1, label="End",
                                         elem_id="react-end")  # fmt: skip
                self._import_choices()
                self.keep = gr.Checkbox(
                    False, label="Start in the other person's first pose (not InterGen)",
                    elem_id="react-keep", visible=False, min_width=0,
                )  # fmt: skip
                self.role = gr.Radio(
                    [("acts first", "a"), ("reacts", "b")], value=ReactRequest.role,
                    label="The given person …", elem_id="react-role",
                )  # fmt: skip
            with gr.Row(elem_classes="pd-rows"):
                self.method = gr.Dropdown(
                    react_choices(), value=AUTOMATIC, label="Method",
                    elem_id="react-method", min_width=0, filterable=False,
                )  # fmt: skip
                self.other = gr.Dropdown(
                    [("nothing", ""), *react_choices()], value="", label="Compare with",
                    elem_id="react-other", min_width=0, filterable=False,
                )  # fmt: skip
            self.about = gr.HTML(self.fit_method(AUTOMATIC)[-1], elem_id="react-about")
            self.prompt = gr.Textbox(
                label=_WORDS,
                placeholder="One person waves and the other waves back.",
                lines=1,  # so that Enter generates; the style sheet gives it the height of three
                max_lines=6,
                elem_id="react-prompt",
            )
            self._go("React", self._live_button)

    def _import_choices(self) -> None:
        """The line on how the file was read, and its settings."""
        with gr.Accordion("How the file was read", open=False, elem_id="react-import"):
            with gr.Row(elem_classes="pd-pair"):
                self.up = gr.Dropdown(
                    [(_DETECTED, AUTO), *AXES], value=AUTO, label="Up axis", elem_id="react-up",
                    min_width=0,
                )  # fmt: skip
                self.unit = gr.Dropdown(
                    [(_DETECTED, AUTO), *UNITS], value=AUTO, label="Unit", elem_id="react-unit",
                    min_width=0,
                )  # fmt: skip
                self.fps = gr.Number(
                    value=None, label="Frames a second", placeholder=_DETECTED, elem_id="react-fps",
                    min_width=0,
                )  # fmt: skip
                self.order = gr.Dropdown(
                    [(_DETECTED, AUTO), *((label, name) for name, label in ORDERS.items())],
                    value=AUTO, label="Data set of a 15-joint file", elem_id="react-order", min_width=0,
                )  # fmt: skip
            self.found = gr.HTML(elem_id="react-found")

    def _live_button(self) -> None:
        self.live = gr.Button(
            "Live", elem_id="react-live", elem_classes="pd-live", min_width=0,
            visible=live_variant() is not None,
        )  # fmt: skip

    def starts(self) -> dict[str, gr.Button]:
        """The buttons *React* and *Live*."""
        return {**super().starts(), "live": self.live}

    # ---- events ----------------------------------------------------------------------------------

    def _wire_actor(self) -> None:
        changed = [
            self.source, self.given, self.line, self.player, self.trim, self.person, self.begin, self.end,
            self.found,
        ]  # fmt: skip
        load: dict[str, Any] = {
            "outputs": changed,
            "concurrency_limit": 2,
            "concurrency_id": "react-read",
            **QUIET,
        }
        self.file.upload(self.upload, inputs=self.file, **load).then(None, **self.compare)
        self.camera.submit(self.read_film, inputs=self.camera, **load).then(None, **self.compare)
        choices = [self.up, self.unit, self.fps, self.order]
        self.file.upload(lambda: (AUTO, AUTO, None, AUTO), outputs=choices, queue=False, **QUIET)
        gr.on(
            [self.up.input, self.unit.input, self.order.input, self.fps.submit, self.fps.blur],
            self.read_again, inputs=[self.source, *choices], trigger_mode="always_last",
            **{**load, "outputs": [*changed, *choices]},
        ).then(None, **self.compare)  # fmt: skip
        for button, (name, path) in zip(self.chips, self.examples, strict=True):
            read = partial(self.load, partial(read_source, path, name))
            button.click(read, **load).then(None, **self.compare)
        for person, button in self.take.items():
            taking = button.click(partial(self.take_result, person), inputs=self.record, **load)
            taking.then(None, **self.compare)
        others = [self.camera.submit, *(button.click for button in (*self.chips, *self.take.values()))]
        gr.on(others, None, outputs=self.file, js="() => null", **QUIET)  # the file is no longer what is used
        self.source.change(
            lambda source: gr.update(visible=source is not None and len(source.people) == 2, value=False),
            inputs=self.source, outputs=self.keep, queue=False, **QUIET,
        )  # fmt: skip
        self.file.clear(self.forget, outputs=changed, queue=False, **QUIET)
        trim = [self.source, self.person, self.begin, self.end]
        gr.on(
            [self.person.input, self.begin.release, self.end.release],
            self.preview, inputs=trim, outputs=[self.line, self.player], trigger_mode="always_last", **QUIET,
        )  # fmt: skip

    @staticmethod
    def fit_method(method: str, other: str = "") -> Updates:
        """Updates of role, steps, guidance, damping, words and the line on a method.

        What a method does not have cannot be set.
        """
        words = {"prompt": "They move."}  # automatic: whatever is set may matter
        chosen = reactor(method, words)
        both = [chosen, *([reactor(other, words)] if other else [])]
        either = all("either role" in variant.method.takes for variant in both)
        forced: dict[str, Any] = {} if either else {"value": "a"}
        heard = any("words" in variant.method.takes for variant in both)
        fixed = chosen.method.fixed
        steps = chosen.method.default("steps", ReactRequest.steps)
        live = live_variant()
        about = _AUTOMATIC if method == AUTOMATIC else chosen.method.summary
        return (
            gr.update(interactive=either, **forced),
            gr.update(value=steps, interactive="steps" not in fixed),
            gr.update(interactive="guidance" not in fixed),
            gr.update(interactive="damping" not in fixed and chosen.mode == "offline"),
            gr.update(interactive=heard, label=_WORDS if heard else f"{_WORDS} Not used: {chosen.label}"),
            method_line(about) + (method_line(f"Live always answers with {live.label}.") if live else ""),
        )

    def upload(self, path: str | None) -> Iterator[Updates]:
        """Reads an uploaded file and shows its actor; one that cannot be read leaves no actor."""
        if path is not None:
            yield from self.load(partial(read_source, path), fresh=True)

    def read_film(self, landmarks: str | None) -> Iterator[Updates]:
        """Makes the people of a film the actors."""
        yield from self.load(partial(film_source, landmarks))

    def read_again(
        self, source: Source | None, up: str, unit: str, fps: float | None, order: str = AUTO
    ) -> Iterator[Updates]:
        """Reads the source's file anew with what the visitor knows of it, or takes that back where it cannot."""
        if source is None or source.path is None:
            return
        path, name, asked = source.path, source.name, (up, unit, fps, order)
        for updates in self.load(lambda: read_source(path, name, asked)):
            failed = updates[0] == gr.skip() and "pd-error" in updates[2]
            yield *updates, *(source.read_with if failed else (gr.skip(),) * 4)

    def take_result(self, person: str, record: Record | None) -> Iterator[Updates]:
        """Makes a person of the session's last result the actor."""

        def read() -> Source:
            if record is None:
                raise InputError("There is no result yet: generate one first.")
            return result_source(record.result, record.prompt, person)

        yield from self.load(read)

    def load(self, read: Callable[[], Source], *, fresh: bool = False) -> Iterator[Updates]:
        """Updates of source, its key, line, player, trim, person, start, end and found while an actor is read.

        Where it is ``fresh`` and cannot be read, an earlier actor is forgotten.
        """
        rest = (gr.skip(),) * 5
        same = (gr.skip(),) * 2
        yield *same, status("Reading the motion …", tone="busy"), busy("Reading the motion …"), *rest
        try:
            source = read()
            payload = source.preview(source.chosen, 0.0, source.end)
        except Exception as error:
            told = status(error_line(error), tone="error")
            if fresh:
                nobody = list(self.forget())
                nobody[2] = told
                yield tuple(nobody)
            else:
                yield *same, told, busy(""), *rest
            return
        last = max(round(source.seconds, 1), _SHORTEST)
        yield (
            source,
            source.key,
            self._told(source, 0.0, source.end),
            show(payload),
            gr.update(visible=True),
            gr.update(choices=source.choices, visible=len(source.people) > 1, value=source.chosen),
            gr.update(maximum=last, value=0),
            gr.update(maximum=last, value=min(round(source.end, 1), last)),
            _found(source),
        )

    @staticmethod
    def forget() -> Updates:
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
        return self._told(source, start, end), show(payload)

    @staticmethod
    def _told(source: Source, start: float, end: float) -> str:
        end = min(end, source.seconds)
        shortest, longest = SECONDS
        used = f"{source.name}: {start:.1f} to {end:.1f} s of {source.seconds:.1f} s."
        if end - start < shortest - 1e-6:
            return status(f"{used} Take {shortest:g} s or more.", tone="warning")
        if end - start > longest + 0.05:
            return status(f"{used} Take {longest:g} s or less.", tone="warning")
        return status(" ".join((used, *source.notes)), tone="warning" if source.notes else "quiet")

    def start_live(
        self, values: dict[gr.components.Component, Any], request: gr.Request
    ) -> Iterator[Updates]:
        """Streams an online reaction while the actor plays; yields updates of the page."""
        yield from self.run(str(request.session_hash), {**self._fields(values), "live": True})

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs one method, two side by side, or the live reaction."""
        if fields.get("live"):
            yield from self._answer_live(session, fields)
        elif fields.get("other"):
            yield from self._answer_both(session, fields)
        else:
            yield from super().answer(session, fields)

    def _answer_both(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs two methods one after the other for the same actor, words and seed, and shows both."""
        keys = (fields["method"], fields["other"])
        if reactor(keys[0], fields) == reactor(keys[1], fields):
            raise InputError("Both methods are the same: choose another one to compare with.")
        wanted = {key: self.request(with_method(fields, key)) for key in keys}
        made: dict[str, Result] = {}
        for key, request in wanted.items():
            made[key] = yield from self.made(session, request, label=f"{reactor(key, fields).label}. ")
        title = self.title(wanted[keys[0]])
        named = {reactor(key, fields).label: result for key, result in made.items()}
        spent = " and ".join(seconds(total(result)) for result in made.values())
        yield self._updates(
            player=show(comparison_payload(named, title=title)),
            line=status(f"Both done, in {spent}.", tone="done") + "".join(map(notes_lines, made.values())),
            under=gr.update(visible=True),
            readouts=comparison_panel(named),
            record=Record(made[keys[0]], title, compared=made),
        )

    def _answer_live(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Streams one sample of the online method, whatever method is chosen."""
        live = live_variant()
        if live is None:
            raise InputError("No installed method can react live: choose a method and press React.")
        wanted = LiveRequest(**chosen_actor({**with_method(fields, live.key), "samples": 1}))
        title = self.title(wanted)
        view = LiveView(wanted.actor, title)
        try:
            result = yield from self.made(session, wanted, watch=view)
        except Exception:
            yield self._updates(player=view.stopped())
            raise
        shown = self._shown(result, title)
        payload = {**result_payload(result, title=title), "continues": view.id}
        told = f"Live reaction by {live.label} done: {view.delay}."
        line = status(told, tone="done") + notes_lines(result)
        yield self._updates(**{**shown, "player": show(payload), "line": line})


def _found(source: Source) -> str:
    """Describes as HTML how a source's file was read: one line, then its joints beside SMPL's."""
    if source.found is None:
        return status("Taken from a result, so there was nothing to detect.")
    pairs = " · ".join(f"{text(theirs)} → {text(ours)}" for theirs, ours in source.found.joints)
    return f'{status(source.found.line)}<p class="pd-timings">{pairs}</p>'
