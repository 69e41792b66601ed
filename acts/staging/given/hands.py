"""The arms of people whose way or posture the words of a beat give, as the network is given them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22
from motion.transforms import heading, heading_matrix

from ..bodies.arm_course import arm, directions, hanging, hangs, raised, rested
from ..bodies.gestures import AT_OTHER, SIDES, Gesture, Hand, wrist
from ..moves import Move
from ..parts import KnownFrames
from ..sampled import Way2D
from ..told import Told
from ..ways import Way
from .postures import UPRIGHT
from .stretch import Frames, Stretch

Array = NDArray[np.floating]

BEGINS = 15
"""Frames of a beat before a hand is given."""
OFTEN = 4
"""Frames between two given places of a hand."""
LATE = 0.4
"""Seconds by which somebody begins a gesture later than they could, at most."""
SHORT = 120
"""Frames of a beat in which they begin sooner."""
IN_TIME = (Hand.FLAPS, Hand.CIRCLES, Hand.SWINGS)
"""Gestures that two people make in one time."""
SELDOM = 15
"""Frames between two given places of a hand that hangs."""
ARRIVED = 0.15
"""Metres from where a person stays, at most, at which their hands begin with a thing."""


def hands(
    told: Told,
    moves: Sequence[Move],
    posed: Mapping[int, Array],
    stretch: Stretch,
    before: Array | None = None,
    seed: int = 0,
) -> Iterator[KnownFrames]:
    """The gestures of those whose way or posture is given, and their other arm where they stand.

    Args:
        told: by the beat.
        moves: of the beat, where they were changed since.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stretch: the beat.
        before: (2, 22, 3) the people before the beat; None where it is the first.
        seed: draws how late each of them is.
    """
    found = dict(told.gestures)
    if _linked(moves):
        around = {who for who, gesture in found.items() if gesture.hand is Hand.AROUND}
        for who, side in _inner(stretch.ways).items():
            if who in around or not around:
                found[who] = Gesture(Hand.AROUND if around else Hand.LINKED, (side,))
    ways = {("ab".index(move.person), move.way) for move in moves}
    for person in (0, 1):
        gesture = found.get("ab"[person])
        if gesture is None or not (person in stretch.ways or person in posed):
            continue  # the network makes the gesture
        begins = 0 if person in posed and person not in stretch.ways else BEGINS
        at: Frames = np.arange(begins, stretch.frames, OFTEN)
        if (person, Way.THING) in ways and len(at):
            at = _there(stretch.course(person).places, at)
        if not len(at):
            continue
        own = None if before is None else before[person]
        free = person in posed and posed[person][0, 1] > UPRIGHT and person not in stretch.ways
        both = free and not (told.contact or told.joined)
        late = 0.0 if gesture.hand in IN_TIME else late_by(seed, person) * min(1.0, stretch.frames / SHORT)
        joints, places = _arms(gesture, person, at, stretch, own, both=both, late=late)
        if len(shown := np.isin(at, stretch.shown(at)).nonzero()[0]):
            yield _given(person, joints, at[shown], places[shown], stretch)


def outer_hands(told: Told, moves: Sequence[Move], stretch: Stretch) -> Iterator[KnownFrames]:
    """The other hands of two who walk hand in hand: they hang, but for a gesture.

    They are given now and then only, so that the arms swing.
    """
    at = stretch.shown(np.arange(0, stretch.frames, SELDOM))
    for who, side in _inner(stretch.ways).items() if _linked(moves) and len(at) else ():
        if who in told.gestures:
            continue
        person, outer = "ab".index(who), "right" if side == "left" else "left"
        turns = np.stack([heading_matrix(angle) for angle in stretch.course(person).headings[at]])
        places = wrist(Gesture(Hand.LINKED, (outer,)), outer, at / FPS, np.zeros((len(at), 3)))
        joints = [SMPL22.index(f"{outer}_wrist")]
        yield _given(person, joints, at, np.einsum("nij,nj->ni", turns, places)[:, None], stretch)


def _linked(moves: Sequence[Move]) -> bool:
    """True for two who walk side by side and hold each other."""
    return {move.way for move in moves if move.linked} == {Way.ALONG}


def _arms(
    gesture: Gesture, person: int, at: Frames, stretch: Stretch, before: Array | None, *, both: bool, late: float
) -> tuple[list[int], Array]:
    """Joints of a person's arms and their places (N, joints, 3) beside the pelvis in the scene's world.

    Args:
        gesture: the gesture.
        person: 0 or 1.
        at: (N,) frames of the beat.
        stretch: the beat.
        before: (22, 3) the person before the beat; None where it is the first.
        both: an arm that does nothing is given as well, if it hangs.
        late: seconds by which they are late.
    """
    own, other = stretch.course(person), stretch.course(1 - person)
    turns = np.stack([heading_matrix(angle) for angle in own.headings[at]])
    line = np.insert(other.places[at] - own.places[at], 1, 0.0, axis=1)
    line /= np.linalg.norm(line, axis=1, keepdims=True).clip(min=1e-6)
    towards = np.einsum("nji,nj->ni", turns, line)
    joints, places = list[int](), list[Array]()
    start = max(int(at[0]) - BEGINS, 0)
    seconds, length = (at - start) / FPS - late, (stretch.frames - start) / FPS - late
    for side in SIDES:
        wrist_joint, elbow_joint = SMPL22.index(f"{side}_wrist"), SMPL22.index(f"{side}_elbow")
        was = raised(side) if gesture.hand is Hand.LOWERS else hanging(side)
        if before is not None:
            was = directions(before @ heading_matrix(float(heading(before[None])[0])), side)
        if side in gesture.sides and gesture.hand in AT_OTHER:
            joints.append(wrist_joint)
            places.append(wrist(gesture, side, at / FPS, towards)[:, None])
        elif side in gesture.sides:
            joints += [elbow_joint, wrist_joint]
            places.append(arm(gesture, side, seconds, length, towards, was))
        elif both and hangs(was):
            joints += [elbow_joint, wrist_joint]
            places.append(rested(side, seconds, was))
    return joints, np.einsum("nij,nsj->nsi", turns, np.concatenate(places, axis=1))


def late_by(seed: int, person: int) -> float:
    """Seconds by which a person begins later than they could: two people who wave do not wave as one."""
    later, *wait = np.random.default_rng(seed).uniform(0.0, 1.0, 3)
    return LATE * (0.5 * float(wait[person]) + (0.5 if (later < 0.5) is (person == 0) else 0.0))


def _there(places: Array, frames: Frames) -> Frames:
    """Those of some frames at which a person has come to where they stay; the last one, if they are never there."""
    short = np.linalg.norm(places[frames] - places[-1], axis=1)
    return frames[short < ARRIVED] if (short < ARRIVED).any() else frames[-1:]


def _given(person: int, joints: Sequence[int], frames: Frames, places: Array, stretch: Stretch) -> KnownFrames:
    """Joints (N, joints, 3) of a person at some frames of a beat, as the network is given them."""
    poses = np.zeros((len(frames), SMPL22.num_joints, 3))
    poses[:, list(joints)] = places
    return stretch.given(person, frames, poses, joints)


def _inner(ways: Mapping[int, Way2D]) -> dict[str, str]:
    """The hand of each of two people side by side that is next to the other."""
    if len(ways) < 2 or any(way.headings is None for way in ways.values()):
        return {}
    line = ways[1].places[-1] - ways[0].places[-1]
    angle = float(np.nan_to_num(np.asarray(ways[0].headings)[-1]))
    left = line @ np.array([np.cos(angle), -np.sin(angle)]) > 0
    return {"a": "left", "b": "right"} if left else {"a": "right", "b": "left"}
