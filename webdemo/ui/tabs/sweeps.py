"""Grids: up to nine results of one tab on one clock, made by sweeping one setting or two."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import gradio as gr

from webdemo.inference.run import Result
from webdemo.ui.components.exports import Record
from webdemo.ui.components.player import show
from webdemo.ui.components.settings import looked_up
from webdemo.ui.components.sweep import (
    MOST,
    Grid,
    Kind,
    Named,
    grid_of,
    grid_payload,
    grid_table,
    read_axis,
    real,
    whole,
)
from webdemo.ui.components.upload import chip
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import notes_lines, status
from webdemo.ui.text.texts import say, worded
from webdemo.ui.text.words import seconds

from .job import JobTab, Updates, total
from .results import QUIET

SEED = Kind("seed", "Seeds", "seed", whole)
GUIDANCE = Kind("guidance", "Guidance", "guidance", real, named=lambda value: f"{value:g}")
STEPS = Kind("steps", "DDIM steps", "steps", whole)
DAMPING = Kind("damping", "Damping", "damping", real, named=lambda value: f"{value:g}")
_SIDES = ("across", "down")
_INFO = say("sweeps.info", most=MOST)


class SweepTab(JobTab):
    """A tab that also makes grids; a subclass says what can be swept."""

    def kinds(self) -> Sequence[Kind]:
        """The settings that can be swept."""
        return (SEED, GUIDANCE, STEPS, DAMPING)

    def presets(self) -> Mapping[str, tuple[str, str]]:
        """Grids that are one press away: label → (field, values)."""
        return {"Plain beside damped": ("damping", "0, 0.7"), "Four seeds": ("seed", "1-4")}

    def cell_fields(self, fields: Mapping[str, Any], cell: Mapping[str, Any]) -> dict[str, Any]:
        """The tab's fields for a cell."""
        return {**fields, **cell}

    def beside_grid(self, made: Mapping[str, Result], fields: Mapping[str, Any]) -> dict[str, Any]:
        """Further updates of the tab when it shows a grid of these results, made from ``fields``; {} when opened."""
        return {}

    # ---- layout ----------------------------------------------------------------------------------

    def _sweeps(self, beside: Callable[[], None] = lambda: None) -> None:
        """The menu *Compare*, folded away: grids that are one press away, ``beside``, and the settings of a grid."""
        choices = [(say("sweeps.nothing"), ""), *((worded("swept", kind.label), kind.field) for kind in self.kinds())]
        with gr.Accordion(say("sweeps.compare"), open=False, elem_id=self._id("grid"), elem_classes="pd-advanced"):
            with gr.Row(elem_classes="pd-chips"):
                self.preset_chips = [chip(worded("preset", label)) for label in self.presets()]
            beside()
            gr.HTML(f'<p class="pd-method">{_INFO}</p>')
            self.sides: dict[str, tuple[gr.Dropdown, gr.Textbox]] = {}
            for side in _SIDES:
                with gr.Row(elem_classes="pd-pair"):
                    field = gr.Dropdown(
                        choices,
                        value="",
                        label=worded("side", side.capitalize()),
                        elem_id=self._id(f"grid-{side}"),
                        min_width=0,
                        filterable=False,
                    )
                    values = gr.Textbox(
                        label=say("sweeps.values"), lines=1, elem_id=self._id(f"grid-{side}-values"), min_width=0
                    )
                    self.sides[side] = (field, values)
            self.make_grid = gr.Button(say("sweeps.make"), size="sm", elem_id=self._id("grid-make"))

    def _wire_sweeps(self) -> None:
        parts = [part for side in _SIDES for part in self.sides[side]]
        self.grid_parts = parts
        self._wire_start(self.start_grid, [self.make_grid.click], more=parts)
        for button, (field, values) in zip(self.preset_chips, self.presets().values(), strict=True):
            chosen = button.click(None, outputs=parts, js=looked_up({"": (field, values, "", "")}), **QUIET)
            self._wire_start(self.start_grid, chosen.then, more=parts)

    def starts(self) -> dict[str, gr.Button]:
        """Also the button that makes a grid."""
        return {**super().starts(), "make_grid": self.make_grid}

    # ---- events ----------------------------------------------------------------------------------

    def start_grid(self, values: dict[gr.components.Component, Any], request: gr.Request) -> Iterator[Updates]:
        """Makes the grid that the controls ask for; yields updates of the page."""
        swept = [values[part] for part in self.grid_parts]
        yield from self.run(str(request.session_hash), {**self._fields(values), "grid": swept})

    def answer(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        """Runs what the fields ask for, or every cell of a grid."""
        if fields.get("grid"):
            yield from self._answer_grid(session, fields)
        else:
            yield from super().answer(session, fields)

    def _answer_grid(self, session: str, fields: Mapping[str, Any]) -> Iterator[Updates]:
        asked = {name: value for name, value in fields.items() if name != "grid"}
        if "samples" in asked:
            asked["samples"] = 1
        known = {kind.field: kind for kind in self.kinds()}
        across, across_values, down, down_values = fields["grid"]
        axes = [
            read_axis(known[field], str(values or ""))
            for field, values in ((across, across_values), (down, down_values))
            if field in known
        ]
        grid = grid_of(axes)
        wanted = [self.request(self.cell_fields(asked, cell)) for cell in grid.cells]
        made: dict[str, Result] = {}
        for i, (name, request) in enumerate(zip(grid.names, wanted, strict=True)):
            made[name] = yield from self.made(session, request, label=f"{i + 1} of {len(wanted)}, {name}. ")
        title = f"{self.title(wanted[0])} · grid of {len(wanted)}"
        spent = sum(map(total, made.values()))
        notes = {note: None for result in made.values() for note in notes_lines(result).splitlines() if note}
        yield self._updates(
            **grid_shown(grid, made, title) | self.laid_out(made.values()) | self.beside_grid(made, asked),
            line=status(f"{len(wanted)} results done in {seconds(spent)}.", tone="done") + "".join(notes),
            under=gr.update(visible=True),
        )

    def opened(self, run: Opened) -> dict[Any, Any]:
        """Also a grid, with the cells that are still there."""
        found, about = super().opened(run), run.kept.controls.get("grid")
        if not isinstance(about, dict) or not run.beside:
            return found
        results = [run.result, *(each.result for each in run.beside)]
        whole_grid = len(results) == len(about["names"])
        names = about["names"] if whole_grid else [str(i + 1) for i in range(len(results))]
        grid = (
            Named(about["columns"], about["rows"], [], tuple(names))
            if whole_grid
            else Named([""] * len(results), [""], [], tuple(names))
        )
        made = dict(zip(names, results, strict=True))
        shown = grid_shown(grid, made, str(about["title"])) | self.laid_out(results) | self.beside_grid(made, {})
        return found | {self.outputs[name]: update for name, update in shown.items()}


def grid_shown(grid: Grid, made: Mapping[str, Result], title: str) -> dict[str, Any]:
    """Updates that show a grid."""
    results = list(made.values())
    about = {"columns": grid.columns, "rows": grid.rows, "names": list(made), "title": title}
    return {
        "player": show(grid_payload(grid, results, title=title)),
        "readouts": grid_table(made),
        "record": Record(results[0], title, compared=dict(made), grid=about),
    }
