"""Marker trajectories as text, ``.trc`` (Motion Analysis, OpenSim, OpenCap, Pose2Sim).

Five lines of head: a title, names of settings, their values (``DataRate``, ``NumFrames``, ``NumMarkers``, ``Units``),
``Frame#  Time`` and the markers' names, one above each three columns, and ``X1 Y1 Z1 …``; then a row a frame. Between
cells stand tabs, or else semicolons, commas or spaces. Empty cells are markers that were not seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .files import MAX_FRAMES, MAX_NUMBERS, MAX_SECONDS, check_duration, decode_text
from .markers import people_of
from .recording import ImportChoices, Recording

Array = NDArray[np.floating]

_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_MOST_MARKERS = 1000
_HEAD = 200_000
"""Characters: the head of a file with so many markers is shorter."""


def read_trc(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """The people of a .trc file, on the joints of :data:`~motion.skeleton.POINTS17`, in metres.

    Raises:
        InputError: one sentence with the line where the file is wrong.
    """
    text = decode_text(data, label, "a .trc file")
    del data
    head, start = _head(text, label)
    mark = next((mark for mark in "\t;," if mark in head[3]), None)
    settings = dict(zip(_cells(head[1], mark), _cells(head[2], mark), strict=False))
    rate = choices.fps or _rate(settings.get("DataRate") or settings.get("CameraRate") or "", label)
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a DataRate of {rate:g} is not possible: give frames a second.")
    unit = settings.get("Units", "mm").strip().lower()
    if unit not in _UNITS:
        raise InputError(f"{label}: the unit {unit!r:.20} is not known: use {', '.join(_UNITS)}.")
    names = [cell.strip() for cell in _cells(head[3], mark)[2:] if cell.strip()]
    if not 1 <= len(names) <= _MOST_MARKERS:
        raise InputError(f"{label} names {len(names)} markers: give 1 to {_MOST_MARKERS}.")
    values = _rows(text, start, len(names), mark, rate, label)
    values *= np.float32(_UNITS[unit])
    return Recording(people_of(names, values, rate, label), "")


def _cells(line: str, mark: str | None) -> list[str]:
    """The cells of a line; a comma that is not between them is a decimal one."""
    cells = line.split(mark)
    return cells if mark in (",", None) or "," not in line else [cell.replace(",", ".") for cell in cells]


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


def _rows(text: str, start: int, markers: int, mark: str | None, rate: float, label: str) -> Array:
    """(T, markers, 3) float32 as in the file; NaN where a marker was not seen."""
    width = 2 + 3 * markers
    longest = 40 * width
    lines = text.count("\n", start) + 1
    if lines > 4 * MAX_FRAMES:
        raise InputError(f"{label} has {lines:,} lines: cut it, or leave out those that are empty.")
    lines = min(lines, int(MAX_SECONDS * rate) + 1, MAX_FRAMES)
    if lines * width > MAX_NUMBERS:
        raise InputError(
            f"{label} holds {markers} markers in more than {MAX_NUMBERS // width:,} frames: cut it or lower its rate."
        )
    rows, frames, number = np.full((lines, 3 * markers), np.nan, dtype=np.float32), 0, 5
    while start < len(text):
        stop = text.find("\n", start)
        stop = len(text) if stop < 0 else stop
        number += 1
        if stop - start > longest:
            raise InputError(f"{label}, line {number} is longer than {markers} markers need: export it again.")
        line, start = text[start:stop].strip("\r\n"), stop + 1
        if not line.strip("\t ;,"):
            continue
        check_duration(frames + 1, rate, label)
        values = [_value(cell, label, number) for cell in _cells(line, mark)[2:width]]
        rows[frames, : len(values)] = values
        frames += 1
    if not frames:
        raise InputError(f"{label} holds no frames: export it again.")
    return rows[:frames].reshape(frames, markers, 3)


def _value(cell: str, label: str, number: int) -> float:
    try:
        return float(cell) if cell.strip() else np.nan
    except ValueError:
        raise InputError(f"{label}, line {number}: {cell.strip()!r:.20} is not a number.") from None


def _rate(word: str, label: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(f"{label} does not give its DataRate as a number: give its true rate.") from None
