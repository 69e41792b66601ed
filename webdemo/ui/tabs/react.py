"""Give it one person, get the other: an uploaded actor, a trim, and a second person who reacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.method import SECONDS
from webdemo.inference.methods import AUTOMATIC, variants
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.live import LiveRequest, LiveTake
from webdemo.ui.components.actors import (
    READ_WITH,
    Source,
    chosen_actor,
    live_variant,
    react_choices,
    reactor,
    rig_of,
    with_method,
)
from webdemo.ui.components.animations import animation_field
from webdemo.ui.components.camera import CameraPanel
from webdemo.ui.components.exports import Record
from webdemo.ui.components.live import LiveView
from webdemo.ui.components.live_panel import LivePanel, take_of
from webdemo.ui.components.player import show
from webdemo.ui.components.settings import looked_up
from webdemo.ui.components.show import result_payload
from webdemo.ui.components.sweep import BETWEEN_SENTENCES, Kind
from webdemo.ui.components.upload import chip, example_chips, file_field
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import method_line, notes_lines, status
from webdemo.ui.text.texts import english, say, worded
from webdemo.ui.text.words import seconds, text

from .actor import ActorTab
from .generate import named_method
from .job import QUIET, Updates

EMPTY_TEXT = "player.empty_react"
_AUTOMATIC = english("method.automatic")
_WORDS = say("react.words")


def _methods() -> list[tuple[str, str]]:
    """The choices of methods as the page shows them."""
    return [(worded("way", label), key) for label, key in react_choices()]


class ReactTab(ActorTab):
    """One person → two people; see :class:`~.source.SourceTab`."""

    label = "React"
    named = "tabs.react"
    prefix = "react-"
    restored = ("file", "found", "method", "other", "about", "given", "person", "folded", *READ_WITH)

    def request(self, fields: Mapping[str, Any]) -> ReactRequest:
        """See :meth:`JobTab.request`."""
        return ReactRequest(**chosen_actor(fields))

    def title(self, request: ReactRequest) -> str:
        """The words, or whose reaction it is."""
        return request.prompt.strip() or f"Reaction to {request.actor.name}"

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the method, with what it lets be set."""
        asked, controls = run.entry.request, run.kept.controls
        known = variants("react")
        its = (asked.get("model"), asked.get("mode"))
        method = next((key for key, v in known.items() if (v.method.name, v.mode) == its), next(iter(known)))
        if controls.get("method") in (*known, AUTOMATIC):
            method = str(controls["method"])
        other = str(controls.get("other") or "") if run.beside else ""
        names = ("role", "steps", "guidance", "damping", "prompt", "about")
        fitted = zip((getattr(self, name) for name in names), self.fit_method(method, other), strict=True)
        kept = (controls.get(name, asked.get(name)) for name in names)
        found = super().opened(run) | {
            self.method: gr.update(value=method),
            self.other: gr.update(value=other),
            **{
                part: fit if value is None else {**fit, "value": value}
                for (part, fit), value in zip(fitted, kept, strict=True)
            },
        }
        found |= self._opened_actor(run, found[self.line]) | self._opened_beside(run)
        self.complete(found[self.outputs["record"]], {"source": found[self.source]})
        return found

    def complete(self, record: Record, fields: Mapping[str, Any]) -> None:
        """The rig of an uploaded file, for the partner on it."""
        if not record.grid:
            source: Source | None = fields.get("source")
            record.rig, record.animation = rig_of(source), source.read_with[4] if source else None

    def kinds(self) -> Sequence[Kind]:
        """Also words, and methods."""
        known = {label.lower(): key for label, key in react_choices()}
        labels = {key: label for label, key in react_choices()}
        methods = Kind(
            "method", "Methods", read=partial(named_method, known), split=BETWEEN_SENTENCES, named=labels.__getitem__
        )
        return (*super().kinds(), Kind("prompt", "Sentences", split=BETWEEN_SENTENCES), methods)

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """Also every method beside the others."""
        labels = [label for label, key in react_choices() if key != AUTOMATIC]
        return {**super().presets(), "Method beside method": ("method", "; ".join(labels))}

    def cell_fields(self, fields: Mapping[str, Any], cell: Mapping[str, Any]) -> dict[str, Any]:
        """A method gets its own number of steps, and its own role."""
        asked = {**fields, **cell, "other": ""}
        if "method" in cell and "steps" not in cell:
            asked["steps"] = with_method(fields, cell["method"])["steps"]
        return asked

    def _opened_beside(self, run: Opened) -> dict[gr.components.Component, Any]:
        """The comparison that the run was a part of, where its other side is still there."""
        if not run.beside or "grid" in run.kept.controls:
            return {}
        results = {label(each): each.result for each in (run, *run.beside[:1])}
        shown = self.shown_beside(results, run.entry.title)
        return {self.outputs[name]: shown[name] for name in ("player", "readouts", "record")}

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
                self._handed_out()
                with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
                    self._sampling()
                    self._sweeps(self._beside)
            self._results(EMPTY_TEXT)
        self.source = gr.State(None, time_to_live=3600)
        self.given = gr.Textbox("", visible=False)
        self.controls = {
            "source": self.source,
            "given": self.given,
            "person": self.person,
            "start": self.begin,
            "end": self.end,
            "role": self.role,
            "prompt": self.prompt,
            "seed": self.seed,
            "samples": self.samples,
            "guidance": self.guidance,
            "steps": self.steps,
            "damping": self.damping,
            "method": self.method,
            "other": self.other,
            "keep": self.keep,
        }
        self._wire_run([self.go.click, self.prompt.submit], record)
        self._wire_start(self.start_stream, [self.stream.click])
        self._wire_start(self.keep_live, [self.live.submit], more=[self.live])
        self._wire_sweeps()
        self._wire_actor()
        self._wire_methods()

    def _wire_methods(self) -> None:
        """Fits the settings to the chosen methods in the browser: a late answer would undo what was set."""
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
            self.file = file_field("react.file", elem_id="react-file")
            with gr.Row(elem_classes="pd-chips"):
                self.chips = example_chips(self.examples)
                self.take = {
                    person: chip(label, elem_id=f"react-take-{person}")
                    for person, label in (("a", say("react.take_a")), ("b", say("react.take_b")))
                }
            with gr.Row(elem_classes="pd-cameras"):
                self.camera = CameraPanel(elem_id="react-camera")
                self.live = LivePanel(elem_id="react-live")
            with gr.Column(visible=False, min_width=0, elem_classes="pd-settings") as self.trim:
                self.animation = animation_field("react-animation")
                self.person = gr.Radio(
                    [(say("react.person_a"), "a"), (say("react.person_b"), "b")],
                    value="a",
                    label=say("react.which"),
                    elem_id="react-person",
                    visible=False,
                )
                with gr.Row(elem_classes="pd-trim"):
                    self.begin = gr.Slider(
                        0,
                        SECONDS[1],
                        value=0,
                        step=0.1,
                        label=say("react.start"),
                        elem_id="react-start",
                        elem_classes="pd-trim-start",
                    )
                    self.end = gr.Slider(
                        0, SECONDS[1], value=SECONDS[1], step=0.1, label=say("react.end"), elem_id="react-end"
                    )
                self._import_choices()
                self.keep = gr.Checkbox(
                    False, label=say("react.keep"), elem_id="react-keep", visible=False, min_width=0
                )
                self.role = gr.Radio(
                    [(say("react.acts_first"), "a"), (say("react.reacts"), "b")],
                    value=ReactRequest.role,
                    label=say("react.role"),
                    elem_id="react-role",
                )
            with gr.Row(elem_classes="pd-rows"):
                self.method = gr.Dropdown(
                    _methods(),
                    value=AUTOMATIC,
                    label=say("react.method"),
                    elem_id="react-method",
                    min_width=0,
                    filterable=False,
                )
            self.about = gr.HTML(self.fit_method(AUTOMATIC)[-1], elem_id="react-about")
            if live := live_variant():
                line = say("react.stream_uses", method=text(live.label))
                gr.HTML(f'<p class="pd-method">{line}</p>', elem_id="react-live-method")
            self.prompt = gr.Textbox(
                label=_WORDS,
                placeholder="One person waves and the other waves back.",
                lines=1,  # so that Enter generates; the style sheet gives it the height of three
                max_lines=6,
                elem_id="react-prompt",
            )
            self._go(say("react.go"), self._stream_button)

    def _beside(self) -> None:
        """A second method, whose partner is shown beside the first one's."""
        with gr.Row(elem_classes="pd-rows"):
            self.other = gr.Dropdown(
                [(say("sweeps.nothing"), ""), *_methods()],
                value="",
                label=say("sweeps.compare_with"),
                elem_id="react-other",
                min_width=0,
                filterable=False,
            )

    def _stream_button(self) -> None:
        self.stream = gr.Button(
            say("react.stream"), elem_id="react-stream", min_width=0, visible=live_variant() is not None
        )

    def starts(self) -> dict[str, gr.Button]:
        """The buttons *React* and *Stream*."""
        return {**super().starts(), "stream": self.stream}

    # ---- events ----------------------------------------------------------------------------------

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
        about = _AUTOMATIC if method == AUTOMATIC else chosen.method.summary
        return (
            gr.update(interactive=either, **forced),
            gr.update(value=chosen.method.steps, interactive="steps" not in fixed),
            gr.update(interactive="guidance" not in fixed),
            gr.update(interactive="damping" not in fixed and chosen.mode == "offline"),
            gr.update(interactive=heard, label=_WORDS if heard else say("react.words_unused", method=chosen.label)),
            method_line(about),
        )

    def start_stream(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Streams an online reaction while the actor plays; yields updates of the page."""
        yield from self.run(str(request.session_hash), {**self._fields(values), "stream": True})

    def keep_live(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Makes a live stream, as the panel sends it, a result of the history; yields updates of the page."""
        taken = {"source": None, "live": values[self.live]}
        yield from self.run(str(request.session_hash), {**self._fields(values), **taken})

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs one method, two side by side, or a streamed reaction."""
        if fields.get("grid"):
            yield from super().answer(session, fields)
        elif "live" in fields:
            yield from self._answer_kept(session, take_of(fields["live"]))
        elif fields.get("stream"):
            yield from self._answer_streamed(session, fields)
        elif fields.get("other"):
            yield from self._answer_both(session, fields)
        else:
            yield from super().answer(session, fields)

    def _answer_kept(self, session: str, take: LiveTake) -> Iterator[Updates]:
        """Shows a live stream as a result."""
        result = yield from self.made(session, take)
        shown = self._shown(result, take.title)
        line = status(f"Kept: {seconds(take.actor.seconds)} live.", tone="done")
        yield self._updates(**{**shown, "line": line + notes_lines(result)})

    def _answer_both(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs two methods one after the other for the same actor, words and seed, and shows both."""
        keys = (fields["method"], fields["other"])
        if reactor(keys[0], fields) == reactor(keys[1], fields):
            raise InputError("Both methods are the same: choose another one to compare with.")
        wanted = {key: self.request(with_method(fields, key)) for key in keys}
        yield from self.answer_beside(session, wanted, {key: reactor(key, fields).label for key in keys})

    def _answer_streamed(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Streams one sample of the online method, whatever method is chosen."""
        live = live_variant()
        if live is None:
            raise InputError("No installed method can stream a reaction: choose a method and press React.")
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
        sentence = f"Streamed by {live.label}: {view.delay}."
        line = status(sentence, tone="done") + notes_lines(result)
        yield self._updates(**{**shown, "player": show(payload), "line": line})


def label(run: Opened) -> str:
    """The label of the method of a kept reaction, in its mode."""
    asked = run.entry.request
    its = (asked.get("model"), asked.get("mode"))
    known = variants("react").values()
    return next((v.label for v in known if (v.method.name, v.mode) == its), str(its[0]))
