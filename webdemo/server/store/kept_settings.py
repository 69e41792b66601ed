"""Settings of tabs in a workspace's file: which runs stand beside each other, checked as if sent by an enemy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from motion import Clip, Duet, InputError

MOST_BESIDE = 8
"""Runs of a grid beside its first."""
_NUMBERS = (
    "seconds", "seed", "samples", "guidance", "steps", "damping", "tries", "start", "end", "marker", "fps", "animation",
)  # fmt: skip
_SWITCHES = ("keep",)
_TEXTS = ("prompt", "class_name", "model", "method", "other", "person", "role", "up", "unit", "order")
_LONGEST = 5000
_GRID = "This is no workspace of Pas de Deux, or it was changed by hand ({}): export it again."


def plain_controls(stored: Any) -> dict[str, Any]:
    """The known controls of a tab whose values are of their kinds, and its grid.

    Raises:
        InputError: for a grid whose names do not fit its cells.
    """
    stored = stored if isinstance(stored, Mapping) else {}
    found = {name: stored[name] for name in _NUMBERS if _is_number(stored.get(name))}
    found |= {name: stored[name] for name in _SWITCHES if isinstance(stored.get(name), bool)}
    found |= {
        name: stored[name]
        for name in _TEXTS
        if isinstance(stored.get(name), str) and len(stored[name]) <= _LONGEST
    }
    if "grid" in stored:
        found["grid"] = _grid(stored["grid"])
    return found


def _grid(stored: Any) -> dict[str, Any]:
    stored = stored if isinstance(stored, Mapping) else {}
    sides = {name: stored.get(name) for name in ("columns", "rows", "names")}
    for side in sides.values():
        if not isinstance(side, list) or not all(
            isinstance(each, str) and len(each) <= _LONGEST for each in side
        ):
            raise InputError(_GRID.format("a grid has no names"))
    columns, rows, names = sides.values()
    if not 1 <= len(names) <= len(columns) * len(rows) <= 2 * (MOST_BESIDE + 1) or len(set(names)) < len(
        names
    ):
        raise InputError(_GRID.format("the names of a grid do not fit its cells"))
    return {**sides, "title": str(stored.get("title", ""))[:_LONGEST]}


def groups(stored: Sequence[Any], motions: Sequence[Duet | Clip]) -> dict[int, list[int]]:
    """The runs beside each run of a file, by their numbers; no run is a part of two others.

    Args:
        stored: of each run, the numbers of those beside it.
        motions: the first of each run.

    Raises:
        InputError: for a number that is none of a run, and for motions that cannot stand beside each other.
    """
    found: dict[int, list[int]] = {}
    parts: set[int] = set()
    for number, others in enumerate(stored):
        if not others:
            continue
        if not isinstance(others, list) or len(others) > MOST_BESIDE:
            raise InputError(_GRID.format("a comparison has too many runs"))
        for other in others:
            if type(other) is not int or not 0 <= other < len(motions) or others.count(other) > 1:
                raise InputError(_GRID.format("a comparison names a run that is not there, or one twice"))
            if motions[other].skeleton.joint_names != motions[number].skeleton.joint_names:
                raise InputError(_GRID.format("a comparison has runs of different joints"))
        if number in parts | set(others) or parts & set(others) or found.keys() & set(others):
            raise InputError(_GRID.format("a run is part of two comparisons"))
        found[number] = list(others)
        parts |= set(others)
    return found


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
