"""Reads what a page sends to a live stream: the landmarks of a few pictures, or poses. All of it may be hostile."""

from __future__ import annotations

import base64
import binascii
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, InputError
from motion.video import Landmarks
from motion.video.landmarks import landmarks_of

Array = NDArray[np.floating]

MOST_BYTES = 100_000
"""Of a message: a picture with one person takes 900."""
MOST_PICTURES = 32
"""Pictures or poses in a message."""
MOST_SECONDS = 86_400.0
"""Of a stream's own clock."""
FARTHEST = 50.0
"""Metres from the origin."""
_BROKEN = "The live stream sent something that cannot be read: reload the page and start again."


@dataclass(frozen=True)
class Poses:
    """Poses of a person whose body is known, such as those of a recorded clip.

    Attributes:
        times: (F,) seconds since the stream began, increasing.
        positions: (F, 22, 3) metres, Y up, floor at 0.
    """

    times: Array
    positions: Array


@dataclass(frozen=True)
class Message:
    """A message to a stream.

    Attributes:
        content: what came; None for a message that only says that somebody is there.
        dropped: pictures that the page could not send since its last message.
    """

    content: Landmarks | Poses | None
    dropped: int = 0


def read_message(body: bytes) -> Message:
    """The message in a request's body.

    Raises:
        InputError: where it is not what the page sends.
    """
    fields = read_fields(body)
    dropped = fields.get("dropped", 0)
    if type(dropped) is not int or not 0 <= dropped <= 10_000:
        raise InputError(_BROKEN)
    if "landmarks" in fields:
        landmarks = landmarks_of(fields)
        if len(landmarks.times) > MOST_PICTURES:
            raise InputError(_BROKEN)
        return Message(landmarks, dropped)
    return Message(_poses(fields) if "poses" in fields else None, dropped)


def read_fields(body: bytes) -> dict[str, Any]:
    """The JSON object in a request's body.

    Raises:
        InputError: where it is too long or not one.
    """
    if len(body) > MOST_BYTES:
        raise InputError(_BROKEN)
    try:
        fields = json.loads(body or b"{}")
    except (ValueError, RecursionError):
        raise InputError(_BROKEN) from None
    if not isinstance(fields, dict):
        raise InputError(_BROKEN)
    return fields


def _poses(fields: dict[str, Any]) -> Poses:
    """Poses as whole millimetres: base64 of little-endian int16, (F, 22, 3)."""
    times = fields.get("times")
    if not isinstance(times, list) or not 1 <= len(times) <= MOST_PICTURES:
        raise InputError(_BROKEN)
    if not all(type(t) in (int, float) and 0 <= t <= MOST_SECONDS for t in times):
        raise InputError(_BROKEN)
    try:
        data = base64.b64decode(fields["poses"], validate=True)
    except (TypeError, ValueError, binascii.Error):
        raise InputError(_BROKEN) from None
    if len(data) != 2 * 3 * SMPL22.num_joints * len(times) or (np.diff(times) <= 0).any():
        raise InputError(_BROKEN)
    positions = np.frombuffer(data, "<i2").reshape(len(times), SMPL22.num_joints, 3) / 1000.0
    if np.abs(positions).max() > FARTHEST:
        raise InputError(_BROKEN)
    return Poses(np.asarray(times, dtype=np.float64), positions)
