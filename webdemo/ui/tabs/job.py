"""What the tabs that make motion have in common: a run that is started, watched, cancelled, kept and opened again.

A tab is made of forms: :class:`~.sampling.Sampling` holds the settings, :class:`~.results.Results` shows and hands out
the result, :class:`~.grids.Grids` sweeps settings, and :class:`~.source.SourcePanel` takes a given motion.
"""

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
from webdemo.inference.requests.sampling import MAX_SEED
from webdemo.inference.run import Cancelled, Progress, Result
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import busy, show
from webdemo.ui.components.prediction_view import payload_of
from webdemo.ui.context import PageContext
from webdemo.ui.history import Kept, Opened
from webdemo.ui.text.panels import effect_line, made_line, notes_lines, readout_panel, status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import cancelled_line, day, error_line, progress_line
from webdemo.ui.visitor import visitor

from .grids import BASIC, PRESETS, Grids, Kind
from .results import QUIET, Parts, Results, Updates
from .sampling import Sampling

log = logging.getLogger(__name__)

PACE = 0.5
"""Seconds between two updates of the page while a run goes on; each costs a browser about ten milliseconds."""
MOST_BACK = 20
"""Runs of a tab that can be gone back to."""
_FORGIVEN = """() => document.querySelector("#%s :is(.pd-error, .pd-warning)") ? "" : { __type__: "update" }"""
"""JavaScript that takes an error or warning away once something else is asked; to be filled with the line's id."""
Named = dict[str, Any]
"""Updates by the names of a tab's outputs."""
Watch = Callable[[Progress], Named | None]


class JobTab(ABC):
    """A tab that turns its controls into a request, runs it and shows the result.

    Args:
        page: what the tabs share.
    """

    label: str
    named: str
    """Key of the tab's name as the page shows it."""
    prefix = ""
    """Before the ids of the tab's elements."""
    sampling: Sampling | None = None
    """The form of the settings, on a tab whose motion is sampled."""
    controls: Mapping[str, gr.components.Component]
    """The inputs of a run, by the names of its fields; set by :meth:`build`."""
    first: str | None = None
    """JavaScript that the values of ``controls`` pass through before a run, in the order of the components' ids."""

    def __init__(self, page: PageContext) -> None:
        self.page = page
        self.results = Results(page, self.prefix)
        self.grids = Grids(self)
        self._cancelled: dict[str, bool] = {}
        """The sessions with a run here, and whether it was cancelled."""

    # ---- what a tab says -------------------------------------------------------------------------

    @abstractmethod
    def build(self, record: gr.State) -> None:
        """Lays out the tab and wires its events.

        Args:
            record: keeps the session's last result, of this tab or another.
        """

    @abstractmethod
    def request(self, fields: Mapping[str, Any]) -> Any:
        """The request that the controls' values ask for; raises InputError where they do not fit."""

    @abstractmethod
    def title(self, request: Any) -> str:
        """The title that the player shows over the result, and from which its files are named."""

    def kinds(self) -> Sequence[Kind]:
        """The settings that a grid can sweep."""
        return BASIC

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """Grids that are one press away: label → (field, values)."""
        return PRESETS

    def cell_fields(self, fields: Mapping[str, Any], cell: Mapping[str, Any]) -> dict[str, Any]:
        """The tab's fields for a cell of a grid."""
        return {**fields, **cell}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """Further updates of the tab when it shows a grid of these results, made from ``fields``; {} when opened."""
        return {}

    def more_outputs(self) -> dict[str, Any]:
        """Further components that :meth:`run` updates, by the names that :meth:`shown` gives."""
        return {}

    def restored(self) -> Sequence[Any]:
        """Components that :meth:`opened` sets, besides the outputs and the controls."""
        return ()

    def settled(self, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """The fields that are used and kept; raises InputError where two of them cannot be brought together."""
        return fields

    def kept_more(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """Further entries of a run's record, beside the values of the controls."""
        return {}

    def starts(self) -> dict[str, gr.Button]:
        """The buttons that start a run, by name: none of them can be pressed while one goes on."""
        return {"go": self.go, "make_grid": self.grids.make}

    # ---- layout ----------------------------------------------------------------------------------

    def _id(self, name: str) -> str:
        return self.prefix + name

    def lay_out(self, ask: Callable[[], None], settings: Callable[[], None], **stage: Any) -> None:
        """What ``ask`` lays out, then the stage, then the figures and the ``settings``: the order of the Tab key.

        The style sheet puts the stage beside the others where there is room.
        """
        with gr.Row(elem_classes="pd-lab", equal_height=False):
            with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
                ask()
            self.results.build_stage(compare=self.grids.build, **stage)
            with gr.Column(elem_classes="pd-controls", min_width=0):
                self.results.build_readouts()
                with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
                    settings()

    def build_go(self, verb: str, beside: Callable[[], None] = lambda: None) -> None:
        """The buttons that start a run and cancel it, with what ``beside`` lays out between them, and the line."""
        with gr.Row(elem_classes="pd-go"):
            self.go = gr.Button(
                verb, variant="primary", elem_id=self._id("generate"), elem_classes="pd-run", min_width=0
            )
            beside()
            self.stop = gr.Button(
                say("job.cancel"), elem_id=self._id("cancel"), elem_classes="pd-stop", interactive=False, min_width=0
            )
        self.line = gr.HTML(status(), elem_id=self._id("status"), elem_classes="pd-line")

    # ---- events ----------------------------------------------------------------------------------

    def wire(self, triggers: Sequence[Any], record: gr.State) -> None:
        """Wires what every tab has; ``triggers`` start a run with the values of ``controls``."""
        self.record = record
        self.trail = gr.State([], time_to_live=3600)
        self.outputs = {
            "player": self.results.player,
            "line": self.line,
            **self.starts(),
            "stop": self.stop,
            "under": self.results.under,
            "menu": self.results.menu,
            "address": self.results.address,
            "readouts": self.results.readouts,
            "record": self.record,
            "own": self.results.own,
            **({"laid": self.sampling.laid} if self.sampling else {}),
            **self.more_outputs(),
        }
        self.results.wire(self.line)
        if self.sampling is not None:
            self.sampling.wire(self.results.another, self.go)
        self.wire_start(self.start, triggers, first=self.first)
        self.stop.click(self.cancel, queue=False, **QUIET)
        knobs: list[Any] = [self.controls[name] for name in self._knobs()]
        gr.on([knob.input for knob in knobs], None, outputs=self.line, js=_FORGIVEN % self.line.elem_id, **QUIET)
        undone = list({part._id: part for part in (*self.parts(), self.trail, self.results.back)}.values())
        self.results.back.click(self.go_back, inputs=[self.results.own, self.trail], outputs=undone, **QUIET)
        self.grids.wire()

    def wire_start(
        self,
        start: Callable[..., Iterator[Updates]],
        triggers: Sequence[Any] | Callable[..., Any],
        *,
        more: Sequence[gr.components.Component] = (),
        first: str | None = None,
    ) -> None:
        """Wires an event that runs something.

        Args:
            start: answers it, with the values of ``controls`` and ``more`` by component.
            triggers: of the event, or what wires it.
            more: further inputs.
            first: JavaScript that the inputs pass through.
        """
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
        rested = [*self.starts().values(), self.stop, self.trail, self.results.back]
        run.then(self.rest, inputs=[self.results.own, self.trail], outputs=rested, queue=False, **QUIET)

    def start(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Runs what the controls ask for; yields updates of the page."""
        yield from self.run(str(request.session_hash), self.fields(values))

    def fields(self, values: Mapping[gr.components.Component, Any]) -> dict[str, Any]:
        """The values of ``controls`` by their names."""
        return {name: values[component] for name, component in self.controls.items()}

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
        for changed in self._steps(session, fields):
            player = changed.get("player", gr.skip())
            motion = {"value": player["value"]} if "value" in player else motion
            left = self.bare() if motion and "stopped" in changed else {}  # of a motion that is no result
            yield self.updates(**{**changed, **lasting, **left, "player": motion | player})

    def _steps(self, session: str, fields: Mapping[str, Any]) -> Iterator[Named]:
        """The updates of a run, each with what it changes."""
        self._cancelled[session] = False
        try:
            yield {"player": busy("Starting …"), "line": status("Starting …", tone="busy")}
            fields = self.settled(fields)
            if fields.get("seed", 0) is None:
                fields = {**fields, "seed": secrets.randbelow(MAX_SEED + 1)}
            answer = self.grids.answer if fields.get("grid") else self.answer
            for changed in answer(session, fields):
                if "record" in changed:
                    self._keep(changed["record"], fields)
                yield changed
        except Cancelled as stopped:
            yield self._stopped(str(stopped), "warning")
        except Exception as error:
            yield self._stopped(error_line(error), "error")
        finally:
            self._cancelled.pop(session, None)

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Named]:
        """Runs what the fields ask for and shows it."""
        wanted = self.request(fields)
        result = yield from self.made(session, wanted)
        yield self.shown(result, self.title(wanted))

    def made(
        self, session: str, wanted: Any, *, label: str = "", watch: Watch | None = None
    ) -> Generator[Named, None, Result]:
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
                if self._cancelled.get(session):  # also before the run was known, or between two of a grid
                    raise Cancelled
                if isinstance(event, Result):
                    return event
                new_stage = last is None or event.stage != last.stage
                last = event
                if watch is not None and (seen := watch(event)) is not None:
                    yield seen
                    continue
                if new_stage or time.monotonic() - shown_at >= PACE:
                    shown_at = time.monotonic()
                    line = label + progress_line(event)
                    share = event.step / max(event.total, 1) if event.stage == "sample" else None
                    yield {"player": busy(line, progress=share), "line": status(line, tone="busy")}
        except Cancelled:
            raise Cancelled(cancelled_line(last)) from None
        raise Cancelled(cancelled_line(last))

    def _stopped(self, line: str, tone: str) -> Named:
        return {"player": busy(""), "line": status(line, tone=tone), "stopped": True}

    def rest(self, record: Record | None, trail: list[str]) -> Updates:
        """The buttons once a run is over, however it ended, and the runs of this tab that can be gone back to."""
        run, kind = "", ""
        if record is not None:
            run, kind = record.result.run, record.result.manifest.get("request", {}).get("kind", "generate")
        if run and kind == self.label.lower() and run not in trail[-1:]:
            trail = [*trail, run][-MOST_BACK:]
        ready = (gr.update(interactive=True) for _ in self.starts())
        return *ready, gr.update(interactive=False), trail, gr.update(visible=len(trail) > 1)

    def go_back(self, record: Record | None, trail: list[str]) -> Parts:
        """Opens the run before the one that is shown, with all its settings, from the history."""
        if record is not None and trail[-1:] == [record.result.run]:
            trail = trail[:-1]
        try:
            if not trail:
                raise InputError("There is no motion before this one.")
            updates = self.opened(self.page.history.open(trail[-1], visitor().owner))
        except Exception as error:
            updates = {self.line: status(error_line(error), tone="error")}
        return updates | {self.trail: trail, self.results.back: gr.update(visible=len(trail) > 1)}

    def cancel(self, request: gr.Request) -> None:
        """Stops the session's run within one denoising step, or as soon as what it needs was read."""
        session = str(request.session_hash)
        if session in self._cancelled:
            self._cancelled[session] = True
        self.page.runs.cancel(session)

    # ---- what is shown and kept ------------------------------------------------------------------

    def updates(self, **changed: Any) -> Updates:
        """Updates in the order of the outputs; what is not named stays as it is."""
        return tuple(changed.get(name, gr.skip()) for name in self.outputs)

    def shown(self, result: Result, title: str) -> dict[str, Any]:
        """Updates that show a result, by the names of the outputs."""
        record = Record(result, title)
        return {
            "player": show(payload_of(result, title=title)),
            "line": status(made_line(result), tone="done") + notes_lines({"": result}),
            "under": gr.update(visible=True),
            "readouts": readout_panel(result),
            "record": record,
            "own": record,
            **self.results.fresh(),
            **self.laid_out([result]),
        }

    def bare(self) -> Named:
        """Updates that take away what is said of a result, and can be done with it, once another motion is shown."""
        hidden = gr.update(visible=False)
        gone = {"under": hidden, "readouts": "", "laid": "", "spans": hidden, "reading": gr.update(checked={})}
        return {name: update for name, update in gone.items() if name in self.outputs}

    def laid_out(self, results: Iterable[Result]) -> dict[str, str]:
        """The update of the line on what the settings did, where the tab has it."""
        return {"laid": effect_line(results)} if "laid" in self.outputs else {}

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Updates that show a kept run here, by the components of this tab."""
        asked = run.entry.request
        shown = self.shown(run.result, run.entry.title)
        made = day(run.entry.created, " %H:%M")
        shown["line"] = status(f"Made on {made}.", tone="done") + notes_lines({"": run.result})
        known = {**asked, **run.kept.controls}
        values = {name: known[name] for name in self._knobs() if name in known}
        return {
            **{self.controls[name]: gr.update(value=value) for name, value in values.items()},
            **{self.outputs[name]: update for name, update in (shown | self.grids.opened(run)).items()},
        }

    def parts(self) -> list[gr.components.Component]:
        """Everything of the tab that :meth:`opened` may set."""
        return [*self.outputs.values(), *self.controls.values(), *self.restored()]

    def _knobs(self) -> list[str]:
        """The names of the controls whose values are kept with a run."""
        return [name for name, part in self.controls.items() if not isinstance(part, gr.State | gr.HTML)]

    def _keep(self, record: Record, fields: Mapping[str, Any]) -> None:
        """Writes down how the tab was set, so that the run opens as it was."""
        if not record.result.run:
            return
        source = fields.get("source")
        controls = {name: fields.get(name) for name in self._knobs()}
        kept = Kept(
            controls=controls | self.kept_more(fields) | ({"grid": dict(record.grid)} if record.grid else {}),
            people=source.people if source is not None else (),
            compared=tuple(result.run for result in record.compared.values())[1:],
        )
        try:
            self.page.history.keep(record.result.run, visitor().owner, kept)
            if record.grid:
                self.page.history.describe(record.result.run, visitor().owner, title=record.prompt[:200])
        except InputError as error:  # the motion itself is kept
            log.warning("The settings of a run could not be kept: %s", error)
