"""The gestures of the hands: where each has its wrists, how they move, and the arms that lead them there.

The network has rarely seen a gesture together with a way or a posture that is given, and some not at all, so hands are
given, also to people who only stand. A wrist alone leaves the elbow to the network, which then raises the upper arm
before the face, lifts the other arm along or has the hand up from the first frame. So both bones are given: the elbow
is below the hand and out to the side, or where the gesture needs it, and the bones turn from where the arm was.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from acts.shapes import Gesture
from motion import FPS, SMPL22
from motion.limbs import solve_two_bones
from motion.skeleton import SIDES
from motion.transforms import heading_matrix
from motion.vectors import Array, floor_points, unit

from .places import ABEAM, EVENLY
from .poses import JOINT, upright
from .recordings import performance
from .score import Move, Score
from .window import Frames, KnownFrames, Stretch, late_by

Place = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """The way of a hand of a person who faces +Z. It stays, goes to and fro, or round and round.

    Attributes:
        at: metres to the middle of its way for the left hand: outwards, up and ahead.
        from_shoulder: these are from the shoulder, as the arm is stretched out; otherwise from the pelvis.
        by: metres to either side of the middle, likewise.
        around: the same a quarter of a stroke later, of a hand that goes round.
        rate: strokes a second.
        in_turn: the right hand is half a stroke behind the left one.
        parallel: both hands go the same way; otherwise one is the other's mirror image.
        twice: it goes twice along ``around`` while it goes once along ``by``: a figure of eight.
        pole: outwards, up and ahead: where the elbow is beside the line from shoulder to wrist. By default it hangs.
        both: the gesture is always made by both hands.
        sinks: the hand sinks again before the beat ends; others are held as long as it lasts.
        in_time: two people make it in one time.
        on: "head", "trunk" or "hands": the part of one's own body that the hand is on. The network is held to it
            there, and to where the head is; other gestures are a draft.
        held: the network is held to it, as it would raise or lower the hand.
    """

    at: Place = (0.0, 0.0, 0.0)
    from_shoulder: bool = False
    by: Place = (0.0, 0.0, 0.0)
    around: Place = (0.0, 0.0, 0.0)
    rate: float = 0.0
    in_turn: bool = False
    parallel: bool = False
    twice: bool = False
    pole: Place = (0.4, -1.0, -0.2)
    both: bool = False
    sinks: bool = False
    in_time: bool = False
    on: str = ""
    held: bool = False

    def way(self, out: float, seconds: Array) -> Array:
        """A wrist's way (N, 3) in metres; ``out`` is 1 for the left hand and -1 for the right."""
        late = np.pi if self.in_turn and out < 0 else 0.0
        phase = 2 * np.pi * self.rate * np.asarray(seconds) - late
        turned = np.sin((2 if self.twice else 1) * phase)
        moved = np.cos(phase)[:, None] * self.by + turned[:, None] * self.around
        mirror = np.array([out, 1.0, 1.0])
        return np.asarray(np.array(self.at) * mirror + moved * (1.0 if self.parallel else mirror))


def _stroke(way: Mapping[str, Any]) -> Stroke:
    values: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in way.items()}
    return Stroke(**values)


GESTURES: Mapping[str, Stroke] = {
    name: _stroke(way)
    for name, way in tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")).items()
}
"""The gestures by their names in the lexicon."""
_POINTS = 0.47
"""Metres from the shoulder to the wrist of a pointing arm, which is nearly straight."""


def hands_of(gesture: Gesture) -> tuple[str, ...]:
    """The hands that make a gesture, "left", "right" or both."""
    return SIDES if gesture.sides == "both" else (gesture.sides,)


def arms_of(gesture: Gesture) -> list[int]:
    """The joints of the arms that make a gesture: of each side the elbow and the wrist."""
    return [JOINT[f"{side}_{joint}"] for side in hands_of(gesture) for joint in ("elbow", "wrist")]


def wrist(name: str, side: str, seconds: Array, towards: Array) -> Array:
    """A wrist's way beside the pelvis of a person who faces +Z.

    Args:
        name: of :data:`GESTURES`.
        side: "left" or "right".
        seconds: (N,) moments.
        towards: (N, 3) unit directions to the other person, as seen by the one who faces +Z.

    Returns:
        (N, 3) metres from the pelvis.
    """
    stroke = GESTURES[name]
    way = stroke.way(1.0 if side == "left" else -1.0, seconds) + (_POINTS if name == "points" else 0.0) * towards
    return way + (_shoulder(side) if stroke.from_shoulder else 0.0)


# ---- arms: both bones of those who gesture, as parts on the time line of a beat -----------------------
RISES = 0.8
"""Seconds after which a hand is up."""
_UNHURRIED = 3.5
"""Seconds of a beat from which an arm takes its time; in shorter ones it is up sooner."""
_SINKS = 1.0
"""Seconds of a beat that are left when a hand sinks again."""
_SHOWS = 1.0
"""Seconds for which a hand is up that sinks again, at least."""
FIRST = 15
"""Frames of a beat before a hand is given."""
ARRIVED = 0.15
"""Metres from where a person stays, at most, at which their hands begin with a thing."""


def arm(gesture: Gesture, side: str, seconds: Array, length: float, towards: Array) -> Array:
    """The elbow and the wrist of a hand that makes a gesture, beside the pelvis of a person who faces +Z.

    Args:
        gesture: the gesture.
        side: "left" or "right".
        seconds: (N,) moments since the hand is free to begin.
        length: seconds until it is over.
        towards: (N, 3) unit directions to the other person.

    Returns:
        (N, 2, 3) metres from the pelvis.
    """
    begins, _, pace = _lasts(gesture, length)
    strokes = np.asarray(seconds, dtype=float)
    if gesture.times and GESTURES[gesture.gesture].rate:  # they are counted from when the hand is up
        strokes = np.clip(pace * (strokes - begins), 0.0, gesture.times / GESTURES[gesture.gesture].rate)
    return _bent(side, wrist(gesture.gesture, side, strokes, towards), GESTURES[gesture.gesture].pole)


def _lasts(gesture: Gesture, length: float) -> tuple[float, float, float]:
    """Seconds from which and until which a hand is up, of a gesture of some length, and the pace of its strokes."""
    stroke = GESTURES[gesture.gesture]
    begins, sinks, pace = RISES * float(np.clip(length / _UNHURRIED, 0.6, 1.0)), length - _SINKS, 1.0
    if gesture.times and stroke.rate:
        lasts = gesture.times / stroke.rate
        pace = max(lasts / max(sinks - begins, 0.5 * lasts), 1.0)
        sinks = begins + lasts / pace
    return begins, sinks if stroke.sinks and length > RISES + _SHOWS + _SINKS else length, pace


def _shoulder(side: str) -> Array:
    pose = upright(np.zeros(2), 0.0)
    return np.asarray(pose[JOINT[f"{side}_shoulder"]] - pose[0])


def _bent(side: str, goal: Array, pole: Place) -> Array:
    """(N, 2, 3) the elbow and the wrist of an arm whose wrist comes near a goal (N, 3) beside the pelvis."""
    shoulder = np.broadcast_to(_shoulder(side), goal.shape)
    upper, lower = (SMPL22.bone_lengths[JOINT[f"{side}_{joint}"]] for joint in ("elbow", "wrist"))
    along = unit(goal - shoulder)
    aside = np.broadcast_to(unit(np.array(pole) * [1.0 if side == "left" else -1.0, 1.0, 1.0]), goal.shape)
    elbow, end = solve_two_bones(
        shoulder, shoulder + upper * along, shoulder + (upper + lower) * along, goal, aside, soft=0.02
    )
    return np.stack([elbow, end], axis=1)


def hand_parts(
    score: Score, moves: Sequence[Move], posed: Mapping[int, Array], stretch: Stretch, seed: int
) -> Iterator[KnownFrames]:
    """The gestures of those whose way or posture is given, while the hands are up: the network brings them there.

    Args:
        score: of the beat.
        moves: of the beat, where they were changed since.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stretch: the beat.
        seed: draws how late each of them is.
    """
    gestures = score.gestures
    ways = {("ab".index(move.person), move.way) for move in moves}
    for person in (0, 1):
        gesture = gestures.get("ab"[person])
        if gesture is None or not (person in stretch.ways or person in posed):
            continue  # the network makes the gesture
        begins = 0 if person in posed and person not in stretch.ways else FIRST
        at: Frames = np.arange(begins, stretch.frames, EVENLY)
        if (person, "thing") in ways and len(at):
            at = _there(stretch.course(person).places, at)
        if not len(at):
            continue
        if (recorded := performance(gestures, person, stretch.frames, seed)) is not None:
            at = at[recorded.share(at / FPS) > 0]
            poses, joints = recorded.poses(at / FPS), arms_of(gesture)
            places: Array = poses[:, joints] - poses[:, :1]
        else:
            turned = bool({(person, "turn"), (person, "thing")} & ways)
            joints, at, places = _arms(gesture, person, at, stretch, seed, turned=turned)
        shown = np.isin(at, stretch.shown(at))
        arms = np.zeros((int(shown.sum()), len(JOINT), 3))
        turns = heading_matrix(stretch.course(person).headings[at[shown]])
        arms[:, joints] = np.einsum("nij,nsj->nsi", turns, places[shown])
        part = stretch.known(person, at[shown], arms, joints)
        yield replace(part, soft=not (GESTURES[gesture.gesture].on or GESTURES[gesture.gesture].held))


def _arms(
    gesture: Gesture, person: int, at: Frames, stretch: Stretch, seed: int, *, turned: bool
) -> tuple[list[int], Frames, Array]:
    """Joints of a person's arms, frames while they are up, and their places (N, joints, 3) from the pelvis, facing +Z.

    Args:
        gesture: the gesture.
        person: 0 or 1.
        at: frames of the beat at which the hands are free.
        stretch: the beat.
        seed: draws how late they are.
        turned: they have turned to a thing, which is before them.
    """
    late = gesture.late + (0.0 if GESTURES[gesture.gesture].in_time else late_by(seed, person, stretch.frames))
    start = max(int(at[0]) - FIRST, 0)
    length = (stretch.frames - start) / FPS - late
    begins, sinks, _ = _lasts(gesture, length)
    since = (at - start) / FPS - late
    up = (since >= begins) & (since <= sinks)
    at, seconds = at[up], since[up]
    own, other = stretch.course(person), stretch.course(1 - person)
    turns = heading_matrix(own.headings[at])
    towards = np.einsum("nji,nj->ni", turns, unit(floor_points(other.places[at] - own.places[at])))
    if turned:
        towards[towards[:, 2] < ABEAM] = [0.0, 0.0, 1.0]
    joints = arms_of(gesture)
    places = [arm(gesture, side, seconds, length, towards) for side in hands_of(gesture)]
    if GESTURES[gesture.gesture].on == "head":
        stands, head = upright(np.zeros(2), 0.0), JOINT["head"]
        joints.append(head)
        places.append(np.tile(stands[head] - stands[0], (len(at), 1, 1)))
    return joints, at, np.concatenate(places, axis=1)


def _there(places: Array, frames: Frames) -> Frames:
    """Those of some frames at which a person has come to where they stay; the last one, if they are never there."""
    short = np.linalg.norm(places[frames] - places[-1], axis=1)
    return frames[short < ARRIVED] if (short < ARRIVED).any() else frames[-1:]
