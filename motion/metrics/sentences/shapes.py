"""Predicates on the shape of one body: limbs, levels and half turns, and small movements of head and shoulders."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from .joints import Array, Mask, Motion, flat, keep, predicate
from .poses import _lift, _of_side


# ---- one body ----------------------------------------------------------------------------------------------
@predicate
def hand_over_head(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is above the head joint; a named side means that hand alone."""
    return _of_side(m.pair(who, "wrist")[..., 1] > m.joint(who, "head")[:, 1], side)


@predicate
def hand_beyond_head(m: Motion, who: int) -> Mask:
    """A wrist is beyond the head, along the trunk: an arm is stretched out, of somebody who lies as well."""
    return np.any(m.of_trunk(who, m.pair(who, "wrist") - m.joint(who, "head"))[..., 1] > 0.0, axis=0)


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
    ahead = (flat(wrists - pelvis, m.forward[who]) > 0.15).all(axis=0)
    over = (wrists[..., 1] > pelvis[:, 1]).all(axis=0) & (wrists[..., 1] < m.joint(who, "head")[:, 1]).all(axis=0)
    return ahead & over & (np.linalg.norm(wrists[0] - wrists[1], axis=-1) < metres)


@predicate
def hands_ahead(m: Motion, who: int, metres: float = 0.15) -> Mask:
    """Both wrists are ``metres`` or more ahead of the pelvis, between the knees and the shoulders."""
    wrists, shoulders, knees = (m.pair(who, part) for part in ("wrist", "shoulder", "knee"))
    ahead = flat(wrists - m.joint(who, "pelvis"), m.forward[who]) > metres
    between = (wrists[..., 1] > knees[..., 1]) & (wrists[..., 1] < shoulders[..., 1])
    return np.all(ahead & between, axis=0)


@predicate
def hands_apart(m: Motion, who: int, metres: float = 0.8) -> Mask:
    """The person's wrists are ``metres`` or more apart, at any height."""
    wrists = m.pair(who, "wrist")
    return np.linalg.norm(wrists[0] - wrists[1], axis=-1) > metres


@predicate
def arm_level(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is 40 cm or more out from its shoulder, in any direction and within 25 cm of its height."""
    arm = m.pair(who, "wrist") - m.pair(who, "shoulder")
    return _of_side((np.linalg.norm(arm[..., [0, 2]], axis=-1) > 0.4) & (np.abs(arm[..., 1]) < 0.25), side)


@predicate
def knee_high(m: Motion, who: int, side: str = "any", below: float = 0.2) -> Mask:
    """A knee is no more than ``below`` metres lower than its hip while the pelvis is up."""
    drop = m.pair(who, "hip")[..., 1] - m.pair(who, "knee")[..., 1]
    return _of_side(drop < below, side) & (m.height(who) > 0.8)


_FLAT = 0.08
"""Metres of an adult's ankle over the ball of a foot that is flat on the floor."""


@predicate
def heels_up(m: Motion, who: int, rise: float = 0.04) -> Mask:
    """Both ankles are ``rise`` metres or more higher over the toes than in the person's flattest stance, or any."""
    over = m.pair(who, "ankle")[..., 1] - m.pair(who, "foot")[..., 1]
    flat = np.minimum(np.percentile(over, 10, axis=-1, keepdims=True), _FLAT * m.size(who))
    return np.all(over > flat + rise, axis=0)


@predicate
def hand_behind_back(m: Motion, who: int, side: str = "any") -> Mask:
    """A wrist is behind the pelvis, within 30 cm to its side and below the shoulders."""
    arm = m.pair(who, "wrist") - m.joint(who, "pelvis")
    below = m.pair(who, "wrist")[..., 1] < m.pair(who, "shoulder")[..., 1] - 0.1
    near = np.abs(flat(arm, m.left(who))) < 0.3
    return _of_side((flat(arm, m.forward[who]) < -0.08) & near & below, side)


@predicate
def knees_bent(m: Motion, who: int, degrees: float = 40.0, side: str = "both") -> Mask:
    """The knees are bent by ``degrees`` or more (0 is a straight leg); "any": one of them."""
    return _of_side(_knees(m, who) > degrees, side)


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
    return _of_side(np.stack([heights[0] - heights[1], heights[1] - heights[0]]) > metres, side)


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
    ahead, left, to_other = m.forward[who], m.left(who), m.towards(who)
    axes = {"forward": ahead, "back": -ahead, "left": left, "right": -left, "towards": to_other, "away": -to_other}
    return np.degrees(np.arctan2(flat(trunk, axes[way]), trunk[:, 1])) > degrees


@predicate
def turned(m: Motion, who: int, degrees: float, give: float = 40.0) -> Mask:
    """Faces ``degrees`` away, to either side and give or take ``give``, from where they first faced."""
    forward = m.forward[who]
    away = np.degrees(np.arccos(np.clip(np.sum(forward * forward[0], axis=-1), -1, 1)))
    return np.abs(away - degrees) < give


@predicate
def off_floor(m: Motion, who: int, metres: float = 0.2, seconds: float = 0.4) -> Mask:
    """Both feet are ``metres`` or more above the floor for ``seconds``: carried or lifted, not jumping."""
    lowest = m.pair(who, "foot")[..., 1].min(axis=0)
    return keep(lowest > metres, m.fps, lambda i, j: j - i >= seconds * m.fps, pause=0.05)


@predicate
def moves(m: Motion, who: int, speed: float = 0.35) -> Mask:
    """Is on the way, or moves a limb against the body, at ``speed`` m/s or more over a quarter of a second."""
    limbs = np.linalg.norm(m.limbs(who), axis=-1).max(axis=1)
    return scipy.ndimage.gaussian_filter1d(np.maximum(limbs, m.speeds[who]), 0.12 * m.fps) > speed


# ---- Small movements -------------------------------------------------------------------------------------------------
def _pitch(m: Motion, who: int) -> Array:
    """(T,) degrees by which the head leans forward, against the trunk."""
    trunk = m.joint(who, "neck") - m.joint(who, "pelvis")
    head = m.joint(who, "head") - m.joint(who, "neck")
    ahead = m.forward[who]
    angles = [np.degrees(np.arctan2(flat(part, ahead), part[:, 1])) for part in (head, trunk)]
    return angles[0] - angles[1]


def _strokes(path: Array, least: float) -> int:
    """Counts how often a path (T,) turns back after ``least`` of its unit or more."""
    return len(scipy.signal.find_peaks(path, prominence=least)[0]) + len(
        scipy.signal.find_peaks(-path, prominence=least)[0]
    )


@predicate
def nods(m: Motion, who: int, degrees: float = 6.0) -> Mask:
    """The head goes down and up again, by ``degrees`` or more against the trunk, while the pelvis stays up."""
    mask = np.zeros(m.frames, dtype=bool)
    for peak in scipy.signal.find_peaks(_pitch(m, who), prominence=degrees)[0]:
        mask[max(0, peak - round(0.15 * m.fps)) : peak + round(0.15 * m.fps) + 1] = True
    return mask & (m.height(who) > 0.8)


@predicate
def head_down(m: Motion, who: int, degrees: float = 10.0) -> Mask:
    """The head leans forward by ``degrees`` more than it mostly does, against the trunk."""
    pitch = _pitch(m, who)
    return pitch > np.percentile(pitch, 20) + degrees


@predicate
def head_up(m: Motion, who: int, degrees: float = 8.0) -> Mask:
    """The head leans back by ``degrees`` more than it mostly does, against the trunk."""
    pitch = _pitch(m, who)
    return pitch < np.percentile(pitch, 80) - degrees


@predicate
def beats(m: Motion, who: int, side: str = "any", strokes: int = 3, metres: float = 0.05, over: float = -0.6) -> Mask:
    """A hand goes to and fro ``strokes`` times within 2 s, by ``metres`` or more each time.

    Args:
        m: the motion.
        who: the person.
        side: "left", "right", "both" or "any".
        strokes: turns of the hand, two for once to and fro.
        metres: of each stroke, against the shoulder.
        over: least height of the wrist over the shoulder, metres.
    """
    masks = []
    for path, lift in zip(m.pair(who, "wrist") - m.pair(who, "shoulder"), _lift(m, who), strict=True):
        busy = np.zeros(m.frames, dtype=bool)
        for axis in path.T:
            peaks = np.sort(
                np.concatenate([scipy.signal.find_peaks(sign * axis, prominence=metres)[0] for sign in (1, -1)])
            )
            for i, j in zip(peaks, peaks[strokes - 1 :], strict=False):
                if j - i <= 2.0 * m.fps and np.all(lift[i : j + 1] > over):
                    busy[i : j + 1] = True
        masks.append(busy)
    return _of_side(np.stack(masks), side)


@predicate
def beckons(m: Motion, who: int) -> Mask:
    """A hand above the waist goes to and fro, by 6 cm or more, in a wave or a beckoning."""
    return beats(m, who, "any", 3, 0.06, -0.35)


@predicate
def palms_strike(m: Motion, who: int, metres: float = 0.2, opens: float = 0.08) -> Mask:
    """The palms strike each other above the waist: within ``metres``, and ``opens`` more apart before and after."""
    left, right = m.palms[who]
    gap = np.linalg.norm(left - right, axis=-1)
    high = m.pair(who, "wrist")[..., 1].min(axis=0) > m.joint(who, "pelvis")[:, 1] + 0.1
    mask, reach = np.zeros(m.frames, dtype=bool), round(0.4 * m.fps)
    for peak in scipy.signal.find_peaks(-gap, prominence=opens)[0]:
        around = gap[max(0, peak - reach) : peak], gap[peak + 1 : peak + reach + 1]
        if gap[peak] < metres and high[peak] and all(part.size and part.max() > gap[peak] + opens for part in around):
            mask[max(0, peak - 1) : peak + 2] = True
    return mask


@predicate
def shrugs(m: Motion, who: int, rise: float = 0.02) -> Mask:
    """Both shoulders are ``rise`` metres or more higher over the chest than they mostly are."""
    over = m.pair(who, "shoulder")[..., 1] - m.joint(who, "spine3")[:, 1]
    return np.all(over > np.percentile(over, 20, axis=-1, keepdims=True) + rise, axis=0)


@predicate
def twists(m: Motion, who: int, degrees: float = 20.0) -> Mask:
    """The line of the shoulders is turned by ``degrees`` or more against the line of the hips."""
    lines = [m.pair(who, part)[0] - m.pair(who, part)[1] for part in ("shoulder", "hip")]
    angles = [np.arctan2(line[:, 0], line[:, 2]) for line in lines]
    return np.abs(np.degrees(np.angle(np.exp(1j * (angles[0] - angles[1]))))) > degrees


@predicate
def sways(m: Motion, who: int, metres: float = 0.04, strokes: int = 2) -> Mask:
    """The trunk or the hips go to a side over the feet, ``strokes`` times by ``metres`` or more: all or none."""
    feet = m.pair(who, "ankle").mean(axis=0)
    left = m.left(who)
    aside = [flat(m.joint(who, name) - feet, left) for name in ("neck", "pelvis")]
    swung = max(_strokes(path, metres) for path in aside) >= strokes
    return np.full(m.frames, swung) & (m.speeds[who] < 0.5)


@predicate
def hands_on_hips(m: Motion, who: int, side: str = "both") -> Mask:
    """The wrists are at the sides of the waist and the elbows further out, both or of a side."""
    wrists, elbows, shoulders = (m.pair(who, part) for part in ("wrist", "elbow", "shoulder"))
    pelvis, left = m.joint(who, "pelvis"), m.left(who)
    at_waist = np.linalg.norm(wrists - pelvis, axis=-1) < 0.32
    signs = np.array([1.0, -1.0])[:, None]
    out = [signs * flat(points - pelvis, left) for points in (elbows, shoulders, wrists)]
    mask = at_waist & (out[0] > out[1] + 0.06) & (out[0] > out[2] + 0.06) & (out[2] > 0.15)
    return _of_side(mask, side)


@predicate
def legs_crossed(m: Motion, who: int) -> Mask:
    """The left ankle is on the right of the right one, for half a second or more."""
    feet = m.pair(who, "ankle")
    return keep(flat(feet[0] - feet[1], m.left(who)) < -0.02, m.fps, lambda i, j: j - i >= 0.5 * m.fps)
