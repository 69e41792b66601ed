"""A body around the joints: one capsule a bone, and the distances between capsules.

The radii are those of an average adult, rounded: skeletons carry no flesh, and all that is measured here
needs is to know when two bodies would be inside each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.vectors import Array

_RADII = {
    "head": 0.085,
    "neck": 0.06,
    "spine3": 0.12,
    "spine2": 0.12,
    "spine1": 0.12,
    "hip": 0.09,
    "knee": 0.07,
    "ankle": 0.045,
    "foot": 0.04,
    "collar": 0.06,
    "shoulder": 0.06,
    "elbow": 0.045,
    "wrist": 0.035,
}
"""Radius in metres of the capsule of the bone that ends in a joint, by the joint's name without its side."""


@dataclass(frozen=True)
class Capsules:
    """Capsules on SMPL22's joints.

    Attributes:
        starts: (C,) joint at which each capsule begins.
        ends: (C,) joint at which it ends.
        radii: (C,) metres.
    """

    starts: NDArray[np.intp]
    ends: NDArray[np.intp]
    radii: Array

    def are(self, *parts: str) -> NDArray[np.bool_]:
        """(C,) whether each ends in a joint of these names, of either side, such as "wrist"."""
        return np.isin(self.ends, [SMPL22.index(name) for name in SMPL22.joint_names if sideless(name) in parts])

    def part(self, kept: NDArray[np.bool_]) -> Capsules:
        """Those capsules for which ``kept`` (C,) is true."""
        return Capsules(self.starts[kept], self.ends[kept], self.radii[kept])

    def of_size(self, size: float) -> Capsules:
        """The same around bones of another size, as a share of an adult's."""
        return replace(self, radii=size * self.radii)


def sideless(joint_name: str) -> str:
    """A joint's name without ``left_`` or ``right_``."""
    return joint_name.removeprefix("left_").removeprefix("right_")


CAPSULES = Capsules(
    starts=np.array([parent for parent, _ in SMPL22.bones], dtype=np.intp),
    ends=np.array([child for _, child in SMPL22.bones], dtype=np.intp),
    radii=np.array([_RADII[sideless(SMPL22.joint_names[child])] for _, child in SMPL22.bones]),
)
"""The body of an adult: one capsule a bone. It ends at the wrists: people who hold hands are not inside each other."""


def point_segment_distance(points: Array, starts: Array, ends: Array) -> Array:
    """Distance in metres from points (…, 3) to segments from ``starts`` to ``ends`` (…, 3), broadcast."""
    along = ends - starts
    length2 = np.maximum(np.einsum("...i,...i->...", along, along), 1e-12)
    share = np.clip(np.einsum("...i,...i->...", points - starts, along) / length2, 0.0, 1.0)
    gap = points - starts - share[..., None] * along
    return np.sqrt(np.einsum("...i,...i->...", gap, gap))


def segment_segment_distance(start_a: Array, end_a: Array, start_b: Array, end_b: Array) -> Array:
    """Distance in metres between segments, each end (N, 3)."""
    here, there = closest_points(start_a, end_a, start_b, end_b)
    gap = here - there
    return np.sqrt(np.einsum("ni,ni->n", gap, gap))


def closest_points(start_a: Array, end_a: Array, start_b: Array, end_b: Array) -> tuple[Array, Array]:
    """The points (N, 3) of two segments that are nearest to each other, each end (N, 3).

    Ericson, *Real-Time Collision Detection* (2005), section 5.1.9, for N pairs at once.
    """
    along_a, along_b, between = end_a - start_a, end_b - start_b, start_a - start_b
    a = np.maximum(np.einsum("ni,ni->n", along_a, along_a), 1e-12)
    e = np.maximum(np.einsum("ni,ni->n", along_b, along_b), 1e-12)
    b = np.einsum("ni,ni->n", along_a, along_b)
    c = np.einsum("ni,ni->n", along_a, between)
    f = np.einsum("ni,ni->n", along_b, between)
    denominator = a * e - b * b
    parallel = denominator <= 1e-9 * a * e
    s = np.where(parallel, 0.0, np.clip((b * f - c * e) / np.where(parallel, 1.0, denominator), 0.0, 1.0))
    t = (b * s + f) / e
    s = np.where(t < 0, np.clip(-c / a, 0, 1), np.where(t > 1, np.clip((b - c) / a, 0, 1), s))
    t = np.clip(t, 0.0, 1.0)
    return start_a + s[:, None] * along_a, start_b + t[:, None] * along_b


def depths(first: Array, one: Capsules, second: Array, two: Capsules) -> Array:
    """(T,) metres of the deepest overlap of capsules on joints (T, J, 3) of one person with the other's; 0 for none.

    The overlap of two capsules is the sum of their radii less the distance of their middle lines. Pairs whose bounding
    spheres do not meet are left out before any distance is computed.
    """
    ends = first[:, one.starts], first[:, one.ends], second[:, two.starts], second[:, two.ends]
    reach_a, reach_b = (
        np.linalg.norm(end - start, axis=-1) / 2 + radii
        for start, end, radii in ((*ends[:2], one.radii), (*ends[2:], two.radii))
    )
    # |m_a − m_b|² of all pairs as one matrix product; middles are taken from a nearby origin so that
    # float32 loses nothing.
    origin = 0.5 * (first[:, :1] + second[:, :1])
    middle_a, middle_b = (ends[0] + ends[1]) / 2 - origin, (ends[2] + ends[3]) / 2 - origin
    gap2 = (
        np.einsum("tci,tci->tc", middle_a, middle_a)[:, :, None]
        + np.einsum("tci,tci->tc", middle_b, middle_b)[:, None]
        - 2 * middle_a @ middle_b.swapaxes(1, 2)
    )
    frame, i, j = np.nonzero(gap2 < (reach_a[:, :, None] + reach_b[:, None]) ** 2)
    deepest = np.zeros(len(first))
    if len(frame):
        distance = segment_segment_distance(ends[0][frame, i], ends[1][frame, i], ends[2][frame, j], ends[3][frame, j])
        np.maximum.at(deepest, frame, one.radii[i] + two.radii[j] - distance)
    return deepest
