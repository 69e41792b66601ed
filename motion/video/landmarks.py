"""The 33 points that MediaPipe's pose network finds on a body, and what they say about SMPL22's joints.

The browser sends them (``static/camera/landmarks.js``) as JSON with plain numbers and base64 of little-endian whole
numbers: ``times`` (uint32, milliseconds), ``counts`` (uint8, 1 for a picture that shows somebody and 0 for another),
``world`` (int16, millimetres), ``image`` (int16, 8000 to the picture's side) and ``seen`` (uint8, 255 is sure); beside
them ``name`` of the film. The text is taken to be hostile.
"""

from __future__ import annotations

import base64
import binascii
import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.vectors import Array

_SIDES = ("left", "right")
POINTS = (
    "nose",
    *(f"{side}_eye{part}" for side in _SIDES for part in ("_inner", "", "_outer")),
    *("left_ear", "right_ear", "mouth_left", "mouth_right"),
    *(f"{side}_{part}" for part in ("shoulder", "elbow", "wrist", "pinky", "index", "thumb") for side in _SIDES),
    *(f"{side}_{part}" for part in ("hip", "knee", "ankle", "heel", "foot_index") for side in _SIDES),
)
"""Names in the network's order (Bazarevsky et al., BlazePose, 2020)."""
INDEX = {name: index for index, name in enumerate(POINTS)}
LIMBS = [INDEX[f"{side}_{part}"] for part in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle") for side in _SIDES]


@dataclass(frozen=True, eq=False)
class Landmarks:
    """The poses found in the pictures of a film, one in a picture at most.

    Attributes:
        width, height: of the film in pixels.
        times: (F,) seconds of the pictures that were looked at, increasing.
        frames: (N,) index of the picture of each pose.
        world: (N, 33, 3) metres about the middle of the hips, as the network gives them: x to the right of
            the picture, y down, z away from the camera.
        image: (N, 33, 2) shares of the picture's width and height from its upper left corner.
        seen: (N, 33) 0 to 1, how surely a point is visible.
    """

    width: int
    height: int
    times: Array
    frames: NDArray[np.integer]
    world: Array = field(repr=False)
    image: Array = field(repr=False)
    seen: Array = field(repr=False)

    @property
    def pixels(self) -> Array:
        """(N, 33, 2) pixels from the upper left corner."""
        return self.image * np.array([self.width, self.height])


# ---- What the browser sends ------------------------------------------------------------------------------------------
VERSION = 1
LONGEST = 61.0
"""Seconds; the page offers 60."""
MOST_FRAMES = 1900
MOST_TEXT = 4_000_000
"""Characters."""
SIDES = (16, 16384)
"""Pixels: the smallest and the largest width and height."""
_IMAGE = 8000.0
_UNNAMED = "Film"
_BROKEN = "The points of the video arrived damaged: reload the page and choose the video again."


def unpack_film(text: str) -> tuple[Landmarks, str]:
    """The landmarks in a text, and the name of the film.

    Raises:
        InputError: where it is not what the page sends.
    """
    if not isinstance(text, str) or len(text) > MOST_TEXT:
        raise InputError("The points of the video are too many: choose a video of 60 s or less.")
    try:
        fields = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError(_BROKEN) from None
    if not isinstance(fields, dict):
        raise InputError(_BROKEN)
    return landmarks_of(fields), _name(fields.get("name"))


def landmarks_of(fields: dict[str, Any]) -> Landmarks:
    """The landmarks in the fields of a text that was read as JSON.

    Raises:
        InputError: where they are not what the page sends.
    """
    if fields.get("landmarks") != VERSION:
        raise InputError(_BROKEN)
    width, height = (_side(fields.get(name)) for name in ("width", "height"))
    times = _numbers(fields.get("times"), "<u4") / 1000.0
    counts = _numbers(fields.get("counts"), "u1")
    if len(times) != len(counts) or not 1 <= len(times) <= MOST_FRAMES or counts.max() > 1:
        raise InputError(_BROKEN)
    if (np.diff(times) <= 0).any() or times[-1] - times[0] > LONGEST:
        raise InputError(_BROKEN)
    frames = np.flatnonzero(counts)
    poses = len(frames)
    points = len(POINTS)
    world, image, seen = (
        _numbers(fields.get(name), kind) for name, kind in (("world", "<i2"), ("image", "<i2"), ("seen", "u1"))
    )
    if (len(world), len(image), len(seen)) != (3 * points * poses, 2 * points * poses, points * poses):
        raise InputError(_BROKEN)
    return Landmarks(
        width,
        height,
        times,
        frames,
        world.reshape(poses, points, 3) / 1000.0,
        image.reshape(poses, points, 2) / _IMAGE,
        seen.reshape(poses, points) / 255.0,
    )


def _name(value: Any) -> str:
    """A film's name without what cannot be shown, at most 80 characters."""
    if not isinstance(value, str):
        return _UNNAMED
    shown = "".join(letter for letter in value[:80] if letter.isprintable() and letter not in "/\\")
    return shown.strip() or _UNNAMED


def _side(value: Any) -> int:
    if type(value) is not int or not SIDES[0] <= value <= SIDES[1]:
        raise InputError(_BROKEN)
    return value


def _numbers(value: Any, kind: str) -> np.ndarray:
    """The whole numbers of a base64 text, as float64 where they are more than a byte."""
    if not isinstance(value, str):
        raise InputError(_BROKEN)
    try:
        data = base64.b64decode(value, validate=True)
    except (binascii.Error, ValueError):
        raise InputError(_BROKEN) from None
    if len(data) % np.dtype(kind).itemsize:
        raise InputError(_BROKEN)
    numbers = np.frombuffer(data, kind)
    return numbers.astype(np.int64) if kind != "u1" else numbers
