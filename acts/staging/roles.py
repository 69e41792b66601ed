"""Roles in a beat: who strikes in which order, who stands by, who gestures on the spot, and whose hands are free."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from acts import shapes
from acts.lexicon import Entry, Lexicon
from acts.plan import Act, other_of

from .act_kinds import is_care, leaves_hands, only_stays, reaches, walks
from .bodies.gestures import AT_OTHER, SIDES, Gesture
from .bodies.strikes import Bout, Strike
from .moves import Move
from .ways import Way

Done = Sequence[tuple[Act, Entry]]
"""Acts that happen, each with its entry of the lexicon."""
Blows = Sequence[tuple[tuple[str, ...], shapes.Strike, Act]]
"""Who strikes, how, and the act by which it is told."""


def strike_of(blows: Blows, done: Done, *, late: bool) -> Strike | None:
    """The blows of a beat, in the order in which they are told; None where there are none.

    Args:
        blows: of the beat.
        done: all that is done in it.
        late: the first blow comes after what somebody does until then.
    """
    if not blows:
        return None
    people, shape, act = blows[0]
    bout = Bout[shape.bout.upper()]
    if len(people) == 2:
        return Strike(bout, "ab")
    turns = "".join(dict.fromkeys("".join(each) for each, *_ in blows))
    turns = turns if len(blows) > 1 else turns * min(act.times or 1, 5)
    hit = other_of(people[0])
    answered = any(hit in other.agents and shape.do in ("posture", "go") for other, e in done for shape in e.stage)
    fight = len(blows) > 1 and not answered and bout is not Bout.THROWS
    hands = tuple(each.side or "" for _, _, each in blows for _ in range(min(each.times or 1, 5)))
    if len(set(turns)) == 1 and any(hand in SIDES for hand in hands):  # "two jabs with the left and a cross"
        return Strike(bout, turns[0] * len(hands), False, answered, late, hands)
    return Strike(bout, turns, shape.goes_on or fight, answered, late, up=act.direction == "up")


def standing_by(acts: Sequence[Act], done: Done, busy: Collection[str], known: Lexicon) -> frozenset[str]:
    """The people who stand by: nothing is told that they do, while the other does something alone.

    Args:
        acts: of the beat.
        done: those that happen.
        busy: who gestures, goes somewhere or stands before something.
        known: the lexicon.
    """
    found = set()
    for who in {*"ab"} - {*busy}:
        own = [(act, e) for act, e in done if who in act.agents]
        theirs = [(act, e) for act, e in done if other_of(who) in act.agents and who not in act.agents]
        denied = any(who in act.agents and not act.happens and not _stays(act, known) for act in acts)
        waits = bool(own) and all(only_stays(e) for _, e in own)
        touched = any(reaches(act, e) and not is_care(e) and act.direction != "up" for act, e in theirs)
        if touched or (own and not waits):
            continue
        if waits or denied or any(not walks(e) for _, e in theirs):
            found.add(who)
    return frozenset(found)


def _stays(act: Act, known: Lexicon) -> bool:
    entry = known.entries.get(act.act)
    return entry is not None and only_stays(entry)


def loose(done: Done, idle: Collection[str]) -> frozenset[str]:
    """The people whose hands have nothing to do, and whom the other does not touch."""
    found = set()
    for who in "ab":
        own = [(act, e) for act, e in done if who in act.agents]
        touched = any(reaches(act, e) for act, e in done if who not in act.agents)
        free = who in idle or (bool(own) and all(leaves_hands(act, e) for act, e in own))
        if free and not touched:
            found.add(who)
    return frozenset(found)


def gesturing(gestures: Mapping[str, Gesture], moves: Sequence[Move], done: Done) -> frozenset[str]:
    """The people who gesture on the spot and do nothing else."""
    gone = {move.person for move in moves if move.way not in (Way.STAY, Way.BACKS)}
    own = {who: sum(who in act.agents and not only_stays(e) for act, e in done) for who in "ab"}
    return frozenset(
        who for who, gesture in gestures.items() if gesture.hand not in AT_OTHER and own[who] < 2 and who not in gone
    )
