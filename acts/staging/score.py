"""The score of a beat: the shapes of its acts, cast with its two people, who are "a" and "b".

The shapes are those of :mod:`acts.shapes`. Where the stage needs more of one, such as the person who touches, a class
here adds that and nothing else. :mod:`.stage` makes scores of acts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal

from acts import shapes
from acts.plan import other_of
from acts.shapes import Figure, Gesture
from motion.skeleton import SIDES

Way = Literal[shapes.Way, "turn", "face", "stay", "averted", "back to back", "hold", "spar", "thing"]
"""Ways over the floor, and of staying: those of :class:`acts.shapes.Go`; a ``turn`` on the spot and one to ``face``
the other; somebody who stays, with their back ``averted``, or ``back to back``; two who go round each other in ``hold``
or ``spar``; and a way to a ``thing``."""
_TO_SEATS = ("to", "beside", "away", "ahead", "thing", "along")
"""Ways at whose end people may sit down."""
IN_PLACE = ("stay", "averted", "back to back")
"""Ways of people who stay as they are."""
DODGES = ("back", "aside")
"""Ways in which somebody gets out of a blow's reach."""
LOW = frozenset(("leg", "foot"))
"""Parts of a standing person's body that one kneels down to reach."""
LOWERED = frozenset(("kneels", "crouches", "bends down"))
"""Postures by which somebody gets down to what is low."""


@dataclass(frozen=True)
class Move:
    """A way of one person over the floor.

    Attributes:
        person: "a" or "b".
        way: how they move.
        speed: metres a second.
        turns: whole turns, of ways "around" and "turn"; a second, of "hold" and "spar".
        until: the move ends early, because something happens then.
        linked: they hold each other by the hands or arms.
        late: it comes after something else that is done in place.
        metres: length of the way, of "ahead" and "back"; 0 for the usual one. Of "hold", of the way to each other.
        near: metres between the two pelvises at its end; 0 leaves that to the network.
        backwards: they go away with their face to the other.
        gait: as in :class:`acts.shapes.Go`.
        rightwards: to their right; of turns and of ways around, clockwise as seen from above.
        sits: they sit down where it ends.
    """

    person: str
    way: Way
    speed: float = 1.1
    turns: float = 0.5
    until: bool = False
    linked: bool = False
    late: bool = False
    metres: float = 0.0
    near: float = 0.0
    backwards: bool = False
    gait: str = ""
    rightwards: bool = False
    sits: bool = False

    @property
    def sense(self) -> float:
        """1 to the left and counter-clockwise, -1 to the right and clockwise."""
        return -1.0 if self.rightwards else 1.0


class Change(shapes.Posture):
    """A posture that one person takes up in a beat, or is in already when it begins ("while she sits").

    Attributes:
        after: share of the beat that comes before, from 0 to 1.
        at_table: they sit at one.
    """

    after: float = 0.0
    at_table: bool = False


class Touch(shapes.Touch):
    """A touch; "waist" is the part only where it is touched from behind.

    Attributes:
        person: the one who touches the other.
        late: something else goes on until then.
        part_side: "left" or "right" for one side of the other's body.
    """

    person: str
    part_side: Literal["", "left", "right"] = ""
    late: bool = False

    @property
    def sides(self) -> tuple[str, ...]:
        """The hands that touch; none for a kiss, or a head that is laid on the other's shoulder from beside."""
        return {"both": SIDES, "none": ()}.get(self.hands, (self.hands,))


class Lift(shapes.Lift):
    """A lift.

    Attributes:
        carrier: the one who lifts the other.
        comes: the one who walks up to the other first; "" for nobody.
        down: they are set down at its end, before something else is done.
    """

    carrier: str
    comes: str = ""
    down: bool = False


@dataclass(frozen=True)
class Strike:
    """The blows or throws of a beat.

    Attributes:
        bout: as in :class:`acts.shapes.Strike`.
        turns: who strikes, in order, "a" and "b", over and over where ``goes_on``.
        goes_on: they strike through the whole beat.
        answered: the other ducks, falls or steps back at the first blow.
        late: something else goes on until then.
        hands: the hand of each blow, where the words name them; "" leaves it open.
        up: what is thrown goes up, and comes down to the one who threw it.
    """

    bout: str
    turns: str
    goes_on: bool = True
    answered: bool = False
    late: bool = False
    hands: tuple[str, ...] = ()
    up: bool = False


@dataclass(frozen=True)
class Score:
    """All that the acts of a beat have its people do.

    Attributes:
        moves: of each person in order; () where nobody is sent anywhere.
        idle: those who stand by.
        frozen: those who stand like statues.
        gesturing: those who only stand and make a gesture that the network knows little of.
        gestures: of hands, by person.
        touch: the first one.
        hold: in which both dance or spin; "" for none.
        by_both_hands: one holds both of the other's hands.
        twirls: under whose raised arm the other turns; "" if nobody does.
        pulls: the one who pulls the other up by the hand; "" if nobody does.
        linked: they hold each other by the hand.
        lift: of one by the other.
        strike: blows or throws.
        changes: of posture in order, by person.
        figures: what whole bodies do on the spot, by person.
        limbs: movements of legs, trunk and head alone, by person.
        on_feet: those who do what needs legs.
        loose: those who do nothing with their hands: they walk, sit, jump or stand by.
        side: how the two are, and stay, to each other: "beside", "back to back", or "" for neither.
        behind: the person who stands behind the other when a story begins with the beat; "" for nobody.
        apart: metres between them then; 0 leaves it free.
        reaching: those who do something within the other's reach, and the metres between the two for it.
        reacting: those of whom the words only say what is done to them, and who react to it.
        alone: a sentence on what a does and one on what b does; "" for a person who has none of their own.
    """

    moves: tuple[Move, ...] = ()
    idle: frozenset[str] = frozenset()
    frozen: frozenset[str] = frozenset()
    gesturing: frozenset[str] = frozenset()
    gestures: Mapping[str, Gesture] = field(default_factory=dict)
    touch: Touch | None = None
    hold: str = ""
    by_both_hands: bool = False
    twirls: str = ""
    pulls: str = ""
    linked: bool = False
    lift: Lift | None = None
    strike: Strike | None = None
    changes: Mapping[str, tuple[Change, ...]] = field(default_factory=dict)
    limbs: Mapping[str, tuple[Figure, ...]] = field(default_factory=dict)
    figures: Mapping[str, Figure] = field(default_factory=dict)
    on_feet: frozenset[str] = frozenset()
    loose: frozenset[str] = frozenset()
    side: str = ""
    behind: str = ""
    apart: float = 0.0
    reaching: Mapping[str, float] = field(default_factory=dict)
    reacting: frozenset[str] = frozenset()
    alone: tuple[str, str] = ("", "")

    @property
    def is_planned(self) -> bool:
        """True if people go somewhere, stand by, sit, kneel, lie down, jump or touch."""
        bodies = (self.touch, self.changes, self.limbs, self.figures)
        return goes(self.moves) or self.has_places or any(bodies) or bool(self.idle or self.gesturing)

    @property
    def has_places(self) -> bool:
        """True if it says where the two are when a story begins with it, whatever they do then."""
        return bool(self.side or self.behind or self.apart)

    @property
    def going(self) -> set[str]:
        """The people who walk, jump, dance or the like."""
        going = leaving(move for move in self.moves if move.way != "face")
        return going | self.on_feet | set(self.figures)

    def bodily(self, who: str) -> tuple[Figure, ...]:
        """The figure of a person, or the movements of their limbs."""
        return (self.figures[who],) if who in self.figures else self.limbs.get(who, ())

    @property
    def joined(self) -> bool:
        """True if two hold or carry each other, so that neither can be placed alone."""
        return bool(self.lift or self.twirls or self.hold)


def leaving(moves: Iterable[Move]) -> set[str]:
    """The people who leave their place, or turn in it."""
    return {move.person for move in moves if move.way not in IN_PLACE}


def goes(moves: Sequence[Move]) -> bool:
    """True if any of the moves takes a person elsewhere or turns them."""
    return any(move.way != "stay" for move in moves)


def as_story(scores: Sequence[Score]) -> tuple[Score, ...]:
    """The scores of the beats of a story, which fit each other."""
    scores = list(scores)
    known: set[str] = set()
    for i, score in enumerate(scores):  # an earlier beat has put them there already
        again = {who for who, listed in score.changes.items() if who in known and listed[0].already and len(listed) > 1}
        changes = {who: listed[1:] if who in again else listed for who, listed in score.changes.items()}
        scores[i] = replace(score, changes=changes) if again else score
        known |= set(score.changes) | score.going
    table: set[str] = set()
    for i, score in enumerate(scores):  # who comes up to a person at a table comes to their side
        table |= {who for who, listed in score.changes.items() if listed[0].already and listed[0].at_table}
        comes = [move.way == "to" and other_of(move.person) in table for move in score.moves]
        moves = (replace(m, way="beside") if side else m for m, side in zip(score.moves, comes, strict=True))
        scores[i] = replace(score, moves=tuple(moves)) if any(comes) else score
        table = table - score.changes.keys() | {who for who, c in score.changes.items() if c[-1].at_table}
    for i, (score, then) in enumerate(pairwise(scores)):  # a person who turns round to the other is touched from behind
        touch, turned = score.touch, {move.person for move in then.moves if move.way == "face"}
        if touch is None or touch.part not in ("shoulder", "back") or touch.person in turned:
            continue
        if turned and not score.changes and not goes(score.moves):
            scores[i] = replace(score, touch=touch.model_copy(update={"behind": True}))
    for i, (score, then) in enumerate(pairwise(scores)):
        if score.lift is not None and score.lift.carry != "drags" and then.lift is None:
            scores[i] = replace(score, lift=score.lift.model_copy(update={"down": True}))
        elif then.touch is not None and then.touch.behind and not then.moves:  # they come from there
            walks_up = (then.touch.person, "to")
            moves = (replace(m, way="behind", near=0.0) if (m.person, m.way) == walks_up else m for m in score.moves)
            scores[i] = replace(score, moves=tuple(moves))
    for i, (score, then) in enumerate(pairwise(scores)):  # to sit down at the end of a way, they turn round there
        sits = [who for who, listed in then.changes.items() if listed[0].posture == "sits" and not listed[0].already]
        there = [move for move in score.moves if move.person in sits and move.way in _TO_SEATS]
        turns = (
            Move(move.person, "turn" if move.way == "along" else "face", sits=True)
            for move in there
            if move.way != "beside"
        )
        moves = (replace(move, sits=move in there) for move in score.moves)
        scores[i] = replace(scores[i], moves=(*moves, *turns)) if there else scores[i]
    for i, score in enumerate(scores):  # a person who is down does not stand by, nor get up for a bow or to step back
        told = tuple(move for move in score.moves if move.person not in score.reacting)
        postures = at_start([*scores[:i], replace(score, figures={}, moves=told), *scores[i + 1 :]], i)
        down = {who for who, posture in postures.items() if posture != "stands"}
        kept = {who: each for who, each in score.figures.items() if each.figure != "bows" or who not in down}
        stays = told if score.reacting & down else score.moves
        scores[i] = replace(score, idle=score.idle - down, figures=kept, moves=stays)
    return tuple(scores)


def at_start(scores: Sequence[Score], beat: int) -> dict[str, str]:
    """The postures of both people, "a" and "b", when a beat of a story begins."""
    held = dict.fromkeys("ab", "stands") | _from_the_start(scores)
    for i, score in enumerate(scores[: beat + 1]):
        held |= dict.fromkeys(score.going, "stands")
        for person, listed in score.changes.items():
            if i == 0 and listed[0].posture == "stands":
                held[person] = "sits"  # a person who gets up was down
            if i < beat and not listed[-1].passing:
                held[person] = listed[-1].posture
    return held


def _from_the_start(scores: Sequence[Score]) -> dict[str, str]:
    """The postures of people of whom a later beat first says that they are down already."""
    states: dict[str, str] = {}
    known: set[str] = set()
    for score in scores:
        for person, listed in score.changes.items():
            if person not in known and listed[0].already:
                states[person] = listed[0].posture
        known |= set(score.changes) | score.going
    return states
