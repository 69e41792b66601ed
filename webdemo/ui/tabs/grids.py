"""Grids: up to nine results of one tab on one clock, made by sweeping one setting or two."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.run import Result
from webdemo.ui.components.exports import Record
from webdemo.ui.components.fields import chip, looked_up
from webdemo.ui.components.player import show
from webdemo.ui.components.sweep import (
    BETWEEN_SENTENCES,
    MOST,
    Grid,
    Kind,
    grid_of,
    grid_payload,
    grid_table,
    read_axis,
    real,
    whole,
)
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import notes_lines, status, total
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import seconds

from .results import QUIET, Updates

BASIC = (
    Kind("seed", "Seeds", "seed", whole),
    Kind("guidance", "Guidance", "guidance", real, named=lambda value: f"{value:g}"),
    Kind("steps", "DDIM steps", "steps", whole),
    Kind("damping", "Damping", "damping", real, named=lambda value: f"{value:g}"),
)
"""The settings that every sampled motion has."""
PLAN = Kind("strictness", "Plan", "strictness", real, named=lambda value: f"{value:g}")
SENTENCES = Kind("prompt", "Sentences", split=BETWEEN_SENTENCES)
PRESETS = {"Plain beside damped": ("damping", "0, 0.7"), "Four seeds": ("seed", "1-4")}
_SIDES = ("across", "down")


def methods_kind(field: str, labels: Mapping[str, str]) -> Kind:
    """Methods as a setting; ``labels`` are theirs, by name."""
    known = {label.lower(): name for name, label in labels.items()}
    read = partial(_named_method, known)
    return Kind(field, "Methods", read=read, split=BETWEEN_SENTENCES, named=labels.__getitem__)


def _named_method(known: Mapping[str, str], given: str) -> str:
    """The name of a method from its name or label; raises InputError for another."""
    named = known.get(given.lower(), given)
    if named not in known.values():
        raise InputError(f"There is no method {given[:40]!r}: choose from {', '.join(known.values())}.")
    return named


class Grids:
    """The menu *Compare* of a tab, and the grids that it makes.

    Args:
        tab: a ``JobTab``, which says what can be swept and makes the requests of the cells.
    """

    def __init__(self, tab: Any) -> None:
        self.tab = tab

    def build(self) -> None:
        """Lays out the menu, folded: grids that are one press away, and the settings of a grid."""
        tab = self.tab
        choices = [(say("sweeps.nothing"), ""), *((kind.label, kind.field) for kind in tab.kinds())]
        with gr.Accordion(say("sweeps.compare"), open=False, elem_id=f"{tab.prefix}grid", elem_classes="pd-menu"):
            with gr.Row(elem_classes="pd-chips"):
                self.chips = [chip(label) for label in tab.presets()]
            gr.HTML(f'<p class="pd-method">{say("sweeps.info", most=MOST)}</p>')
            self.swept: list[Any] = []
            for side in _SIDES:
                name = f"{tab.prefix}grid-{side}"
                with gr.Row(elem_classes="pd-pair"):
                    self.swept += [
                        gr.Dropdown(
                            choices, value="", label=side.capitalize(), elem_id=name, min_width=0, filterable=False
                        ),
                        gr.Textbox(label=say("sweeps.values"), lines=1, elem_id=f"{name}-values", min_width=0),
                    ]
            self.make = gr.Button(say("sweeps.make"), size="sm", elem_id=f"{tab.prefix}grid-make")

    def wire(self) -> None:
        """Wires the menu's buttons."""
        start: Callable[..., None] = partial(self.tab.wire_start, self.start, more=self.swept)
        start([self.make.click])
        for button, (field, values) in zip(self.chips, self.tab.presets().values(), strict=True):
            filled = looked_up({"": (field, values, "", "")})
            start(button.click(None, outputs=self.swept, js=filled, **QUIET).then)

    def start(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Makes the grid that the controls ask for; yields updates of the page."""
        swept = [values[part] for part in self.swept]
        yield from self.tab.run(str(request.session_hash), {**self.tab.fields(values), "grid": swept})

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        """Runs every cell of a grid, one after another, and shows all."""
        tab = self.tab
        asked = {name: value for name, value in fields.items() if name != "grid"}
        if "samples" in asked:
            asked["samples"] = 1
        known = {kind.field: kind for kind in tab.kinds()}
        swept = fields["grid"]
        pairs = zip(swept[::2], swept[1::2], strict=True)
        grid = grid_of([read_axis(known[field], str(values or "")) for field, values in pairs if field in known])
        wanted = [tab.request(tab.cell_fields(asked, cell)) for cell in grid.cells]
        made: dict[str, Result] = {}
        for i, (name, request) in enumerate(zip(grid.names, wanted, strict=True)):
            made[name] = yield from tab.made(session, request, label=f"{i + 1} of {len(wanted)}, {name}. ")
        title = f"{tab.title(wanted[0]).rstrip('.')} · grid of {len(wanted)}"
        spent = seconds(sum(map(total, made.values())))
        line = status(f"{len(wanted)} results done in {spent}.", tone="done") + notes_lines(made)
        yield self.shown(grid, made, title, asked) | {"line": line}

    def opened(self, run: Opened) -> dict[str, Any]:
        """Updates that show a kept grid with the cells that are still there; none for a run that is no grid."""
        about = run.kept.controls.get("grid")
        if not isinstance(about, dict) or not run.beside:
            return {}
        results = [run.result, *(each.result for each in run.beside)]
        whole_grid = len(results) == len(about["names"])
        names = about["names"] if whole_grid else [str(i + 1) for i in range(len(results))]
        columns, rows = (about["columns"], about["rows"]) if whole_grid else ([""] * len(results), [""])
        made = dict(zip(names, results, strict=True))
        return self.shown(Grid(columns, rows, [], names), made, str(about["title"]))

    def shown(
        self, grid: Grid, made: Mapping[str, Result], title: str, fields: Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        """Updates that show a grid of results, which were made from ``fields`` or are of the history."""
        results = list(made.values())
        about = {"columns": grid.columns, "rows": grid.rows, "names": list(made), "title": title}
        record = Record(results[0], title, compared=dict(made), grid=about)
        return {
            "player": show(grid_payload(grid, results, title=title)),
            "readouts": grid_table(made),
            "record": record,
            "own": record,
            "under": gr.update(visible=True),
            **self.tab.results.fresh(),
            **self.tab.laid_out(results),
            **self.tab.beside_grid(made, fields or {}),
        }
