"""The acts of a beat as a score: each entry's shapes, cast with the beat's people.

What several acts of one beat ask for is settled here, in one place: two who are in a hold, a lift, a twirl or a fight
take part in that and in nothing else, in this order; a person whom no act names stands by, and a denied act leaves its
people where they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

from acts import shapes
from acts.captions import of_each
from acts.lexicon import Entry, Lexicon, is_fixture, kind_of, lexicon
from acts.plan import FROM_BEHIND, GAITS, ON_TIPTOE, Act, beats, other_of
from motion.skeleton import OTHER_SIDE

from .act_kinds import (
    figure_of,
    gesturing,
    hits,
    is_attempt,
    is_manner,
    is_near,
    loose,
    only_stays,
    part_of,
    standing_by,
    strike_of,
    walks,
)
from .figures import DANCES, LIMBS
from .floor import CLOSE
from .gestures import GESTURES
from .holds import COUPLE, EMBRACE, HOLDS
from .moves import (
    away,
    fastest,
    followed,
    held_moves,
    led_backwards,
    lifted_moves,
    struck_moves,
    told_still,
    twirled_moves,
)
from .score import DODGES, LOW, LOWERED, Change, Lift, Move, Score, Strike, Touch, Way, as_story, goes

PULLED = 0.8
"""Metres from where somebody stands up at which the one stands who pulls them up."""
ON_BENCH = 0.65
"""Metres between two who sit on one bench."""
_MOST = 5
"""Times that something is done in one beat, at most."""
_TO_THING = 0.3
"""Of a whole turn: by how much somebody turns from the other to point at a thing."""
_LONG = {1: 1.1, 2: 1.6}
"""Metres from the other at which one person who crawls stops, and at which two do."""
_GAITS = {ON_TIPTOE, *GAITS} - {"staggers"}
_RIGHTWARDS = ("right", "clockwise")
"""Directions to the right, and those of a turn to the right."""
_LEGS = frozenset(("dance", "fight", "ways", "play"))
"""Groups whose acts are done on one's feet."""


def scores_of(story: Sequence[Sequence[Act]]) -> tuple[Score, ...]:
    """The scores of a story, beat by beat, which fit each other."""
    return as_story([score_of(acts) for acts in story])


def score_of(acts: Sequence[Act]) -> Score:
    """The score of the acts of one beat.

    Args:
        acts: of the beat; those that the lexicon does not have are passed over.
    """
    return _score_of(tuple(acts), lexicon())


@lru_cache(maxsize=512)
def _score_of(acts: tuple[Act, ...], known: Lexicon) -> Score:
    return _Stage(acts, known).score()


def _distance(act: Act, entry: Entry) -> float:
    """The metres between two people of whom one does something from so far away, or comes from there; else 0."""
    ways = {shape.way for shape in entry.stage if isinstance(shape, shapes.Go)}
    if act.distance is None or not (act.patient or len(act.agents) == 2) or not ways <= {"to"}:
        return 0.0
    return act.distance + CLOSE / 2 * len(ways)


class _Stage:
    """One beat's acts, taken shape by shape."""

    def __init__(self, acts: Sequence[Act], known: Lexicon) -> None:
        self.acts, self.known = acts, known
        self.done = [
            (act, known.entries[act.act])
            for act in acts
            if act.act in known.entries and (act.happens or is_attempt(act, known.entries[act.act]))
        ]
        groups = beats(self.acts)
        self.level = {act.id: level for level, group in enumerate(groups) for act in group}
        self.levels = len(groups)
        self.moves: list[Move] = []
        self.gestures: dict[str, shapes.Gesture] = {}
        self.changes: dict[str, tuple[Change, ...]] = {}
        self.limbs: dict[str, tuple[shapes.Figure, ...]] = {}
        self.figures: dict[str, shapes.Figure] = {}
        self.touch: Touch | None = None
        self.lift: Lift | None = None
        self.blows: list[tuple[tuple[str, ...], shapes.Strike, Act]] = []
        self.hold = self.twirls = self.pulls = self.side = self.stands_behind = ""
        self.apart = 0.0
        self.linked = self.both_hands = False
        self.frozen: set[str] = set()
        self.behind: set[str] = set()
        """Those who are behind the other, whether they are there from the start or not."""
        self.faces: set[str] = set()
        """Those who stand before a window or the like and do something with it."""
        self.reacting: set[str] = set()
        """Those of whom the words only say what is done to them."""

    def score(self) -> Score:
        """All that they ask for."""
        for act, entry in sorted(self.done, key=lambda pair: self.level[pair[0].id]):
            self.apart = self.apart or _distance(act, entry)
            for shape in () if is_manner(entry) and len(self.done) > 1 else entry.stage:
                self._take(act, shape)
        for act in self.acts:
            if act.happens or len(act.agents) != 1 or act.act not in self.known.entries:
                continue
            for shape in self.known.entries[act.act].refused:
                if act.polarity == "done":  # it is offered in vain
                    self._take(act, shape.model_copy(update={"who": "agent"}))
                elif act.modality == "told":
                    self._take(act, shape)
        acting = {who for act in self.acts for who in act.agents}
        for act, entry in self.done:
            if entry.reaction and len(act.agents) == 1 and (other := other_of(act.agents[0])) not in acting:
                self.reacting.add(other)
                facing = act.model_copy(update={"side": OTHER_SIDE.get(act.side or "")})
                for shape in entry.reaction:
                    self._take(facing, shape.model_copy(update={"who": "patient"}))
        self._agree()
        struck = strike_of(self.blows, self.done, late=bool(self.blows) and self._follows(self.blows[0][2]))
        if struck is not None and struck.bout == "throws":  # catching is part of it
            caught = {who for act, e in self.done if e.thing == "catches" for who in act.agents}
            self.gestures = {who: gesture for who, gesture in self.gestures.items() if who not in caught}
        moves = self._moves(struck)
        busy = {*self.gestures, *self.faces, *(move.person for move in (*self.moves, *moves) if move.way != "stay")}
        idle = standing_by(self.acts, self.done, busy, self.known)
        waving = gesturing(self.gestures, moves, self.done)
        linked = self.linked or any(move.linked for move in self.moves)
        free = frozenset[str]() if self.lift or self.hold or self.twirls or linked else loose(self.done, idle)
        leads = any(m.backwards and m.way == "away" and m.person not in self.gestures for m in moves)
        return Score(
            moves=moves,
            idle=idle,
            frozen=frozenset(self.frozen),
            gesturing=waving - self.changes.keys() - self.figures.keys(),
            gestures=self.gestures,
            touch=self.touch,
            hold=self.hold,
            by_both_hands=self.both_hands or leads,
            twirls=self.twirls,
            pulls=self.pulls,
            lift=self.lift,
            strike=struck,
            changes=self.changes,
            limbs=self.limbs,
            figures=self.figures,
            linked=self.linked or any(move.linked for move in moves),
            on_feet=frozenset(who for act, e in self.done if e.group in _LEGS for who in act.agents),
            loose=free - self.gestures.keys() - self.limbs.keys(),
            side=self.side,
            behind=self.stands_behind,
            apart=self.apart,
            reaching=self._reaching(),
            reacting=frozenset(self.reacting),
            alone=told_still(away(of_each(self.acts, self.known), moves), idle),
        )

    # ---- shapes --------------------------------------------------------------------------------------

    def _take(self, act: Act, shape: shapes.Shape) -> None:
        people = self._people(act, shape)
        if isinstance(shape, shapes.Stay | shapes.Gesture) and is_fixture(act.thing):
            self.faces |= set(people)
        match shape:
            case shapes.Go(way="after") if len(people) == 2:
                self._chase(act, shape)
            case shapes.Go():
                self.moves += [self._go(act, shape, who) for who in people]
            case shapes.Turn(way="to") if len(people) == 2 and self._is_going(act):
                pass  # they circle each other face to face
            case shapes.Turn():
                late, times = self._late(act), act.times or 1
                turns = times * (shape.turns if times == 1 else max(shape.turns, 1.0))  # "turns around twice"
                faces = shape.way == "around" and shape.turns < 1 and act.patient and not act.part
                way: Way = "face" if faces or shape.way == "to" else "turn"
                right = act.direction in _RIGHTWARDS
                self.moves += [Move(who, way, turns=turns, late=late, rightwards=right) for who in people]
            case shapes.Stay():
                self.frozen |= set(people) if shape.frozen else set()
                self.moves += [Move(who, "averted") for who in people if shape.averted]
            case shapes.Place():
                self._place(act, shape)
            case shapes.Posture():
                if len(people) == 2 and kind_of(act.thing or "") == "bench":
                    self.side, self.apart = self.side or "beside", ON_BENCH
                for who in people:
                    self.changes[who] = (*self.changes.get(who, ()), *self._changed(act, shape))
            case shapes.Figure():
                figure = figure_of(act, shape)
                if figure.figure in LIMBS:
                    self.limbs |= {who: (*self.limbs.get(who, ()), figure) for who in people}
                else:
                    self.figures |= dict.fromkeys(people, figure)
            case shapes.Gesture():
                sides = "both" if GESTURES[shape.gesture].both else act.side or shape.sides
                self.gestures |= dict.fromkeys(
                    people, shape.model_copy(update={"sides": sides, "times": min(act.times or 0, 20)})
                )
            case shapes.Touch():
                self._touch(act, shape)
            case shapes.Hold(hold="twirl"):
                self.twirls = people[0]
            case shapes.Hold(hold="couple") if len(people) == 1 and act.patient is None:
                self.figures |= dict.fromkeys(people, shapes.Figure(figure=DANCES))
            case shapes.Hold():
                self.hold = shape.hold
            case shapes.Pull():
                self.pulls, self.both_hands = people[0], act.side == "both"
                self.moves.append(Move(people[0], "to", near=PULLED))
            case shapes.Link():
                self.linked = True
            case shapes.Lift() if self.lift is None or self.lift.carry == "up":
                rider = act.agents[0] if shape.who == "patient" and not act.already else ""  # jumps on the back
                comes = people[0] if self.lift is not None else rider  # to pick up the person whom they then carry
                self.lift = Lift(carrier=people[0], carry=shape.carry, spins=shape.spins, comes=comes)
            case shapes.Strike():
                both = self.known.entries[act.act].mutual
                self.blows.append((("a", "b") if both else people, shape, act))

    def _people(self, act: Act, shape: shapes.Shape) -> tuple[str, ...]:
        """Whom a shape is for."""
        if shape.who == "both":
            return ("a", "b")
        if shape.who == "patient":
            return (act.patient or other_of(act.agents[0]),)
        if shape.who == "first":
            return act.agents[:1]
        return act.agents

    def _is_going(self, act: Act) -> bool:
        """True if both are on their way while an act is done."""
        level = self.level[act.id]
        beside = (other for other, entry in self.done if self.level[other.id] == level and walks(entry))
        return any(len(other.agents) == 2 for other in beside)

    def _place(self, act: Act, shape: shapes.Place) -> None:
        if shape.way == "behind":
            self.behind.update(self._people(act, shape))
            if len(act.agents) == 1 or shape.who == "first":
                self.stands_behind, self.apart = act.agents[0], shape.apart
            return
        self.apart = self.apart or shape.apart
        if shape.way == "back to back":
            self.side = shape.way
            self.moves += [Move(who, "back to back") for who in "ab"]
        elif shape.way == "beside":
            self.side = self.side or shape.way

    def _changed(self, act: Act, shape: shapes.Posture) -> list[Change]:
        """The changes of posture of an act, one after another where it is done several times."""
        already = shape.already or act.already
        waits = {"lies": 0.4, "stands": 0.35} if shape.who == "patient" else {}
        if any(other.agents != act.agents and hits(entry) for other, entry in self.done):
            waits = {"lies": 0.35}  # they are struck first
        after = max(self.level[act.id] / self.levels, waits.get(shape.posture, 0.0))
        times = min(act.times or shape.times, _MOST) if shape.passing else 1
        return [
            Change(
                posture=shape.posture,
                already=already,
                after=0.0 if already else after + (1 - after) * i / times,
                passing=shape.passing,
                gently=shape.gently and not already,
                at_table=shape.posture == "sits" and kind_of(act.thing or "") == "table",
            )
            for i in range(times)
        ]

    def _go(self, act: Act, shape: shapes.Go, who: str) -> Move:
        way: Way = shape.way
        near = _LONG[len(act.agents)] if way == "to" and "crawls" in act.manner else shape.near
        if act.direction == "back" and way in ("ahead", "past"):
            way = "back"  # "glides backwards"
        return Move(
            who,
            way,
            speed=min(shape.speed * (1.0 if shape.who == "patient" else act.speed), 3.0),
            turns=float(act.times) if act.times and way == "around" else shape.turns,
            until=shape.stops or any(r.kind == "until" for r in act.order),
            linked=shape.linked,
            late=who in self.reacting or (way != "after" and self._late(act)),
            metres=act.distance if act.distance is not None and way in ("ahead", "back") else shape.metres,
            near=act.distance if act.distance is not None and way == "around" else near,
            backwards=shape.backwards or (way == "away" and act.direction == "back"),
            gait=shape.gait or next((name for name in act.manner if name in _GAITS), ""),
            rightwards=act.direction in _RIGHTWARDS,
        )

    def _chase(self, act: Act, shape: shapes.Go) -> None:
        """Both run after each other: a goes ahead, unless later words say who chases whom."""
        chases = [each for each, entry in self.done if any(getattr(s, "way", "") == "after" for s in entry.stage)]
        if all(len(each.agents) == 2 for each in chases):
            self.moves.append(self._go(act, shape, "b"))

    def _late(self, act: Act) -> bool:
        """True if an act comes after one that is done in place, or after one that is refused."""
        refused = (other for other in self.acts if not other.happens and other.act in self.known.entries)
        if any(shape.do != "stay" for other in refused for shape in self.known.entries[other.act].refused):
            return True
        return any(self.level[other.id] < self.level[act.id] and not walks(entry) for other, entry in self.done)

    def _follows(self, act: Act) -> bool:
        """True for an act that comes after what somebody does until then."""
        return any(
            self.level[act.id] > self.level[other.id] and not (other.already or only_stays(entry))
            for other, entry in self.done
        )

    def _touch(self, act: Act, shape: shapes.Touch) -> None:
        giver = self._people(act, shape)[0]
        lies = shape.beside and shape.part == "shoulder"  # also of a head on the chest
        part: shapes.Part = "shoulder" if lies else part_of(act, shape)
        if self.touch is not None or not part:
            return
        behind = shape.behind or giver in self.behind or FROM_BEHIND in act.manner
        behind = behind or (part == "back" and not any(e.mutual for _, e in self.done))
        self.touch = Touch(
            person=giver,
            part=part,
            hands=act.side if act.side and shape.hands in ("left", "right") else shape.hands,
            times=min(act.times or shape.times, _MOST) if shape.times else 0,
            late=self._follows(act),
            behind=behind and not shape.beside,
            fells=shape.fells,
            beside=shape.beside,
            part_side=act.part_side or "",
        )
        if shape.fells:
            other = other_of(giver)
            self.changes[other] = (*self.changes.get(other, ()), Change(posture="lies", after=0.4))

    # ---- what yields to what -------------------------------------------------------------------------

    def _agree(self) -> None:
        """Settles what two shapes ask of one body: a low person keeps their trunk, a lifted one is turned round."""
        if (touch := self.touch) is not None and touch.part in LOW:
            lowered = {change.posture for change in self.changes.get(touch.person, ())}
            if lowered and lowered <= LOWERED:
                del self.changes[touch.person]  # they kneel down to what they touch
                self.touch = touch.model_copy(update={"late": False})
        low = {who for who, listed in self.changes.items() if listed[-1].posture != "stands"}
        self.limbs = {who: limbs for who, limbs in self.limbs.items() if who not in low}
        if self.hold == COUPLE and (self.side or self.behind or self.moves):  # they dance, and not with each other
            self.hold, self.figures = "", self.figures | dict.fromkeys("ab", shapes.Figure(figure=DANCES))
        if self.lift is not None:
            comes = next((move.person for move in self.moves if move.way == "to"), self.lift.comes)
            turns = bool(self.twirls) or any(move.way in ("turn", "face") for move in self.moves)
            spins = self.lift.carry != "back" if turns else self.lift.spins
            self.lift, self.twirls = self.lift.model_copy(update={"comes": comes, "spins": spins}), ""
        for who, listed in self.changes.items():  # they get up from where they are, from a seat if nothing says
            first, *later = listed
            later = [change for change in later if not change.already]
            new = [c for last, c in pairwise([first, *later]) if c.passing or c.posture != last.posture]
            self.changes[who] = (first, *new)

    def _moves(self, struck: Strike | None) -> tuple[Move, ...]:
        """The moves of the shape that comes first, of which the others yield."""
        if self.hold and not (self.hold == EMBRACE and any(move.way == "to" for move in self.moves)):
            return held_moves(self.hold)
        if self.lift is not None:
            return lifted_moves(self.lift, max((m.speed for m in self.moves if m.way == "to"), default=1.1))
        if self.twirls:
            return twirled_moves(self.twirls)
        if struck is not None:
            other = other_of(struck.turns[0])
            dodge = next((m for m in self.moves if m.person == other and m.way in DODGES), None)
            return struck_moves(struck, dodge, down=other in self.changes)
        return self._own_moves()

    def _own_moves(self) -> tuple[Move, ...]:
        """The moves of people who are free to go; others stay, unless a posture or a figure has their legs."""
        low = {*self.changes, *self.figures}
        moves = [replace(move, linked=move.linked or self.linked) for move in fastest(self.moves)]
        moves = [move for move in moves if move.way != "face" or move.person not in self.changes]  # "sit face to face"
        if self.hold or {move.person for move in moves if move.way == "to"} == {"a", "b"}:  # they meet for what follows
            near = dict.fromkeys("ab", HOLDS[self.hold].apart) if self.hold else self._reaching()
            moves = [replace(m, near=m.near or near.get(m.person, 0.0)) for m in moves]
        going = {move.person for move in moves} | low
        points = {who for who, gesture in self.gestures.items() if gesture.gesture == "points"}
        for who in sorted(self.faces - going):
            moves.append(Move(who, "turn" if who in points else "thing", turns=_TO_THING))
        moves = led_backwards(followed(moves, until=any(move.until for move in self.moves)))
        if not goes(moves):
            stay = self.done and all(only_stays(entry) for _, entry in self.done)
            return tuple(Move(who, "stay") for who in "ab") if stay and not moves else tuple(moves)
        backs = any(move.way in DODGES for move in moves)
        acting = {who for act, _ in self.done for who in act.agents}
        for who in "ab":
            stands = all(move.person != who for move in moves) and who not in low
            if stands and not (backs and who in acting):  # a push or a blow takes its own step
                moves.append(Move(who, "stay"))
        return tuple(move for move in moves if move.way != "stay" or move.person not in low)

    def _reaching(self) -> dict[str, float]:
        """The metres between the two for what each does within the other's reach."""
        return {who: e.near for act, e in self.done if is_near(act, e) for who in act.agents}
