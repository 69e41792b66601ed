"""The gestures of the hands: where each has its wrists, how they move, and the arms that lead them there.

The network has rarely seen a gesture together with a way or a posture that is given, and some not at all, so hands are
given, also to people who only stand. A wrist alone leaves the elbow to the network, which then raises the upper arm
before the face, lifts the other arm along or has the hand up from the first frame. So both bones are given: the elbow
is below the hand and out to the side, or where the gesture needs it, and the bones turn from where the arm was.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acts.shapes import Gesture
from motion import FPS, SMPL22
from motion.limbs import solve_two_bones
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix
from motion.vectors import Array, unit

from .places import Way2D
from .poses import JOINT, UPRIGHT, upright
from .score import SIDES, Move, Score
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
        uneven: the right of two hands is a little higher than the left.
        in_time: two people make it in one time.
        at_other: it is at the other's body.
        on: "head" or "trunk": the part of one's own body that the hand is on. The network is held to it there, and of
            somebody on their way to the head as well; other gestures are a draft.
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
    uneven: bool = False
    in_time: bool = False
    at_other: bool = False
    on: str = ""

    def way(self, out: float, seconds: Array) -> Array:
        """A wrist's way (N, 3) in metres; ``out`` is 1 for the left hand and -1 for the right."""
        late = np.pi if self.in_turn and out < 0 else 0.0
        phase = 2 * np.pi * self.rate * np.asarray(seconds) - late
        turned = np.sin((2 if self.twice else 1) * phase)
        moved = np.cos(phase)[:, None] * self.by + turned[:, None] * self.around
        mirror = np.array([out, 1.0, 1.0])
        return np.asarray(np.array(self.at) * mirror + moved * (1.0 if self.parallel else mirror))


GESTURES: Mapping[str, Stroke] = {
    # Stretched out
    "high": Stroke(at=(0.1, 0.45, 0.08), from_shoulder=True, pole=(1.0, -0.3, 0.4), both=True, uneven=True),
    "up": Stroke(at=(0.1, 0.32, 0.16), from_shoulder=True, pole=(0.8, -0.8, 0.3), uneven=True),
    "ahead": Stroke(at=(0.02, -0.05, 0.45), from_shoulder=True, both=True, uneven=True),
    "spread": Stroke(at=(0.45, 0.0, 0.06), from_shoulder=True, uneven=True),
    "offers": Stroke(at=(-0.06, -0.2, 0.38), from_shoulder=True, pole=(0.25, -1.0, -0.2)),
    "waves": Stroke(
        at=(0.2, 0.18, 0.16),
        from_shoulder=True,
        around=(0.11, 0.0, 0.0),
        rate=1.2,
        parallel=True,
        pole=(0.5, -1.0, 0.0),
        sinks=True,
        uneven=True,
    ),
    "beckons": Stroke(at=(0.02, -0.06, 0.3), from_shoulder=True, around=(0.0, -0.048, 0.064), rate=1.1, sinks=True),
    "flaps": Stroke(at=(0.4, -0.06, 0.06), from_shoulder=True, around=(0.0, 0.22, 0.0), rate=1.2, in_time=True),
    "circles": Stroke(
        at=(0.14, 0.0, 0.0),
        from_shoulder=True,
        by=(0.0, 0.42, 0.0),
        around=(0.0, 0.0, 0.42),
        rate=1 / 1.3,
        in_time=True,
    ),
    "swings": Stroke(at=(0.06, 0.0, 0.0), from_shoulder=True, rate=1 / 1.4, in_time=True),
    # At the head; the fingertips of a salute are at the temple, the palm at an ear is higher than the wrist
    "salutes": Stroke(at=(0.03, 0.15, 0.15), from_shoulder=True, pole=(1.0, -0.25, 0.0), sinks=True, on="head"),
    "phone": Stroke(at=(0.2, 0.54, 0.06), pole=(0.6, -1.0, 0.3), on="head"),
    "ears": Stroke(at=(0.2, 0.54, 0.06), pole=(0.9, -1.0, 0.2), both=True, on="head"),
    "eyes": Stroke(at=(0.08, 0.58, 0.18), pole=(0.7, -1.0, 0.1), both=True, on="head"),
    "photo": Stroke(at=(0.08, 0.58, 0.28), pole=(0.7, -1.0, 0.1), both=True),
    "head": Stroke(at=(0.12, 0.66, -0.05), pole=(1.0, 0.1, 0.3), on="head"),
    "mouth": Stroke(at=(0.07, 0.48, 0.17), on="head"),
    "blows": Stroke(at=(0.08, 0.4, 0.29), by=(0.0, 0.08, -0.12), rate=0.4, sinks=True, on="head"),
    "fans": Stroke(at=(0.12, 0.42, 0.22), around=(0.1, 0.0, 0.0), rate=2.0, parallel=True),
    "brushes": Stroke(at=(0.08, 0.49, 0.2), by=(0.045, 0.0, 0.0), rate=2.2, pole=(0.8, -0.8, 0.0), on="head"),
    "eats": Stroke(at=(0.085, 0.31, 0.24), by=(0.01, -0.15, 0.06), rate=0.5, on="head"),
    "combs": Stroke(at=(0.14, 0.6, 0.02), by=(0.0, 0.06, -0.05), rate=0.8, pole=(1.0, -0.4, 0.2), on="head"),
    # At the trunk
    "hips": Stroke(at=(0.21, 0.1, 0.0), pole=(1.0, 0.0, -0.5), on="trunk"),
    "chest": Stroke(at=(0.02, 0.36, 0.2), pole=(0.6, -1.0, -0.1), on="trunk"),
    "belly": Stroke(at=(0.04, 0.14, 0.2), on="trunk"),
    "behind": Stroke(at=(0.04, 0.02, -0.18), pole=(1.0, -0.2, -0.6), on="trunk"),
    "crossed": Stroke(at=(-0.1, 0.24, 0.17), by=(0.0, -0.05, 0.0), in_turn=True, pole=(0.6, -1.0, 0.0), on="trunk"),
    "beats": Stroke(
        at=(0.06, 0.37, 0.22), by=(0.0, 0.0, 0.07), rate=1.8, in_turn=True, pole=(1.0, -0.5, 0.0), on="trunk"
    ),
    "bends": Stroke(at=(0.2, 0.42, 0.2), pole=(0.3, -1.0, 0.1)),
    # Before the body
    "claps": Stroke(at=(0.145, 0.28, 0.3), by=(0.07, 0.0, 0.0), rate=2.0, both=True, sinks=True),
    "prays": Stroke(at=(0.04, 0.36, 0.22), pole=(0.7, -1.0, -0.1), both=True),
    "shakes": Stroke(at=(0.28, 0.08, 0.12), around=(0.0, 0.05, 0.0), rate=3.0),
    "works": Stroke(at=(0.1, 0.16, 0.28), by=(0.06, 0.0, 0.0), around=(0.0, 0.0, 0.06), rate=0.9, parallel=True),
    "rubs": Stroke(at=(0.05, 0.24, 0.26), around=(0.0, 0.04, 0.0), rate=1.6, in_turn=True, both=True),
    "drums": Stroke(at=(0.17, 0.2, 0.34), by=(0.0, 0.09, 0.02), rate=2.0, in_turn=True, pole=(0.7, -1.0, -0.2)),
    "types": Stroke(at=(0.1, 0.24, 0.38), by=(0.01, 0.014, 0.0), rate=2.6, in_turn=True),
    "juggles": Stroke(at=(0.17, 0.22, 0.28), by=(0.07, 0.0, 0.0), around=(0.0, 0.11, 0.0), rate=1.3, in_turn=True),
    "dribbles": Stroke(at=(0.23, 0.16, 0.23), by=(0.0, 0.1, 0.0), rate=1.5),
    "conducts": Stroke(
        at=(0.24, 0.46, 0.32), by=(0.14, 0.0, 0.0), around=(0.0, 0.1, 0.02), rate=0.8, twice=True, pole=(0.9, -0.8, 0.0)
    ),
    "pumps": Stroke(at=(0.1, 0.24, 0.32), by=(0.0, 0.09, 0.02), rate=1.5),
    "knocks": Stroke(at=(0.1, 0.46, 0.4), by=(0.0, 0.01, 0.045), rate=2.4),
    "paints": Stroke(at=(0.12, 0.46, 0.4), by=(0.0, 0.2, 0.0), around=(0.05, 0.0, 0.0), rate=0.7),
    "hammers": Stroke(at=(0.13, 0.28, 0.32), by=(0.0, 0.14, -0.03), rate=1.3),
    "writes": Stroke(at=(0.06, 0.2, 0.34), by=(0.05, 0.0, 0.01), around=(0.0, 0.012, 0.0), rate=0.9),
    "carries": Stroke(at=(0.15, 0.14, 0.3)),
    # By where the other or the arm is; see wrist()
    "points": Stroke(at=(0.0, -0.05, 0.0), from_shoulder=True),
    "around": Stroke(at=(0.0, 0.32, -0.12), at_other=True),
    "linked": Stroke(at=(0.22, 0.0, 0.08), at_other=True),
    "lowers": Stroke(),
}
"""The gestures by their names in the lexicon."""
_TOWARDS = {"points": 0.47, "around": 0.4}
"""Metres by which the wrist is nearer to the other: that of an arm that is nearly straight, or around their back."""
_PENDULUM, _SWUNG = 0.44, 0.9
"""Metres from the shoulder to the wrist of an arm that swings, and radians by which it swings to either side."""


def hands_of(gesture: Gesture) -> tuple[str, ...]:
    """The hands that make a gesture, "left", "right" or both."""
    return SIDES if gesture.sides == "both" else (gesture.sides,)


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
    stands, stroke = upright(np.zeros(2), 0.0), GESTURES[name]
    if name == "lowers":
        return np.tile(stands[JOINT[f"{side}_wrist"]] - stands[0], (len(seconds), 1))
    way = stroke.way(1.0 if side == "left" else -1.0, seconds) + _TOWARDS.get(name, 0.0) * towards
    if name == "swings":
        angle = _SWUNG * np.sin(2 * np.pi * stroke.rate * np.asarray(seconds))
        way += _PENDULUM * np.stack([0.0 * angle, -np.cos(angle), np.sin(angle)], axis=1)
    return way + (stands[JOINT[f"{side}_shoulder"]] - stands[0] if stroke.from_shoulder else 0.0)


# ---- arms: both bones of those who gesture, as parts on the time line of a beat -----------------------
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
_HANGS = 0.25
"""Metres of a wrist below its shoulder from which an arm hangs."""
_OVER = np.array([[0.0, 0.0, 0.4], [0.0, 0.0, 1.0]])
"""Upper arm and forearm: how far ahead the direction is over which they turn by half a circle."""
_DRIFT = 0.012
"""Metres by which a held hand wanders."""
_UNEVEN = 0.025
"""Metres by which the right of two hands in the air is higher than the left."""
FIRST = 15
"""Frames of a beat before a hand is given."""
OFTEN = 4
"""Frames between two given places of a hand."""
SELDOM = 15
"""Frames between two given places of a hand that hangs."""
ARRIVED = 0.15
"""Metres from where a person stays, at most, at which their hands begin with a thing."""


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
    stroke = GESTURES[gesture.gesture]
    late = _LAG if gesture.sides == "both" and side == "left" else 0.0
    pace = float(np.clip(length / _UNHURRIED, 0.6, 1.0))
    up = minimum_jerk((seconds / pace - BEGINS - late) / RISES)
    sinks, down = length - _RESTS - _FALLS, 0.0 * up
    strokes = seconds
    if gesture.times and stroke.rate:  # they are counted from when the hand is up, until it sinks
        begins = pace * (BEGINS + RISES)
        lasts = gesture.times / stroke.rate
        share = max(lasts / max(sinks - begins, 0.5 * lasts), 1.0)
        strokes = np.clip(share * (seconds - begins), 0.0, lasts)
        sinks = begins + lasts / share
    goal = wrist(gesture.gesture, side, strokes, towards) + _wandering(seconds, out)
    if gesture.sides == "both" and stroke.uneven:
        goal[:, 1] -= out * _UNEVEN
    if stroke.sinks and length > BEGINS + RISES + _SHOWS + _FALLS + _RESTS:
        down = minimum_jerk((seconds - sinks - late) / _FALLS)
    return _turned(_directions(side, goal, stroke.pole), np.asarray(before), up, down, side)


def hanging(side: str) -> Array:
    """(2, 3) directions of the upper arm and the forearm of an arm that hangs, of a person who faces +Z."""
    return directions(upright(np.zeros(2), 0.0), side)


def raised(side: str) -> Array:
    """(2, 3) directions of the upper arm and the forearm of an arm that is up, of a person who faces +Z."""
    out = 1.0 if side == "left" else -1.0
    return np.asarray(unit(np.array([[0.35 * out, 0.8, 0.35], [0.1 * out, 1.0, 0.1]])))


def directions(poses: Array, side: str) -> Array:
    """(…, 2, 3) directions of the upper arm and the forearm in poses (…, 22, 3)."""
    shoulder, elbow, hand = (poses[..., JOINT[f"{side}_{j}"], :] for j in ("shoulder", "elbow", "wrist"))
    return np.stack([unit(elbow - shoulder), unit(hand - elbow)], axis=-2)


def hangs(arm: Array) -> bool:
    """True for an arm that hangs, by the directions (2, 3) of its bones."""
    lengths = [SMPL22.bone_lengths[JOINT[f"left_{joint}"]] for joint in ("elbow", "wrist")]
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
    return np.asarray(pose[JOINT[f"{side}_shoulder"]] - pose[0])


def _directions(side: str, goal: Array, pole: tuple[float, float, float]) -> Array:
    """(N, 2, 3) directions of an arm's bones whose wrist is at its goal (N, 3) beside the pelvis."""
    out = 1.0 if side == "left" else -1.0
    shoulder = np.broadcast_to(_shoulder(side), goal.shape)
    upper, lower = (SMPL22.bone_lengths[JOINT[f"{side}_{joint}"]] for joint in ("elbow", "wrist"))
    along = unit(goal - shoulder)
    aside = np.broadcast_to(unit(np.array(pole) * [out, 1.0, 1.0]), goal.shape)
    elbow, end = solve_two_bones(
        shoulder, shoulder + upper * along, shoulder + (upper + lower) * along, goal, aside, soft=0.02
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
    upper, lower = (SMPL22.bone_lengths[JOINT[f"{side}_{joint}"]] for joint in ("elbow", "wrist"))
    elbow = _shoulder(side) + upper * bones[:, 0]
    return np.stack([elbow, elbow + lower * bones[:, 1]], axis=1)


def _between(first: Array, second: Array, share: Array) -> Array:
    """Directions (…, 3) on the great circle from the first to the second ones."""
    angle = np.arccos(np.clip(np.sum(first * second, axis=-1, keepdims=True), -1.0, 1.0))
    sine = np.maximum(np.sin(angle), 1e-6)
    near = angle < 1e-4
    own, theirs = (np.where(near, each, np.sin(each * angle) / sine) for each in (1 - share, share))
    return unit(own * first + theirs * second)


def hand_parts(
    score: Score,
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
    gestures = dict(score.gestures)
    if _linked(moves):
        around = {who for who, gesture in gestures.items() if gesture.gesture == "around"}
        for who, side in _inner(stretch.ways).items():
            if who in around or not around:
                gestures[who] = Gesture.model_validate({"gesture": "around" if around else "linked", "sides": side})
    ways = {("ab".index(move.person), move.way) for move in moves}
    for person in (0, 1):
        gesture = gestures.get("ab"[person])
        if gesture is None or not (person in stretch.ways or person in posed):
            continue  # the network makes the gesture
        begins = 0 if person in posed and person not in stretch.ways else FIRST
        at: Frames = np.arange(begins, stretch.frames, OFTEN)
        if (person, "thing") in ways and len(at):
            at = _there(stretch.course(person).places, at)
        if not len(at):
            continue
        own = None if before is None else before[person]
        free = person in posed and posed[person][0, 1] > UPRIGHT and person not in stretch.ways
        both = free and not (score.touch or score.joined)
        late = 0.0 if GESTURES[gesture.gesture].in_time else late_by(seed, person, stretch.frames)
        joints, places = _arms(gesture, person, at, stretch, own, both=both, late=late)
        if len(shown := np.isin(at, stretch.shown(at)).nonzero()[0]):
            part = _known(person, joints, at[shown], places[shown], stretch)
            yield replace(part, soft=not GESTURES[gesture.gesture].on)


def outer_hand_parts(score: Score, moves: Sequence[Move], stretch: Stretch) -> Iterator[KnownFrames]:
    """The other hands of two who walk hand in hand: they hang, but for a gesture.

    They are given now and then only, so that the arms swing.
    """
    at = stretch.shown(np.arange(0, stretch.frames, SELDOM))
    for who, side in _inner(stretch.ways).items() if _linked(moves) and len(at) else ():
        if who in score.gestures:
            continue
        person, outer = "ab".index(who), "right" if side == "left" else "left"
        turns = heading_matrix(stretch.course(person).headings[at])
        places = wrist("linked", outer, at / FPS, np.zeros((len(at), 3)))
        joints = [JOINT[f"{outer}_wrist"]]
        yield _known(person, joints, at, np.einsum("nij,nj->ni", turns, places)[:, None], stretch)


def _linked(moves: Sequence[Move]) -> bool:
    """True for two who walk side by side and hold each other."""
    return {move.way for move in moves if move.linked} == {"along"}


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
    turns = heading_matrix(own.headings[at])
    line = np.insert(other.places[at] - own.places[at], 1, 0.0, axis=1)
    line /= np.linalg.norm(line, axis=1, keepdims=True).clip(min=1e-6)
    towards = np.einsum("nji,nj->ni", turns, line)
    joints, places = list[int](), list[Array]()
    start = max(int(at[0]) - FIRST, 0)
    seconds, length = (at - start) / FPS - late, (stretch.frames - start) / FPS - late
    for side in SIDES:
        wrist_joint, elbow_joint = JOINT[f"{side}_wrist"], JOINT[f"{side}_elbow"]
        was = raised(side) if gesture.gesture == "lowers" else hanging(side)
        if before is not None:
            was = directions(before @ heading_matrix(float(heading(before[None])[0])), side)
        if side in hands_of(gesture) and GESTURES[gesture.gesture].at_other:
            joints.append(wrist_joint)
            places.append(wrist(gesture.gesture, side, at / FPS, towards)[:, None])
        elif side in hands_of(gesture):
            joints += [elbow_joint, wrist_joint]
            places.append(arm(gesture, side, seconds, length, towards, was))
        elif both and hangs(was):
            joints += [elbow_joint, wrist_joint]
            places.append(rested(side, seconds, was))
    if GESTURES[gesture.gesture].on == "head" and person in stretch.ways:
        stands, head = upright(np.zeros(2), 0.0), JOINT["head"]
        joints.append(head)
        places.append(np.tile(stands[head] - stands[0], (len(at), 1, 1)))
    return joints, np.einsum("nij,nsj->nsi", turns, np.concatenate(places, axis=1))


def _there(places: Array, frames: Frames) -> Frames:
    """Those of some frames at which a person has come to where they stay; the last one, if they are never there."""
    short = np.linalg.norm(places[frames] - places[-1], axis=1)
    return frames[short < ARRIVED] if (short < ARRIVED).any() else frames[-1:]


def _known(person: int, joints: Sequence[int], frames: Frames, places: Array, stretch: Stretch) -> KnownFrames:
    """Joints (N, joints, 3) of a person at some frames of a beat."""
    poses = np.zeros((len(frames), len(JOINT), 3))
    poses[:, list(joints)] = places
    return stretch.known(person, frames, poses, joints)


def _inner(ways: Mapping[int, Way2D]) -> dict[str, str]:
    """The hand of each of two people side by side that is next to the other."""
    if len(ways) < 2 or any(way.headings is None for way in ways.values()):
        return {}
    line = ways[1].places[-1] - ways[0].places[-1]
    angle = float(np.nan_to_num(np.asarray(ways[0].headings)[-1]))
    left = line @ np.array([np.cos(angle), -np.sin(angle)]) > 0
    return {"a": "left", "b": "right"} if left else {"a": "right", "b": "left"}
