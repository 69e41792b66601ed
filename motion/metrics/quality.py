"""Measures of motion quality: foot skating, jerk, bone drift and penetration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion import Duet
from motion.looks import size_of

from .bodies import capsules, segment_segment_distance

Array = NDArray[np.floating]

TOE_HEIGHT, ANKLE_HEIGHT = 0.05, 0.12
"""Metres below which a toe and an ankle joint count as on the floor (InterGen, section 4.3, as released)."""
SKATE_SPEED = 0.5
"""Metres a second above which a planted foot skates: 2.5 cm a frame at 20 fps (Karunratanakul et al.,
Guided Motion Diffusion, ICCV 2023, section 5)."""


@dataclass(frozen=True)
class FootSkate:
    """Sliding of the feet while they stand.

    Attributes:
        speed: mean horizontal speed of the feet that stand, in cm/s; 0 if no foot ever stands.
        ratio: share of those foot-frames with more than :data:`SKATE_SPEED`, 0 to 1.
        contact: share of all foot-frames in which a foot stands, 0 to 1.
    """

    speed: float
    ratio: float
    contact: float


def foot_skate(duet: Duet) -> FootSkate:
    """Slides of standing feet, over both feet of both people.

    A foot stands from one frame to the next where its toe joint is below 5 cm *and* its ankle joint below
    12 cm in both: a swinging foot also passes close to the floor, but with its heel lifted. Skeletons that
    lack one of the two joints are judged by the other.
    """
    names = duet.skeleton.joint_names
    speeds, standing = [], []
    for side in ("left", "right"):
        found = [
            (names.index(f"{side}_{part}"), height)
            for part, height in (("foot", TOE_HEIGHT), ("ankle", ANKLE_HEIGHT))
            if f"{side}_{part}" in names
        ]
        if not found:
            continue
        low = np.all([duet.positions[:, :, joint, 1] < height for joint, height in found], axis=0)
        path = duet.positions[:, :, found[0][0]][..., [0, 2]].astype(np.float64)
        speeds.append(np.linalg.norm(np.diff(path, axis=1), axis=-1) * duet.fps)
        standing.append(low[:, 1:] & low[:, :-1])
    if not speeds or not np.any(standing):
        return FootSkate(0.0, 0.0, 0.0)
    planted = np.array(speeds)[np.array(standing)]
    return FootSkate(
        speed=float(planted.mean() * 100), ratio=float((planted > SKATE_SPEED).mean()), contact=float(np.mean(standing))
    )


def jerk(duet: Duet) -> float:
    """Mean length of the third derivative of all joint positions, in m/s³; 0 under four frames."""
    if duet.num_frames < 4:
        return 0.0
    third = np.diff(duet.positions.astype(np.float64), n=3, axis=1) * duet.fps**3
    return float(np.linalg.norm(third, axis=-1).mean())


def bone_drift(duet: Duet) -> float:
    """Change of bone lengths over time, in percent.

    For every bone the standard deviation of its length over time as a share of its mean length, averaged
    over the bones of both people; 0 for a rigid skeleton.
    """
    positions = duet.positions.astype(np.float64)
    parents, children = (list(ends) for ends in zip(*duet.skeleton.bones, strict=True))
    lengths = np.linalg.norm(positions[:, :, children] - positions[:, :, parents], axis=-1)
    mean = lengths.mean(axis=1)
    return float(100 * np.mean(lengths.std(axis=1) / np.maximum(mean, 1e-6)))


@dataclass(frozen=True)
class Penetration:
    """Penetration depth of the two bodies.

    Attributes:
        depth: (T,) the deepest overlap of two capsules at each frame, cm.
        mean: mean of ``depth``, cm.
        deepest: its largest value, cm.
    """

    depth: Array
    mean: float
    deepest: float


def penetration(duet: Duet) -> Penetration:
    """Overlap of the two people's capsule bodies (see :func:`~motion.metrics.bodies.capsules`).

    The overlap of two capsules is the sum of their radii less the distance of their axes. Pairs whose
    bounding spheres do not meet are left out before any distance is computed. A child's body is as thin as it is short.
    """
    body = capsules(duet.skeleton)
    radii_a, radii_b = (body.of_size(size_of(look)).radii for look in duet.looks)
    a, b = duet.positions
    starts_a, ends_a, starts_b, ends_b = (a[:, body.starts], a[:, body.ends], b[:, body.starts], b[:, body.ends])
    reach_a = np.linalg.norm(ends_a - starts_a, axis=-1) / 2 + radii_a
    reach_b = np.linalg.norm(ends_b - starts_b, axis=-1) / 2 + radii_b
    # |m_a − m_b|² of all pairs as one matrix product; middles are taken from a nearby origin so that
    # float32 loses nothing.
    origin = 0.5 * (a[:, :1] + b[:, :1])
    middle_a, middle_b = (starts_a + ends_a) / 2 - origin, (starts_b + ends_b) / 2 - origin
    gap2 = (
        np.einsum("tci,tci->tc", middle_a, middle_a)[:, :, None]
        + np.einsum("tci,tci->tc", middle_b, middle_b)[:, None]
        - 2 * middle_a @ middle_b.swapaxes(1, 2)
    )
    reach = reach_a[:, :, None] + reach_b[:, None]
    frame, i, j = np.nonzero(gap2 < reach * reach)
    depth = np.zeros(duet.num_frames)
    if len(frame):
        distance = segment_segment_distance(starts_a[frame, i], ends_a[frame, i], starts_b[frame, j], ends_b[frame, j])
        np.maximum.at(depth, frame, radii_a[i] + radii_b[j] - distance)
    depth *= 100
    return Penetration(depth, float(depth.mean()), float(depth.max()))
