"""Moves: where the acts of a beat send its people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from acts.plan import other_of

from .holds import HOLDS, TWIRL
from .lifts import takes_hold
from .score import Lift, Move, Strike, Way
from .strikes import BOUTS

_GOING = {"away", "past", "around", "along", "to", "behind"}
"""Ways on which somebody can be followed."""


def fastest(moves: Sequence[Move]) -> list[Move]:
    """The moves, each once: who walks away and runs away at once, runs; who walks ahead of another passes nobody."""
    found: dict[tuple[str, Way, bool], Move] = {}
    for move in moves:
        key = move.person, move.way, move.late
        if key not in found or move.speed > found[key].speed:
            found[key] = move
    ahead = {move.person for move in found.values() if move.way == "ahead"}
    return [move for move in found.values() if move.way != "past" or move.person not in ahead]


def held_moves(hold: str) -> tuple[Move, ...]:
    """Two in a hold go round the middle between them."""
    return tuple(Move(who, "hold", near=HOLDS[hold].apart, turns=HOLDS[hold].turns) for who in "ab")


def twirled_moves(leader: str) -> tuple[Move, ...]:
    """The way of one to the other, who then turns under their arm."""
    other = other_of(leader)
    return Move(leader, "to", near=TWIRL), Move(other, "face", late=True), Move(other, "turn", turns=1.0)


def struck_moves(strike: Strike, dodge: Move | None, *, down: bool) -> tuple[Move, ...]:
    """The places of two people when at least one strikes; the other dodges, goes down or stays."""
    bout, first = BOUTS[strike.bout], strike.turns[0]
    if not strike.answered:
        return tuple(Move(person, "spar", near=bout.apart, turns=bout.circling) for person in "ab")
    comes = Move(first, "to", near=bout.apart)
    if dodge is not None:
        return comes, replace(dodge, late=True)
    return (comes,) if down else (comes, Move(other_of(first), "stay"))


def lifted_moves(lift: Lift, speed: float) -> tuple[Move, ...]:
    """The way to the other, at a speed, of the one who comes, and of one who picks them up and walks on or turns."""
    comes = lift.comes or lift.carrier
    moves = [Move(comes, "to", speed, near=takes_hold(lift.carry)), Move(other_of(comes), "stay")]
    if lift.spins:
        moves.append(Move(lift.carrier, "turn", turns=1.0))
    elif lift.carry != "up":
        moves.append(Move(lift.carrier, "stay"))
        drags = lift.carry == "drags"
        moves.append(Move(lift.carrier, "away", 0.5 if drags else 0.8, backwards=drags))
    return tuple(moves)


def followed(moves: list[Move], *, until: bool) -> list[Move]:
    """The moves: the person followed goes ahead; ``until`` something ends that early."""
    for person, other in ("ab", "ba"):
        ways = {move.way for move in moves if move.person == other}
        after = next((move for move in moves if move.person == person and move.way == "after"), None)
        if after is not None and "back" in ways:
            moves = [
                replace(m, way="away", speed=0.8, backwards=True) if (m.person, m.way) == (other, "back") else m
                for m in moves
            ]
        elif after is not None and not ways & _GOING:
            moves = [Move(other, "away", after.speed, until=until), *moves]
    return moves


def led_backwards(moves: list[Move]) -> list[Move]:
    """The moves, where one who walks backwards and leads the other along goes ahead of them."""
    backs = {move.person for move in moves if move.way == "back"}
    if len(backs) != 1 or not any(move.way == "along" for move in moves):
        return moves
    (leader,) = backs
    near = HOLDS["ring"].apart
    return [Move(leader, "away", 0.8, backwards=True, near=near), Move(other_of(leader), "after", 0.8, near=near)]


def away(alone: tuple[str, str], moves: Sequence[Move]) -> tuple[str, str]:
    """The sentences of each, of which one who goes to a thing only walks away, as the network knows no things.

    Their hands are given; of a reach the network would make one to the other, and not turn round.
    """
    gone = {move.person for move in moves if move.way == "thing"}
    a, b = (
        "One person turns around and walks away." if words and who in gone else words
        for who, words in zip("ab", alone, strict=True)
    )
    return a, b
