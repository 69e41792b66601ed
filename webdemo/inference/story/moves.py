"""Moves: where a sentence sends its people, read from its verbs of motion."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from .clauses import Clause, clauses
from .holds import TWIRL, Hold, hold, twirls
from .lifts import Carry, Lift, lift
from .strikes import Strike, strike, turning
from .ways import Way, way_of


@dataclass(frozen=True)
class Move:
    """The movement of one person in a sentence.

    Attributes:
        person: "a" or "b".
        way: how they move.
        speed: metres a second.
        turns: whole turns, of :attr:`Way.ROUND` and :attr:`Way.TURN`; a second, of :attr:`Way.HOLD` and
            :attr:`Way.SPAR`.
        until: the move ends early, because the sentence goes on with "until …".
        linked: they hold each other by the hands or arms.
        late: the sentence tells it after something else that is done in place.
        metres: length of the way, of :attr:`Way.AHEAD`.
        near: metres from the other at which who comes up to them stands; 0 for as far as the network likes.
        backwards: they go away with their face to the other.
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


LED = re.compile(
    r"\b(?:(?:lead|guid|escort|usher|walk)(?:s|es|ing)? (?:person [ab]|him|her|them|(?:the|an?|his|her) (?:\w+ )?\w+) "
    r"(?:by the (?:hand|arm) )?(?:across|to|through|over|away|off|along|out|down|onto|into|home)\b"
    r"|(?:is|are|gets?) (?:led|guided|escorted|helped|walked) (?:by the (?:hand|arm) )?"
    r"(?:across|to the|through|away|off|along|out|home)\b)"
)
"""Acts in which one takes the other along by the hand or arm."""
STRUCK = re.compile(r"\b(?:push|shov|kick|punch)\w*")
"""Acts in which one moves the other at one moment."""
MOVED = re.compile(
    r"\b(?:danc|waltz|lead|drag|pull|carr(?!(?:y|ies) on)|guid|fight|wrestl|help|support|escort)\w*"
)
"""Acts in which one moves the other: where they go follows from their touch."""
_ROUND = re.compile(r"\bdanc\w* (?:all )?(?:a?round|past|towards|over to) (?:person [ab]|him|her|the \w+)")
"""A dance of one person that has a way."""
_FLOOR = re.compile(
    r"\b(?:sit|kneel|crawl|roll|lie|lying|fall|seated|crouch|squat|get|jump|leap)\w*|\bone knee\b|\bdown\b"
)
"""Acts that take a person off their feet or to the ground, for which no place is held."""
_BARE = re.compile(
    r"(?P<verb>(?:(?:go|goes|are|is) )?(?:walk|runn?|jog|stroll|skipp?|march|wander)s?(?:ing)?)"
    r"(?P<rest>(?: together| a bit| a little| \w+ly)?"
    r"(?: (?:through|along|down|in|across|around|on|by|over) (?:the |a |an |their )?\w+(?: \w+)?)?)"
)
_TALKS = re.compile(r"(?:are |is )?(?:talk|chat|laugh|sing|gossip|argu|joke|discuss|hold|swing)\w*")
"""What two people do while they walk."""
MEETS = re.compile(r"(?:shake hands|hug|embrace|high[- ]five|kiss|fist[- ]bump|bump fists|greet)")
"""What two people do who have walked up to each other, in words without a subject: "walk, hug"."""
_WITH = re.compile(r"\b(?:beside|next to|alongside|with|accompan\w+|together|by side)\b")
_LINKED = re.compile(
    r"\b(?:hand in hand|arm in arm|(?:hold|link|join|tak)\w* (?:\w+ )?(?:hands?|arms?)|arms? around)\b"
)
_STOPS = re.compile(r"\bstops? (?:dead|short|walking|running|moving)\b")
"""Who stops was on the way."""
_WALKS = re.compile(
    r"(?:is |keeps? |goes )?(?:walk|stroll|jog|run|march|strut|limp|wander|shuffl|sleepwalk|creep|skip|hobbl|"
    r"stagger)\w*"
    r"(?: \w+ly)?(?: (?:about|along|by|on|across the \w+|down the \w+|through the \w+))?(?: with [\w ]+)?"
)
"""A walk of one person without a way."""
_HALT = re.compile(r"\b(?:stop|halt|stand still|wait|freeze|stay|remain|pause)s?\b")
_SPEEDS = (
    (re.compile(r"\b(?:run|sprint|dash|charg|chas|rac(?:e|ing)|fle[ed]|bolt|dart|scamper)"), 2.2),
    (re.compile(r"\b(?:jog|hurr|rush|storm|trot|quick|fast\b)"), 1.7),
    (re.compile(r"\b(?:stroll|saunter|wander|ambl|drift|trudg|plod|roam|slow|calm|careful)"), 0.8),
    (re.compile(r"\b(?:creep|sneak|tiptoe|shuffl|limp|edg|inch|hobbl|totter)"), 0.6),
)
_FULL = re.compile(
    r"\b(?:in (?:a )?circles?|once|all the way|full|whole|complete\w*|360|(?:round )?and round|several times|twice)\b"
)
_SPINS = re.compile(r"\b(?:spin|pirouette|twirl|whirl|rotat)\w*\b(?! (?:a?round|about|to))")
"""A turn all the way round: "spins", not "spins around"."""
_GOING = {Way.AWAY, Way.PAST, Way.ROUND, Way.ALONG, Way.TO, Way.BEHIND}
"""Ways on which somebody can be followed."""
_OF_ONE = {Way.AFTER, Way.BEHIND, Way.PAST, Way.ROUND, Way.TO}
"""Ways that relate one person to the other; without a subject, as in "Following him", they are a's."""
_EACH = re.compile(r"\b(?:each other|one another|meets?)\b")
_STEP = 0.7
"""Metres of a step."""
_COUNT = re.compile(r"\b(?:a(?! few)|one|two|three|four|five|ten)\b(?= (?:\w+ )?(?:step|pace)s?\b)")
_STEPS = {"a": 1, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "ten": 6}
"""Steps for a number word, and three where there is none; ten would lead too far away."""


def is_moved(clause: Clause) -> bool:
    """True if in a clause one moves the other by touch, and not along with themselves."""
    return bool(MOVED.search(clause.words)) and not (LED.search(clause.words) or _ROUND.search(clause.words))


def is_bare(clause: Clause) -> bool:
    """True if a clause says that both walk, and nothing else."""
    return clause.who == "ab" and bool(_BARE.fullmatch(clause.words))


def goes(found: Sequence[Move]) -> bool:
    """True if any of the moves takes a person elsewhere or turns them."""
    return any(move.way is not Way.STAY for move in found)


def moves(sentence: str) -> tuple[Move, ...]:
    """The moves of a beat's sentence, for each person in order; () where its words move nobody.

    A person who is not mentioned while the other walks stays in place. A sentence in which one moves the other by
    touch, as in leading or pushing, has no moves: the network places those two better.
    """
    held = hold(sentence)
    if held is not None:
        return tuple(Move(person, Way.HOLD, near=held.value, turns=held.turns) for person in "ab")
    if (lifted := lift(sentence)) is not None:
        return _lifted(lifted, clauses(sentence))
    if leader := twirls(sentence):
        other = "b" if leader == "a" else "a"
        return (
            Move(leader, Way.TO, near=TWIRL),
            Move(other, Way.FACE, late=True),
            Move(other, Way.TURN, turns=1.0),
        )
    if (struck := strike(sentence)) is not None:
        return _struck(struck, clauses(sentence))
    found = clauses(sentence)
    if any(is_moved(clause) or STRUCK.search(clause.words) for clause in found):
        return ()
    made: list[Move] = []
    hands = any(re.search(r"\bhands?\b|\barms?\b", clause.words) for clause in found)
    for i, clause in enumerate(found):
        late = not clause.at_once and any(way_of(before.words) is None for before in found[:i])
        if (
            is_bare(clause)
            and not clause.subject
            and any(MEETS.match(after.words) for after in found[i + 1 :])
        ):
            clause, late = replace(clause, words="walk up to each other"), False
        elif is_bare(clause) and all(_TALKS.match(after.words) for after in found[i + 1 :]):
            clause, late = replace(clause, words=_BARE.sub(r"\g<verb> along\g<rest>", clause.words)), False
        if (
            clause.who == "ab"
            and hands
            and re.search(r"\b(?:spin|twirl|whirl|turn)\w* (?:a?round)", clause.words)
        ):
            clause = replace(clause, words="circle each other")
        made += _of_clause(clause, late=late)
    made = finished(made, until=any(clause.until for clause in found))
    if _LINKED.search(sentence.lower()):
        made = [replace(move, linked=True) for move in made]
    for i, clause in enumerate(found):
        if clause.until and i:
            made = [_ended(move, found[i - 1]) for move in made]
    if not goes(made):
        return (
            tuple(made) if len({move.person for move in made}) == 2 and _HALT.search(sentence.lower()) else ()
        )
    low = {who for clause in found if _FLOOR.search(clause.words) for who in clause.who}
    backs = any(move.way in (Way.BACK, Way.ASIDE) for move in made)
    for person in "ab":
        if all(move.person != person for move in made) and person not in low and not backs:
            made.append(Move(person, Way.STAY))
    return tuple(move for move in made if move.way is not Way.STAY or move.person not in low)


def _of_clause(clause: Clause, *, late: bool) -> list[Move]:
    if LED.search(clause.words):
        return [Move(person, Way.ALONG, 0.9, linked=True, late=late) for person in "ab"]
    way, who = way_of(clause.words), clause.who
    if who != "ab" and _STOPS.search(clause.words):
        return [Move(who, Way.TO, until=True), Move(who, Way.STAY)]
    if way is None and who != "ab" and clause.subject and _WALKS.fullmatch(clause.words):
        way = Way.PAST
    if way is None or (_FLOOR.search(clause.words) and way in (Way.STAY, Way.TURN)):
        return []
    if not clause.subject and way in _OF_ONE and not _EACH.search(clause.words):
        who = "a"
    if way is Way.ALONG and _WITH.search(clause.words):
        who = "ab"
    elif way is Way.ALONG and who != "ab":
        way = Way.AWAY  # "the other one walks on"
    late = late and way is not Way.AFTER
    speed = _speed(clause.words)
    metres = _STEP * _STEPS.get((_COUNT.search(clause.words) or [""])[0], 3) if way is Way.AHEAD else 0.0
    turns = 1.0 if _FULL.search(clause.words) or (way is Way.TURN and _SPINS.search(clause.words)) else 0.5
    return [Move(person, way, speed, turns, late=late, metres=metres) for person in who]


def _speed(words: str) -> float:
    """Metres a second of the movement that a clause names."""
    return next((value for pattern, value in _SPEEDS if pattern.search(words)), 1.1)


def finished(made: Sequence[Move], *, until: bool) -> list[Move]:
    """The moves, where somebody who is followed or leads backwards goes ahead; ``until`` something ends that early."""
    return _led_backwards(_followed(list(made), until=until))


def _struck(found: Strike, listed: Sequence[Clause]) -> tuple[Move, ...]:
    other = "b" if found.turns[0] == "a" else "a"
    own = [clause.words for clause in listed if clause.who == other]
    backs = any(way_of(words) is Way.BACK for words in own)
    return struck_moves(
        found,
        Move(other, Way.BACK) if backs else None,
        down=any(_FLOOR.search(words) or "duck" in words for words in own),
    )


def _lifted(found: Lift, listed: Sequence[Clause]) -> tuple[Move, ...]:
    comes = found.comes or found.carrier
    ways = [clause.words for clause in listed if clause.who == comes and way_of(clause.words) is Way.TO]
    return lifted_moves(found, _speed(ways[0]) if ways else 1.1)


def struck_moves(found: Strike, dodge: Move | None, *, down: bool) -> tuple[Move, ...]:
    """The places of two of whom at least one strikes; the other dodges, goes down or stays."""
    near, first = found.bout.value, found.turns[0]
    if not found.answered:
        return tuple(Move(person, Way.SPAR, near=near, turns=turning(found.bout)) for person in "ab")
    other = "b" if first == "a" else "a"
    comes = Move(first, Way.TO, near=near)
    if dodge is not None:
        return comes, replace(dodge, late=True)
    return (comes,) if down else (comes, Move(other, Way.STAY))


def lifted_moves(found: Lift, speed: float) -> tuple[Move, ...]:
    """The way to the other, at a speed, of the one who comes, and of one who picks them up and walks on or turns."""
    comes = found.comes or found.carrier
    made = [
        Move(comes, Way.TO, speed, near=found.carry.near),
        Move("b" if comes == "a" else "a", Way.STAY),
    ]
    if found.spins:
        made.append(Move(found.carrier, Way.TURN, turns=1.0))
    elif found.carry is not Carry.UP:
        made.append(Move(found.carrier, Way.STAY))
        drags = found.carry is Carry.DRAGS
        made.append(Move(found.carrier, Way.AWAY, 0.5 if drags else 0.8, backwards=drags))
    return tuple(made)


def _followed(made: list[Move], *, until: bool) -> list[Move]:
    """The moves, where somebody who is followed goes ahead; ``until`` something ends that early."""
    for person, other in ("ab", "ba"):
        ways = {move.way for move in made if move.person == other}
        after = next((move for move in made if move.person == person and move.way is Way.AFTER), None)
        if after is not None and Way.BACK in ways:
            made = [
                replace(m, way=Way.AWAY, speed=0.8, backwards=True)
                if (m.person, m.way) == (other, Way.BACK)
                else m
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
    follower = "b" if leader == "a" else "a"
    near = Hold.RING.value
    return [Move(leader, Way.AWAY, 0.8, backwards=True, near=near), Move(follower, Way.AFTER, 0.8, near=near)]


def _ended(move: Move, before: Clause) -> Move:
    """The move with an early end, if it is the one of the clause before an "until"."""
    ends = move.person in before.who and way_of(before.words) is move.way
    return replace(move, until=True) if ends else move
