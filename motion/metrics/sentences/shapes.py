"""Predicates on the shape of a body and on two bodies that move alike: limbs, levels, half turns, unison."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .joints import SIDES, Array, Motion
from .stretches import Mask, keep
from .touches import to_joints
from .vocabulary import predicate


def _side(values: Mask, side: str) -> Mask:
    """(2, T) by side to (T,): "any" either one, "both" both, "left" or "right" that one and not the other."""
    if side in ("any", "both"):
        return (np.logical_or if side == "any" else np.logical_and).reduce(values)
    own = SIDES.index(side)
    return values[own] & ~values[1 - own]


def _flat(vectors: Array, axis: Array) -> Array:
    """(…, T) metres of vectors (…, T, 3) along an axis over the floor, (T, 2)."""
    return np.sum(vectors[..., [0, 2]] * axis, axis=-1)


def _left(m: Motion, who: int) -> Array:
    """(T, 2) unit vectors to a person's left over the floor."""
    x, z = m.forward[who].T
    return np.stack([z, -x], axis=-1)


# ---- one body ----------------------------------------------------------------------------------------------
@predicate
def hand_over_head(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is above the head joint; a named side means that hand alone."""
    return _side(m.pair(who, "wrist")[..., 1] > m.joint(who, "head")[:, 1], side)


@predicate
def hand_near_floor(m: Motion, who: int, metres: float = 0.45) -> Mask:
    """A wrist is less than ``metres`` above the floor while the person does not lie flat on it."""
    flat = (m.joint(who, "head")[:, 1] < 0.35) & (m.height(who) < 0.45)
    return (m.pair(who, "wrist")[..., 1].min(axis=0) < metres) & ~flat


@predicate
def arms_wide(m: Motion, who: int, metres: float = 1.1) -> Mask:
    """Both arms out to the sides: the wrists ``metres`` apart, each within 35 cm of its shoulder's height."""
    wrists, shoulders = m.pair(who, "wrist"), m.pair(who, "shoulder")
    level = (np.abs(wrists - shoulders)[..., 1] < 0.35).all(axis=0)
    return level & (np.linalg.norm(wrists[0] - wrists[1], axis=-1) > metres)


@predicate
def arms_crossed(m: Motion, who: int, gap: float = 0.2) -> Mask:
    """Each wrist is within ``gap`` metres of the other arm's elbow."""
    wrists, elbows = m.pair(who, "wrist"), m.pair(who, "elbow")[::-1]
    return (np.linalg.norm(wrists - elbows, axis=-1) < gap).all(axis=0)


@predicate
def holds_in_front(m: Motion, who: int, metres: float = 0.45) -> Mask:
    """Both hands before the body as if on one thing: ``metres`` apart at most, above the waist and ahead of it."""
    wrists, pelvis = m.pair(who, "wrist"), m.joint(who, "pelvis")
    ahead = (_flat(wrists - pelvis, m.forward[who]) > 0.15).all(axis=0)
    over = (wrists[..., 1] > pelvis[:, 1]).all(axis=0) & (wrists[..., 1] < m.joint(who, "head")[:, 1]).all(axis=0)
    return ahead & over & (np.linalg.norm(wrists[0] - wrists[1], axis=-1) < metres)


@predicate
def hands_ahead(m: Motion, who: int, metres: float = 0.15) -> Mask:
    """Both wrists are ``metres`` or more ahead of the pelvis, between the knees and the shoulders."""
    wrists, shoulders, knees = (m.pair(who, part) for part in ("wrist", "shoulder", "knee"))
    ahead = _flat(wrists - m.joint(who, "pelvis"), m.forward[who]) > metres
    between = (wrists[..., 1] > knees[..., 1]) & (wrists[..., 1] < shoulders[..., 1])
    return np.all(ahead & between, axis=0)


@predicate
def hands_apart(m: Motion, who: int, metres: float = 0.8) -> Mask:
    """The person's wrists are ``metres`` or more apart, at any height."""
    wrists = m.pair(who, "wrist")
    return np.linalg.norm(wrists[0] - wrists[1], axis=-1) > metres


@predicate
def wrist_over_pelvis(m: Motion, who: int, metres: float = 0.3) -> Mask:
    """A wrist is ``metres`` or more above the pelvis, in any pose."""
    return np.any(m.pair(who, "wrist")[..., 1] - m.joint(who, "pelvis")[:, 1] > metres, axis=0)


@predicate
def reaches_out(m: Motion, who: int, metres: float = 0.35) -> Mask:
    """A wrist is ``metres`` or more from the pelvis towards the other, at any height."""
    arm = m.pair(who, "wrist") - m.joint(who, "pelvis")
    return np.any(_flat(arm, m.towards(who)) > metres, axis=0)


@predicate
def arm_level(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is 40 cm or more out from its shoulder, in any direction and within 25 cm of its height."""
    arm = m.pair(who, "wrist") - m.pair(who, "shoulder")
    return _side((np.linalg.norm(arm[..., [0, 2]], axis=-1) > 0.4) & (np.abs(arm[..., 1]) < 0.25), side)


@predicate
def knee_high(m: Motion, who: int, side: str = "any", below: float = 0.2) -> Mask:
    """A knee is no more than ``below`` metres lower than its hip while the pelvis is up."""
    drop = m.pair(who, "hip")[..., 1] - m.pair(who, "knee")[..., 1]
    return _side(drop < below, side) & (m.height(who) > 0.8)


@predicate
def heels_up(m: Motion, who: int, rise: float = 0.04) -> Mask:
    """Both ankles are ``rise`` metres or more higher over the toes than in the person's flattest stance."""
    over = m.pair(who, "ankle")[..., 1] - m.pair(who, "foot")[..., 1]
    return np.all(over > np.percentile(over, 10, axis=-1, keepdims=True) + rise, axis=0)


@predicate
def trunk_upright(m: Motion, who: int, degrees: float = 15.0) -> Mask:
    """The trunk is within ``degrees`` of the vertical, whatever the legs do."""
    return m.lean(who) < degrees


@predicate
def hand_behind_back(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is behind the pelvis, within 30 cm to its side and below the shoulders."""
    arm = m.pair(who, "wrist") - m.joint(who, "pelvis")
    below = m.pair(who, "wrist")[..., 1] < m.pair(who, "shoulder")[..., 1] - 0.1
    near = np.abs(_flat(arm, _left(m, who))) < 0.3
    return _side((_flat(arm, m.forward[who]) < -0.08) & near & below, side)


@predicate
def knees_bent(m: Motion, who: int, degrees: float = 40.0, side: str = "both") -> Mask:
    """The knees are bent by ``degrees`` or more (0 is a straight leg); "any": one of them."""
    return _side(_knees(m, who) > degrees, side)


def _knees(m: Motion, who: int) -> Array:
    """(2, T) degrees by which the knees are bent."""
    hip, knee, ankle = (m.pair(who, part) for part in ("hip", "knee", "ankle"))
    thigh, shin = knee - hip, ankle - knee
    lengths = np.linalg.norm(thigh, axis=-1) * np.linalg.norm(shin, axis=-1)
    return np.degrees(np.arccos(np.clip(np.sum(thigh * shin, axis=-1) / np.maximum(lengths, 1e-9), -1, 1)))


@predicate
def foot_up(m: Motion, who: int, side: str = "any", metres: float = 0.2) -> Mask:
    """An ankle is ``metres`` or more above the other one, which stands: on one leg."""
    heights = m.pair(who, "ankle")[..., 1]
    return _side(np.stack([heights[0] - heights[1], heights[1] - heights[0]]) > metres, side)


@predicate
def wide_stance(m: Motion, who: int, metres: float = 0.6) -> Mask:
    """The ankles are ``metres`` or more apart over the floor while the person hardly moves: a lunge, a straddle."""
    feet = m.pair(who, "ankle")[..., [0, 2]]
    return (np.linalg.norm(feet[0] - feet[1], axis=-1) > metres) & (m.speeds[who] < 0.5)


@predicate
def leans(m: Motion, who: int, way: str, degrees: float = 15.0) -> Mask:
    """The trunk leans by ``degrees`` or more "forward", "back", "left", "right", "towards" or "away" (of the other).

    "any" is any of them.
    """
    if way == "any":
        return m.lean(who) > degrees
    trunk = m.joint(who, "neck") - m.joint(who, "pelvis")
    ahead, left, to_other = m.forward[who], _left(m, who), m.towards(who)
    axes = {"forward": ahead, "back": -ahead, "left": left, "right": -left, "towards": to_other, "away": -to_other}
    return np.degrees(np.arctan2(_flat(trunk, axes[way]), trunk[:, 1])) > degrees


@predicate
def turned(m: Motion, who: int, degrees: float, give: float = 40.0) -> Mask:
    """Faces ``degrees`` away, to either side and give or take ``give``, from where they first faced."""
    forward = m.forward[who]
    away = np.degrees(np.arccos(np.clip(np.sum(forward * forward[0], axis=-1), -1, 1)))
    return np.abs(away - degrees) < give


@predicate
def turns_way(m: Motion, who: int, way: str, degrees: float = 60.0) -> Mask:
    """Turns by ``degrees`` or more to the "left" or "right"; to either for every other way."""
    found = np.zeros(m.frames, dtype=bool)
    for sign in {"left": (1.0,), "right": (-1.0,)}.get(way, (1.0, -1.0)):
        heading = sign * m.headings[who]
        turning = np.gradient(heading) * m.fps > 20.0
        found |= keep(turning, m.fps, lambda i, j: heading[j - 1] - heading[i] >= degrees, pause=0.4)  # noqa: B023
    return found


@predicate
def off_floor(m: Motion, who: int, metres: float = 0.2, seconds: float = 0.4) -> Mask:
    """Both feet are ``metres`` or more above the floor for ``seconds``: carried or lifted, not jumping."""
    lowest = m.pair(who, "foot")[..., 1].min(axis=0)
    return keep(lowest > metres, m.fps, lambda i, j: j - i >= seconds * m.fps, pause=0.05)


@predicate
def goes_at(m: Motion, who: int, least: float, most: float, metres: float = 0.6) -> Mask:
    """On the way for ``metres`` at a speed between ``least`` and ``most`` metres a second."""
    speed = m.speeds[who]
    return keep((speed > least) & (speed < most), m.fps, lambda i, j: speed[i:j].sum() / m.fps >= metres)


@predicate
def goes_ahead(m: Motion, who: int, metres: float = 0.5) -> Mask:
    """Goes the way they face, by ``metres`` or more."""
    rate = np.sum(m.velocities[who] * m.forward[who], axis=-1)
    return keep(rate > 0.15, m.fps, lambda i, j: rate[i:j].sum() / m.fps >= metres)


@predicate
def moves(m: Motion, who: int, speed: float = 0.35) -> Mask:
    """Is on the way, or moves a limb against the body, at ``speed`` m/s or more over a quarter of a second."""
    limbs = np.linalg.norm(_limbs(m, who, False), axis=-1).max(axis=1)
    return gaussian_filter1d(np.maximum(limbs, m.speeds[who]), 0.12 * m.fps) > speed


# ---- two bodies --------------------------------------------------------------------------------------------
@predicate
def higher(m: Motion, who: int, metres: float = 0.25) -> Mask:
    """The person's head is ``metres`` or more above the other's."""
    return m.joint(who, "head")[:, 1] - m.joint(1 - who, "head")[:, 1] > metres


@predicate
def back_to_back(m: Motion, metres: float = 0.7) -> Mask:
    """Both face away from each other, ``metres`` apart at most."""
    return (m.off(0) > 120) & (m.off(1) > 120) & (m.distance < metres)


@predicate
def in_front(m: Motion, who: int, degrees: float = 60.0) -> Mask:
    """Is where the other faces, give or take ``degrees``."""
    return m.off(1 - who) < degrees


@predicate
def at_others_start(m: Motion, who: int, metres: float = 0.7) -> Mask:
    """Is within ``metres`` of where the other began, and further from where they themselves began."""
    there = np.linalg.norm(m.roots[who] - m.roots[1 - who][0], axis=-1)
    home = np.linalg.norm(m.roots[who] - m.roots[who][0], axis=-1)
    return (there < metres) & (home > there)


@predicate
def arm_on(m: Motion, who: int, part: str, gap: float = 0.22) -> Mask:
    """An elbow, wrist or palm is on a part of the other's body."""
    arms = np.concatenate([m.hands(who), m.pair(who, "elbow")])
    return to_joints(m, arms, 1 - who, part).min(axis=0) < gap


@predicate
def feet_near(m: Motion, metres: float = 0.3) -> Mask:
    """A foot of one is within ``metres`` of a foot of the other."""
    feet = [m.pair(who, "foot") for who in (0, 1)]
    return np.linalg.norm(feet[0][:, None] - feet[1][None], axis=-1).min(axis=(0, 1)) < metres


@predicate
def shoulders_touch(m: Motion, gap: float = 0.25) -> Mask:
    """A shoulder of one is within ``gap`` metres of a shoulder of the other, or a back of the other's back."""
    shoulders = [m.pair(who, "shoulder") for who in (0, 1)]
    near = np.linalg.norm(shoulders[0][:, None] - shoulders[1][None], axis=-1).min(axis=(0, 1))
    backs = np.linalg.norm(m.joint(0, "spine3") - m.joint(1, "spine3"), axis=-1)
    return np.minimum(near, backs) < gap


_LIMBS = ("wrist", "elbow", "knee", "ankle")


def _limbs(m: Motion, who: int, mirrored: bool) -> Array:
    """(T, 8, 3) velocities of the limbs in the body's own frame (left, up, ahead), m/s; sides swapped if mirrored."""
    order = SIDES[::-1] if mirrored else SIDES
    points = np.stack([m.joint(who, f"{side}_{part}") for part in _LIMBS for side in order])
    points = points - m.joint(who, "pelvis") * [1, 0, 1]
    left = _flat(points, _left(m, who)) * (-1 if mirrored else 1)
    local = np.stack([left, points[..., 1], _flat(points, m.forward[who])], axis=-1)
    return gaussian_filter1d(np.gradient(local, axis=1), 0.1 * m.fps, axis=1).swapaxes(0, 1) * m.fps


@predicate
def alike(m: Motion, mirrored: bool = False, lag: float = 0.0, least: float = 0.55) -> Mask:
    """Both move their limbs the same way at once, or b ``lag`` seconds after a.

    The limbs' velocities, each in its own body's frame, have a cosine of ``least`` or more over about a second, and
    both move. With ``mirrored`` a's left is compared with b's right.
    """
    first, second = _limbs(m, 0, mirrored), _limbs(m, 1, False)
    shift = round(lag * m.fps)
    if abs(shift) >= m.frames:
        return np.zeros(m.frames, dtype=bool)
    first = np.roll(first, shift, axis=0)

    def over(values: Array) -> Array:
        return gaussian_filter1d(values.sum(axis=(1, 2)), 0.3 * m.fps, mode="nearest")

    energies = over(first**2), over(second**2)
    cos = over(first * second) / np.sqrt(np.maximum(energies[0] * energies[1], 1e-12))
    mask = (cos > least) & (np.minimum(*energies) > 0.15)
    mask[: max(shift, 0)] = False
    mask[m.frames + min(shift, 0) :] = False
    return keep(mask, m.fps, lambda i, j: j - i >= 0.5 * m.fps, pause=0.1)


@predicate
def copies(m: Motion, who: int, least: float = 0.55) -> Mask:
    """Moves as the other did 0.4 to 2 s before, on the same side or mirrored."""
    sign = 1.0 if who == 1 else -1.0
    found = np.zeros(m.frames, dtype=bool)
    for lag in np.arange(0.4, 2.01, 0.2):
        for mirrored in (False, True):
            found |= alike(m, mirrored, sign * lag, least)
    return found
