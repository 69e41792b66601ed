"""Marker trajectories as text, ``.trc`` (Motion Analysis, OpenSim, OpenCap, Pose2Sim).

Five lines of head: a title, names of settings, their values (``DataRate``, ``NumFrames``, ``NumMarkers``, ``Units``),
``Frame#  Time`` and the markers' names, one above each three columns, and ``X1 Y1 Z1 …``; then a row a frame. Empty
cells are markers that were not seen.
"""

from __future__ import annotations

from array import array
from itertools import repeat
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .crowd import Motion, gathered
from .files import MAX_NUMBERS, check_duration, decode_text, read_bytes
from .markers import people_of

Array = NDArray[np.floating]

_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_MOST_MARKERS = 1000
_HEAD = 200_000
"""Characters: the head of a file with so many markers is shorter."""


def read_trc(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    """Reads the people of a .trc file.

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: unused: the file gives its rate.
        everyone: return all people instead of the first two.

    Returns:
        a person, two or more on the joints of :data:`~motion.skeleton.POINTS17`, in metres and Y up.

    Raises:
        InputError: one sentence with the line where the file is wrong.
    """
    data, label = read_bytes(source, name)
    text = decode_text(data, label, "a .trc file")
    del data
    head, start = _head(text, label)
    settings = dict(zip(_cells(head[1]), _cells(head[2]), strict=False))
    rate = _number(settings.get("DataRate") or settings.get("CameraRate"), "DataRate", label)
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a DataRate of {rate:g} is not possible: give frames a second.")
    unit = settings.get("Units", "mm").strip().lower()
    if unit not in _UNITS:
        raise InputError(f"{label}: the unit {unit!r:.20} is not known: use {', '.join(_UNITS)}.")
    names = _marker_names(head[3], label)
    values = _rows(text, start, len(names), rate, label)
    values *= _UNITS[unit]
    return gathered(people_of(names, values, rate, label), label, everyone=everyone)


def _cells(line: str) -> list[str]:
    """The cells of a line between tabs, or between spaces where there are no tabs."""
    return line.split("\t") if "\t" in line else line.split()


def _head(text: str, label: str) -> tuple[list[str], int]:
    """The five lines of the head, and where the rows begin."""
    start, lines = 0, []
    for _ in range(5):
        stop = text.find("\n", start, start + _HEAD)
        if stop < 0:
            raise InputError(f"{label} has no head of five lines: is it a .trc file?")
        lines.append(text[start:stop].rstrip("\r"))
        start = stop + 1
    if "DataRate" not in lines[1] or not lines[3].lower().startswith("frame"):
        raise InputError(f"{label} does not name DataRate and Frame# in its head: is it a .trc file?")
    return lines, start


def _marker_names(line: str, label: str) -> list[str]:
    names = [cell.strip() for cell in _cells(line)[2:] if cell.strip()]
    if not 1 <= len(names) <= _MOST_MARKERS:
        raise InputError(f"{label} names {len(names)} markers: give 1 to {_MOST_MARKERS}.")
    return names


def _rows(text: str, start: int, markers: int, rate: float, label: str) -> Array:
    """(T, markers, 3) as in the file; NaN where a marker was not seen."""
    width = 2 + 3 * markers
    longest = 40 * width
    found, frames = array("f"), 0
    number = 5
    while start < len(text):
        stop = text.find("\n", start)
        stop = len(text) if stop < 0 else stop
        number += 1
        if stop - start > longest:
            raise InputError(
                f"{label}, line {number} is longer than {markers} markers need: export it again."
            )
        line, start = text[start:stop].strip("\r\n"), stop + 1
        if not line.strip():
            continue
        frames += 1
        check_duration(frames, rate, label)
        found.extend(_values(_cells(line)[2:width], label, number))
        found.extend(repeat(np.nan, 3 * markers * frames - len(found)))
        if len(found) > MAX_NUMBERS:
            raise InputError(
                f"{label} holds {markers} markers in more than {frames:,} frames: cut it or lower its frame rate."
            )
    if not frames:
        raise InputError(f"{label} holds no frames: export it again.")
    return np.frombuffer(found, np.float32).reshape(frames, markers, 3)


def _values(cells: list[str], label: str, number: int) -> list[float]:
    try:
        return [float(cell or "nan") for cell in cells]
    except ValueError:
        return [_value(cell, label, number) for cell in cells]


def _value(cell: str, label: str, number: int) -> float:
    try:
        return float(cell) if cell.strip() else np.nan
    except ValueError:
        raise InputError(f"{label}, line {number}: {cell.strip()!r:.20} is not a number.") from None


def _number(word: str | None, what: str, label: str) -> float:
    try:
        return float(word or "")
    except ValueError:
        raise InputError(f"{label} does not give its {what} as a number: export it again.") from None
