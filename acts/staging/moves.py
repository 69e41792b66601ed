"""Moves: where the acts of a beat send its people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from acts.plan import other_of

from .bodies.strikes import Strike, turning
from .holds import Hold
from .lifts import Carry, Lift
from .ways import Way


@dataclass(frozen=True)
class Move:
    """The movement of one person in a beat.

    Attributes:
        person: "a" or "b".
        way: how they move.
        speed: metres a second.
        turns: whole turns, of :attr:`Way.ROUND` and :attr:`Way.TURN`; a second, of :attr:`Way.HOLD` and
            :attr:`Way.SPAR`.
        until: the move ends early, because something happens then.
        linked: they hold each other by the hands or arms.
        late: it comes after something else that is done in place.
        metres: length of the way, of :attr:`Way.AHEAD`.
        near: metres from the other at which who comes up to them stands; 0 for as far as the network likes.
        backwards: they go away with their face to the other.
        gait: of :data:`.gaits.GAITS`, of a person who goes low over the floor, or of :data:`.steps.STEPS`; "" for a
            walk or a run.
        rightwards: to their right; of turns and of ways around, clockwise as seen from above.
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

    @property
    def sense(self) -> float:
        """1 to the left and counter-clockwise, -1 to the right and clockwise."""
        return -1.0 if self.rightwards else 1.0


_GOING = {Way.AWAY, Way.PAST, Way.ROUND, Way.ALONG, Way.TO, Way.BEHIND}
"""Ways on which somebody can be followed."""


def goes(found: Sequence[Move]) -> bool:
    """True if any of the moves takes a person elsewhere or turns them."""
    return any(move.way is not Way.STAY for move in found)


def fastest(told: Sequence[Move]) -> list[Move]:
    """The moves, each once: who walks away and runs away at once, runs; who walks ahead of another passes nobody."""
    found: dict[tuple[str, Way, bool], Move] = {}
    for move in told:
        key = move.person, move.way, move.late
        if key not in found or move.speed > found[key].speed:
            found[key] = move
    ahead = {move.person for move in found.values() if move.way is Way.AHEAD}
    return [move for move in found.values() if move.way is not Way.PAST or move.person not in ahead]


def finished(made: Sequence[Move], *, until: bool) -> list[Move]:
    """The moves: the person followed, or leading backwards, goes ahead; ``until`` something ends that early."""
    return _led_backwards(_followed(list(made), until=until))


def struck_moves(found: Strike, dodge: Move | None, *, down: bool) -> tuple[Move, ...]:
    """The places of two people when at least one strikes; the other dodges, goes down or stays."""
    near, first = found.bout.value, found.turns[0]
    if not found.answered:
        return tuple(Move(person, Way.SPAR, near=near, turns=turning(found.bout)) for person in "ab")
    other = other_of(first)
    comes = Move(first, Way.TO, near=near)
    if dodge is not None:
        return comes, replace(dodge, late=True)
    return (comes,) if down else (comes, Move(other, Way.STAY))


def lifted_moves(found: Lift, speed: float) -> tuple[Move, ...]:
    """The way to the other, at a speed, of the one who comes, and of one who picks them up and walks on or turns."""
    comes = found.comes or found.carrier
    made = [Move(comes, Way.TO, speed, near=found.carry.near), Move(other_of(comes), Way.STAY)]
    if found.spins:
        made.append(Move(found.carrier, Way.TURN, turns=1.0))
    elif found.carry is not Carry.UP:
        made.append(Move(found.carrier, Way.STAY))
        drags = found.carry is Carry.DRAGS
        made.append(Move(found.carrier, Way.AWAY, 0.5 if drags else 0.8, backwards=drags))
    return tuple(made)


def away(alone: tuple[str, str], moves: Sequence[Move]) -> tuple[str, str]:
    """The sentences of each, of which one who goes to a thing only walks away, as the network knows no things.

    Their hands are given; of a reach the network would make one to the other, and not turn round.
    """
    gone = {move.person for move in moves if move.way is Way.THING}
    a, b = (
        "One person turns around and walks away." if words and who in gone else words
        for who, words in zip("ab", alone, strict=True)
    )
    return a, b


def _followed(made: list[Move], *, until: bool) -> list[Move]:
    """The moves: the person followed goes ahead; ``until`` something ends that early."""
    for person, other in ("ab", "ba"):
        ways = {move.way for move in made if move.person == other}
        after = next((move for move in made if move.person == person and move.way is Way.AFTER), None)
        if after is not None and Way.BACK in ways:
            made = [
                replace(m, way=Way.AWAY, speed=0.8, backwards=True) if (m.person, m.way) == (other, Way.BACK) else m
                for m in made
            ]
        elif after is not None and not ways & _GOING:
            made = [Move(other, Way.AWAY, after.speed, until=until), *made]
    return made


def _led_backwards(made: Sequence[Move]) -> list[Move]:
    """The moves, where one who walks backwards and leads the other along goes ahead of them."""
    backs = {move.person for move in made if move.way is Way.BACK}
    if len(backs) != 1 or not any(move.way is Way.ALONG for move in made):
        return list(made)
    (leader,) = backs
    follower = other_of(leader)
    near = Hold.RING.value
    return [Move(leader, Way.AWAY, 0.8, backwards=True, near=near), Move(follower, Way.AFTER, 0.8, near=near)]
