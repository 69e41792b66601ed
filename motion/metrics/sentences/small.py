"""Predicates on small movements of one body: the head, the shoulders, a twist, a sway, hands on the hips."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from .joints import Array, Motion
from .poses import _lift, _of_side
from .shapes import _flat, _left
from .stretches import Mask, keep
from .vocabulary import predicate


def _pitch(m: Motion, who: int) -> Array:
    """(T,) degrees by which the head leans forward, against the trunk."""
    trunk = m.joint(who, "neck") - m.joint(who, "pelvis")
    head = m.joint(who, "head") - m.joint(who, "neck")
    ahead = m.forward[who]
    angles = [np.degrees(np.arctan2(_flat(part, ahead), part[:, 1])) for part in (head, trunk)]
    return angles[0] - angles[1]


def _strokes(path: Array, least: float) -> int:
    """Counts how often a path (T,) turns back after ``least`` of its unit or more."""
    return len(scipy.signal.find_peaks(path, prominence=least)[0]) + len(
        scipy.signal.find_peaks(-path, prominence=least)[0]
    )


@predicate
def nods(m: Motion, who: int, degrees: float = 6.0) -> Mask:
    """The head goes down and up again, by ``degrees`` or more against the trunk, while the pelvis stays up."""
    found = np.zeros(m.frames, dtype=bool)
    for peak in scipy.signal.find_peaks(_pitch(m, who), prominence=degrees)[0]:
        found[max(0, peak - round(0.15 * m.fps)) : peak + round(0.15 * m.fps) + 1] = True
    return found & (m.height(who) > 0.8)


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
def head_aside(m: Motion, who: int, degrees: float = 10.0) -> Mask:
    """The head leans to a side by ``degrees`` more than it mostly does, against the trunk."""
    left = _left(m, who)
    parts = (m.joint(who, "head") - m.joint(who, "neck"), m.joint(who, "neck") - m.joint(who, "pelvis"))
    angles = [np.degrees(np.arctan2(_flat(part, left), part[:, 1])) for part in parts]
    aside = angles[0] - angles[1]
    return np.abs(aside - np.median(aside)) > degrees


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
    found = []
    for path, lift in zip(m.pair(who, "wrist") - m.pair(who, "shoulder"), _lift(m, who), strict=True):
        busy = np.zeros(m.frames, dtype=bool)
        for axis in path.T:
            peaks = np.sort(
                np.concatenate([scipy.signal.find_peaks(sign * axis, prominence=metres)[0] for sign in (1, -1)])
            )
            for i, j in zip(peaks, peaks[strokes - 1 :], strict=False):
                if j - i <= 2.0 * m.fps and np.all(lift[i : j + 1] > over):
                    busy[i : j + 1] = True
        found.append(busy)
    return _of_side(np.stack(found), side)


@predicate
def palms_strike(m: Motion, who: int, metres: float = 0.2, opens: float = 0.05) -> Mask:
    """The palms of one person strike each other: within ``metres``, and ``opens`` more apart just before and after."""
    left, right = m.palms[who]
    gap = np.linalg.norm(left - right, axis=-1)
    found = np.zeros(m.frames, dtype=bool)
    for peak in scipy.signal.find_peaks(-gap, prominence=opens)[0]:
        reach = round(0.5 * m.fps)
        around = gap[max(0, peak - reach) : peak], gap[peak + 1 : peak + reach + 1]
        if gap[peak] < metres and all(part.size and part.max() > gap[peak] + opens for part in around):
            found[max(0, peak - 1) : peak + 2] = True
    return found


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
    left = _left(m, who)
    aside = [_flat(m.joint(who, name) - feet, left) for name in ("neck", "pelvis")]
    swung = max(_strokes(path, metres) for path in aside) >= strokes
    return np.full(m.frames, swung) & (m.speeds[who] < 0.5)


@predicate
def hands_on_hips(m: Motion, who: int, side: str = "both") -> Mask:
    """The wrists are at the sides of the waist and the elbows further out; "any": one of them."""
    wrists, elbows, shoulders = (m.pair(who, part) for part in ("wrist", "elbow", "shoulder"))
    pelvis, left = m.joint(who, "pelvis"), _left(m, who)
    at_waist = np.linalg.norm(wrists - pelvis, axis=-1) < 0.32
    signs = np.array([1.0, -1.0])[:, None]
    out = [signs * _flat(points - pelvis, left) for points in (elbows, shoulders, wrists)]
    mask = at_waist & (out[0] > out[1] + 0.06) & (out[0] > out[2] + 0.06) & (out[2] > 0.15)
    return np.any(mask, axis=0) if side == "any" else np.all(mask, axis=0)


@predicate
def legs_crossed(m: Motion, who: int) -> Mask:
    """The left ankle is on the right of the right one, for half a second or more."""
    feet = m.pair(who, "ankle")
    return keep(_flat(feet[0] - feet[1], _left(m, who)) < -0.02, m.fps, lambda i, j: j - i >= 0.5 * m.fps)
