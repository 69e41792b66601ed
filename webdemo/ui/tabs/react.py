"""Give it one person, get the other: an uploaded actor, a trim, and a second person who reacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import gradio as gr

from webdemo.inference.methods import AUTOMATIC, variants
from webdemo.inference.requests import ReactRequest
from webdemo.inference.requests.live import PARTNERS
from webdemo.ui.components.actors import chosen_actor, react_choices, reactor, with_method
from webdemo.ui.components.fields import looked_up, method_list, prompt_field
from webdemo.ui.components.live import LivePanel, take_of
from webdemo.ui.components.sweep import Kind
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import method_line, notes_lines, status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import seconds

from .actor import ActorPanel
from .grids import SENTENCES, methods_kind
from .job import JobTab, Named
from .results import QUIET, Updates
from .sampling import Sampling

_AUTOMATIC = say("method.automatic")
_WORDS = say("react.words")
_STREAM = """(method) => {
  const panel = document.querySelector("#react-live .pdlive");
  const find = (name) => panel.querySelector(`.${name}`);
  if (find("pdcam-body").hidden) find("pdcam-open").click();
  find("pdlive-source").value = "clip";
  find("pdlive-partner").value = method === "agent" ? "agent" : "regennet";
  find("pdcam-begin").click();
}"""
"""JavaScript that lets a live partner answer the person on the stage, by a method where that can."""


class ReactTab(JobTab):
    """One person → two people."""

    label = "React"
    named = "tabs.react"
    prefix = "react-"

    def __init__(self, page: PageContext) -> None:
        super().__init__(page)
        self.sampling: Sampling = Sampling(self.prefix)
        self.actor = ActorPanel(self.results, self.prefix)

    def request(self, fields: Mapping[str, Any]) -> ReactRequest:
        """See :meth:`JobTab.request`."""
        return ReactRequest(**chosen_actor(fields))

    def title(self, request: ReactRequest) -> str:
        """The words, or whose reaction it is."""
        return request.prompt.strip() or f"Reaction to {request.actor.name}"

    def kinds(self) -> Sequence[Kind]:
        """Also words, and methods."""
        return (*super().kinds(), SENTENCES, methods_kind("method", {key: label for label, key in react_choices()}))

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """Also every method beside the others."""
        labels = [label for label, key in react_choices() if key != AUTOMATIC]
        return {**super().presets(), "Method beside method": ("method", "; ".join(labels))}

    def cell_fields(self, fields: Mapping[str, Any], cell: Mapping[str, Any]) -> dict[str, Any]:
        """A method gets its own number of steps."""
        asked = {**fields, **cell}
        if "method" in cell and "steps" not in cell:
            asked["steps"] = with_method(fields, cell["method"])["steps"]
        return asked

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, record: gr.State) -> None:
        """See :meth:`JobTab.build`."""
        self.lay_out(self._ask, self.sampling.build)
        self.controls = {
            "source": self.actor.state,
            "person": self.actor.person,
            "start": self.actor.begin,
            "end": self.actor.end,
            "role": self.role,
            "prompt": self.prompt,
            **self.sampling.controls,
            "method": self.method,
        }
        self.wire([self.go.click, self.prompt.submit], record)
        self.wire_start(self.keep_live, [self.live.submit], more=[self.live])
        self.actor.wire(self)
        self.stream.click(None, inputs=self.method, js=_STREAM, **QUIET)
        # In the browser: a late answer of the server would undo what was set meanwhile.
        fits = {key: self.fit_method(key) for _, key in react_choices()}
        self.method.input(None, inputs=self.method, outputs=self._fitted(), js=looked_up(fits), **QUIET)

    def _fitted(self) -> list[Any]:
        """What :meth:`fit_method` updates."""
        form = self.sampling
        return [self.role, form.steps, form.pace, form.guidance, form.damping, self.prompt, self.about, self.stream]

    def _ask(self) -> None:
        self.actor.build(self._live)
        self.actor.build_trim()
        self.prompt = prompt_field(_WORDS, "One person waves and the other waves back.", "react-prompt")
        self.build_go(say("react.go"), self._stream)
        with gr.Accordion(say("react.advanced"), open=False, elem_id="react-advanced", elem_classes="pd-advanced"):
            self.method = method_list(react_choices(), AUTOMATIC, "react-method")
            self.about = gr.HTML(method_line(_AUTOMATIC), elem_id="react-about")
            self.role = gr.Radio(
                [(say("react.acts_first"), "a"), (say("react.reacts"), "b")],
                value=ReactRequest.role,
                label=say("react.role"),
                elem_id="react-role",
            )

    def _live(self) -> None:
        self.live = LivePanel(elem_id="react-live")

    def _stream(self) -> None:
        """The button by which a method answers the person on the stage pose by pose, where it can."""
        self.stream = gr.Button(say("react.stream"), elem_id="react-stream", scale=0, min_width=96)

    def restored(self) -> Sequence[Any]:
        """The file, how it was read, the pace, the line on the method and whether it can stream."""
        file, more = [self.actor.file, self.actor.animation, *self.actor.known], self.actor.more()
        return [*file, *more, self.sampling.pace, self.about, self.stream]

    # ---- events ----------------------------------------------------------------------------------

    @staticmethod
    def fit_method(method: str) -> Updates:
        """Updates of role, steps, pace, guidance, damping, words, the line on a method and the button *Stream*.

        What a method does not have cannot be set.
        """
        chosen = reactor(method, {"prompt": "They move."})  # automatic: whatever is set may matter
        forced: dict[str, Any] = {} if "either role" in chosen.method.takes else {"value": "a"}
        heard, fixed = "words" in chosen.method.takes, chosen.method.fixed
        about = _AUTOMATIC if method == AUTOMATIC else chosen.method.summary
        return (
            gr.update(interactive=not forced, **forced),
            gr.update(value=chosen.method.steps, interactive="steps" not in fixed),
            gr.update(interactive="steps" not in fixed),
            gr.update(interactive="guidance" not in fixed),
            gr.update(interactive="damping" not in fixed and chosen.mode == "offline"),
            gr.update(interactive=heard, label=_WORDS if heard else say("react.words_unused", method=chosen.label)),
            method_line(about),
            gr.update(visible=method == AUTOMATIC or chosen.method.name in PARTNERS),
        )

    def keep_live(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Makes a live stream, as the panel sends it, a result of the history; yields updates of the page."""
        taken = {"source": None, "live": values[self.live]}
        yield from self.run(str(request.session_hash), {**self.fields(values), **taken})

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Named]:
        """Runs a method, or shows a live stream that is kept as a result."""
        if "live" not in fields:
            yield from super().answer(session, fields)
            return
        take = take_of(fields["live"])
        result = yield from self.made(session, take)
        said = status(f"Kept: {seconds(take.actor.seconds)} live.", tone="done")
        yield self.shown(result, take.title) | {"line": said + notes_lines({"": result})}

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also the method with what it lets be set, and the given person."""
        asked, controls = run.entry.request, run.kept.controls
        known = variants("react")
        its = (asked.get("model"), asked.get("mode"))
        method = next((key for key, v in known.items() if (v.method.name, v.mode) == its), next(iter(known)))
        if controls.get("method") in (*known, AUTOMATIC):
            method = str(controls["method"])
        updates = super().opened(run)
        fitted = dict(zip(self._fitted(), self.fit_method(method), strict=True))
        for part, fit in fitted.items():
            kept = updates.get(part)
            fitted[part] = {**fit, "value": kept["value"]} if isinstance(kept, dict) else fit
        given = self.actor.opened(run)
        updates |= {**fitted, **given, self.method: gr.update(value=method)}
        return updates
