"""Acts that the words beside a verb name: seats, formations, postures, and nouns of what somebody does.

Each is an act of its own beside the verb's: "reads in his armchair" has somebody sit, "they walk side by side" has them
beside each other, "begs on his knees" has him kneel, "answers with a bow" has her bow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from acts.events import Event, Ref
from acts.lexicon import Lexicon

from .ellipsis import PERFORM
from .matching import Found
from .relations import BESIDE
from .spelling import deeds
from .vocabulary import is_act, vocabulary

Find = Callable[[Event], Found | None]

_HELD = frozenset(("crossed", "folded", "cross", "fold", "outstretched", "raised", "raise", "outstretch"))
"""Participles of postures of the arms, and the parser's lemmas of them."""
_NOUNS = frozenset(("with", "in", "into", "for"))
"""Prepositions behind which a noun may be an act."""
_OWN = {
    "back": frozenset(("sit", "kneel", "lie", "lean")),
    "unison": frozenset(("dance", "move", "act", "perform")),
    "canon": frozenset(("dance", "move", "act", "perform", "do")),
}
"""Verbs that a formation goes with as one act: "they sit back to back"."""
_IS = frozenset(("be", "stand", "stay", "remain"))
_EACH = Ref("each", "ab", "other")


def seated(event: Event, found: Found, known: Lexicon, told: Iterable[str]) -> Event | None:
    """The event that somebody sits where a phrase says so: "reads in his armchair".

    Args:
        event, found: the verb and its act.
        known: the lexicon.
        told: people of whom the text has told something before.
    """
    seats = vocabulary().seats
    seat = next((ref for word, ref in event.prepositions if word in ("in", "on") and ref.lemma in seats), None)
    if seat is None:
        return None
    shown = {shape.do for shape in known.entries[found[0]].stage}
    who, other = event.subject, event.object
    if found[2].patient and other is not None and other.kind == "person" and other.last <= seat.first:
        who = other  # "pushes an old man in a wheelchair"
    elif not shown <= BESIDE | {"stay"}:
        return None
    if who is None or set(told) & set(who.who):
        return None
    return Event("sit", who, first=event.first, last=event.last, ongoing=True, state=True)


def formations(event: Event, names: Iterable[str]) -> Iterator[Event]:
    """The ways to stand or move together that stand beside a verb, as events: "face each" for "face to face"."""
    if event.distance is not None and "apart" in event.words:
        names = (*names, "keep apart")
    who = event.subject if event.subject is not None and len(event.subject.who) == 2 else Ref("person", "ab")
    if event.denied:  # "they never touch, always two metres apart"
        names = [name for name in names if name == "keep apart"]
    for name in dict.fromkeys(names):
        verb, _, noun = name.partition(" ")
        verb = event.lemma if event.lemma in _OWN.get(noun, ()) else verb
        ongoing = event.ongoing and verb == event.lemma
        formed = Event(verb, who, first=event.first, last=event.last, ongoing=ongoing)
        if verb == "follow":
            formed.subject, formed.object = Ref("person", "b"), Ref("person", "a")
        elif noun == "each":
            formed.object = _EACH
        elif noun == "apart":
            formed.words, formed.distance = ["apart"], event.distance
        elif noun == "close":
            formed.words = ["close"]
        elif noun == "back":
            formed.words = ["back", "to", "back"]
        elif noun == "line":
            formed.object = Ref("thing", lemma=noun)
        else:
            formed.prepositions = [("in", Ref("thing", lemma=noun))]
        yield formed


def is_next_to(event: Event, found: Found, known: Lexicon) -> bool:
    """True for what is done beside the other: "lies down next to her"."""
    shown = {shape.do for shape in known.entries[found[0]].stage}
    near = (p for p, ref in event.prepositions if ref.kind == "person")
    beside = any(p in ("beside", "alongside") or (p == "to" and "next" in event.words) for p in near)
    return bool(found[2].patient) and "posture" in shown and beside


def held(event: Event, found: Found, find: Find) -> Iterator[tuple[Event, Found]]:
    """The postures that phrases beside an act name: "begs on his knees", "with folded arms"."""
    agents = found[2].agents
    rest = [event.prepositions[i] for i in found[2].rest]
    for preposition, ref in rest:
        open_ = not ref.who and (preposition == "with" or (_carries(ref) and ref.family != "knee"))
        if ref.kind != "part" or not (open_ or ref.who == agents) or (preposition == "on" and not _carries(ref)):
            continue
        words = [word for word in event.words if word in _HELD]
        if preposition == "with" and not words:
            continue
        posture = replace(
            event,
            lemma="stand",
            subject=Ref("person", agents),
            object=None,
            dative=None,
            words=words,
            particles=[],
            noun=None,
            times=None,
            prepositions=[(preposition, ref)],
            side=None,
            direction=None,
            adverbs=[],
        )
        posed = find(posture)
        if posed is not None and posed[0] != found[0] and not posed[2].rest and posed[2].score > 1.5:
            yield posture, posed


def _carries(part: Ref) -> bool:
    """True for what one kneels or stands on: "on his knees", "on one leg"."""
    return part.family == "knee" or (part.family in ("leg", "foot") and part.side != "both")


def noun_acts(event: Event, known: Lexicon, rest: Sequence[int]) -> Iterator[tuple[str, Event]]:
    """The acts that nouns beside a verb stand for, with their prepositions: "pulls her into a hug" has a hug.

    Args:
        event: of the verb.
        known: the lexicon.
        rest: numbers of the event's prepositions that its own act leaves over.
    """
    for i in rest:
        preposition, ref = event.prepositions[i]
        if (
            preposition not in _NOUNS
            or ref.kind != "thing"
            or ref.lemma not in deeds(known)
            or (ref.place and preposition != "with")
            or ref.bare
        ):
            continue
        own = any(vocabulary().part(word) for word in event.words)  # "with slow arm circles"
        bodily = is_act(ref.lemma) or own or (preposition == "in" and event.lemma in _IS)
        if not bodily or ref.lemma in vocabulary().verbs["no_nouns"]:
            continue
        others = [each for j, each in enumerate(event.prepositions) if j != i and j in rest]
        person = event.object if event.object is not None and event.object.kind in ("person", "each") else None
        done = replace(
            event,
            lemma=ref.lemma,
            object=person or event.dative,
            dative=None,
            words=[],
            particles=[],
            prepositions=others,
            noun=None,
            direction=None,
        )
        words = [word for word in event.words if word not in event.particles]
        performed = replace(done, lemma=PERFORM, object=ref, dative=done.object, words=words, noun=done)
        yield preposition, done if ref.lemma in known.frames and not own else performed
        if done.object is None:
            yield preposition, performed
