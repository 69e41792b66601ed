"""The places at which a story begins: those of its first beat, or such that its first moves can begin; and the room
that the poses of a beat need, in which people begin, or step, so far apart that their bodies do not overlap. Where
words leave it open, a take draws where and how people begin."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from acts import shapes
from acts.lexicon import Lexicon
from acts.plan import Act, other_of
from motion import FPS, SMPL22
from motion.skeleton import HEAD_TOP
from motion.vectors import Array, floor_points

from .figures import has_side
from .floor import ABREAST, BEHIND, CLOSE, CREEPS, LINKED
from .holds import TWIRL
from .lifts import takes_hold
from .places import Standing, Way2D, eased
from .poses import JOINT, Pose, posed, upright
from .score import Lift, Move, Score, at_start, goes, leaving
from .strikes import BOUTS
from .window import Part, Stretch

BACKS = 0.34
"""Metres between the pelvises of two people who stand or sit back to back: the backs touch."""
BEHIND_BACK = 0.6
"""Metres between two people one of whom stands behind the other."""
RUN_UP = 2.5
"""Metres that somebody runs who jumps on the other's back."""
LEAD = 1.6
"""Metres by which somebody is ahead who is overtaken."""
REACH = 0.75
"""Metres between two people one of whom touches the other."""
_START = {"away": 1.1, "thing": 1.1, "past": 2.2, "around": 1.2, "back": 0.9}
"""Metres between two people at the beginning of a first beat with such a move."""
_SEATS = ("sits", "sits on the ground")
"""Postures in which backs can touch."""


def beginning(scores: Sequence[Score], lengths: Sequence[float]) -> Standing:
    """The places before the first of some beats, of so many seconds, so that the first moves of the story can begin."""
    first, touch = scores[0], scores[0].touch
    free = not (first.lift or first.twirls or first.strike) and leaving(first.moves)
    if not free and (places := placed(first)) is not None:
        return places
    offers = [who for who, gesture in first.gestures.items() if gesture.gesture == "offers"]
    if offers and not goes(first.moves) and (not first.reaching or first.reaching.keys() & offers):
        return starting((), lengths[0])
    opening = [listed[0] for listed in first.changes.values()]
    low = any(at_start(scores, i)[who] != "stands" for i, score in enumerate(scores) for who in score.reaching)
    near = low or bool(first.reaching) or any(c.already and c.posture == "lies" and not c.passing for c in opening)
    if touch is not None and touch.behind and not goes([m for m in first.moves if m.person == touch.person]):
        return starting((Move(other_of(touch.person), "averted"),), lengths[0], near=True)
    for score, seconds in zip(scores, lengths, strict=True):
        if goes(score.moves):
            return starting(score.moves, seconds, near=near)
    return starting((), lengths[0], near=near)


def starting(moves: Sequence[Move], seconds: float, *, near: bool = False) -> Standing:
    """Places before a first beat: a at the origin, facing +Z, and b so that their moves can begin.

    Args:
        moves: of the first beat that has any.
        seconds: its length.
        near: they are within reach of each other, unless one comes to the other.
    """
    ways = {move.way: move for move in reversed(moves)}
    if "along" in ways:
        gap = LINKED if ways["along"].linked else ABREAST
        return Standing(np.array([[0.0, 0.0], [-gap, 0.0]]), np.zeros(2))
    if "after" in ways and any(move.backwards for move in moves):
        gap = ways["after"].near or BEHIND
        return Standing(np.array([[0.0, 0.0], [0.0, gap]]), np.array([0.0, math.pi]))
    if "after" in ways:
        lead = 1 if ways["after"].person == "a" else -1
        return Standing(np.array([[0.0, 0.0], [0.0, lead * BEHIND]]), np.zeros(2))
    if "past" in ways and "ahead" in ways and ways["past"].person != ways["ahead"].person:
        lead = 1 if ways["past"].person == "a" else -1
        return Standing(np.array([[0.0, 0.0], [0.0, lead * LEAD]]), np.zeros(2))
    if "past" in ways and ways["past"].backwards:
        facing = math.pi if ways["past"].person == "a" else 0.0  # both look the same way
        return Standing(np.array([[0.0, 0.0], [0.0, _START["past"]]]), np.full(2, facing))
    if "back to back" in ways:
        return _back_to_back("stands")
    gap = next((_START[move.way] for move in moves if move.way in _START), REACH if near else 1.4)
    if "past" in ways and ways["past"].speed <= CREEPS:
        gap = min(gap, max(0.55 * seconds * ways["past"].speed, 1.2))
    held = (ways[way] for way in ("hold", "spar", "around") if way in ways)
    gap = next((move.near + move.metres for move in held if move.near), gap)
    for move in (ways[way] for way in ("to", "behind", "beside") if way in ways):
        longest = 3.6 if move.speed < 2 else 5.0
        gap = float(np.clip(max(CLOSE, 1.3 * move.near) + 0.6 * seconds * move.speed, 1.8, longest))
    if "ahead" in ways:
        gap = max(gap, min(CLOSE + ways["ahead"].metres, 5.0))
    averted = ("averted",) if "around" in ways else ("averted", "face")
    turned = next((m.person for m in moves if m.way in averted and not m.sits), "")
    turned = turned or next((other_of(m.person) for m in moves if m.way == "behind"), "")
    ahead = -1.0 if turned == "a" else 1.0
    facing_b = 0.0 if turned else math.pi
    return Standing(np.array([[0.0, 0.0], [0.0, ahead * gap]]), np.array([0.0, facing_b]))


def placed(score: Score) -> Standing | None:
    """The places of two people in a first beat; None where it leaves them free."""
    if score.side == "back to back":
        postures = [change.posture for listed in score.changes.values() for change in listed]
        return _back_to_back(next((posture for posture in postures if posture in _SEATS), "stands"))
    if score.side == "beside":
        return Standing(np.array([[0.0, 0.0], [-(score.apart or ABREAST), 0.0]]), np.zeros(2))
    lift, strike = score.lift, score.strike
    if lift is not None and lift.carry == "back" and lift.comes not in ("", lift.carrier):
        return _behind("ab".index(lift.carrier) - 1, RUN_UP)
    if lift is not None and not lift.comes:
        return _carried(lift)
    if score.behind:
        return _behind("ab".index(score.behind), score.apart or BEHIND_BACK)
    if score.twirls or (strike and strike.answered) or score.apart:
        apart = TWIRL if score.twirls else score.apart or (BOUTS[strike.bout].apart if strike else 0.0)
        return Standing(np.array([[0.0, 0.0], [0.0, apart]]), np.array([0.0, math.pi]))
    return None


def _back_to_back(posture: str) -> Standing:
    """The places of two whose backs touch in a posture; the feet are where they stand."""
    apart = BACKS - 2 * float(posed(posture, np.zeros(2), 0.0)[0, 2])
    return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))


def _behind(person: int, metres: float) -> Standing:
    """The place of one person behind the other."""
    places = np.zeros((2, 2))
    places[person, 1] = -metres
    return Standing(places, np.zeros(2))


def _carried(lift: Lift) -> Standing:
    """A place in front of the other for one who is lifted or dragged, and behind the walker for one who is carried."""
    if lift.carry in ("up", "drags"):
        places = np.zeros((2, 2))
        places[1, 1] = takes_hold(lift.carry)
        return Standing(places, np.array([0.0, math.pi]))
    return _behind("ab".index(lift.carrier) - 1, 0.3)


# ---- the room that poses need ------------------------------------------------------------------------


BODY = 0.2
"""Metres between the bones of two people at which their bodies touch."""
FARTHEST = 3.0
"""Metres by which two people are moved apart at most."""
_STEP = 0.05
"""Metres by which the distance is tried."""
PACE = 0.9
"""Metres a second of people who step apart."""
SETTLE = 0.3
"""Seconds in which they come to rest."""
_OFTEN = 8
"""Frames between two given places of a step."""


@dataclass(frozen=True, eq=False)
class Room:
    """Two people with the room that they need.

    Attributes:
        stand: where they are for the poses of the beat.
        delay: frames of the beat in which they step there.
        before: where they are when the beat begins.
    """

    stand: Standing
    delay: int = 0
    before: Standing = field(default_factory=lambda: Standing(np.zeros((2, 2)), np.zeros(2)))

    def steps(self, stretch: Stretch) -> list[Part]:
        """The places of people who step apart, as the network is given them."""
        parts: list[Part] = []
        at = np.arange(_OFTEN, self.delay + 1, _OFTEN)
        if not len(at):
            return parts
        done = eased(np.arange(1, self.delay + 1) / self.delay, 0.4)[at - 1][:, None]
        for person in (0, 1):
            first, last = self.before.places[person], self.stand.places[person]
            if np.linalg.norm(last - first) > _STEP / 2:
                headings = np.full(len(at), float(self.stand.headings[person]))
                parts += stretch.known_way(Way2D(person, at.tolist(), first + done * (last - first), headings))
        return parts


def roomy(stand: Standing, poses: Mapping[int, Sequence[Pose]], fixed: Sequence[int], *, first: bool) -> Room:
    """The room of two people for the poses of a beat.

    Args:
        stand: where they are when it begins.
        poses: by person, as :func:`.postures.postures` gives them for people who stand there. Who has none
            stands upright.
        fixed: people who cannot step aside, as they are down already.
        first: nothing comes before: they begin where they have room.
    """
    moving = [person for person in (0, 1) if person not in fixed]
    if not any(poses.values()) or not moving:
        return Room(stand)
    bodies = _together(stand, poses)
    line = stand.towards(0)
    shares = np.zeros((2, 2))
    for person in moving:
        shares[person] = (line if person else -line) / len(moving)
    if first:  # a is where the scene begins
        shares = np.stack([np.zeros(2), line])
    for apart in np.arange(0.0, FARTHEST + _STEP, _STEP):
        moved = [bodies[i] + floor_points(apart * shares[i]) for i in (0, 1)]
        if distance(moved[0], moved[1]) >= BODY:
            break
    places = stand.places + apart * shares
    if first:
        return Room(replace(stand, places=places))
    if not apart:
        return Room(stand)
    delay = math.ceil((apart / len(moving) / PACE + SETTLE) * FPS)
    return Room(Standing(places, stand.headings), delay, stand)


def _together(stand: Standing, poses: Mapping[int, Sequence[Pose]]) -> tuple[Array, Array]:
    """(N, 22, 3) of both people at every frame at which one of them has a pose."""
    frames = sorted({frame for listed in poses.values() for frame, _ in listed})
    bodies = []
    for person in (0, 1):
        listed = poses.get(person) or [(0, upright(stand.places[person], float(stand.headings[person])))]
        known = np.array([frame for frame, _ in listed])
        bodies.append(np.stack([listed[int(np.abs(known - frame).argmin())][1] for frame in frames]))
    return bodies[0], bodies[1]


def distance(a: Array, b: Array) -> float:
    """The least metres between the bones of two people (N, 22, 3) at one moment."""
    gaps = np.linalg.norm(_points(a)[:, :, None] - _points(b)[:, None], axis=-1)
    return float(gaps.min())


def _points(poses: Array) -> Array:
    """Joints (N, 22, 3), the middles of their bones, and the tops of the heads."""
    neck, head = (poses[:, JOINT[name]] for name in ("neck", "head"))
    up = (head - neck) / np.linalg.norm(head - neck, axis=-1, keepdims=True).clip(min=1e-6)
    crowns = head[:, None] + HEAD_TOP * np.array([[0.5], [1.0]]) * up[:, None]
    return np.concatenate([poses, 0.5 * (poses[:, 1:] + poses[:, list(SMPL22.parents[1:])]), crowns], axis=1)


# ---- takes: what words leave open, drawn by the seed --------------------------------------------------
LEFT_HANDED = 0.35
"""Share of the people who use the left hand where either would do."""
PACES = (0.88, 1.15)
"""Factors of the speed of a walk whose words do not say how fast."""
APART = (0.9, 1.25)
"""Factors of the metres between two who begin without touching."""
OPEN = 0.3
"""Radians by which a person may be turned away from the other at the beginning, to either side."""
_SIDED = (shapes.Gesture, shapes.Touch, shapes.Strike)
_SIDES = ("side", "sides", "hands")
"""Names of their fields for it, which may say "both"."""
_REACHING = frozenset(("hold", "spar", "along", "after", "past", "back to back", "averted", "behind", "thing"))
"""Ways whose places depend on each other."""


@dataclass(frozen=True)
class Take:
    """One take of a story.

    Attributes:
        left: whether a, and b, use the left hand where either would do.
        clockwise: they go round clockwise where no words say how.
        pace: factor of both people's speed.
        apart: factor of the metres between the two at the beginning.
        turned: radians by which a, and b, are turned away from the other at the beginning.
    """

    left: tuple[bool, bool]
    clockwise: bool
    pace: float
    apart: float
    turned: tuple[float, float]

    @classmethod
    def of(cls, seed: int) -> Take:
        """The take of a seed."""
        dice = np.random.default_rng([seed, 1])
        left, clockwise = dice.random(2) < LEFT_HANDED, dice.random() < 0.5
        pace, apart, (a, b) = dice.uniform(*PACES), dice.uniform(*APART), dice.uniform(-OPEN, OPEN, 2).tolist()
        return cls((bool(left[0]), bool(left[1])), clockwise, pace, apart, (a, b))

    def of_acts(self, acts: Sequence[Act], known: Lexicon) -> list[Act]:
        """The acts of a beat with what their words leave open filled in."""
        sided = {str(who) for act in acts if act.side for who in act.agents}
        return [self._filled(act, known, sided) for act in acts]

    def _filled(self, act: Act, known: Lexicon, sided: set[str]) -> Act:
        if act.act not in known.entries or not act.happens:
            return act
        stage, update = known.entries[act.act].stage, dict[str, object]()
        left = all(self.left["ab".index(who)] and who not in sided for who in act.agents)
        one_handed = any(
            has_side(s.figure)
            if isinstance(s, shapes.Figure)
            else isinstance(s, _SIDED) and "both" not in (getattr(s, name, "") for name in _SIDES)
            for s in stage
        )
        if left and act.direction is None and one_handed:
            update["side"] = "left"
        around = any(isinstance(shape, shapes.Go | shapes.Turn) and shape.way == "around" for shape in stage)
        if act.direction is None and act.side is None and self.clockwise and around:
            update["direction"] = "clockwise"
        if act.speed == 1.0 and any(isinstance(shape, shapes.Go) for shape in stage):
            update["speed"] = self.pace
        return act.model_copy(update=update)

    def of_places(self, stand: Standing, score: Score) -> Standing:
        """The places at which a story begins whose first beat leaves them free."""
        fixed = score.joined or score.has_places or score.strike or score.touch or score.linked or score.reaching
        if fixed or any(move.way in _REACHING or (move.way == "around" and move.near) for move in score.moves):
            return stand
        a, b = stand.places
        beside, ahead = self.apart * (b - a)
        sine, cosine = np.sin(self.turned[0]), np.cos(self.turned[0])
        b = a + np.array([beside * cosine + ahead * sine, ahead * cosine - beside * sine])
        return replace(stand, places=np.stack([a, b]), headings=stand.headings + np.array([0.0, sum(self.turned)]))
