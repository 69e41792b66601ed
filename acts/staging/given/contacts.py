"""Contacts and holds that the words of a beat ask for: people are led within reach, and the hands are given."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22

from ..bodies.curves import direction
from ..bodies.poses import LOWER, TRUNK, bending, upright
from ..contacts import LOWEST, Contact, arms_beside, beside, kneels, middle, reach, touched, touching
from ..floor import ABEAM, Standing
from ..holds import Hold, joined, raised
from ..moves import Move
from ..parts import KnownFrames
from ..told import Told
from ..ways import Way
from .stretch import Course, Stretch

Array = NDArray[np.floating]

FAR_APART = 1.8
"""Metres between two people beyond which one comes up to do something within the other's reach."""
_NEARLY = 0.2
"""Metres more than in a hold at which two who begin in it stand."""
REACHES = 12
"""Frames in which a hand is brought to the place that it touches."""
HELD = 1.6
"""Seconds that a hand stays, where the beat is long enough."""
BEAT = 20
"""Frames from one pat to the next."""
TAKEN_BACK = 0.2
"""Metres by which a hand is taken back between two pats."""
LOWERS = 24
"""Frames in which a hand that has patted somebody's back goes down."""
KNEELS = 40
"""Frames in which somebody kneels down to touch what is low."""
_HIPS = [SMPL22.index("left_hip"), SMPL22.index("right_hip")]
_WRISTS = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]
_COMES = (Way.TO, Way.BEHIND, Way.BESIDE, Way.STAY, Way.FACE)
_WAITS = (Way.STAY, Way.AVERTED, Way.FACE, Way.TURN)


def meeting(
    touch: Contact | None, found: Sequence[Move], posed: Mapping[int, Array], stand: Standing
) -> tuple[Contact | None, tuple[Move, ...]]:
    """The contact, if it can be planned, and the moves of the beat with those that it needs.

    Args:
        touch: as the words name it.
        found: the beat's moves.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stand: where the people are when the beat begins.
    """
    moves = tuple(found)
    if touch is None:
        return None, moves
    giver = "ab".index(touch.person)
    own = [move for move in moves if move.person == touch.person]
    theirs = [move for move in moves if move.person != touch.person]
    if touch.fells:
        if 1 - giver not in posed:
            return None, moves  # the network knows pushes
        posed = {}
        if middle(touch, upright(np.zeros(2), 0.0))[1] < LOWEST:
            return None, moves
    pose = posed.get(1 - giver, upright(np.zeros(2), 0.0))
    down = kneels(touch, pose)
    if (giver in posed and not down) or any(move.way not in _COMES for move in own):
        return None, moves
    if any(move.way not in (*_WAITS, Way.TO) for move in theirs):
        return None, moves
    near = reach(touch, pose)
    lies = 1 - giver in posed and beside(pose, stand.places[giver]) is not None
    way = Way.BEHIND if touch.behind or lies else Way.BESIDE if touch.beside else Way.TO
    comes = [
        Move(m.person, way if m.way is Way.TO else m.way, m.speed, late=m.late, near=near) if m.way in _COMES[:3] else m
        for m in own
    ]
    if not any(move.near for move in comes):
        speed = 1.2 if touch.beside else 0.8
        comes = [*(m for m in comes if m.way is Way.FACE), Move(touch.person, way, speed, near=near)]
    other = "ab"[1 - giver]
    waits = [Move(m.person, m.way, m.speed, near=near) if m.way is Way.TO else m for m in theirs]
    if 1 - giver not in posed and not touch.fells and (not waits or waits[0].way in (Way.TURN, Way.FACE)):
        waits = [Move(other, Way.AVERTED if touch.behind else Way.STAY), *waits]
    return touch, (*comes, *waits)


def coming(told: Told, stand: Standing, down: Collection[int]) -> tuple[Move, ...]:
    """The moves of a beat; who does something within the other's reach comes up to them first, if they are far apart.

    The other turns to them, and both stay there. Their arms are left to the network.

    Args:
        told: of the beat.
        stand: where the people are when it begins.
        down: those who are not on their feet.
    """
    found = told.moves
    if found or told.contact or told.placed or told.strike or not told.reaching or stand.gap() < FAR_APART:
        return found
    comes = sorted(who for who in told.reaching if "ab".index(who) not in down)
    turned = [
        who
        for i, who in enumerate("ab")
        if i not in down and direction(float(stand.headings[i])) @ stand.towards(i) < ABEAM
    ]
    waits = [Move(who, Way.FACE) for who in turned if who not in comes]
    return (*(Move(who, Way.TO, until=True, near=told.reaching[who]) for who in comes), *waits)


def towards_touched(touch: Contact | None, posed: Mapping[int, Array], stand: Standing, pulls: str = "") -> Standing:
    """The places that a way to the other is planned from: of a person who is posed, the one that is touched.

    A person who lies is taken to face away from the one who comes, so that they are touched from the side. A person
    whom the other ``pulls`` up is where they will stand.
    """
    giver = touch.person if touch is not None and not touch.fells else pulls
    other = 1 - "ab".index(giver) if giver else 0
    if not giver or other not in posed:
        return stand
    places, headings = stand.places.copy(), stand.headings.copy()
    pose = posed[other]
    places[other] = (middle(touch, pose) if touch is not None else pose[0])[[0, 2]]
    across = beside(pose, stand.places[1 - other])
    headings[other] = headings[other] if across is None else across
    return replace(stand, places=places, headings=headings)


def given_contact(touch: Contact, posed: Mapping[int, Array], stretch: Stretch) -> KnownFrames | None:
    """The trunk and hands of the person who touches, as the network is given them; None if the beat is too short.

    Of a person who kneels down to what they touch, also the pelvis and the legs.

    Args:
        touch: the contact.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stretch: the beat.
    """
    giver, frames = "ab".index(touch.person), stretch.frames
    if giver not in stretch.ways:
        return None
    own, other = stretch.course(giver), stretch.course(1 - giver)
    arms = touch.sides
    if touch.beside:
        there = upright(other.places[-1], float(other.headings[-1]))
        arms = arms_beside(touch, there, own.places[-1], float(own.headings[-1]))
        touch = replace(touch, sides=arms if touch.sides else ())
    down = kneels(touch, posed.get(1 - giver, upright(np.zeros(2), 0.0)))
    first = _turned(own) if touch.beside else 0
    first = max(first, _arrival(own), _arrival(other) if 1 - giver in stretch.ways else 0)
    first += KNEELS if down else REACHES
    first = max(first, round(0.6 * frames)) if touch.late else first
    last = min(frames, _leaving(other, first))
    at = _moments(touch, first, last)
    if down and at:
        rest = TAKEN_BACK if touch.times else 0.0
        at += [(frame, rest) for frame in range(at[-1][0] + REACHES // 2, frames, REACHES // 2)]
    wrists = [SMPL22.index(f"{side}_wrist") for side in arms]
    joints = [*(LOWER if down else ()), *(j for j in TRUNK if not down or j not in LOWER), *wrists]
    kept: list[int] = []
    poses: list[Array] = []
    for frame, back in at:
        if not stretch.shows(frame):
            continue
        target = None if touch.fells else posed.get(1 - giver)
        if target is None:
            target = upright(other.places[frame], float(other.headings[frame]))
        pose = _reaching(touch, target, own, frame, back)
        pose -= 0.0 if down else pose[0].copy()
        kept.append(frame)
        poses.append(pose)
    comes = range(REACHES, first - REACHES, REACHES) if touch.beside and stretch.start else range(0)
    for frame in (*comes, *_rests(touch, at, frames)):
        if stretch.shows(frame):
            kept.append(frame)
            pose = upright(own.places[frame], float(own.headings[frame]))
            poses.append(pose - pose[0])
    if not kept:
        return None
    order = np.argsort(kept)
    return stretch.given(giver, np.array(kept)[order], np.stack(poses)[order], joints)


def _reaching(touch: Contact, target: Array, own: Course, frame: int, back: float) -> Array:
    """The pose (22, 3) of a person who touches the other's ``target``, with the hands taken ``back`` by some metres."""
    pose = touching(touch, target, own.places[frame], float(own.headings[frame]))
    if touch.sides:
        wrists = [SMPL22.index(f"{side}_wrist") for side in touch.sides]
        places = touched(touch, target, pose)
        away = pose[wrists] - places
        away /= np.linalg.norm(away, axis=1, keepdims=True).clip(min=1e-6)
        pose[wrists] = places + back * away
    return pose


def given_hold(kind: Hold, stretch: Stretch) -> list[KnownFrames]:
    """The trunks and hands of two people in a hold, as the network is given them."""
    courses = [stretch.course(person) for person in (0, 1)]
    apart = float(np.linalg.norm(np.subtract(*stretch.stand.places)))
    begun = stretch.start == 0 and apart < kind.value + _NEARLY  # a story that begins in the hold
    at = stretch.shown(np.arange(0 if begun else REACHES, stretch.frames, 3))
    if not len(at):
        return []
    wrists = joined(kind, np.stack([course.places[at] for course in courses]))
    parts = []
    for person, course in enumerate(courses):
        poses = np.stack([bending(course.places[t], float(course.headings[t]), kind.lean) for t in at])
        poses[:, _WRISTS] = np.moveaxis(wrists[person], 0, 1)
        poses -= poses[:, :1].copy()
        parts.append(stretch.given(person, at, poses, [*TRUNK, *_WRISTS]))
    return parts


def given_twirl(stretch: Stretch) -> list[KnownFrames]:
    """The bodies and joined right hands of two people, one of whom turns under them."""
    courses = [stretch.course(person) for person in (0, 1)]
    at = stretch.shown(np.arange(REACHES, stretch.frames - REACHES, 3))
    if not len(at):
        return []
    hands = raised(np.stack([course.places[at] for course in courses]))
    wrist = SMPL22.index("right_wrist")
    parts = []
    for person, course in enumerate(courses):
        poses = np.stack([upright(course.places[t], float(course.headings[t])) for t in at])
        poses[:, wrist] = hands
        poses -= poses[:, :1].copy()
        parts.append(stretch.given(person, at, poses, [*_HIPS, *TRUNK, wrist]))
    return parts


def _moments(touch: Contact, first: int, last: int) -> list[tuple[int, float]]:
    """The frames at which the hand is given, and metres by which it is taken back then."""
    if not touch.times:
        stop = min(last, max(first + round(HELD * FPS), round(0.85 * last)))
        return [(frame, 0.0) for frame in range(first, stop, 3)]
    found: list[tuple[int, float]] = []
    for i in range(touch.times):
        on = first + i * BEAT
        found += [(frame, 0.0) for frame in range(on, on + 7, 3)]
        if i + 1 < touch.times:
            found.append((on + BEAT // 2 + 3, TAKEN_BACK))
    return [(frame, back) for frame, back in found if frame < last]


def _rests(touch: Contact, at: Sequence[tuple[int, float]], frames: int) -> range:
    """The frames after the last pat of somebody's back: their hands hang, where the network would pat the front."""
    if not touch.times or not touch.behind or not at:
        return range(0)
    return range(at[-1][0] + LOWERS, frames, REACHES // 2)


def _arrival(course: Course) -> int:
    """The frame from which somebody stays within 4 cm of where they end up."""
    away = np.linalg.norm(course.places - course.places[-1], axis=1) > 0.04
    return int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0


def _turned(course: Course) -> int:
    """The frame from which somebody faces where they will face in the end."""
    away = np.abs(course.headings - course.headings[-1]) > 0.2
    return int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0


def _leaving(course: Course, first: int) -> int:
    """The frame after ``first`` at which somebody begins to turn or to go."""
    if first >= len(course.places):
        return len(course.places)
    moved = np.linalg.norm(course.places[first:] - course.places[first], axis=1) > 0.1
    turned = np.abs(course.headings[first:] - course.headings[first]) > 0.4
    gone = np.flatnonzero(moved | turned)
    return first + int(gone[0]) if len(gone) else len(course.places)
