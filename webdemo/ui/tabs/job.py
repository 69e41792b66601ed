"""The common part of the tabs that make motion: sliders, a player, a run that can be cancelled, files."""

from __future__ import annotations

import logging
import secrets
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.requests import MAX_SEED, SamplingRequest
from webdemo.inference.run import Cancelled, Progress, Result
from webdemo.ui.components.actors import READ_WITH
from webdemo.ui.components.compare import comparison_payload
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import busy, show
from webdemo.ui.components.settings import OPENED, differs, snapshot
from webdemo.ui.components.show import result_payload
from webdemo.ui.context import PageContext
from webdemo.ui.history import Kept, Opened, Original
from webdemo.ui.text.panels import comparison_panel, notes_lines, plan_line, readout_panel, status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import cancelled_line, error_line, progress_line, seconds
from webdemo.ui.visitor import visitor

from .results import QUIET, Updates
from .sampling import SamplingTab

log = logging.getLogger(__name__)
__all__ = ["QUIET", "JobTab", "Updates", "total"]


PACE = 0.5
"""Seconds between two updates of the page while a run goes on; each costs a browser about ten milliseconds."""
Watch = Callable[[Progress], dict[str, Any] | None]


def total(result: Result) -> float:
    """Seconds that a result took."""
    return result.timings.get("total", sum(result.timings.values()))


class JobTab(SamplingTab, ABC):
    """A tab that turns its controls into a request, runs it and shows the result.

    A subclass lays out its own controls between these parts and answers :meth:`request` and :meth:`title`.

    Args:
        page: what the tabs share.
    """

    label: str
    named: str
    """Key of the tab's name as the page shows it."""
    restored: tuple[str, ...] = ()
    """Attributes that :meth:`opened` sets, besides the result and controls named as a request's fields."""
    controls: Mapping[str, gr.components.Component]
    """The inputs of a run, by the names of its fields; set by ``build``."""
    first: str | None = None
    """JavaScript that the values of ``controls`` pass through before a run, in the order of the components' ids."""

    @abstractmethod
    def request(self, fields: Mapping[str, Any]) -> SamplingRequest:
        """The request that the controls' values ask for; raises InputError where they do not fit."""

    @abstractmethod
    def title(self, request: Any) -> str:
        """The title that the player shows over the result, and from which its files are named."""

    def __init__(self, page: PageContext) -> None:
        super().__init__(page)
        self._cancelled: set[str] = set()
        """Sessions whose last run here was cancelled."""

    # ---- layout ----------------------------------------------------------------------------------

    def _go(self, verb: str, beside: Callable[[], None] = lambda: None) -> None:
        """The buttons that start a run and cancel it, with what ``beside`` lays out between them."""
        with gr.Row(elem_classes="pd-go"):
            self.go = gr.Button(
                verb, variant="primary", elem_id=self._id("generate"), elem_classes="pd-run", min_width=0
            )
            beside()
            self.stop = gr.Button(
                say("job.cancel"), elem_id=self._id("cancel"), elem_classes="pd-stop", interactive=False, min_width=0
            )
        self.line = gr.HTML(status(), elem_id=self._id("status"), elem_classes="pd-line")
        self.changed = gr.HTML("", elem_id=self._id("changed"), elem_classes="pd-line")
        self.asked = gr.Textbox("", visible=False)

    # ---- events ----------------------------------------------------------------------------------

    def _wire_run(self, triggers: Sequence[Any], record: gr.State | None) -> None:
        """Runs :meth:`start` with the values of ``controls``.

        ``record`` keeps the result, in a state of its own by default.
        """
        self.knobs = {name: part for name, part in self.controls.items() if not isinstance(part, gr.State | gr.HTML)}
        self.record = record or gr.State(None, time_to_live=3600)
        self.outputs = {
            "player": self.player,
            "line": self.line,
            **self.starts(),
            "stop": self.stop,
            "under": self.under,
            "readouts": self.readouts,
            "record": self.record,
            "asked": self.asked,
            "changed": self.changed,
            **({} if self.laid is None else {"laid": self.laid}),
            **self.more_outputs(),
        }
        self.compare: dict[str, Any] = {
            "inputs": [self.asked, *self.knobs.values()],
            "outputs": self.changed,
            "js": differs(list(self.knobs)),
            **QUIET,
        }
        changes: list[Any] = [getattr(part, "change") for part in self.knobs.values()]  # noqa: B009
        gr.on(changes, None, **self.compare)
        self._wire_sampling()
        self._wire_start(self.start, triggers, first=self.first)
        self.stop.click(self.cancel, queue=False, **QUIET)
        self._wire_results()

    def _wire_start(
        self,
        start: Callable[..., Iterator[Updates]],
        triggers: Sequence[Any] | Callable[..., Any],
        *,
        more: Sequence[gr.components.Component] = (),
        first: str | None = None,
    ) -> None:
        listen = triggers if callable(triggers) else partial(gr.on, list(triggers))
        run = listen(
            start,  # not called "generate": that name is the public endpoint's
            inputs={*self.controls.values(), *more},
            outputs=list(self.outputs.values()),
            concurrency_limit=None,  # runs wait in a line of their own, where they can be cancelled
            trigger_mode="once",
            js=first,
            **QUIET,
        )
        # Only now would a press be taken: while the event goes on, Gradio drops it.
        run.then(self.rest, outputs=[*self.starts().values(), self.stop], queue=False, **QUIET)
        run.then(None, **self.compare)  # what was changed while it ran
        run.then(self.withhold, inputs=self.record, outputs=self.handed_out, queue=False, **QUIET).then(
            self.export,
            inputs=[self.record, self.worn],
            outputs=[self.line, *self.downloads],
            concurrency_limit=2,
            **QUIET,
        )

    def start(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Runs what the controls ask for; yields updates of the page."""
        yield from self.run(str(request.session_hash), self._fields(values))

    def _fields(self, values: Mapping[gr.components.Component, Any]) -> dict[str, Any]:
        return {name: values[component] for name, component in self.controls.items()}

    def starts(self) -> dict[str, gr.Button]:
        """The buttons that start a run, by name: none of them can be pressed while one goes on."""
        return {"go": self.go}

    def more_outputs(self) -> dict[str, Any]:
        """Further components that :meth:`run` updates, by the names that :meth:`_shown` gives."""
        return {}

    def run(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """The page's updates while a request with these fields runs for a session.

        An empty seed is drawn. Whatever goes wrong ends as one sentence in the status line, with the last
        result still on show.

        Each update holds what has to last as long as the run does: buttons, and a motion that is shown before
        the result. Gradio's page changes an update in place into the one after it, so that of those that
        arrive together it applies only the last, and the first alone may be among the others.
        """
        lasting: dict[str, Any] = {
            "stop": gr.update(interactive=True),
            **{name: gr.update(interactive=False) for name in self.starts()},
        }
        motion: dict[str, Any] = {}
        for updates in self._steps(session, fields):
            shown = dict(zip(self.outputs, updates, strict=True)) | lasting
            motion = {"value": shown["player"]["value"]} if "value" in shown["player"] else motion
            yield self._updates(**shown | {"player": motion | shown["player"]})

    def _steps(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """The updates of a run, each with what it changes."""
        self._cancelled.discard(session)
        yield self._updates(player=busy("Starting …"), line=status("Starting …", tone="busy"), changed="")
        try:
            fields = self.settled(fields)
            asked = snapshot(fields, self.knobs)
            if fields.get("seed", 0) is None:
                fields = {**fields, "seed": secrets.randbelow(MAX_SEED + 1)}
            for updates in self.answer(session, fields):
                shown = dict(zip(self.outputs, updates, strict=True))
                if not isinstance(record := shown["record"], Record):
                    yield updates
                    continue
                self.complete(record, fields)
                self._keep(record, fields)
                yield self._updates(**shown | {"asked": asked})
        except Cancelled as stopped:
            yield self._stopped(str(stopped), "warning")
        except Exception as error:
            yield self._stopped(error_line(error), "error")

    def settled(self, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The fields that are used and kept; raises InputError where two of them cannot be brought together."""
        return fields

    def complete(self, record: Record, fields: Mapping[str, Any]) -> None:
        """Adds to a record what its files need beside the result."""

    def _keep(self, record: Record, fields: Mapping[str, Any]) -> None:
        """Writes down how the tab was set, so that the run opens as it was."""
        if self.page.history is None or not record.result.run:
            return
        source = fields.get("source")
        controls = {name: fields.get(name) for name in self.knobs if name != "given"}
        original = None
        if source is not None:
            controls |= dict(zip(READ_WITH, source.read_with, strict=True))
            original = Original(source.path, source.name) if source.path is not None else None
        kept = Kept(
            controls=controls | self.kept_more(fields) | ({"grid": dict(record.grid)} if record.grid else {}),
            people=source.people if source is not None else (),
            compared=tuple(result.run for result in record.compared.values())[1:],
            original=original,
        )
        try:
            self.page.history.keep(record.result.run, visitor().owner, kept)
            if record.grid:
                self.page.history.describe(record.result.run, visitor().owner, title=record.prompt[:200])
        except InputError as error:  # the motion itself is kept
            log.warning("The settings of a run could not be kept: %s", error)

    def kept_more(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """Further entries of a run's record, beside the values of the controls."""
        return {}

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs what the fields ask for and shows it."""
        wanted = self.request(fields)
        result = yield from self.made(session, wanted)
        yield self._updates(**self._shown(result, self.title(wanted)))

    def answer_beside(self, session: str, wanted: Mapping[str, Any], labels: Mapping[str, str]) -> Iterator[Updates]:
        """Runs requests of one input one after another, and shows all on one clock.

        Args:
            session: whose runs they are.
            wanted: the requests, by the names with which their files begin.
            labels: of their methods, by the same names.
        """
        made: dict[str, Result] = {}
        for name, request in wanted.items():
            made[name] = yield from self.made(session, request, label=f"{labels[name]}. ")
        title = self.title(next(iter(wanted.values())))
        shown = self.shown_beside({labels[name]: result for name, result in made.items()}, title)
        spent = " and ".join(seconds(total(result)) for result in made.values())
        yield self._updates(
            **shown | {"record": Record(next(iter(made.values())), title, compared=made)},
            line=status(f"Both done, in {spent}.", tone="done") + "".join(map(notes_lines, made.values())),
            under=gr.update(visible=True),
        )

    def shown_beside(self, named: Mapping[str, Result], title: str) -> dict[str, Any]:
        """Updates that show results of one input beside each other, by the labels of their methods."""
        return {
            "player": show(comparison_payload(named, title=title)),
            "readouts": comparison_panel(named),
            "record": Record(next(iter(named.values())), title, compared=named),
        }

    def made(
        self, session: str, wanted: Any, *, label: str = "", watch: Watch | None = None
    ) -> Generator[Updates, None, Result]:
        """Runs one request, yields the page's updates meanwhile and returns its result.

        Args:
            session: whose run it is.
            wanted: the request.
            label: stands before the progress, where several requests are run.
            watch: sees each event first, and gives what is to change on the page or None for the progress
                line.

        Raises:
            InputError: for what the engine cannot do.
            Cancelled: with a sentence on how far it was.
        """
        last: Progress | None = None
        shown_at = 0.0
        try:
            for event in self.page.runs.run(session, wanted):
                if session in self._cancelled:  # also before the run was known, or between two of a grid
                    raise Cancelled
                if isinstance(event, Result):
                    return event
                new_stage = last is None or event.stage != last.stage
                last = event
                if watch is not None and (seen := watch(event)) is not None:
                    if seen:
                        yield self._updates(**seen)
                    continue
                if new_stage or time.monotonic() - shown_at >= PACE:
                    shown_at = time.monotonic()
                    line = label + progress_line(event)
                    share = event.step / max(event.total, 1) if event.stage == "sample" else None
                    yield self._updates(player=busy(line, progress=share), line=status(line, tone="busy"))
        except Cancelled:
            raise Cancelled(cancelled_line(last)) from None
        raise Cancelled(cancelled_line(last))

    def _shown(self, result: Result, title: str) -> dict[str, Any]:
        spent = total(result)
        count = len(result.duets)
        time_spent = f" in {seconds(spent)}" if spent else ""
        made = f"Made{time_spent}." if count == 1 else f"{count} samples made{time_spent}."
        return {
            "player": show(result_payload(result, title=title)),
            "line": status(made, tone="done") + notes_lines(result),
            "under": gr.update(visible=True),
            "readouts": readout_panel(result),
            "record": Record(result, title),
            **self.laid_out([result]),
        }

    def laid_out(self, results: Iterable[Result]) -> dict[str, str]:
        """The update of the line on how much is planned, where the tab has it."""
        return {} if self.laid is None else {"laid": plan_line(results)}

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Updates that show a kept run here, by the components of this tab."""
        made = time.strftime("%Y-%m-%d %H:%M", time.gmtime(run.entry.created))
        shown = self._shown(run.result, run.entry.title)
        shown["line"] = status(f"Made on {made} UTC.", tone="done") + notes_lines(run.result)
        shown |= {"asked": OPENED, "changed": ""}
        found = {self.outputs[name]: update for name, update in shown.items()}
        for name, value in run.kept.controls.items():
            if name in self.knobs:
                found[self.knobs[name]] = gr.update(value=value)
        return found | self._opened_sampling(run.entry.request)

    def _stopped(self, line: str, tone: str) -> Updates:
        return self._updates(player=busy(""), line=status(line, tone=tone), asked="", changed="")

    def rest(self) -> Updates:
        """The buttons once a run is over, however it ended."""
        return *(gr.update(interactive=True) for _ in self.starts()), gr.update(interactive=False)

    def _updates(self, **changed: Any) -> Updates:
        """Updates in the order of the outputs; what is not named stays as it is."""
        return tuple(changed.get(name, gr.skip()) for name in self.outputs)

    def cancel(self, request: gr.Request) -> None:
        """Stops the session's run within one denoising step, or as soon as what it needs was read."""
        self._cancelled.add(str(request.session_hash))
        self.page.runs.cancel(str(request.session_hash))
