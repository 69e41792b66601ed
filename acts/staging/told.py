"""A beat in the terms of the stage: the one form between words or acts and what is given.

The pipelines read no words. They take a :class:`Told`, which comes from the acts of a plan (:mod:`.staging`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from .bodies.figures import Figure
from .bodies.gestures import Gesture
from .bodies.limbs import Limb
from .bodies.strikes import Strike
from .contacts import Contact
from .floor import Standing
from .holds import Hold
from .lifts import Lift
from .moves import Move, goes
from .postures import Change, Posture
from .ways import Way

_IN_PLACE = (Way.STAY, Way.FACE, Way.BACKS)
"""Moves that need no legs."""


@dataclass(frozen=True)
class Told:
    """All that a beat has its people do, who are "a" and "b".

    Attributes:
        moves: of each person in order; () where nobody is sent anywhere.
        idle: those who stand by.
        frozen: those who stand like statues.
        gesturing: those who only stand and make a gesture that the network knows little of.
        gestures: of hands, by person.
        contact: the first touch.
        hold: in which both dance or spin.
        by_both_hands: one holds both of the other's hands.
        twirls: under whose raised arm the other turns; "" if nobody does.
        linked: they hold each other by the hand.
        pulls: the one who pulls the other up by the hand; "" if nobody does.
        lift: of one by the other.
        strike: blows or throws.
        changes: of posture in order, by person.
        limbs: legs, trunk and head that move by themselves, by person.
        figures: what whole bodies do on the spot, by person.
        leaps: the number of jumps, by person.
        bows: the number of bows, by person, and True where they are deep.
        on_feet: those who do what needs legs.
        loose: those who do nothing with their hands: they walk, sit, jump or stand by.
        placed: where both are when the story begins with this beat.
        keeps_place: they are side by side or back to back, and stay so.
        reaching: those who do something within the other's reach, and the metres between the two for it.
        alone: a sentence on what a does and one on what b does; "" for a person who has none of their own.
    """

    moves: tuple[Move, ...] = ()
    idle: frozenset[str] = frozenset()
    frozen: frozenset[str] = frozenset()
    gesturing: frozenset[str] = frozenset()
    gestures: Mapping[str, Gesture] = field(default_factory=dict)
    contact: Contact | None = None
    hold: Hold | None = None
    by_both_hands: bool = False
    twirls: str = ""
    pulls: str = ""
    linked: bool = False
    lift: Lift | None = None
    strike: Strike | None = None
    changes: Mapping[str, tuple[Change, ...]] = field(default_factory=dict)
    limbs: Mapping[str, tuple[Limb, ...]] = field(default_factory=dict)
    figures: Mapping[str, Figure] = field(default_factory=dict)
    leaps: Mapping[str, int] = field(default_factory=dict)
    bows: Mapping[str, tuple[int, bool]] = field(default_factory=dict)
    on_feet: frozenset[str] = frozenset()
    loose: frozenset[str] = frozenset()
    placed: Standing | None = None
    keeps_place: bool = False
    reaching: Mapping[str, float] = field(default_factory=dict)
    alone: tuple[str, str] = ("", "")

    @property
    def is_planned(self) -> bool:
        """True if people go somewhere, stand by, sit, kneel, lie down, jump, bow or touch."""
        return self.moves_bodies or bool(self.idle or self.gesturing)

    @property
    def moves_bodies(self) -> bool:
        """True if more is planned than bystanders and a gesture."""
        found = (self.contact, self.changes, self.leaps, self.bows, self.limbs, self.figures)
        return goes(self.moves) or self.placed is not None or any(found)

    @property
    def size(self) -> int:
        """The number of things that are planned, without who stands by."""
        ways = {(move.person, move.way) for move in self.moves if move.way is not Way.STAY}
        single = (self.contact, self.hold, self.lift, self.strike, self.twirls, self.keeps_place)
        whole = (self.leaps, self.bows, self.figures)
        listed = [*self.changes.values(), *self.limbs.values(), self.gestures, *whole, ways]
        return sum(map(bool, single)) + sum(map(len, listed))

    @property
    def going(self) -> set[str]:
        """The people who walk, jump, dance or the like."""
        going = {move.person for move in self.moves if move.way not in _IN_PLACE}
        return going | self.on_feet | set(self.leaps) | set(self.figures)

    @property
    def joined(self) -> bool:
        """True if two hold or carry each other, so that neither can be placed alone."""
        return bool(self.lift or self.twirls or self.hold)


def at_start(story: Sequence[Told], beat: int) -> dict[str, Posture]:
    """The postures of both people, "a" and "b", when a beat of a story begins."""
    held = dict.fromkeys("ab", Posture.STANDS)
    for person, posture in _from_the_start(story).items():
        held[person] = posture
    for i, told in enumerate(story[: beat + 1]):
        held |= dict.fromkeys(told.going, Posture.STANDS)
        for person, listed in told.changes.items():
            if i == 0 and listed[0].posture is Posture.STANDS:
                held[person] = Posture.SITS  # who gets up was down
            if i < beat and not listed[-1].passing:
                held[person] = listed[-1].posture
    return held


def _from_the_start(story: Sequence[Told]) -> dict[str, Posture]:
    """The postures of people of whom a later beat first says that they are down already."""
    found: dict[str, Posture] = {}
    known: set[str] = set()
    for told in story:
        for person, listed in told.changes.items():
            if person not in known and listed[0].already:
                found[person] = listed[0].posture
        known |= set(told.changes) | told.going
    return found
