"""Whole arms of people who gesture: from where they hang to where a gesture has the hand, and down again.

A wrist alone leaves the elbow to a network that has seldom seen the gesture, and which then raises the upper arm before
the face, lifts the other arm along or has the hand up from the first frame. So both bones are given: the elbow is below
the hand and out to the side, or where the gesture needs it, and the bones turn from where the arm was.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.cleaning import solve_two_bones
from motion.easing import minimum_jerk
from motion.vectors import unit

from .gestures import Gesture, Hand, wrist
from .poses import upright

Array = NDArray[np.floating]

BEGINS, RISES = 0.25, 0.8
"""Seconds after which an arm begins to rise, and those that it takes."""
_UNHURRIED = 3.5
"""Seconds of a beat from which an arm takes its time; in shorter ones it is up sooner."""
_LAG = 0.07
"""Seconds by which the left of two hands is later than the right one."""
_FALLS, _RESTS = 0.9, 0.15
"""Seconds in which a hand sinks again, and those of a beat that are left then."""
_SHOWS = 1.0
"""Seconds for which a hand is up that sinks again, at least."""
PASSING = (Hand.WAVES, Hand.BECKONS, Hand.SALUTES, Hand.CLAPS)
"""Gestures after which hands sink again; others are held as long as the beat lasts."""
_HANGS = 0.25
"""Metres of a wrist below its shoulder from which an arm hangs."""
_OVER = np.array([[0.0, 0.0, 0.4], [0.0, 0.0, 1.0]])
"""Upper arm and forearm: how far ahead the direction is over which they turn by half a circle."""
_DRIFT = 0.012
"""Metres by which a held hand wanders."""
_UNEVEN = 0.025
"""Metres by which the right of two hands in the air is higher than the left."""
_IN_THE_AIR = (Hand.HIGH, Hand.UP, Hand.AHEAD, Hand.SPREAD, Hand.WAVES)
_POLE = (0.4, -1.0, -0.2)
"""Outwards, up and ahead: where the elbow is beside the line from shoulder to wrist. It hangs."""
_POLES = {
    Hand.SALUTES: (1.0, -0.25, 0.0),
    Hand.HIPS: (1.0, 0.0, -0.5),
    Hand.BEHIND: (1.0, -0.2, -0.6),
    Hand.HEAD: (1.0, 0.1, 0.3),
    Hand.HIGH: (1.0, -0.3, 0.4),
    Hand.UP: (0.8, -0.8, 0.3),
    Hand.EARS: (0.9, -1.0, 0.2),
    Hand.EYES: (0.7, -1.0, 0.1),
    Hand.PHOTO: (0.7, -1.0, 0.1),
    Hand.PHONE: (0.6, -1.0, 0.3),
    Hand.WAVES: (0.5, -1.0, 0.0),
    Hand.CROSSED: (0.6, -1.0, 0.0),
    Hand.CONDUCTS: (0.9, -0.8, 0.0),
    Hand.BRUSHES: (0.8, -0.8, 0.0),
    Hand.DRUMS: (0.7, -1.0, -0.2),
    Hand.COMBS: (1.0, -0.4, 0.2),
    Hand.BEATS: (1.0, -0.5, 0.0),
    Hand.BENDS: (0.3, -1.0, 0.1),
    Hand.PRAYS: (0.7, -1.0, -0.1),
    Hand.OFFERS: (0.25, -1.0, -0.2),
    Hand.CHEST: (0.6, -1.0, -0.1),
}


def arm(gesture: Gesture, side: str, seconds: Array, length: float, towards: Array, before: Array) -> Array:
    """The elbow and the wrist of a hand that makes a gesture, beside the pelvis of a person who faces +Z.

    Args:
        gesture: the gesture.
        side: "left" or "right".
        seconds: (N,) moments since the hand is free to begin.
        length: seconds until it is over; hands that sink again have sunk then.
        towards: (N, 3) unit directions to the other person.
        before: (2, 3) directions of the upper arm and the forearm before it begins.

    Returns:
        (N, 2, 3) metres from the pelvis.
    """
    seconds = np.asarray(seconds, dtype=float)
    out = 1.0 if side == "left" else -1.0
    goal = wrist(gesture, side, seconds, towards)
    goal += _wandering(seconds, out)
    late = 0.0
    if len(gesture.sides) == 2:
        late = _LAG if side == "left" else 0.0
        goal[:, 1] -= out * _UNEVEN if gesture.hand in _IN_THE_AIR else 0.0
    pace = float(np.clip(length / _UNHURRIED, 0.6, 1.0))
    up = minimum_jerk((seconds / pace - BEGINS - late) / RISES)
    if gesture.hand in PASSING and length > BEGINS + RISES + _SHOWS + _FALLS + _RESTS:
        down = minimum_jerk((seconds - length + _RESTS + _FALLS - late) / _FALLS)
        return _turned(_directions(side, goal, gesture.hand), np.asarray(before), up, down, side)
    return _turned(_directions(side, goal, gesture.hand), np.asarray(before), up, 0.0 * up, side)


def hanging(side: str) -> Array:
    """(2, 3) directions of the upper arm and the forearm of an arm that hangs, of a person who faces +Z."""
    return directions(upright(np.zeros(2), 0.0), side)


def raised(side: str) -> Array:
    """(2, 3) directions of the upper arm and the forearm of an arm that is up, of a person who faces +Z."""
    out = 1.0 if side == "left" else -1.0
    return np.asarray(unit(np.array([[0.35 * out, 0.8, 0.35], [0.1 * out, 1.0, 0.1]])))


def directions(poses: Array, side: str) -> Array:
    """(…, 2, 3) directions of the upper arm and the forearm in poses (…, 22, 3)."""
    shoulder, elbow, hand = (poses[..., SMPL22.index(f"{side}_{j}"), :] for j in ("shoulder", "elbow", "wrist"))
    return np.stack([unit(elbow - shoulder), unit(hand - elbow)], axis=-2)


def hangs(arm: Array) -> bool:
    """True for an arm that hangs, by the directions (2, 3) of its bones."""
    lengths = [SMPL22.bone_lengths[SMPL22.index(f"left_{joint}")] for joint in ("elbow", "wrist")]
    return float(np.dot(lengths, np.asarray(arm)[:, 1])) < -_HANGS


def rested(side: str, seconds: Array, before: Array) -> Array:
    """The elbow and the wrist (N, 2, 3) of an arm that goes on hanging; see :func:`arm`."""
    up = minimum_jerk((np.asarray(seconds) - BEGINS) / RISES)
    return _turned(np.broadcast_to(hanging(side), (len(up), 2, 3)), np.asarray(before), up, 0.0 * up, side)


def _wandering(seconds: Array, out: float) -> Array:
    """(N, 3) metres of a hand that is held still, as far as people do; each hand in its own time."""
    turn = 2 * np.pi * seconds
    waves = [np.sin(turn / period + out * phase) for period, phase in ((3.1, 0.4), (3.7, 1.1), (4.3, 2.0))]
    return _DRIFT * np.stack(waves, axis=-1)


def _shoulder(side: str) -> Array:
    pose = upright(np.zeros(2), 0.0)
    return np.asarray(pose[SMPL22.index(f"{side}_shoulder")] - pose[0])


def _directions(side: str, goal: Array, hand: Hand) -> Array:
    """(N, 2, 3) directions of an arm's bones whose wrist is at its goal (N, 3) beside the pelvis."""
    out = 1.0 if side == "left" else -1.0
    shoulder = np.broadcast_to(_shoulder(side), goal.shape)
    upper, lower = (SMPL22.bone_lengths[SMPL22.index(f"{side}_{joint}")] for joint in ("elbow", "wrist"))
    along = unit(goal - shoulder)
    pole = np.broadcast_to(unit(np.array(_POLES.get(hand, _POLE)) * [out, 1.0, 1.0]), goal.shape)
    elbow, end = solve_two_bones(
        shoulder, shoulder + upper * along, shoulder + (upper + lower) * along, goal, pole, soft=0.02
    )
    return np.stack([unit(elbow - shoulder), unit(end - elbow)], axis=1)


def _turned(goal: Array, before: Array, up: Array, down: Array, side: str) -> Array:
    """(N, 2, 3) elbow and wrist of an arm whose bones turn from before (2, 3) to their goal, and then hang again.

    They go round in front: along a curve of Bézier's on the sphere, over a direction that is the farther ahead, the
    more a bone has to turn (Shoemake 1985, "Animating rotation with quaternion curves").
    """
    share = (up * (1 - down))[:, None, None]
    rest = np.where((down > 0)[:, None, None], hanging(side), before)
    turned = (1 - np.sum(rest * goal, axis=-1, keepdims=True)) / 2
    over = unit((rest + goal) / 2 + turned * _OVER)
    bones = _between(_between(rest, over, share), _between(over, goal, share), share)
    upper, lower = (SMPL22.bone_lengths[SMPL22.index(f"{side}_{joint}")] for joint in ("elbow", "wrist"))
    elbow = _shoulder(side) + upper * bones[:, 0]
    return np.stack([elbow, elbow + lower * bones[:, 1]], axis=1)


def _between(first: Array, second: Array, share: Array) -> Array:
    """Directions (…, 3) on the great circle from the first to the second ones."""
    angle = np.arccos(np.clip(np.sum(first * second, axis=-1, keepdims=True), -1.0, 1.0))
    sine = np.maximum(np.sin(angle), 1e-6)
    near = angle < 1e-4
    own, theirs = (np.where(near, each, np.sin(each * angle) / sine) for each in (1 - share, share))
    return unit(own * first + theirs * second)
