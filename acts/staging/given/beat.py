"""The ways that the words of a beat send its people, as the network is given them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from acts.plan import other_of
from motion import FPS
from motion.placement import Placement
from motion.transforms import heading

from ..beginnings import starting
from ..bodies.gestures import Hand
from ..bodies.poses import ARMS, HANDS, standing, upright
from ..bodies.steps import ON_FEET
from ..bodies.strikes import Bout
from ..contacts import Contact
from ..floor import Standing, plan
from ..holds import Hold
from ..moves import Move, goes
from ..parts import KnownFrames, Part
from ..postures import Change, Posture
from ..sampled import Way2D
from ..told import Told
from ..ways import Way
from ..window import Window
from .bodies import SETTLES, all_but, figure_poses, given_bow, given_figure, given_limbs, given_steps, halted
from .contacts import coming, given_contact, given_hold, given_twirl, meeting, towards_touched
from .hands import hands, outer_hands
from .lifts import Carrying
from .paths import given_gait, path_of
from .postures import UPRIGHT, Pose, led, postures, still_down
from .pulls import given_pull
from .room import Room, roomy
from .stretch import Stretch
from .strikes import given_blows

Array = NDArray[np.floating]

POSED = 4
"""Frames between two poses of a bystander: as many as between the network's knots, of which others would waver."""
TURNED = 4
"""Frames between two poses of a person whose trunk the network would turn to the other."""


class _Beat(Protocol):
    @property
    def length(self) -> float:
        """Seconds."""


class _Story(Protocol):
    """The story that is staged: what the request of a scene says of its beats.

    Attributes:
        beats: their lengths.
        edges: the first frame of each beat and the end of the last one.
        told: what each beat's acts ask for.
        paths, poses: the request's own, which come before what the words ask for.
        plans_words: whether what is planned is said.
        seed: draws how people stand and how late they are.
    """

    @property
    def beats(self) -> Sequence[_Beat]: ...
    @property
    def edges(self) -> Sequence[int]: ...
    @property
    def told(self) -> Sequence[Told]: ...
    @property
    def paths(self) -> Sequence[Any]: ...
    @property
    def poses(self) -> Sequence[Any]: ...
    @property
    def plans_words(self) -> bool: ...
    @property
    def seed(self) -> int: ...


def planned(
    request: _Story, window: Window, scene: Array, placement: Placement, taken: Collection[int] = ()
) -> list[Part]:
    """The places, poses and hands that the words of a window's beat ask for, in the network's frame.

    Args:
        request: the story.
        window: the window.
        scene: (2, T, 22, 3), whose frames before the window are there.
        placement: from the scene's world to the network's frame.
        taken: the people whose way or poses the request gives. Two who hold or carry each other are then left to the
            network.
    """
    if taken and request.told[window.beat].joined:
        return []
    return [part for part in _parts(request, window, scene, placement) if part.person not in taken]


def _parts(request: _Story, window: Window, scene: Array, placement: Placement) -> list[Part]:
    told = request.told[window.beat]
    still = told.idle
    start, stop = request.edges[window.beat], request.edges[window.beat + 1]
    if not start and (request.paths or request.poses):
        return []
    if not start and not told.is_planned:
        return _apart(request, window, placement)
    before = scene[:, max(start - 4, 0) : start]
    stand = _stand(before) if start else _beginning(request)
    lifted = told.lift
    found = coming(told, stand, _down(scene, start)) if start else told.moves
    room = _room(request, scene, still, found, Stretch(window, placement, stand, start, stop))
    stand = room.stand
    beat = Stretch(window, placement, stand, start, stop)
    parts, posed = ([], {}) if lifted else _held(request, scene, room, still, found, beat)
    parts += room.steps(start, window, placement)
    touch, found = meeting(told.contact, found, posed, stand)
    if lifted is not None and not start and not lifted.comes:  # they are held from the first frame
        found = tuple(m for m in found if (m.person, m.way) != (lifted.carrier, Way.STAY))
    if touch is not None:
        parts = [part for part in parts if part.person != "ab".index(touch.person)]
    if not start and not parts and not found and told.keeps_place:
        found = tuple(Move(who, Way.AVERTED) for who in "ab")
    goal = towards_touched(touch, posed, stand, told.pulls)
    ways = {way.person: way for way in plan(found, goal, stop - start, first=not start)}
    ways = {person: way for person, way in ways.items() if person not in {part.person for part in parts}}
    beat = replace(beat, ways=ways)
    if lifted is not None and len(ways) == 2:
        carrying = Carrying(lifted, beat, told.gestures.get("ab"["ba".index(lifted.carrier)]))
        parts += carrying.given()
        beat = replace(beat, ways=carrying.before())
    return parts + _on_their_ways(request, scene, found, touch, posed, beat)


def _on_their_ways(
    request: _Story, scene: Array, found: Sequence[Move], touch: Contact | None, posed: dict[int, Array], beat: Stretch
) -> list[Part]:
    """The ways of a beat, and the touches, holds, blows and gestures on them."""
    told, ways, parts = request.told[beat.window.beat], beat.ways, list[Part]()
    hand = None if touch is None else given_contact(touch, posed, beat)
    if hand is not None:
        parts.append(hand)
    if told.pulls:
        down = 1 - "ab".index(told.pulls)
        parts += given_pull(told.pulls, _postures(request, scene, down, beat), beat, both=told.by_both_hands)
    low = {"ab".index(move.person): move.gait for move in found if move.gait}
    free = not (told.contact or told.joined or told.linked or told.strike)
    for person, way in ways.items():
        if low.get(person) in ON_FEET:
            parts += given_steps(low[person], person, told, beat) if free else path_of(way, beat)
        elif person in low:
            parts += given_gait(low[person], person, _down(scene, beat.start), beat)
        else:
            parts += path_of(_until_posed(way, hand, beat), beat)
    led = Hold.RING if any(move.backwards for move in found) and told.by_both_hands else None
    if (held := told.hold or led) is not None and len(ways) == 2:
        parts += given_hold(held, beat)
    if len(ways) == 2 and told.twirls:
        parts += given_twirl(beat)
    if (struck := told.strike) is not None and "ab".index(struck.turns[0]) in ways:
        parts += given_blows(struck, told, beat)
    before = scene[:, beat.start - 1].astype(np.float64) if beat.start else None
    for arms in hands(told, found, posed, beat, before, request.seed):
        if told.lift is None or "ab"[arms.person] == told.lift.carrier:
            parts.append(arms)
    parts += outer_hands(told, found, beat)
    return parts


def _postures(request: _Story, scene: Array, person: int, beat: Stretch) -> list[Pose]:
    """The poses by which a person's posture is held in a beat of a scene (2, T, 22, 3)."""
    last = scene[person, beat.start - 1] if beat.start else None
    return postures(request.told, beat.window.beat, person, beat.start, beat.stop, beat.stand, last)


def _until_posed(way: Way2D, hand: KnownFrames | None, beat: Stretch) -> Way2D:
    """A way, up to where the same person kneels down to what they touch: from then on poses say where they are."""
    if hand is None or hand.person != way.person or 0 not in hand.joints:
        return way
    kept = np.asarray(beat.in_window(way.frames)) < min(hand.frames)
    headings = None if way.headings is None else way.headings[kept]
    return Way2D(way.person, np.asarray(way.frames)[kept].tolist(), way.places[kept], headings)


def _room(request: _Story, scene: Array, still: Collection[str], found: Sequence[Move], beat: Stretch) -> Room:
    """The room that the postures of a beat need, in which nobody goes anywhere or touches the other."""
    told, stand = request.told[beat.window.beat], beat.stand
    met = any(figure.meets for figure in told.figures.values())
    if told.joined or told.strike or told.contact or met or _going(found):
        return Room(stand)
    poses = {
        person: figure_poses(told, person, beat, request.seed)
        if who in told.figures
        else _postures(request, scene, person, beat)
        for person, who in enumerate("ab")
        if who not in still
    }
    return roomy(stand, poses, _down(scene, beat.start), first=not beat.start)


def _down(scene: Array, start: int) -> list[int]:
    """The people who are not on their feet before a frame of a scene."""
    return [person for person in (0, 1) if start and scene[person, start - 1, 0, 1] <= UPRIGHT]


def _going(found: Sequence[Move]) -> set[str]:
    """The people who leave their place."""
    return {move.person for move in found if move.way not in (Way.STAY, Way.BACKS, Way.AVERTED)}


def _held(
    request: _Story, scene: Array, room: Room, still: Collection[str], found: Sequence[Move], beat: Stretch
) -> tuple[list[Part], dict[int, Array]]:
    """The poses of bystanders and of those whose posture is given, and a pose of each of the latter."""
    beat = replace(beat, start=beat.start + room.delay)
    window, stand, start, stop = beat.window, beat.stand, beat.start, beat.stop
    told = request.told[window.beat]
    gone = {move.person for move in found if move.way not in (Way.STAY, Way.BACKS)}
    parts: list[Part] = []
    posed: dict[int, Array] = {}
    for person, who in enumerate("ab"):
        last = scene[person, start - room.delay - 1] if start else None
        up = last is None or last[0, 1] > UPRIGHT
        if who in told.figures and who not in gone:
            parts += given_figure(request.told, person, beat, last, request.seed)
            posed[person] = upright(stand.places[person], float(stand.headings[person]))
            continue
        if up and who in told.limbs and who not in gone:
            parts += given_limbs(told.limbs[who], person, told, beat, request.seed)
            posed[person] = upright(stand.places[person], float(stand.headings[person]))
            continue
        if up and who in told.bows and _only_bows(told, who) and who not in gone:
            parts += given_bow(person, told, beat, request.seed)
            posed[person] = upright(stand.places[person], float(stand.headings[person]))
            continue
        turned = last is None and _keeps_back(told, who)
        if up and (who in still or ((turned or who in told.gesturing) and who not in gone)):
            touched = told.contact is not None and told.contact.person != who and who not in told.gestures
            free = () if who in still or touched else HANDS if turned else ARMS
            every = TURNED if turned else POSED
            parts += _posed(person, beat, request.seed, free, every)
            if who not in still:
                posed[person] = upright(stand.places[person], float(stand.headings[person]))
        elif who not in gone:
            poses = postures(request.told, window.beat, person, start, stop, stand, last)
            if len(poses) > 1:
                posed[person] = poses[-1][1]
            tail = window.tail(request.edges[-1])
            busy = who in told.gestures or (told.contact is not None and told.contact.person == who)
            down = still_down(poses, stop, tail)
            loose = who in told.loose
            for joints, frames, known in led(down, window.start, window.stop + tail, arms=not busy, loose=loose):
                parts.append(beat.given(person, np.asarray(frames) - start, known, joints))
    return parts, posed


def _only_bows(told: Told, who: str) -> bool:
    """True for a person who bows and keeps their feet and hands out of other things."""
    return not (who in told.changes or who in told.leaps or who in told.gestures or told.contact)


def _keeps_back(told: Told, who: str) -> bool:
    """True for a person who stands so that the network would turn their trunk to the other, against their feet."""
    touch, down = told.contact, who in told.changes
    if touch is not None and touch.beside and touch.person == who:
        return False  # they lean to the other, or reach around them
    return not down and (told.keeps_place or (touch is not None and touch.behind and touch.person != who))


def plan_note(request: _Story, go_on: Callable[[], None] = lambda: None) -> list[str]:
    """A sentence on what the words of a scene have its people do, as far as that is given to the network.

    ``go_on`` is called before each beat; what it raises ends the reading.
    """
    said = []
    for number, told in enumerate(request.told, 1):
        go_on()
        ways = _said_together(told) or [
            *_said_postures(told),
            *(f"person {m.person.upper()} {m.way.value}" for m in told.moves if _is_said(m)),
        ]
        if ways:
            said.append((f"in beat {number} " if len(request.beats) > 1 else "") + " and ".join(dict.fromkeys(ways)))
    if not request.plans_words or not said:
        return []
    return [f"From the words: {'; '.join(said)}. A path that you draw takes the place of this."]


def _is_said(move: Move) -> bool:
    """True for a move that takes somebody elsewhere or turns them."""
    return move.way is not Way.STAY and bool(move.turns or move.way is not Way.HOLD)


def _said_together(told: Told) -> list[str]:
    """A lift, a twirl or the blows of a beat, in words."""
    if (lifted := told.lift) is not None:
        turns = " and turns round" if lifted.spins else ""
        return [f"person {lifted.carrier.upper()} {lifted.carry.words}{turns}"]
    if leader := told.twirls:
        return [f"person {'B' if leader == 'a' else 'A'} turns under the other's arm"]
    if (struck := told.strike) is not None:
        verb = "throws something" if struck.bout is Bout.THROWS else "strikes"
        return [f"person {who.upper()} {verb}" for who in dict.fromkeys(struck.turns)]
    return []


def _said_postures(told: Told) -> Iterator[str]:
    """The changes of posture and the jumps of a beat, in words."""
    for who, listed in told.changes.items():
        for change in listed:
            up = change.posture is Posture.STANDS
            yield f"person {who.upper()} {'gets up' if up else change.posture.value}"
    for who in told.leaps:
        yield f"person {who.upper()} jumps"


def _beginning(request: _Story) -> Standing:
    """Places before the first beat, so that the first moves of the story can begin."""
    first = request.told[0]
    if (first.lift or first.twirls or first.strike or not _going(first.moves)) and first.placed is not None:
        return first.placed
    if any(gesture.hand is Hand.OFFERS for gesture in first.gestures.values()) and not goes(first.moves):
        return starting((), request.beats[0].length)
    lies = any(listed[0] == Change(Posture.LIES, already=True) for listed in first.changes.values())
    near = lies or bool(first.reaching)
    touch = first.contact
    if touch is not None and touch.behind and not goes(first.moves):
        averted = Move(other_of(touch.person), Way.AVERTED)
        return starting((averted,), request.beats[0].length, near=True)
    for beat, told in zip(request.beats, request.told, strict=True):
        if goes(told.moves):
            return starting(told.moves, beat.length, near=near)
    return starting((), request.beats[0].length, near=near)


def _apart(request: _Story, window: Window, placement: Placement) -> list[Part]:
    """The places where two people begin who only come or go in a later beat; free if they touch before."""
    for beat, told in zip(request.beats[1:], request.told[1:], strict=True):
        found = told.moves
        if goes(found):
            if not any(move.way in (Way.TO, Way.AWAY) for move in found) or window.part or request.told[0].reaching:
                return []
            return _given_places(starting(found, beat.length), window, placement)
    return []


def _given_places(stand: Standing, window: Window, placement: Placement) -> list[Part]:
    """The places of both people at the first frame."""
    ways = [Way2D(i, [0], stand.places[i : i + 1], stand.headings[i : i + 1]) for i in (0, 1)]
    beat = Stretch(window, placement, stand, 0, window.stop)
    return [part for way in ways for part in path_of(way, beat)]


def _posed(person: int, beat: Stretch, seed: int, free: Collection[int], every: int) -> list[Part]:
    """The poses of a bystander that fall into a window, but for the joints that are ``free``."""
    frames = beat.every(every, SETTLES if beat.start else 0)
    if not len(frames):
        return []
    seconds = (frames + beat.start) / FPS
    poses = standing(halted(person, beat), float(beat.stand.headings[person]), seconds, seed=seed + person)
    return [beat.given(person, frames, poses, all_but(free))]


def _stand(poses: Array) -> Standing:
    """Places and speeds of the two people at the last of some frames (2, N, 22, 3)."""
    poses = np.asarray(poses, dtype=np.float64)
    places = poses[:, :, 0][..., [0, 2]]
    speeds = (places[:, -1] - places[:, 0]) / max(poses.shape[1] - 1, 1) * FPS
    return Standing(places[:, -1], heading(poses[:, -1]), speeds)
