"""A grid of results: settings that are swept along one or two axes, and their read-outs in a table."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from motion import InputError
from motion.metrics import MEASURES
from webdemo.inference.run import Result
from webdemo.ui.text.panels import measures_table, sides
from webdemo.view.payload import Payload, build_payload, grid_sample

from .prediction_view import payload_of

MOST = 9
"""Cells of a grid."""
BETWEEN_VALUES, BETWEEN_SENTENCES = re.compile(r"[,;\s]+"), re.compile(r"[;\n]")
"""What stands between numbers and single words, and between names and sentences."""
_RANGE = re.compile(r"(\d{1,10})\s*(?:-|–|\.\.|to)\s*(\d{1,10})\Z")


@dataclass(frozen=True)
class Kind:
    """A setting that can be swept.

    Attributes:
        field: of a tab's settings.
        label: on the page.
        short: before a value, such as "seed"; "" where the value says enough.
        read: a value from its text.
        split: between the values.
        named: a value as the grid shows it.
    """

    field: str
    label: str
    short: str = ""
    read: Callable[[str], Any] = str
    split: re.Pattern[str] = BETWEEN_VALUES
    named: Callable[[Any], str] = str


@dataclass(frozen=True)
class Axis:
    """The values of one setting along a side of a grid."""

    kind: Kind
    values: tuple[Any, ...]

    @property
    def names(self) -> list[str]:
        """The labels beside the cells."""
        return [f"{self.kind.short} {self.kind.named(value)}".strip() for value in self.values]


def read_axis(kind: Kind, given: str) -> Axis:
    """The values that somebody typed: separated, or a range of whole numbers such as 1-4.

    Raises:
        InputError: for no value, one that does not fit the setting, or more than a grid holds.
    """
    parts = [part.strip() for part in kind.split.split(given[:5000].strip()) if part.strip()]
    if kind.read is whole and (range_ := _RANGE.match(given.strip())):
        first, last = int(range_[1]), int(range_[2])
        _check(last - first + 1)
        parts = [str(value) for value in range(first, last + 1)]
    if not parts:
        raise InputError(f"The grid has no values for {kind.label.lower()}: give some, or choose nothing.")
    _check(len(parts))
    return Axis(kind, tuple(dict.fromkeys(kind.read(part) for part in parts)))


def whole(given: str) -> int:
    """A whole number; raises InputError for anything else."""
    if not re.fullmatch(r"\d{1,10}", given):
        raise InputError(f"{given[:40]!r} is not a whole number: write the grid's values as 1, 2, 3 or 1-3.")
    return int(given)


def real(given: str) -> float:
    """A number; raises InputError for anything else."""
    try:
        return float(given)
    except ValueError:
        raise InputError(f"{given[:40]!r} is not a number: write the grid's values as 0, 0.5, 1.") from None


def _check(count: int) -> None:
    if count < 1 or count > MOST:
        raise InputError(f"A grid has 1 to {MOST} cells, not {count}: give fewer values.")


@dataclass(frozen=True)
class Grid:
    """The cells of a grid, row after row.

    Attributes:
        columns: names over the columns.
        rows: names beside the rows; one "" for a single row.
        cells: the settings that each cell changes.
        names: of the cells.
    """

    columns: list[str]
    rows: list[str]
    cells: list[dict[str, Any]]
    names: list[str]


def grid_of(axes: Sequence[Axis]) -> Grid:
    """The grid of one axis, in a row or in up to three, or of two.

    Raises:
        InputError: for no axis, one setting twice, or too many cells.
    """
    if not axes:
        raise InputError("Choose what the grid compares, such as seeds or methods, and give its values.")
    if len(axes) == 2 and axes[0].kind.field == axes[1].kind.field:
        raise InputError("Both sides of the grid are the same setting: choose two.")
    if len(axes) == 1:
        (axis,) = axes
        return loose([{axis.kind.field: value} for value in axis.values], axis.names)
    _check(len(axes[0].values) * len(axes[1].values))
    across, down = axes
    cells = [{down.kind.field: d, across.kind.field: a} for d, a in product(down.values, across.values)]
    return Grid(across.names, down.names, cells, [" · ".join(pair) for pair in product(down.names, across.names)])


def loose(cells: list[dict[str, Any]], names: list[str]) -> Grid:
    """A grid without a second axis: up to three cells in a row, then two or three rows; cells name themselves."""
    _check(len(cells))
    wide = len(cells) if len(cells) <= 3 else 2 if len(cells) == 4 else 3
    return Grid([""] * wide, [""] * -(-len(cells) // wide), cells, names)


def grid_payload(grid: Grid, results: Sequence[Result], *, title: str = "") -> Payload:
    """The player's value for the first sample of every cell's result, in the grid's order."""
    cells = [
        {**payload_of(result)["samples"][0], "caption": name} for result, name in zip(results, grid.names, strict=True)
    ]
    whole_grid = grid_sample(cells, grid.columns, grid.rows)
    return build_payload([whole_grid], skeleton=results[0].duets[0].skeleton, title=title)


def grid_table(results: Mapping[str, Result]) -> str:
    """A column a cell, of its first sample after damping and clean-up, and a row a measure; "" where there is none."""
    cells = {name: (None, sides(each.readouts[0] if each.readouts else {})[1]) for name, each in results.items()}
    measures = [m for m in MEASURES if any(m.key in after for _, after in cells.values())]
    if not measures:
        return ""
    done = [_acts_done(result) for result in results.values()]
    acts = "".join(f"<td><b>{each or '–'}</b></td>" for each in done)
    first = f'<tr><th scope="row">Acts done</th>{acts}</tr>' if any(done) else ""
    shown = measures_table("Best in green, worst in red", measures, cells, first)
    return f'<div class="pd-readouts">{shown}</div>'


def _acts_done(result: Result) -> str:
    """How many acts of the sentence the first sample shows, of those that are measured: "2 of 3"; "" for none."""
    judged = [row["done"] for row in result.manifest.get("checked") or () if row["done"] is not None]
    return f"{sum(judged)} of {len(judged)}" if judged else ""
