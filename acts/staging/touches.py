"""Touches: a hand that is laid on the other's shoulder, a pat on the back, a kiss on the cheek.

The network makes the touches of its training sentences. It often misses by a hand's breadth after a
walk, on a person who sits or kneels, or on a part of the body that those sentences never name. In such cases the person
who touches is led to where they reach the other, and the hand is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np

from motion import FPS
from motion.skeleton import SIDES
from motion.transforms import facing, mirrored
from motion.vectors import FLAT, Array, leftwards, unit

from .places import Course
from .poses import HANDS, JOINT, LOWER, TRUNK, UPRIGHT, leaning, placed, posed, upright
from .recordings import drawn
from .score import Touch
from .window import GETS_DOWN, REACHES, KnownFrames, Stretch

_JOINTS = {
    "head": "head",
    "shoulder": "{side}_shoulder",
    "back": "spine3",
    "chest": "spine2",
    "waist": "spine2",
    "arm": "{side}_elbow",
    "hand": "{side}_wrist",
    "leg": "{side}_knee",
    "foot": "{side}_ankle",
}
_SKIN = 0.1
"""Metres between a wrist and the joint inside the part of the body that its hand is on."""
_PALM = 0.05
"""Metres by which a wrist is further from the spine, so that the palm and not the wrist is on the back."""
_KISS = 0.22
"""Metres between two heads at a kiss."""
_ROUND = {"waist": (0.36, 0.12, -0.02, 0.02), "head": (0.36, 0.05, 0.1, 0.02)}
"""Metres between the pelvises of two people one of whom has the arms round the other from behind, and those ahead of
the other's joint, aside and over it, at which the wrists are: the palms are before the belly or the eyes."""
_ARM = 0.45
"""Metres from the shoulder to the wrist of an arm that is nearly straight."""
_TRUNK = 0.47
"""Metres from the pelvis to the line of the shoulders."""
_HIP = 0.93
"""Height in metres of the pelvis of a person who stands."""
_DOWN = 0.33
"""Metres that the hand of a person who kneels is below their shoulder."""
_FLAT = 0.3
"""Metres between the heights of head and pelvis of a person who lies, at most."""
BESIDE = 0.46
"""Metres between the pelvises of two people one of whom has an arm around the other or the head on their shoulder."""
_AROUND = (0.13, 0.06, 0.04)
"""Metres behind, inside of and under the other's far shoulder of a wrist whose arm is around them."""
LOWEST = 0.55
"""Height in metres of the lowest place that somebody on their feet reaches."""
HELD = 1.6
"""Seconds that a hand stays, where the beat is long enough."""
BEAT = 20
"""Frames from one pat to the next."""
TAKEN_BACK = 0.2
"""Metres by which a hand is taken back between two pats."""
LOWERS = 24
"""Frames in which a hand that has patted somebody's back, where the network would go on to the front, or has pushed
them goes down."""
_PUSHED = 0.3
"""Metres that somebody goes who is pushed, at least: the network would have both fall."""


@cache
def _kneeling() -> float:
    """Height in metres of the pelvis of a person who kneels."""
    return float(posed("kneels", np.zeros(2), 0.0)[0, 1])


def kneels(touch: Touch, pose: Array) -> bool:
    """True for a place of a pose (22, 3) so low that the person who touches it kneels down to it."""
    return float(middle(touch, pose)[1]) < LOWEST and not touch.fells


def beside(pose: Array, place: Array) -> float | None:
    """The heading across a person's lying body (22, 3), from the side of a place (2,); None if they do not lie."""
    body = np.asarray(pose)[JOINT["head"]] - pose[0]
    if abs(body[1]) > _FLAT or pose[0][1] > _kneeling():
        return None
    across = np.array([body[2], -body[0]])
    side = 1.0 if across @ (np.asarray(pose)[0][[0, 2]] - place) >= 0 else -1.0
    return float(np.arctan2(*(side * across)))


def touching(touch: Touch, pose: Array, place: Array, angle: float) -> Array:
    """The pose (22, 3) of a person at a place (2,) who leans, or kneels down, to the other's pose, arms hanging."""
    if touch.beside and not touch.sides:  # the head on the other's shoulder, or at their ear
        leans = drawn("whispers" if touch.part == "head" else "rests")  # to the left
        return placed(leans if inner_side(pose, place, angle) == SIDES[0] else mirrored(leans), place, angle)
    if touch.beside:
        return upright(place, angle)
    stands = posed("kneels" if kneels(touch, pose) else "stands", place, angle)
    return leaning(stands, angle, lean(touch, pose))


def reach(touch: Touch, pose: Array) -> float:
    """Metres over the floor from a person's pelvis to what they touch of the other, leaning or kneeling if it is low.

    Args:
        touch: the contact.
        pose: (22, 3) metres of the one who is touched.
    """
    if touch.beside:
        return BESIDE
    height, angle = float(middle(touch, pose)[1]), lean(touch, pose)
    if kneels(touch, pose):
        return float(_TRUNK * np.sin(angle) + np.sqrt(_ARM**2 - _DOWN**2))
    ahead, up = _TRUNK * np.sin(angle), _HIP + _TRUNK * np.cos(angle)
    if not touch.sides:
        return float(ahead + 0.08 + _KISS)
    if _goes_round(touch):
        return _ROUND[touch.part][0]
    arm = float(np.sqrt(max(_ARM**2 - (up - height) ** 2, 0.1**2)))
    return float(min(ahead + arm, 0.55)) + _SKIN


def _goes_round(touch: Touch) -> bool:
    """True for both arms around somebody from behind: a hug, or hands before the eyes."""
    return touch.part == "waist" or (touch.part == "head" and touch.behind and len(touch.sides) == 2)


def lean(touch: Touch, pose: Array) -> float:
    """Radians by which a person leans forward to touch the other, whose pose (22, 3) is given."""
    if kneels(touch, pose):
        over = float(middle(touch, pose)[1]) + _DOWN - _kneeling()
        return float(np.arccos(np.clip(over / _TRUNK, 0.2, 1.0)))
    least = 0.05 if touch.sides else 0.15
    return float(np.clip(0.1 + 1.2 * (1.3 - middle(touch, pose)[1]), least, 1.0))


def middle(touch: Touch, pose: Array) -> Array:
    """The middle (3,) of the joints of a pose (22, 3) that are touched."""
    return np.asarray(pose)[_joints(touch.part, touch.part_side)].mean(axis=0)


def _joints(part: str, only: str = "") -> list[int]:
    """The joints of a part of the body: of both sides, or ``only`` of one."""
    name = _JOINTS[part]
    return [JOINT[name.format(side=side)] for side in ((only,) if only else SIDES if "{" in name else SIDES[:1])]


def touched(touch: Touch, other: Array, own: Array) -> Array:
    """The places of the wrists, or of the head, at a contact.

    Args:
        touch: the contact.
        other: (22, 3) metres, a pose of the one who is touched.
        own: (22, 3) metres, a pose of the one who touches, who leans forward at their place.

    Returns:
        (len(sides), 3) metres; (1, 3) for a kiss.
    """
    joints = _joints(touch.part, touch.part_side)
    back = other[JOINT["spine3"]]
    if touch.part == "back" and float((own[0] - other[0]) @ facing(other)) > 0:
        joints = _joints("shoulder")  # as far as an arm gets round somebody from the front
    if not touch.sides:
        return other[joints[0]] + _KISS * unit(own[JOINT["head"]] - other[joints[0]])[None]
    poses = []
    for side in touch.sides:
        shoulder = own[JOINT[f"{side}_shoulder"]]
        if touch.beside:
            poses.append(_around(other, shoulder))
            continue
        joint = min(joints, key=lambda j: float(np.linalg.norm(other[j] - shoulder)))
        place = other[joint] + _SKIN * unit(shoulder - other[joint])
        if _goes_round(touch):
            _, ahead, aside, up = _ROUND[touch.part]
            across = unit((shoulder - own[0]) * FLAT)
            place = other[joint] + ahead * facing(other) + aside * across + np.array([0.0, up, 0.0])
        elif len(joints) == 1 and len(touch.sides) == 2:
            place = place + 0.08 * unit((shoulder - own[0]) * FLAT)
        if touch.part == "back" and len(joints) == 1:
            place = place + _PALM * unit(shoulder - back)
        poses.append(place)
    return np.stack(poses)


def inner_side(other: Array, place: Array, angle: float) -> str:
    """The side, "left" or "right", on which a person at a place (2,) has the other (22, 3)."""
    return SIDES[0] if float((np.asarray(other)[0][[0, 2]] - place) @ leftwards(angle)) > 0 else SIDES[1]


def arms_beside(touch: Touch, other: Array, place: Array, angle: float) -> tuple[str, ...]:
    """The sides of the arms that are given of a person at a place (2,) beside the other (22, 3): the inner one, and of
    one who whispers both."""
    whispers = touch.part == "head" and not touch.sides
    return SIDES if whispers else (inner_side(other, place, angle),)


def _around(other: Array, shoulder: Array) -> Array:
    """The place (3,) of a wrist on the other's (22, 3) far shoulder, behind them, of an arm from a shoulder (3,)."""
    behind, inside, under = _AROUND
    far, near = sorted(
        (other[JOINT[f"{side}_shoulder"]] for side in SIDES), key=lambda joint: -float(np.linalg.norm(joint - shoulder))
    )
    return np.asarray(far + inside * unit(near - far) - behind * facing(other) - [0.0, under, 0.0])


def touch_parts(touch: Touch, posed: Mapping[int, Array], stretch: Stretch) -> list[KnownFrames]:
    """The trunk and hands of the person who touches, as the network is given them; none if the beat is too short.

    Of a person who kneels down to what they touch, also the pelvis and the legs, and the head that hands are laid on.

    Args:
        touch: the contact.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stretch: the beat.
    """
    giver, frames = "ab".index(touch.person), stretch.frames
    if giver not in stretch.ways:
        return []
    own, other = stretch.course(giver), stretch.course(1 - giver)
    arms = touch.sides
    if touch.beside:
        there = upright(other.places[-1], float(other.headings[-1]))
        arms = arms_beside(touch, there, own.places[-1], float(own.headings[-1]))
        touch = touch.model_copy(update={"hands": arms[0] if touch.sides else "none"})
    down = kneels(touch, posed.get(1 - giver, upright(np.zeros(2), 0.0)))
    first = _since(np.abs(own.headings - own.headings[-1]) > 0.2) if touch.beside else 0
    apart = np.linalg.norm(own.places - other.places, axis=1)
    first = max(first, _arrival(own), int(np.argmax(apart < apart.min() + 0.04)))
    first += GETS_DOWN if down else REACHES
    first = max(first, round(0.6 * frames)) if touch.late else first
    last = min(frames, _leaving(other, first))
    at = _moments(touch, first, last)
    if down and at:
        rest = TAKEN_BACK if touch.times else 0.0
        at += [(frame, rest) for frame in range(at[-1][0] + REACHES // 2, frames, REACHES // 2)]
    wrists = [JOINT[f"{side}_wrist"] for side in arms]
    joints = [*(LOWER if down else ()), *(j for j in TRUNK if not down or j not in LOWER), *wrists]
    kept: list[int] = []
    poses: list[Array] = []
    for frame, back in at:
        if not stretch.shows(frame):
            continue
        target = None if touch.fells else posed.get(1 - giver)
        if target is None:
            target = upright(other.places[frame], float(other.headings[frame]))
        kept.append(frame)
        poses.append(_reaching(touch, target, own, frame, back))
    comes = range(REACHES, first - REACHES, REACHES) if touch.beside and stretch.start else range(0)
    pushes = bool(at) and float(np.linalg.norm(other.places[-1] - other.places[at[0][0]])) > _PUSHED
    rests = range(at[-1][0] + LOWERS, frames, REACHES // 2) if pushes or (at and touch.times and touch.behind) else ()
    for frame in (*comes, *rests):
        if stretch.shows(frame):
            kept.append(frame)
            poses.append(upright(own.places[frame], float(own.headings[frame])))
    if not kept:
        return []
    order = np.argsort(kept)
    parts = [stretch.known(giver, np.array(kept)[order], np.stack(poses)[order], joints)]
    if touch.part == "head" and touch.sides and (1 - giver not in posed or posed[1 - giver][0, 1] > UPRIGHT):
        parts.append(stretch.still(1 - giver, np.array(kept)[order], [JOINT["head"]]))
    elif pushes:
        steady = stretch.shown(np.array([*range(0, at[0][0], REACHES), *rests]))
        parts += [stretch.still(1 - giver, steady, [*TRUNK, *HANDS])] if len(steady) else []
    return parts


def _reaching(touch: Touch, target: Array, own: Course, frame: int, back: float) -> Array:
    """The pose (22, 3) of a person who touches the other's ``target``, with the hands taken ``back`` by some metres."""
    pose = touching(touch, target, own.places[frame], float(own.headings[frame]))
    if touch.sides:
        wrists = [JOINT[f"{side}_wrist"] for side in touch.sides]
        places = touched(touch, target, pose)
        away = pose[wrists] - places
        away /= np.linalg.norm(away, axis=1, keepdims=True).clip(min=1e-6)
        pose[wrists] = places + back * away
    return pose


def _moments(touch: Touch, first: int, last: int) -> list[tuple[int, float]]:
    """The frames at which the hand is given, and metres by which it is taken back then."""
    if not touch.times:
        stop = min(last, max(first + round(HELD * FPS), round(0.85 * last)))
        return [(frame, 0.0) for frame in range(first, stop, 3)]
    moments: list[tuple[int, float]] = []
    for i in range(touch.times):
        on = first + i * BEAT
        moments += [(frame, 0.0) for frame in range(on, on + 7, 3)]
        if i + 1 < touch.times:
            moments.append((on + BEAT // 2 + 3, TAKEN_BACK))
    return [(frame, back) for frame, back in moments if frame < last]


def _arrival(course: Course) -> int:
    """The frame from which somebody stays within 4 cm of where they end up."""
    return _since(np.linalg.norm(course.places - course.places[-1], axis=1) > 0.04)


def _since(away: Array) -> int:
    """The first frame from which something is no longer so."""
    return int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0


def _leaving(course: Course, first: int) -> int:
    """The frame after ``first`` at which somebody begins to turn or to go."""
    if first >= len(course.places):
        return len(course.places)
    moved = np.linalg.norm(course.places[first:] - course.places[first], axis=1) > 0.1
    turned = np.abs(course.headings[first:] - course.headings[first]) > 0.4
    gone = np.flatnonzero(moved | turned)
    return first + int(gone[0]) if len(gone) else len(course.places)
