"""Predicates on poses: the body's height, the arms and the legs."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.skeleton import SIDES

from .joints import Array, Mask, Motion, flat, keep, predicate


# ---- the body's height -----------------------------------------------------------------------------------
@predicate
def upright(m: Motion, who: int) -> Mask:
    """On their feet: the pelvis within a tenth of its standing height, the trunk within 35° of vertical."""
    return (m.height(who) > 0.88) & (m.lean(who) < 35)


@predicate
def low(m: Motion, who: int, share: float = 0.75) -> Mask:
    """The pelvis is below a share of its standing height: sitting, kneeling, squatting or lying."""
    return m.height(who) < share


@predicate
def sits(m: Motion, who: int) -> Mask:
    """The pelvis is low, the thighs are level or drawn up, the trunk is upright; on a seat or the floor."""
    hips, knees = m.pair(who, "hip")[..., 1], m.pair(who, "knee")[..., 1]
    return low(m, who) & ((hips - knees).mean(axis=0) < 0.25) & (m.lean(who) < 50)


@predicate
def kneels(m: Motion, who: int) -> Mask:
    """A knee on the floor and no further behind the hips than in a kneel, the pelvis low, the head over it."""
    knees = m.pair(who, "knee")
    behind = flat(m.joint(who, "pelvis") - knees, m.forward[who])
    down = ((knees[..., 1] < 0.16) & (behind < 0.2)).any(axis=0)
    return down & (m.height(who) < 0.82) & (m.joint(who, "head")[:, 1] > 0.6)


@predicate
def lies(m: Motion, who: int) -> Mask:
    """Head and pelvis are near the floor."""
    return (m.joint(who, "head")[:, 1] < 0.5) & (m.height(who) < 0.45)


@predicate
def falls(m: Motion, who: int) -> Mask:
    """Down on the floor, on seat, hands and knees or flat: the pelvis below half its height."""
    return low(m, who, 0.48)


@predicate
def bows(m: Motion, who: int, drop: float = 0.15) -> Mask:
    """The trunk leans forward, the more the deeper, and the head drops by ``drop`` while the pelvis stays up."""
    trunk = (m.joint(who, "neck") - m.joint(who, "pelvis"))[:, [0, 2]]
    ahead = np.sum(trunk * m.forward[who], axis=-1) > 0.15
    leans = m.lean(who) > max(20.0, 140.0 * drop)
    return ahead & leans & (m.drop(who) > drop) & (m.height(who) > 0.8)


@predicate
def ducks(m: Motion, who: int, drop: float = 0.15) -> Mask:
    """The head is ``drop`` or more below where it mostly is, by the knees or the trunk."""
    return m.drop(who) > drop


@predicate
def jumps(m: Motion, who: int, rise: float = 0.06) -> Mask:
    """Both feet are ``rise`` or more above where they stand, for a tenth of a second."""
    lowest = m.pair(who, "foot")[..., 1].min(axis=0)
    air = lowest > np.percentile(lowest, 10) + rise
    return keep(air & (m.height(who) > 0.8), m.fps, lambda i, j: j - i >= 0.1 * m.fps, pause=0.05)


@predicate
def hops(m: Motion, who: int, rise: float = 0.05) -> Mask:
    """One of two or more moments at which no foot is on the floor: the pelvis goes up and down by ``rise`` in each."""
    feet = np.minimum(m.pair(who, "foot")[..., 1].min(axis=0), m.pair(who, "ankle")[..., 1].min(axis=0) - 0.06)
    up = feet > np.percentile(feet, 10) + 0.03
    bobs = scipy.signal.find_peaks(m.joint(who, "pelvis")[:, 1], prominence=rise)[0]
    mask = np.zeros(m.frames, dtype=bool)
    reach = round(0.2 * m.fps)
    for peak in bobs:
        mask[max(0, peak - reach) : peak + reach + 1] = up[max(0, peak - reach) : peak + reach + 1].any()
    return mask


@predicate
def inverted(m: Motion, who: int) -> Mask:
    """Upside down: both ankles are higher than the head."""
    return m.pair(who, "ankle")[..., 1].min(axis=0) > m.joint(who, "head")[:, 1]


@predicate
def limps(m: Motion, who: int, share: float = 0.25) -> Mask:
    """Walks with one foot lifted less than ``1 - share`` of the other's height, or bobs with every other step."""
    going = keep(m.speeds[who] > 0.2, m.fps, lambda i, j: m.speeds[who][i:j].sum() / m.fps >= 0.6, pause=0.4)
    if not going.any():
        return going
    lifts = np.ptp(m.pair(who, "ankle")[:, going, 1], axis=1)
    return going & bool(lifts.min() < (1.0 - share) * lifts.max())


# ---- arms ------------------------------------------------------------------------------------------------
def _lift(m: Motion, who: int) -> Array:
    """(2, T) metres of the left and right wrist over their shoulder."""
    return m.pair(who, "wrist")[..., 1] - m.pair(who, "shoulder")[..., 1]


def _wrist_speed(m: Motion, who: int) -> Array:
    """(2, T) speed of the wrists relative to their shoulders."""
    relative = m.pair(who, "wrist") - m.pair(who, "shoulder")
    return np.linalg.norm(np.gradient(relative, axis=1), axis=-1) * m.fps


def _of_side(values: Mask, side: str) -> Mask:
    """(2, T) by side to (T,): "any" one of them, "both" both, "left" and "right" that one and no other."""
    if side == "any":
        return np.logical_or.reduce(values)
    if side == "both":
        return np.logical_and.reduce(values)
    own = SIDES.index(side)
    return values[own] & ~values[1 - own]


@predicate
def hand_up(m: Motion, who: int, side: str = "any", over: float = -0.1) -> Mask:
    """A wrist is at least ``over`` above the shoulder; a named side means that hand alone."""
    return _of_side(_lift(m, who) > over, side)


@predicate
def hands_high(m: Motion, who: int) -> Mask:
    """Both wrists are above the head joint."""
    return np.logical_and.reduce(m.pair(who, "wrist")[..., 1] > m.joint(who, "head")[:, 1])


@predicate
def arms_down(m: Motion, who: int) -> Mask:
    """Both wrists hang 25 cm or more below the shoulders."""
    return np.logical_and.reduce(_lift(m, who) < -0.25)


@predicate
def waves(m: Motion, who: int, side: str = "any", travel: float = 0.3) -> Mask:
    """A raised hand that moves to and fro: its wrist travels ``travel`` or more relative to the shoulder."""
    raised, speed = _lift(m, who) > -0.1, _wrist_speed(m, who)

    def wave(own_raised: Mask, own_speed: Array) -> Mask:
        return keep(own_raised, m.fps, lambda i, j: float(own_speed[i:j].sum()) / m.fps > travel)

    return _of_side(np.stack([wave(raised[i], speed[i]) for i in (0, 1)]), side)


@predicate
def talks(m: Motion, who: int, over: float = 0.06) -> Mask:
    """Gestures: a hand that moves ``over`` above the pelvis or higher, for half a second or more.

    Arms that swing in a walk pass 0.06; 0.2 leaves out nine walks of ten.
    """
    over_waist = m.pair(who, "wrist")[..., 1] > m.joint(who, "pelvis")[:, 1] + over
    busy = _wrist_speed(m, who) > 0.2
    mask = np.logical_or.reduce(over_waist & busy)
    return keep(mask, m.fps, lambda i, j: j - i >= 0.5 * m.fps, pause=0.4)


def _reach(m: Motion, who: int) -> Array:
    """(2, T) metres by which the wrists are held out from the shoulders towards the other, at an adult's size."""
    arm = (m.pair(who, "wrist") - m.pair(who, "shoulder"))[..., [0, 2]]
    return np.sum(arm * m.towards(who), axis=-1) / m.size(who)


@predicate
def reaches(m: Motion, who: int, side: str = "any", metres: float = 0.3) -> Mask:
    """Holds out a hand towards the other, at the height of the waist or above."""
    over_waist = m.pair(who, "wrist")[..., 1] > m.joint(who, "pelvis")[:, 1] + 0.02
    return _of_side((_reach(m, who) > metres) & over_waist, side)


@predicate
def offers(m: Motion, who: int, side: str = "any") -> Mask:
    """Stands within three steps of the other, looks at them and holds a hand out, no higher than the shoulder."""
    over_waist = m.pair(who, "wrist")[..., 1] > m.joint(who, "pelvis")[:, 1] + 0.02
    held = (_reach(m, who) > 0.3) & over_waist & (_lift(m, who) < 0.05) & _still(m, who)
    return _held_before_other(m, who, _of_side(held, side))


@predicate
def holds_up(m: Motion, who: int, side: str = "any") -> Mask:
    """Stands within three steps of the other, looks at them and holds a hand up, above the shoulder."""
    return _held_before_other(m, who, _of_side((_lift(m, who) > 0.0) & _still(m, who), side))


def _still(m: Motion, who: int) -> Mask:
    """(2, T) whether the left and the right hand hardly move."""
    return scipy.ndimage.gaussian_filter1d(_wrist_speed(m, who), 0.1 * m.fps, axis=-1) < 0.4


def _held_before_other(m: Motion, who: int, hand: Mask) -> Mask:
    ready = (m.speeds[who] < 0.25) & (m.off(who) < 50) & (m.distance < 2.0)
    return keep(hand & ready, m.fps, lambda i, j: j - i >= 0.4 * m.fps, pause=0.1)


@predicate
def points(m: Motion, who: int, side: str = "any") -> Mask:
    """Holds an arm out towards the other, nearly straight and nearly level."""
    return _of_side((_reach(m, who) > 0.38) & (_lift(m, who) > -0.3), side)


@predicate
def strikes(m: Motion, who: int, side: str = "any", speed: float = 2.5) -> Mask:
    """A hand shoots out towards the other: a punch, a shove or a throw."""
    near = np.ones(2 * round(0.3 * m.fps) + 1)  # frames before and after
    fast = np.stack([np.convolve(s > speed, near, mode="same") > 0.5 for s in _wrist_speed(m, who)])
    return _of_side((_reach(m, who) > 0.33) & (_lift(m, who) > -0.35) & fast, side)


@predicate
def kicks(m: Motion, who: int, side: str = "any") -> Mask:
    """A foot is swung up towards the other, 30 cm or more off the floor."""
    leg = m.pair(who, "ankle") - m.pair(who, "hip")
    ahead = np.sum(leg[..., [0, 2]] * m.towards(who), axis=-1) > 0.3
    return _of_side(ahead & (m.pair(who, "ankle")[..., 1] > 0.3), side)


@predicate
def claps(m: Motion, who: int, metres: float = 0.2) -> Mask:
    """The two palms of one person meet in front of them."""
    left, right = m.palms[who]
    over_waist = m.pair(who, "wrist")[..., 1].min(axis=0) > m.joint(who, "pelvis")[:, 1]
    return (np.linalg.norm(left - right, axis=-1) < metres) & over_waist
