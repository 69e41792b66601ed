"""A motion as a moving thumbnail: a few joints, seen from the side, in about a kilobyte.

The browser's side of this format is ``static/notebook/thumbnail.js``.
"""

from __future__ import annotations

import base64

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Clip, Duet, stacked_positions

FRAMES = 20
"""Moments of the motion that a thumbnail holds."""
JOINTS = tuple(
    SMPL22.index(name)
    for name in (
        *("pelvis", "neck", "head"),
        *(f"{s}_{part}" for part in ("shoulder", "elbow", "wrist", "knee", "ankle") for s in ("left", "right")),
    )
)
_LEVELS = 255
_BODY = 0.2
"""Metres by which a body is wider and taller than its joints."""
_NEAR, _FAR = 0.6, 0.9
"""Metres from the middle up to which people stand where they are, and at which those stand who are far away."""


def thumbnail(motion: Duet | Clip) -> str:
    """People, frames and places of :data:`JOINTS` in a square, as base64 of bytes.

    The first byte is the number of people and the second that of frames; then follow x and y (down) of every joint
    (person, frame, joint), 0 to 255. People are seen from the side of the line between them, by a camera that goes
    along with them; who is far away is moved nearer, so that all thumbnails show people of one size.
    """
    people = stacked_positions(motion).astype(np.float64)
    moments = np.linspace(0, people.shape[1] - 1, FRAMES).round().astype(int)
    seen = people[:, moments][:, :, JOINTS]
    flat = np.stack([_across(people, seen), -seen[..., 1]], axis=-1)
    flat[..., 0] -= flat[..., 0, 0].mean(axis=0)[None, :, None]
    pelvis = np.abs(flat[..., :1, 0])
    beyond = np.maximum(pelvis - _NEAR, 0.0) / (_FAR - _NEAR)
    flat[..., 0] -= np.sign(flat[..., :1, 0]) * (_FAR - _NEAR) * (beyond - np.tanh(beyond))
    low, high = flat.min(axis=(0, 1, 2)), flat.max(axis=(0, 1, 2))
    low, high = low - _BODY, high + _BODY
    size = max(float((high - low).max()), 1.0)
    places = (flat - (low + high) / 2) / size + 0.5
    levels = np.clip(np.rint(places * _LEVELS), 0, _LEVELS).astype(np.uint8)
    return base64.b64encode(bytes([len(people), FRAMES]) + levels.tobytes()).decode("ascii")


def _across(people: NDArray[np.float64], seen: NDArray[np.float64]) -> NDArray[np.float64]:
    """(people, frames, joints) metres along the line from A to B on the floor, with a little of what lies across."""
    pelvis = people[:, :, 0].mean(axis=1)
    line = (pelvis[1] - pelvis[0] if len(people) > 1 else np.array([0.0, 0.0, 1.0]))[[0, 2]]
    length = float(np.linalg.norm(line))
    along = line / length if length > 1e-6 else np.array([0.0, 1.0])
    ground = seen[..., [0, 2]]
    return ground @ along + 0.35 * (ground @ np.array([-along[1], along[0]]))
