"""Measures of motion quality: foot skating, jerk, bone drift and penetration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.kinematics import bone_lengths
from motion.looks import size_of
from motion.representation import CONTACT_HEIGHTS
from motion.skeleton import FEET, TOES
from motion.transforms import facing
from motion.vectors import Array, left_of, wrapped

from .bodies import CAPSULES, depths


def _low_feet(positions: Array) -> NDArray[np.bool_]:
    """(…, T, side) feet of (…, T, J, 3) whose ankles and toes are both low enough to stand on the floor."""
    low = positions[..., list(FEET), 1] < CONTACT_HEIGHTS
    return np.asarray(low.reshape(*low.shape[:-1], 2, 2).all(axis=-1))


def foot_skate(duet: Duet) -> float:
    """Mean speed over the floor of standing feet, both feet of both people, in cm/s; 0 if no foot ever stands.

    A foot stands from one frame to the next where its toe joint is below 5 cm *and* its ankle joint below
    12 cm in both: a swinging foot also passes close to the floor, but with its heel lifted.
    """
    positions = duet.positions
    low = _low_feet(positions)
    path = positions[:, :, TOES][..., [0, 2]].astype(np.float64)
    speeds = np.linalg.norm(np.diff(path, axis=1), axis=-1) * duet.fps
    planted = speeds[low[:, 1:] & low[:, :-1]]
    return float(planted.mean() * 100) if len(planted) else 0.0


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
    lengths = bone_lengths(duet.positions.astype(np.float64))
    mean = lengths.mean(axis=1)
    return float(100 * np.mean(lengths.std(axis=1) / np.maximum(mean, 1e-6)))


def penetration(duet: Duet) -> Array:
    """(T,) the deepest overlap of the two people's :data:`~motion.metrics.bodies.CAPSULES` at each frame, cm.

    A child's body is as thin as it is short.
    """
    one, two = (CAPSULES.of_size(size_of(look)) for look in duet.looks)
    return 100 * depths(duet.a.positions, one, duet.b.positions, two)


PHYSICAL = {
    "foot_skate": ("foot skate", "cm/s"),
    "jerk": ("jerk", "m/s³"),
    "penetration": ("penetration", "cm"),
    "bone_drift": ("bone drift", "%"),
}
"""Key → (label, unit) of each measure."""


def physical(duets: Sequence[Duet]) -> dict[str, float]:
    """The mean of each measure of :data:`PHYSICAL` over duets."""
    values = [(foot_skate(duet), jerk(duet), penetration(duet).mean(), bone_drift(duet)) for duet in duets]
    return {key: round(float(mean), 4) for key, mean in zip(PHYSICAL, np.mean(values, axis=0), strict=True)}


# ---- How planned a motion looks: feet, jolts, arms that mirror each other, limbs in the other's body
# Measures of one person on SMPL22, to be compared with those of recorded people who do the same kind of thing.
DEEP = 0.02
"""Metres that a limb may be in the other's body: soft tissue gives way as far as that."""
SLOW = 1.0
"""Hertz below which people's arms have most of their energy (Hogan and Sternad 2007 hold jerk to be set by tempo)."""
TWISTED = 60.0
"""Degrees between shoulders and hips beyond which a spine hardly turns."""
_HIPS = (SMPL22.index("left_hip"), SMPL22.index("right_hip"))
_SHOULDERS = (SMPL22.index("left_shoulder"), SMPL22.index("right_shoulder"))
_WRISTS = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]
_ARMS = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("elbow", "wrist")]
_LIMBS = ("elbow", "wrist", "knee", "ankle", "foot")


@dataclass(frozen=True)
class Naturalness:
    """The measures of one person in a scene.

    Attributes:
        standing_foot: mean speed over the floor of the foot that stands, cm/s; NaN where none does.
        jerk: 95th percentile over joints and frames of the third derivative, m/s³.
        fastest: the fastest joint at any frame, m/s.
        mirror_gap: mean distance between one wrist and the mirror image of the other, cm.
        slow_arms: share of the energy of elbows and wrists beside the pelvis under 1 Hz, 0 to 1.
        twisted: share of frames in which shoulders and hips are turned apart by more than 60°, 0 to 1.
        deep: share of frames with a limb of theirs deeper than 2 cm in the other's body, 0 to 1; NaN if alone.
    """

    standing_foot: float
    jerk: float
    fastest: float
    mirror_gap: float
    slow_arms: float
    twisted: float
    deep: float = float("nan")


def naturalness(positions: Array, fps: float, other: Array | None = None) -> Naturalness:
    """All measures of a person.

    Args:
        positions: (T, 22, 3) metres, Y up, floor at 0, T of at least 4.
        fps: frames a second.
        other: (T, 22, 3), the other person.
    """
    return Naturalness(
        standing_foot=standing_foot(positions, fps),
        jerk=jerk_percentile(positions, fps),
        fastest=float(joint_speeds(positions, fps).max()),
        mirror_gap=mirror_gap(positions),
        slow_arms=slow_arms(positions, fps),
        twisted=float((trunk_twist(positions) > TWISTED).mean()),
        deep=float("nan") if other is None else float((limb_depth(positions, other) > DEEP).mean()),
    )


def standing_foot(positions: Array, fps: float) -> float:
    """Mean speed over the floor, in cm/s, of the foot that stands: the slower one of the feet that are on the floor.

    A foot is on the floor where its toe joint is below 5 cm and its ankle joint below 12. No speed is asked of it, so
    that a foot that glides is not taken for one that swings.
    """
    low = _low_feet(positions)
    speed = np.linalg.norm(np.diff(positions[:, TOES][..., [0, 2]], axis=0), axis=-1) * fps
    slower = np.where(low[1:] & low[:-1], speed, np.inf).min(axis=1)
    slower = slower[np.isfinite(slower)]
    return float(100 * slower.mean()) if len(slower) else float("nan")


def jerk_percentile(positions: Array, fps: float) -> float:
    """The 95th percentile of the length of the third derivative over all joints and frames, in m/s³."""
    third = np.diff(positions, n=3, axis=0) * fps**3
    return float(np.percentile(np.linalg.norm(third, axis=-1), 95.0))


def joint_speeds(positions: Array, fps: float) -> Array:
    """(T - 1, J) metres a second of each joint."""
    return np.asarray(np.linalg.norm(np.diff(positions, axis=0), axis=-1) * fps)


def mirror_gap(positions: Array) -> float:
    """Mean distance in cm of one wrist from the mirror image of the other in the body's middle plane.

    The plane goes through the pelvis, upright, along the way that the hips face. Two arms that do the same at the same
    time have 0.
    """
    left = left_of(facing(positions))
    one, other = (positions[:, wrist] - positions[:, 0] for wrist in _WRISTS)
    image = other - 2 * np.sum(other * left, axis=-1, keepdims=True) * left
    return float(100 * np.linalg.norm(one - image, axis=-1).mean())


def slow_arms(positions: Array, fps: float) -> float:
    """Share of the kinetic energy of elbows and wrists, as seen from the pelvis, that is slower than 1 Hz."""
    beside = positions[:, _ARMS] - positions[:, :1]
    velocity = np.diff(beside, axis=0) * fps
    power = (np.abs(np.fft.rfft(velocity, axis=0)) ** 2).sum(axis=(1, 2))
    slow = np.fft.rfftfreq(len(velocity), 1 / fps) < SLOW
    return float(power[slow].sum() / max(power.sum(), 1e-12))


def trunk_twist(positions: Array) -> Array:
    """(T,) degrees between the line of the shoulders and that of the hips, as seen from above."""
    hips, shoulders = (positions[:, left] - positions[:, right] for left, right in (_HIPS, _SHOULDERS))
    turned = np.arctan2(hips[:, 2], hips[:, 0]) - np.arctan2(shoulders[:, 2], shoulders[:, 0])
    return np.asarray(np.degrees(np.abs(wrapped(turned))))


def limb_depth(person: Array, other: Array) -> Array:
    """(T,) metres that the forearms, upper arms, shanks, thighs and feet of a person are in the other's body.

    Hands are no part of it: hands that are held are not in each other.
    """
    return depths(person, CAPSULES.part(CAPSULES.are(*_LIMBS)), other, CAPSULES)
