"""C3D files, the standard of laboratories: points in space with their names.

A header of 512 bytes, parameters in groups, and for each frame four numbers a point (x, y, z and how well it was seen)
before as many of analog channels as the header says, which are passed over.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from motion.errors import InputError
from motion.vectors import Array

from .files import check_duration, check_rate
from .markers import people_of
from .recording import ImportChoices, Recording

_BLOCK = 512
_MOST_BLOCKS = 255
"""Of parameters: their number is one byte."""
_MOST_POINTS = 1000
_MOST_VALUES = 16 * 2**20
_OTHERS = (85, 86)
"""Kinds of machine, DEC and MIPS, whose numbers are stored in other ways than Intel's."""
_TYPES = {-1: "S1", 1: "u1", 2: "i2", 4: "f4"}


def read_c3d(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """The people of a .c3d file, on the joints of :data:`~motion.skeleton.POINTS17`, in metres.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    if data[1:2] != b"\x50":
        raise InputError(f"{label} is not a C3D file: export it again.")
    try:
        names, points, rate, unit = _points(data, label, choices.fps)
    except (struct.error, IndexError, ValueError, OverflowError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{label} is not a whole C3D file, or it is damaged: export it again.") from None
    return people_of(names, points, rate, unit, label)


def _points(data: bytes, label: str, fps: float | None) -> tuple[list[str], Array, float, str]:
    """Names, (T, P, 3) float32 with NaN where a point was not seen, frames a second and the unit's name."""
    parameters = _BLOCK * (max(data[0], 1) - 1)
    if data[parameters + 3] in _OTHERS:
        raise InputError(f"{label} holds the numbers of a DEC or MIPS machine: save it again as Intel's.")
    used, analog, first, last, _, scaled, start, _, often = struct.unpack_from("<5Hf2Hf", data, 2)
    header = dict(_parameters(data[: parameters + _MOST_BLOCKS * _BLOCK], parameters + 4))
    rate = fps or float(header["POINT:RATE"][0] if "POINT:RATE" in header else often)
    count = int(header["POINT:USED"][0]) if "POINT:USED" in header else used
    scale = float(header["POINT:SCALE"][0] if "POINT:SCALE" in header else scaled)
    if last == 0xFFFF and "TRIAL:ACTUAL_END_FIELD" in header:  # two words, as 16 bits are not enough
        low, high = (int(word) % 2**16 for word in header["TRIAL:ACTUAL_END_FIELD"][:2])
        last = low + 2**16 * high
    frames = last - first + 1
    check_rate(rate, label)
    if not 1 <= count <= _MOST_POINTS:
        raise InputError(f"{label} holds {count} points: give 1 to {_MOST_POINTS}.")
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    check_duration(frames, rate, label)
    if 4 * count * frames > _MOST_VALUES:
        raise InputError(f"{label} holds {frames:,} frames of {count} points: cut it or lower its frame rate.")
    dtype = np.dtype("<f4" if scale < 0 else "<i2")
    row, begin = dtype.itemsize * (4 * count + analog), _BLOCK * (start - 1)
    if begin < _BLOCK or begin + frames * row > len(data):
        raise ValueError
    values = np.ndarray((frames, count, 4), dtype, data, begin, (row, 4 * dtype.itemsize, dtype.itemsize))
    places = values[..., :3].astype(np.float32)
    places *= np.float32(1.0 if scale < 0 else scale)
    places[~(values[..., 3] >= 0)] = np.nan  # no camera saw it
    unit = _texts(header.get("POINT:UNITS"))[:1]
    return _names(header, count), places, rate, (unit[0].lower() if unit else "") or "mm"


def _names(parameters: dict[str, Any], count: int) -> list[str]:
    """Of all points: a parameter holds 255 labels, and LABELS2, LABELS3 … hold those after them."""
    names: list[str] = []
    for number in range(1, 2 + count // 255):
        names += _texts(parameters.get(f"POINT:LABELS{number if number > 1 else ''}"))
    return [*names[:count], *(f"point {number}" for number in range(len(names), count))]


def _parameters(data: bytes, at: int) -> Iterator[tuple[str, Any]]:
    """ "GROUP:NAME" and values of each parameter; texts are arrays of bytes. None reaches into the next."""
    groups: dict[int, str] = {}
    later: list[tuple[int, str, int, int]] = []
    while at + 4 < len(data):
        length, group = struct.unpack_from("bb", data, at)
        length = abs(length)
        name = data[at + 2 : at + 2 + length].decode("latin-1").strip().upper()
        (step,) = struct.unpack_from("<H", data, at + 2 + length)
        if length == 0:
            break
        begin, at = at + 4 + length, (at + 2 + length + step if step else len(data))
        if group < 0:
            groups[-group] = name
        else:
            later.append((group, name, begin, at))
    for group, name, place, end in later:
        kind, count = struct.unpack_from("bB", data, place)
        sizes = data[place + 2 : place + 2 + count]
        dtype = np.dtype(_TYPES.get(kind, "u1")).newbyteorder("<")
        total = math.prod(sizes)  # 1 for a scalar
        raw = data[place + 2 + count : min(place + 2 + count + total * dtype.itemsize, end)]
        if len(raw) == total * dtype.itemsize and total:
            values = np.frombuffer(raw, dtype)
            yield (
                f"{groups.get(group, '')}:{name}",
                values.reshape(-1, sizes[0] if kind == -1 and sizes else 1) if kind == -1 else values,
            )


def _texts(values: Any) -> list[str]:
    """The rows of a text parameter."""
    if values is None or getattr(values, "dtype", None) != np.dtype("S1"):
        return []
    return [row.tobytes().decode("latin-1").strip(" \0") for row in values]
