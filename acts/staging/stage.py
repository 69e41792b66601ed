"""The acts of a beat in the terms of the stage: each entry's shapes become moves, touches, postures and the like.

What several acts of one beat ask for is settled here, in one place: a person who is held, carried or struck takes part
in that and in nothing else, a person whom no act names stands by, and a denied act leaves its people where they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

from acts import shapes
from acts.captions import of_each
from acts.lexicon import Lexicon, lexicon
from acts.plan import FROM_BEHIND, Act, beats, other_of
from acts.things import is_fixture, kind_of

from .act_kinds import (
    figure_of,
    hits,
    is_after,
    is_attempt,
    is_deep,
    is_gentle,
    is_manner,
    is_near,
    only_stays,
    region_of,
    walks,
)
from .beginnings import Setting, standing
from .bodies.figures import Figure
from .bodies.gestures import OF_BOTH, SIDES, Gesture, Hand
from .bodies.limbs import Limb
from .bodies.strikes import Bout, Strike
from .contacts import LOW, Contact, Region
from .holds import TWIRL, Hold
from .lifts import Carry, Lift
from .moves import Move, away, fastest, finished, goes, lifted_moves, struck_moves
from .postures import LOWERED, Change, Posture
from .roles import gesturing, loose, standing_by, strike_of
from .told import Told
from .ways import Way

_WAYS = {
    "to": Way.TO,
    "away": Way.AWAY,
    "past": Way.PAST,
    "around": Way.ROUND,
    "behind": Way.BEHIND,
    "along": Way.ALONG,
    "after": Way.AFTER,
    "back": Way.BACK,
    "aside": Way.ASIDE,
    "ahead": Way.AHEAD,
    "to and fro": Way.PACE,
}
_RIGHTWARDS = ("right", "clockwise")
"""Directions to the right, and those of a turn to the right."""
_TURNS = {"around": Way.TURN, "to": Way.FACE, "away": Way.TURN}
PULLED = 0.8
"""Metres from where somebody stands up at which the one stands who pulls them up."""
ON_BENCH = 0.65
"""Metres between two who sit on one bench."""
_JUMPS = 3
"""Jumps of a person who is already jumping when the beat begins."""
_DODGES = (Way.BACK, Way.ASIDE)
"""Ways in which somebody gets out of a blow's reach."""
_LEGS = frozenset(("dance", "fight", "ways", "play"))
"""Groups whose acts are done on one's feet."""


def staged(acts: Sequence[Act], known: Lexicon | None = None) -> Told:
    """Tells the stage what the acts of one beat ask for.

    Args:
        acts: of the beat; those that the lexicon does not have are passed over.
        known: the lexicon; ours by default.
    """
    return _staged(tuple(acts), lexicon() if known is None else known)


@lru_cache(maxsize=512)
def _staged(acts: tuple[Act, ...], known: Lexicon) -> Told:
    return _Stage(acts, known).told()


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
        self.gestures: dict[str, Gesture] = {}
        self.changes: dict[str, tuple[Change, ...]] = {}
        self.leaps: dict[str, int] = {}
        self.limbs: dict[str, tuple[Limb, ...]] = {}
        self.figures: dict[str, Figure] = {}
        self.bows: dict[str, tuple[int, bool]] = {}
        self.contact: Contact | None = None
        self.hold: Hold | None = None
        self.twirls, self.pulls = "", ""
        self.lift: Lift | None = None
        self.blows: list[tuple[tuple[str, ...], shapes.Strike, Act]] = []
        self.setting = Setting()
        self.linked = self.both_hands = False
        self.frozen: set[str] = set()
        self.behind: set[str] = set()
        """Those who stand behind the other."""
        self.faces: set[str] = set()
        """Those who stand before a window or the like and do something with it."""

    def told(self) -> Told:
        """All that they tell."""
        for act, entry in sorted(self.done, key=lambda pair: self.level[pair[0].id]):
            for shape in () if is_manner(entry) and len(self.done) > 1 else entry.stage:
                self._take(act, shape)
        for act in self.acts:
            refused = self.known.entries[act.act].refused if act.act in self.known.entries else ()
            if act.polarity == "not" and act.modality == "told" and len(act.agents) == 1:
                for shape in refused:
                    self._take(act, shape)
            elif not act.happens and act.polarity == "done" and len(act.agents) == 1:  # it is offered in vain
                for shape in refused:
                    self._take(act, shape.model_copy(update={"who": "agent"}))
        self._agree()
        struck = strike_of(self.blows, self.done, late=bool(self.blows) and self._follows(self.blows[0][2]))
        if struck is not None and struck.bout is Bout.THROWS:  # catching is part of it
            caught = {who for act, e in self.done if e.thing == "catches" for who in act.agents}
            self.gestures = {who: gesture for who, gesture in self.gestures.items() if who not in caught}
        moves = self._moves(struck)
        busy = {*self.gestures, *self.faces, *(move.person for move in self.moves)}
        idle = standing_by(self.acts, self.done, busy, self.known)
        waving = gesturing(self.gestures, moves, self.done)
        free = frozenset[str]() if self._is_joined() else loose(self.done, idle)
        return Told(
            moves=moves,
            idle=idle,
            frozen=frozenset(self.frozen),
            gesturing=waving - self.changes.keys(),
            gestures=self.gestures,
            contact=self.contact,
            hold=self.hold,
            by_both_hands=self.both_hands or any(self._leads_by_both_hands(move) for move in moves),
            twirls=self.twirls,
            pulls=self.pulls,
            lift=self.lift,
            strike=struck,
            changes=self.changes,
            limbs=self.limbs,
            figures=self.figures,
            leaps=self.leaps,
            bows=self.bows,
            linked=self.linked or any(move.linked for move in moves),
            on_feet=frozenset(who for act, e in self.done if e.group in _LEGS for who in act.agents),
            loose=free - self.gestures.keys() - self.limbs.keys(),
            placed=standing(
                replace(
                    self.setting,
                    lift=self.lift,
                    strike=struck,
                    twirls=bool(self.twirls),
                    postures=[change.posture for listed in self.changes.values() for change in listed],
                )
            ),
            keeps_place=self.setting.backs or self.setting.beside,
            reaching=self._reaching(),
            alone=away(of_each(self.acts, self.known), moves),
        )

    # ---- shapes --------------------------------------------------------------------------------------

    def _take(self, act: Act, shape: shapes.Shape) -> None:
        people = self._people(act, shape)
        if isinstance(shape, shapes.Stay):
            self.frozen |= set(people) if shape.frozen else set()
            self.setting = replace(self.setting, apart=self.setting.apart or shape.apart)
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
                way = Way.FACE if faces else _TURNS[shape.way]
                right = act.direction in _RIGHTWARDS
                self.moves += [Move(who, way, turns=turns, late=late, rightwards=right) for who in people]
            case shapes.Stay() if shape.facing == "away":
                self.moves += [Move(who, Way.AVERTED) for who in people]
            case shapes.Place():
                self._place(act, shape)
            case shapes.Posture():
                self._posture(act, shape, people)
            case shapes.Limb():
                side, direction = act.side or shape.side, act.direction or shape.direction
                limb = Limb(shape.does, side, direction, act.times or 0)
                self.limbs |= {who: (*self.limbs.get(who, ()), limb) for who in people}
            case shapes.Figure():
                self.figures |= dict.fromkeys(people, figure_of(act, shape))
            case shapes.Jump():
                times = act.times or (max(shape.times, _JUMPS) if act.already else shape.times)
                self.leaps |= dict.fromkeys(people, min(times, 5))
            case shapes.Bow():
                self.bows |= dict.fromkeys(people, (min(act.times or 1, 5), shape.deep or is_deep(act)))
            case shapes.Gesture():
                hand, side = Hand[shape.gesture.upper()], act.side or shape.sides
                sides = SIDES if hand in OF_BOTH or side == "both" else (side,)
                self.gestures |= dict.fromkeys(people, Gesture(hand, sides))
            case shapes.Touch():
                self._touch(act, shape)
            case shapes.Hold(hold="twirl"):
                self.twirls = people[0]
            case shapes.Hold():
                self.hold = Hold[shape.hold.upper()]
            case shapes.Pull():
                self.pulls, self.both_hands = people[0], act.side == "both"
                self.moves.append(Move(people[0], Way.TO, near=PULLED))
            case shapes.Link():
                self.linked = True
            case shapes.Lift() if self.lift is None or self.lift.carry is Carry.UP:
                comes = people[0] if self.lift is not None else ""  # to pick up whom they carry then
                self.lift = Lift(people[0], Carry[shape.carry.upper()], shape.spins, comes)
            case shapes.Strike():
                both = self.known.entries[act.act].mutual
                self.blows.append((("a", "b") if both else people, shape, act))

    def _is_going(self, act: Act) -> bool:
        """True if both are on their way while an act is done."""
        level = self.level[act.id]
        beside = (other for other, entry in self.done if self.level[other.id] == level and walks(entry))
        return any(len(other.agents) == 2 for other in beside)

    def _place(self, act: Act, shape: shapes.Place) -> None:
        if shape.way == "behind":
            self.behind.update(self._people(act, shape))
            alone = len(act.agents) == 1 or shape.who == "first"
            if alone:
                self.setting = replace(self.setting, behind=act.agents[0], apart=shape.apart)
            return
        here, backs = self.setting, shape.way == "back to back"
        beside = here.beside or shape.way == "beside"
        self.setting = replace(here, backs=here.backs or backs, beside=beside, apart=here.apart or shape.apart)
        self.moves += [Move(who, Way.BACKS) for who in "ab" if backs]

    def _posture(self, act: Act, shape: shapes.Posture, people: tuple[str, ...]) -> None:
        if len(people) == 2 and kind_of(act.thing or "") == "bench":
            self.setting = replace(self.setting, beside=True, apart=ON_BENCH)
        for who in people:
            self.changes[who] = (*self.changes.get(who, ()), *self._changed(act, shape))

    def _changed(self, act: Act, shape: shapes.Posture) -> list[Change]:
        """The changes of posture of an act, one after another where it is done several times."""
        posture, already = Posture(shape.posture), shape.already or act.already
        waits = {Posture.LIES: 0.4, Posture.STANDS: 0.35} if shape.who == "patient" else {}
        if any(other.agents != act.agents and hits(entry) for other, entry in self.done):
            waits = {Posture.LIES: 0.35}  # they are struck first
        after = max(self.level[act.id] / self.levels, waits.get(posture, 0.0))
        times = min(act.times or shape.times, 5) if shape.passing else 1
        shares = [0.0 if already else after + (1 - after) * i / times for i in range(times)]
        gently = is_gentle(act) and not already
        return [Change(posture, already, share, shape.passing, gently) for share in shares]

    def _people(self, act: Act, shape: shapes.Shape) -> tuple[str, ...]:
        """Whom a shape is for."""
        if shape.who == "both":
            return ("a", "b")
        if shape.who == "patient":
            return (act.patient or other_of(act.agents[0]),)
        if shape.who == "first":
            return act.agents[:1]
        return act.agents

    def _go(self, act: Act, shape: shapes.Go, who: str) -> Move:
        way = _WAYS[shape.way]
        if act.direction == "back" and way in (Way.AHEAD, Way.PAST):
            way = Way.BACK  # "glides backwards"
        given = act.distance is not None and way in (Way.AHEAD, Way.BACK)
        metres = act.distance if act.distance is not None and given else shape.metres
        turns = float(act.times) if act.times and way is Way.ROUND else shape.turns
        return Move(
            who,
            way,
            min(shape.speed * (1.0 if shape.who == "patient" else act.speed), 3.0),
            turns,
            shape.stops or any(r.kind == "until" for r in act.order),
            shape.linked,
            way is not Way.AFTER and self._late(act),
            metres,
            shape.near,
            shape.backwards,
            shape.gait,
            act.direction in _RIGHTWARDS,
        )

    def _chase(self, act: Act, shape: shapes.Go) -> None:
        """Both run after each other: a goes ahead, unless later words say who chases whom."""
        told = [each for each, entry in self.done if any(is_after(s) for s in entry.stage)]
        if all(len(each.agents) == 2 for each in told):
            self.moves.append(self._go(act, shape, "b"))

    def _late(self, act: Act) -> bool:
        """True if an act comes after one that is done in place, or after one that is refused."""
        refused = (other for other in self.acts if not other.happens and other.act in self.known.entries)
        if any(shape.do != "stay" for other in refused for shape in self.known.entries[other.act].refused):
            return True
        before = [other for other, _ in self.done if self.level[other.id] < self.level[act.id]]
        going = {other.id for other, entry in self.done if walks(entry)}
        return any(other.id not in going for other in before)

    def _follows(self, act: Act) -> bool:
        """True for an act that comes after what somebody does until then."""
        return any(
            self.level[act.id] > self.level[other.id] and not (other.already or only_stays(entry))
            for other, entry in self.done
        )

    def _touch(self, act: Act, shape: shapes.Touch) -> None:
        if self.contact is not None:
            return
        giver = act.agents[0]
        lies = shape.beside and shape.part == "shoulder"  # also of a head on the chest
        region = Region.SHOULDER if lies else region_of(act, shape)
        if region is None:
            return
        hands = act.side if act.side and shape.hands in ("left", "right") else shape.hands
        sides = {"both": SIDES, "none": ()}.get(hands, (hands,))
        times = min(act.times or shape.times, 5) if shape.times else 0
        late = self._follows(act)
        behind = shape.behind or giver in self.behind or FROM_BEHIND in act.manner
        behind = behind or (region is Region.BACK and not any(e.mutual for _, e in self.done))
        self.contact = Contact(
            giver, region, sides, times, late, behind and not shape.beside, shape.fells, shape.beside
        )
        if shape.fells:
            fallen = Change(Posture.LIES, after=0.4)
            self.changes[other_of(giver)] = (*self.changes.get(other_of(giver), ()), fallen)

    # ---- what follows from all of them ---------------------------------------------------------------

    def _agree(self) -> None:
        """Settles what two shapes ask of one body: a low person keeps their trunk, a lifted one is turned round."""
        if (touch := self.contact) is not None and touch.region in LOW:
            lowered = {change.posture for change in self.changes.get(touch.person, ())}
            if lowered and lowered <= LOWERED:
                del self.changes[touch.person]  # they kneel down to what they touch
                self.contact = replace(touch, late=False)
        low = {who for who, listed in self.changes.items() if listed[-1].posture is not Posture.STANDS}
        self.limbs = {who: limbs for who, limbs in self.limbs.items() if who not in low}
        comes = next((move.person for move in self.moves if move.way is Way.TO), "")
        if self.lift is not None and comes:
            self.lift = replace(self.lift, comes=comes)
        turns = any(move.way in (Way.TURN, Way.FACE) for move in self.moves)
        if self.lift is not None and (self.twirls or turns):
            self.lift, self.twirls = replace(self.lift, spins=self.lift.carry is not Carry.BACK), ""
        for who, listed in self.changes.items():  # gets up from where they are, from a seat if nothing says
            self.changes[who] = (listed[0], *(c for c in listed[1:] if not c.already))
        self.changes = {
            who: tuple(c for i, c in enumerate(listed) if not i or c.passing or c.posture is not listed[i - 1].posture)
            for who, listed in self.changes.items()
        }

    def _moves(self, struck: Strike | None) -> tuple[Move, ...]:
        if self.hold is not None:
            return tuple(Move(who, Way.HOLD, near=self.hold.value, turns=self.hold.turns) for who in "ab")
        if self.lift is not None:
            return lifted_moves(self.lift, max((m.speed for m in self.moves if m.way is Way.TO), default=1.1))
        if self.twirls:
            other = other_of(self.twirls)
            turned = Move(other, Way.FACE, late=True), Move(other, Way.TURN, turns=1.0)
            return Move(self.twirls, Way.TO, near=TWIRL), *turned
        low = {*self.changes, *self.leaps, *self.figures}
        if struck is not None:
            other = other_of(struck.turns[0])
            own = next((m for m in self.moves if m.person == other and m.way in _DODGES), None)
            return struck_moves(struck, own, down=other in self.changes)
        told = [replace(move, linked=move.linked or self.linked) for move in fastest(self.moves)]
        if {move.person for move in told if move.way is Way.TO} == {"a", "b"}:  # they meet for what they do then
            told = [replace(m, near=m.near or self._reaching().get(m.person, 0.0)) for m in told]
        going = {move.person for move in told} | low
        told += [Move(who, Way.THING) for who in sorted(self.faces - going)]
        made = finished(told, until=any(move.until for move in self.moves))
        if not goes(made):
            stay = self.done and all(only_stays(entry) for _, entry in self.done)
            return tuple(Move(who, Way.STAY) for who in "ab") if stay and not made else tuple(made)
        backs = any(move.way in _DODGES for move in made)
        acting = {who for act, _ in self.done for who in act.agents}
        for who in "ab":
            stands = all(move.person != who for move in made) and who not in low
            if stands and not (backs and who in acting):  # a push or a blow takes its own step
                made.append(Move(who, Way.STAY))
        return tuple(move for move in made if move.way is not Way.STAY or move.person not in low)

    def _reaching(self) -> dict[str, float]:
        """The metres between the two for what each does within the other's reach."""
        return {who: e.near for act, e in self.done if is_near(act, e) for who in act.agents}

    def _leads_by_both_hands(self, move: Move) -> bool:
        return move.backwards and move.way is Way.AWAY and move.person not in self.gestures

    def _is_joined(self) -> bool:
        """True for two who hold each other or are led."""
        linked = self.linked or any(move.linked for move in self.moves)
        return bool(self.lift or self.hold or self.twirls or linked)
