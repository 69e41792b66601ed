"""C3D files, the standard of laboratories: points in space with their names, read by the package ``c3d``.

That package is pure Python. The better known ``ezc3d`` is C++ that a damaged file can send into an endless loop or
out of memory, so it may not read what strangers upload.
"""

from __future__ import annotations

import io
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .crowd import Motion, gathered
from .files import MAX_FRAMES, check_duration, read_bytes
from .markers import people_of

Array = NDArray[np.floating]

_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_MOST_POINTS = 1000
_MOST_VALUES = 16 * 2**20


def read_c3d(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    """Reads the people of a .c3d file.

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: unused: the file gives its rate.
        everyone: return all people instead of the first two.

    Returns:
        a person, two or more on the joints of :data:`~motion.skeleton.POINTS17`, in metres and Y up.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    data, label = read_bytes(source, name)
    if find_spec("c3d") is None:
        raise InputError("C3D files need the package c3d: install it with pip.")
    if data[1:2] != b"\x50":
        raise InputError(f"{label} is not a C3D file: export it again.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            names, points, rate, unit = _points(data, label)
    except InputError:
        raise
    except Exception:  # the package raises anything over damaged files
        raise InputError(f"{label} is not a whole C3D file, or it is damaged: export it again.") from None
    if unit not in _UNITS:
        raise InputError(f"{label}: the unit {unit!r:.20} is not known: use {', '.join(_UNITS)}.")
    points *= _UNITS[unit]
    return gathered(people_of(names, points, rate, label), label, everyone=everyone)


def _points(data: bytes, label: str) -> tuple[list[str], Array, float, str]:
    """Names, (T, P, 3) with NaN where a point was not seen, frames a second and the unit's name."""
    import c3d

    reader: Any = c3d.Reader(io.BytesIO(data))
    rate, count = float(reader.point_rate), int(reader.point_used)
    frames = int(reader.last_frame) - int(reader.first_frame) + 1
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a frame rate of {rate:g} is not possible: export it again.")
    if not 1 <= count <= _MOST_POINTS:
        raise InputError(f"{label} holds {count} points: give 1 to {_MOST_POINTS}.")
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    check_duration(frames, rate, label)
    if 4 * count * frames > _MOST_VALUES or frames > MAX_FRAMES:
        raise InputError(
            f"{label} holds {frames:,} frames of {count} points: cut it or lower its frame rate."
        )
    places, filled = np.empty((frames, count, 3), dtype=np.float32), 0
    for place, (_, points, _) in zip(places, reader.read_frames(copy=False), strict=False):
        place[:] = points[:, :3]
        place[points[:, 3] < 0] = np.nan  # the residual of a point that no camera saw
        filled += 1
    if not filled:
        raise ValueError("no frames")
    places = places[:filled]
    names = [str(label_).strip() for label_ in reader.point_labels][:count]
    names += [f"point {number}" for number in range(len(names), count)]
    units = reader.get("POINT:UNITS")
    unit = str(units.string_value).strip().lower() if units is not None else "mm"
    return names, places, rate, unit or "mm"
