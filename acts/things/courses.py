"""The course of one thing through a motion: the hands that hold, give and throw it, and where it is put."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from motion import InputError
from motion.skeleton import SIDES
from motion.things import FURNITURE, Mesh, Thing, shape
from motion.things.hands import WITHIN, Hands, Moment, kick, level, lowest, meeting, release, smoothed
from motion.things.tracks import BLEND, Course, Track, at_rest, held, takes_both_hands, upright_frame
from motion.vectors import FLAT, heading_of, square_frame

from .uses import Use

SPEED = 5.5
"""Metres a second of a throw, along the floor."""
SHORTEST, LONGEST = 0.4, 1.1
"""Seconds of a flight."""
BEFORE_FEET = 0.3
"""Metres from a pelvis at which a thing that was rolled there comes to rest."""
TOE = 0.06
"""Metres from the ball of a foot to the tip of its shoe."""
WORKS_AHEAD = 0.75
"""Metres before the pelvis at which the far end of a broom or a spade is on the floor."""
TABLE = 0.74
"""Height of a table in metres, where the hand does not say it."""
TABLES = (0.45, 1.0)
"""Heights that a hand may ask for."""
CHANGES = 0.5
"""Seconds in which a thing changes from a person's one hand to the other."""
IN_HAND = frozenset(("holds", "takes", "plays", "fights", "uses", "gives", "drops", "throws", "rolls", "bounces"))
"""What is done with a thing by somebody who has it in their hand, and takes it up or over for that."""


@dataclass
class ThingCourse:
    """One thing and all that happens to it.

    Args:
        hands: of both people.
        uses: of the thing, in order.
    """

    hands: Hands
    uses: Sequence[Use]
    events: list[dict[str, Any]] = field(default_factory=list)
    tables: list[Thing] = field(default_factory=list)
    holders: list[tuple[int, tuple[int, ...], tuple[int, ...]]] = field(default_factory=list)
    """(first frame, holders, their hands) of each hold, in order; hands: 0 left, 1 right."""

    def __post_init__(self) -> None:
        first = self.uses[0]
        self.kind, self.name = first.kind, first.name
        self.surface = self._carried_shape() if first.does == "carries" else shape(self.kind)
        self.holder: int | None = None
        self.side = 1
        self.course = Course(self._first(first), self.hands.fps)
        self._hold_from(0)
        if first.does == "carries" and len(first.agents) == 2:
            self.holders = [(0, (0, 1), (0, 1))]

    def thing(self) -> Thing:
        """The thing with its track."""
        for use in self.uses:
            if use.does not in IN_HAND:
                getattr(self, f"_{use.does}")(use)
            elif self._takes_up(use, use.agents[0]) and (then := getattr(self, f"_{use.does}", None)):
                then(use)
        places, rotations = self.course.places, self.course.rotations
        return Thing(self.kind, self.surface, places, rotations, self.name)

    # ---- where it begins -------------------------------------------------------------------------------
    def _first(self, use: Use) -> Track:
        who = use.agents[0]
        if use.does == "carries":
            return self._between_both()
        if use.does == "uses":
            return self._to_floor(who)
        if use.does == "kicks":
            self.holder = None
            return self._before_foot(who, kick(self.hands, who, use.start, use.stop))
        if use.does == "lifts":
            return self._on_floor(who, lowest(self.hands, who, use.start, use.stop).frame)
        if use.does in ("takes", "catches") and use.other is not None:
            who = use.other
        return self._in_hand(who, self._side_of(use, who))

    def _side_of(self, use: Use, who: int) -> int:
        """The hand with which a person begins to hold it."""
        hands = self.hands
        if use.does == "gives" or use.does == "takes":
            giver = use.agents[0] if use.does == "gives" else 1 - use.agents[0]
            return meeting(hands, giver, use.start, use.stop).sides[0]
        if use.does in ("throws", "catches"):
            return self._release(who, use).sides[0]
        if use.does in ("puts", "rolls"):
            return lowest(hands, who, use.start, use.stop).sides[0]
        return hands.better_side(who, use.start, use.stop, use.side)

    def _in_hand(self, who: int, side: int) -> Track:
        self.holder, self.side = who, side
        return held(self.hands, who, side, self.kind, self.surface)

    def _on_floor(self, who: int, frame: int) -> Track:
        self.holder = None
        hands = self.hands
        spot = hands.palms[who, :, frame].mean(axis=0)
        pelvis, ahead = hands.joint(who, "pelvis")[frame], hands.ahead[who, frame]
        short = 0.3 + self.surface.size[2] / 2 - float((spot - pelvis) @ ahead)
        spot = (spot + max(short, 0.0) * ahead) * FLAT
        return at_rest(self.kind, self.surface, spot, ahead, hands.frames)

    def _to_floor(self, who: int) -> Track:
        """A tool in the right hand, as a broom is held: its far end is on the floor ahead."""
        self.holder, self.side = who, 1
        hands, ahead = self.hands, self.hands.ahead[who]
        palm = smoothed(hands.palms[who, 1], 3)
        goal = (hands.joint(who, "pelvis") + WORKS_AHEAD * ahead) * FLAT
        reach = np.linalg.norm(goal - palm, axis=1, keepdims=True)
        along = (goal - palm) / reach
        return palm + (reach - self.surface.vertices[:, 1].max()) * along, square_frame(along, ahead)

    def _before_foot(self, who: int, moment: Moment) -> Track:
        """On the floor, where the foot of a kick strikes it."""
        ahead = self.hands.ahead[who, moment.frame]
        toes = self.hands.joint(who, f"{SIDES[moment.sides[0]]}_foot")[moment.frame]
        spot = (toes + (TOE + self.surface.size[2] / 2) * ahead) * FLAT
        return at_rest(self.kind, self.surface, spot, ahead, self.hands.frames)

    def _hold_from(self, frame: int) -> None:
        """Notes who holds it from a frame on."""
        both = takes_both_hands(self.kind, self.surface)
        sides = (0, 1) if both else (self.side,)
        self.holders.append((frame, () if self.holder is None else (self.holder,), sides))

    def _take(self, frame: int, who: int, side: int, seconds: float = BLEND) -> None:
        """Puts it into a person's hand at a frame."""
        self.course.then(frame, self._in_hand(who, side), seconds)
        self._hold_from(frame)

    def _let_hands_go(self, frame: int) -> None:
        self.holder = None
        self._hold_from(frame)

    # ---- what happens to it ----------------------------------------------------------------------------
    def _say(self, use: Use, frame: int | None, **more: Any) -> None:
        at = None if frame is None else round(frame / self.hands.fps, 2)
        self.events.append({"act": use.id, "does": use.does, "by": "ab"[use.agents[0]], "at": at} | more)

    def _takes_up(self, use: Use, who: int) -> bool:
        """True if a person holds it when their act begins, or takes it up or over for that."""
        if self.holder is None:
            self._lifts(use)
        elif self.holder != who:
            self._pass(use, self.holder, who)
        named = SIDES.index(use.side) if use.side else self.side
        if self.holder == who and named != self.side and not takes_both_hands(self.kind, self.surface):
            self._take(use.start, who, named, CHANGES)  # into the hand that the words name
        return self.holder == who

    def _pass(self, use: Use, giver: int, receiver: int) -> None:
        """From hand to hand where these meet; it stays with the giver where they do not."""
        moment = meeting(self.hands, giver, use.start, use.stop)
        if moment.metres > WITHIN + self.surface.size.max() / 4:
            self._say(use, None, why=f"hands stay {moment.metres:.1f} m apart")
            return
        if self.side != moment.sides[0]:
            before = max(moment.frame - round(0.5 * self.hands.fps), 0)
            self._take(before, giver, moment.sides[0])
        self._take(moment.frame, receiver, moment.sides[1], max(BLEND, moment.metres / 3))
        self._say(use, moment.frame, to="ab"[receiver])

    def _gives(self, use: Use) -> None:
        if use.other is not None:
            self._pass(use, use.agents[0], use.other)

    def _lifts(self, use: Use) -> None:
        if self.holder is not None:
            return
        who = use.agents[0]
        moment = lowest(self.hands, who, use.start, use.stop)
        self._take(moment.frame, who, moment.sides[0], 0.25)
        self._say(use, moment.frame)

    def _puts(self, use: Use) -> None:
        who = use.agents[0]
        if self.holders[-1][1] == use.agents == (0, 1):  # it comes down between them
            frame, frames = lowest(self.hands, who, use.start, use.stop).frame, self.hands.frames
            place = self.course.places[frame] * FLAT - [0.0, self.surface.vertices[:, 1].min(), 0.0]
            self.course.put(frame, (np.tile(place, (frames, 1)), np.tile(self.course.rotations[frame], (frames, 1, 1))))
            self._let_hands_go(frame)
            self._say(use, frame, on="floor")
            return
        if not self._takes_up(use, who):
            return
        moment = lowest(self.hands, who, use.start, use.stop, self.side)
        self._let_go(use, who, moment.frame)

    def _drops(self, use: Use) -> None:
        self._let_go(use, use.agents[0], (use.start + use.stop) // 2)

    def _let_go(self, use: Use, who: int, frame: int) -> None:
        hands = self.hands
        spot, ahead = self.course.places[frame].copy(), hands.ahead[who, frame]
        near = float((spot - hands.joint(who, "pelvis")[frame]) @ ahead)
        spot = spot + max(0.38 - near, 0.0) * ahead  # not between the feet
        support = 0.0
        if use.on:
            below = -(self.surface.vertices @ self.course.rotations[frame].T)[:, 1].min()
            support = round(float(np.clip(spot[1] - below, *TABLES)), 2)
            support = TABLE if use.on == "computer" else support
            mesh = shape(use.on, height=support)
            place = (spot + (mesh.size[2] / 2 - 0.15) * ahead) * FLAT
            self.tables.append(Thing.at_rest(use.on, mesh, place, heading_of(-ahead), hands.frames))
        rest = at_rest(self.kind, self.surface, spot * FLAT + [0, support, 0], ahead, hands.frames)
        self.course.put(frame, rest)
        self._let_hands_go(frame)
        self._say(use, frame, on=use.on or "floor")

    # ---- throws ----------------------------------------------------------------------------------------
    def _release(self, thrower: int, use: Use) -> Moment:
        way = level((self.hands.joint(1 - thrower, "pelvis") - self.hands.joint(thrower, "pelvis")).mean(axis=0))
        towards = way + np.array([0.0, 0.4, 0.0])
        return release(self.hands, thrower, use.start, use.stop, towards)

    def _throws(self, use: Use) -> None:
        who = use.agents[0]
        moment = self._release(who, use)
        if moment.sides[0] != self.side:
            before = max(moment.frame - round(0.6 * self.hands.fps), 0)
            self._take(before, who, moment.sides[0])
        caught = next((then for one, then in pairwise(self.uses) if one is use and then.does == "catches"), None)
        if use.other is None and caught is None:
            self._throw_away(use, who, moment.frame)
        else:
            catcher = caught.agents[0] if caught else use.other
            assert catcher is not None
            self._fly(use, moment.frame, catcher)

    def _fly(self, use: Use, frame: int, catcher: int) -> None:
        """A throw that is caught by the hand that is nearest when it comes down."""
        hands, last = self.hands, self.hands.frames - 1
        gap = float(np.linalg.norm((hands.palms[catcher, :, frame].mean(axis=0) - self.course.places[frame])[[0, 2]]))
        seconds = float(np.clip(gap / SPEED, SHORTEST, LONGEST)) if catcher != use.agents[0] else LONGEST
        down = frame + round(seconds * hands.fps)
        at = min(down, last)
        side = int(hands.palms[catcher, :, at, 1].argmax())
        if abs(float(np.diff(hands.palms[catcher, :, at, 1])[0])) < 0.1:
            reach = np.linalg.norm(hands.palms[catcher, :, at] - self.course.places[frame], axis=-1)
            side = int(reach.argmin())
        self._let_hands_go(frame)
        goal = self._in_hand(catcher, side)
        self._hold_from(max(down - round(0.1 * hands.fps), frame))
        self.course.throw(frame, down, goal[0][at])
        if down < last:
            self.course.places[down:] = goal[0][down:]
            self.course.then(down + round(0.15 * hands.fps), (self.course.places, goal[1]), 0.15)
        self._say(use, frame, to="ab"[catcher], caught=round(down / hands.fps, 2))

    def _throw_away(self, use: Use, who: int, frame: int) -> None:
        """A throw that nobody catches: it comes down three metres ahead."""
        hands = self.hands
        spot = (self.course.places[frame] + 3.0 * hands.ahead[who, frame]) * FLAT
        rest = at_rest(self.kind, self.surface, spot, hands.ahead[who, frame], hands.frames)
        down = frame + round(0.8 * hands.fps)
        self.course.throw(frame, down, rest[0][0])
        if down < hands.frames - 1:
            self.course.then(down + round(0.1 * hands.fps), rest, 0.1)
        self._let_hands_go(frame)
        self._say(use, frame)

    def _rolls(self, use: Use) -> None:
        """Let go where the hand is lowest, it rolls over the floor to the other's feet, or three metres ahead."""
        self._roll(use, lowest(self.hands, use.agents[0], use.start, use.stop, self.side).frame)

    def _kicks(self, use: Use) -> None:
        """Struck by the foot that swings fastest, it rolls over the floor as :meth:`_rolls` lets it."""
        who = use.agents[0]
        moment = kick(self.hands, who, use.start, use.stop)
        if self.holder is not None:
            laid = max(moment.frame - self.hands.fps // 2, use.start)
            self.course.put(round(laid), self._before_foot(who, moment))
        self._roll(use, moment.frame)

    def _roll(self, use: Use, frame: int) -> None:
        who, hands = use.agents[0], self.hands
        goal = self.course.places[frame] + 3.0 * hands.ahead[who, frame]
        if use.other is not None:
            other = hands.joint(use.other, "pelvis")[min(frame + round(LONGEST * hands.fps), hands.frames - 1)]
            goal = other - BEFORE_FEET * level(other - self.course.places[frame])
        self.course.roll(frame, goal, float(self.surface.size[1]) / 2)
        self._let_hands_go(frame)
        self._say(use, frame, **({} if use.other is None else {"to": "ab"[use.other]}))

    def _bounces(self, use: Use) -> None:
        """From the hand to the floor and back, as often as the hand goes down."""
        radius = float(self.surface.size[1]) / 2
        under = self.hands.palms[use.agents[0], self.side] - [0.0, radius + 0.02, 0.0]
        self.course.bounce(under, use.start, use.stop, radius)
        self._say(use, use.start)

    def _catches(self, use: Use) -> None:
        who = use.agents[0]
        if self.holder == who:
            return
        if self.holder is None:
            self._lifts(use)
            return
        moment = self._release(self.holder, use)
        self._fly(use, moment.frame, who)

    # ---- carried by two --------------------------------------------------------------------------------
    def _carries(self, use: Use) -> None:
        if len(use.agents) == 1:
            self._takes_up(use, use.agents[0])
        else:
            self.holder = None
            self._say(use, use.start, to="ab"[use.agents[1]])

    def _carried_shape(self) -> Mesh:
        """As long as the way between the two people leaves room for."""
        gap = np.linalg.norm((self.hands.joint(0, "pelvis") - self.hands.joint(1, "pelvis"))[:, [0, 2]], axis=1)
        width = round(float(np.clip(np.median(gap) - 0.55, 0.5, 2.2)), 1)
        return shape(self.kind, width=width)

    def _between_both(self) -> Track:
        """Between the hands of both, along the line between them, upright."""
        hands = self.hands
        ends = hands.palms.mean(axis=1)  # (2, T, 3)
        middle = smoothed(ends.mean(axis=0), 5)
        along = smoothed(level(hands.joint(1, "pelvis") - hands.joint(0, "pelvis")), 9)
        top = float(self.surface.vertices[:, 1].max())
        standing = float(self.surface.vertices[:, 1].min()) >= 0.0
        place = middle.copy()
        place[:, 1] = np.maximum(middle[:, 1] - (top - 0.05 if standing else 0.0), 0.03 if standing else 0.0)
        return place, upright_frame(along)


def courses(hands: Hands, uses: Iterable[Use]) -> list[ThingCourse]:
    """One course a thing: uses of one name follow each other, and two who each hold one have two."""
    several: dict[tuple[str, str], list[Use]] = {}
    for use in uses:
        if use.does in ("sits", "passes", "faces", "opens", "closes"):
            continue
        if use.kind in FURNITURE and use.does != "carries":
            continue
        single = use.does in ("holds", "fights", "plays", "uses") and len(use.agents) == 2
        for who in use.agents if single else (None,):
            mine = use if who is None else replace(use, agents=(who,), other=None)
            several.setdefault((use.name, "" if who is None else "ab"[who]), []).append(mine)
    listed: list[ThingCourse] = []
    for each in several.values():
        try:
            listed.append(ThingCourse(hands, each))
        except InputError:  # a size that its kind cannot have
            continue
    return listed
