"""Moves: where the acts of a beat send its people, and what their touches and postures make of that."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from acts.plan import other_of
from motion.vectors import Array, direction

from .holds import HOLDS, TWIRL
from .lifts import takes_hold
from .places import ABEAM, Standing
from .poses import upright
from .score import DODGES, Lift, Move, Score, Strike, Touch, Way
from .strikes import BOUTS
from .touches import LOWEST, beside, kneels, middle, reach

_GOING = {"away", "past", "around", "along", "to", "behind"}
"""Ways on which somebody can be followed."""
FAR_BEYOND = 0.4
"""Metres by which two people may be further apart than what they do needs before they come up to each other for it."""
_COMES = ("to", "behind", "beside", "stay", "face")
_LEAVES = ("turn", "face", *DODGES)
_WAITS = ("stay", "averted", "to", *_LEAVES)


def fastest(moves: Sequence[Move]) -> list[Move]:
    """The moves, each once: who walks away and runs away at once, runs; who walks ahead of another passes nobody."""
    by_way: dict[tuple[str, Way, bool], Move] = {}
    for move in moves:
        key = move.person, move.way, move.late
        if key not in by_way or move.speed > by_way[key].speed:
            by_way[key] = move
    ahead = {move.person for move in by_way.values() if move.way == "ahead"}
    return [move for move in by_way.values() if move.way != "past" or move.person not in ahead]


def held_moves(hold: str) -> tuple[Move, ...]:
    """Two in a hold go round the middle between them."""
    near, turns, begins = HOLDS[hold].apart, HOLDS[hold].turns, HOLDS[hold].begins
    return tuple(Move(who, "hold", near=near, turns=turns, metres=begins) for who in "ab")


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


def told_still(alone: tuple[str, str], idle: Collection[str]) -> tuple[str, str]:
    """The sentences of each, of which one who stands by is told so: the network would have them do as the other."""
    if not any(alone):
        return alone
    a, b = (words or "One person stands still." * (who in idle) for who, words in zip("ab", alone, strict=True))
    return a, b


def meeting(
    touch: Touch | None, walked: Sequence[Move], posed: Mapping[int, Array], stand: Standing
) -> tuple[Touch | None, tuple[Move, ...]]:
    """The contact, if it can be planned, and the moves of the beat with those that it needs.

    Args:
        touch: as the words name it.
        walked: the beat's moves.
        posed: a pose (22, 3) of those whose posture is given, by person.
        stand: where the people are when the beat begins.
    """
    moves = tuple(walked)
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
    if any(move.way not in _WAITS for move in theirs):
        return None, moves
    near = reach(touch, pose)
    lies = 1 - giver in posed and beside(pose, stand.places[giver]) is not None
    way: Way = "behind" if touch.behind or lies else "beside" if touch.beside else "to"
    comes = [
        Move(m.person, way if m.way == "to" else m.way, m.speed, late=m.late, near=near) if m.way in _COMES[:3] else m
        for m in own
    ]
    if not any(move.near for move in comes):
        speed = 1.2 if touch.beside else 0.8
        comes = [*(m for m in comes if m.way == "face"), Move(touch.person, way, speed, near=near, until=True)]
    other = "ab"[1 - giver]
    waits = [Move(m.person, m.way, m.speed, near=near) if m.way == "to" else m for m in theirs]
    if 1 - giver not in posed and not touch.fells and (not waits or waits[0].way in _LEAVES):
        faces = touch.behind or any(move.way in DODGES for move in waits)
        waits = [Move(other, "averted" if faces else "stay"), *waits]
    return touch, (*comes, *waits)


def coming(score: Score, stand: Standing, down: Collection[int]) -> tuple[Move, ...]:
    """The moves of a beat; who does something within the other's reach comes up to them first, if they are far apart.

    The other turns to them, and both stay there. Their arms are left to the network.

    Args:
        score: of the beat.
        stand: where the people are when it begins.
        down: those who are not on their feet.
    """
    moves = score.moves
    if moves or score.touch or score.has_places or score.strike or not score.reaching:
        return moves
    if stand.gap() < min(score.reaching.values()) + FAR_BEYOND:
        return moves
    comes = sorted(who for who in score.reaching if "ab".index(who) not in down)
    turned = [
        who
        for i, who in enumerate("ab")
        if i not in down and direction(float(stand.headings[i])) @ stand.towards(i) < ABEAM
    ]
    waits = [Move(who, "face") for who in turned if who not in comes]
    return (*(Move(who, "to", until=True, near=score.reaching[who]) for who in comes), *waits)


def towards_touched(touch: Touch | None, posed: Mapping[int, Array], stand: Standing, pulls: str) -> Standing:
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
