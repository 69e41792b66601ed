"""Placing motion in the world and in the frame that the networks know: facing, floor, mirror, resampling.

All functions take and give arrays (…, T, J, 3) of positions in metres, Y up. Headings are angles around
Y in radians, 0 along +Z and positive towards +X.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts are loaded with their first use

from .skeleton import LEGS, SMPL22
from .vectors import FLAT, Array, heading_of

if TYPE_CHECKING:
    from .clip import Clip


def heading_matrix(angle: float | Array) -> Array:
    """(…, 3, 3) rotation about Y that turns +Z to the heading ``angle`` (radians)."""
    angle = np.asarray(angle, dtype=np.float64)
    cos, sin, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [cos, zero, sin, zero, one, zero, -sin, zero, cos]
    return np.stack(rows, axis=-1).reshape(*angle.shape, 3, 3)


def facing(positions: Array) -> Array:
    """(…, T, 3) unit vector in the XZ plane that the body faces: Y × (left → right reversed).

    Across runs from the right hip to the left hip, as in InterGen's canonical frame; a degenerate
    frame (hips above each other) faces +Z.
    """
    across = positions[..., LEGS[0][0], :] - positions[..., LEGS[1][0], :]
    forward = np.stack([-across[..., 2], np.zeros_like(across[..., 0]), across[..., 0]], axis=-1)
    # Y × (right − left) = forward for a body whose left is at +X when it faces +Z.
    length = np.linalg.norm(forward, axis=-1, keepdims=True)
    return np.where(length > 1e-6, forward / np.maximum(length, 1e-6), np.array([0.0, 0.0, 1.0]))


def heading(positions: Array) -> Array:
    """(…, T) heading of the body in radians, 0 along +Z and positive towards +X."""
    return heading_of(facing(positions))


def turn(positions: Array, angle: float) -> Array:
    """Turns positions by ``angle`` radians about the vertical axis through the origin."""
    return positions @ heading_matrix(angle).T


def canonicalize(positions: Array) -> Array:
    """Moves a scene so that the first person stands at the origin facing +Z at the first frame.

    Args:
        positions: (P, T, 22, 3) people of one scene, or (T, 22, 3) for one person.

    Returns:
        the same shape, with that person's root at XZ = 0, facing +Z. Heights do not change.
    """
    reference = positions[0] if positions.ndim == 4 else positions
    root = reference[0, 0] * FLAT
    return turn(positions - root, -float(heading(reference[0])))


def mirrored(positions: Array) -> Array:
    """The motion as a mirror in the plane X = 0 shows it: X negated, left and right joints exchanged."""
    return positions[..., list(SMPL22.mirror), :] * np.array([-1.0, 1.0, 1.0])


def resample(positions: Array, fps: float, new_fps: float) -> Array:
    """Resamples (T, J, 3) from ``fps`` to ``new_fps`` with a cubic spline; the first frame stays.

    Fewer than four frames are interpolated linearly.
    """
    frames = len(positions)
    if frames == 1 or fps == new_fps:
        return np.array(positions, dtype=np.float64)
    duration = (frames - 1) / fps
    times = np.arange(int(np.floor(duration * new_fps + 1e-6)) + 1) / new_fps
    spline = scipy.interpolate.make_interp_spline(np.arange(frames) / fps, positions, k=3 if frames > 3 else 1, axis=0)
    return spline(np.minimum(times, duration))


# ---- The place of a person in the frame that the networks know -------------------------------------------------------
MEDIAN_START_DISTANCE = 1.5
"""Metres between the two people of the median training scene at its first frame; they face each other."""
# Metres: a motion whose lowest joint is this close to 0 is taken to stand on the floor.
_ON_FLOOR = (-0.05, 0.15)


@dataclass(frozen=True)
class Placement:
    """A rotation about the vertical axis and a translation from a clip's world to the network's frame.

    There person a stands at the origin at the first frame and faces +Z. Person b is assumed to stand
    :data:`MEDIAN_START_DISTANCE` in front of that place and to face it. The floor is at 0.

    Attributes:
        turn: (3, 3) rotation about Y.
        origin: (3,) the point of the clip's world that maps to ``goal``.
        goal: (3,) metres.
        mirror: whether people (…, 22, 3) are also mirrored in the plane X = 0 of the network's frame.
    """

    turn: Array
    origin: Array
    goal: Array
    mirror: bool = False

    @classmethod
    def of(cls, clip: Clip, role: str, words: str = "") -> Placement:
        """The placement that puts a person of this role where the network expects one.

        In training, words that name no side occur with right-handed scenes only (:mod:`training.core.handedness`),
        so a person who acts with the left hand under such words is mirrored.
        """
        positions = clip.positions.astype(np.float64)
        lowest = positions[..., 1].min()
        floor = 0.0 if _ON_FLOOR[0] <= lowest <= _ON_FLOOR[1] else lowest
        origin = np.array([positions[0, 0, 0], floor, positions[0, 0, 2]])
        goal = np.array([0.0, 0.0, 0.0 if role == "a" else MEDIAN_START_DISTANCE])
        towards = 0.0 if role == "a" else math.pi
        sideless = role == "a" and bool(words.strip()) and not names_side(words)
        mirror = sideless and leading_wrist(positions) == "left"
        return cls(heading_matrix(towards - float(heading(positions[0]))), origin, goal, mirror)

    def to_network(self, positions: Array) -> Array:
        """(…, 3) float64 metres in the network's frame."""
        placed = (positions.astype(np.float64) - self.origin) @ self.turn.T + self.goal
        return mirrored(placed) if self.mirror else placed

    def to_world(self, positions: Array) -> Array:
        """Inverse of :meth:`to_network`."""
        placed = mirrored(positions) if self.mirror else positions
        return (placed.astype(np.float64) - self.goal) @ self.turn + self.origin


# ---- The leading hand ------------------------------------------------------------------------------------------------
LEAD = 1.5
"""Least ratio of the leading hand's movement to the other's."""
LEAST = 0.3
"""Metres over which a leading hand moves at least."""
_SIDE = re.compile(r"\b(left|right)(wards)?\b", re.IGNORECASE)


def names_side(words: str) -> bool:
    """True if words say left or right."""
    return _SIDE.search(words) is not None


def limb_travel(positions: Array, joint: str, root: str) -> float:
    """Metres over which a joint moves relative to its root joint, in the body's own heading.

    The diagonal of the box that holds 96 % of its path, so that a pose which is merely held counts nothing.

    Args:
        positions: (T, 22, 3) metres.
    """
    relative = positions[:, SMPL22.index(joint)] - positions[:, SMPL22.index(root)]
    own = np.einsum("tij,ti->tj", heading_matrix(heading(positions)), relative)
    low, high = np.percentile(own, (2, 98), axis=0)
    return float(np.linalg.norm(high - low))


def leading_wrist(positions: Array) -> str | None:
    """ "left" or "right" where that wrist moves much further than the other, else None.

    Args:
        positions: (T, 22, 3) metres.
    """
    travel = {side: limb_travel(positions, f"{side}_wrist", f"{side}_shoulder") for side in ("left", "right")}
    least, most = sorted(travel, key=travel.__getitem__)
    return most if travel[most] > max(LEAST, LEAD * travel[least]) else None
