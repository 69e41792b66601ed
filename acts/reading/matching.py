"""The act that an event means: by its frames, by verbs of like meaning, or with what other words say of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

from acts.frames import Event, Frame, Match, Ref, best
from acts.lexicon import Lexicon
from acts.plan import Act, Span, other_of
from motion.skeleton import OTHER_SIDE

from . import wordnet
from .ellipsis import PERFORM
from .relations import BESIDE, kinds
from .spelling import deeds
from .vocabulary import FORMATION, closed, is_act, vocabulary

LEAST_SCORE = -1.0
"""What a frame must score to be taken at all: more beside it than in it is another sentence."""
_SYNONYM = 0.8
"""What each step through WordNet costs."""
_FARTHEST = 1.0
"""Steps through WordNet, at most: ranks of the two verbs' senses and levels up."""
_MOST_SENSES = 9
"""Senses of a verb that others may stand for, at most: one of more, as "move" and "step", means too many things."""

Found = tuple[str, Frame, Match]


class Matcher:
    """Finds the entries of events in one lexicon."""

    def __init__(self, known: Lexicon) -> None:
        self._known = known
        self._named = {wordnet.synset(name): entries for name, entries in known.synsets.items()}
        self._verbs: dict[str, list[tuple[str, int]]] = defaultdict(list)
        self._frames = dict(known.frames)
        """By the lemma of the verb, and by that of a verb with its particle, as "doze_off"."""
        for lemma, frames in known.frames.items():
            for named in frames:
                for particle in named[1].particles():
                    self._frames.setdefault(_joined(lemma, particle), []).append(named)
        for lemma in self._frames:
            for rank, sense in enumerate(wordnet.senses(lemma)[:2]):
                self._verbs[sense].append((lemma, rank))

    def find(self, event: Event) -> Found | None:
        """The act that fits an event best; None if none does."""
        match = max(self._said_by_noun(event), key=lambda each: each[2].score, default=None)
        if match is None or match[2].score < LEAST_SCORE:
            match = self._synonym(event)
        return match

    def _said_by_noun(self, event: Event) -> Iterator[Found]:
        """The best act of an event and of what its noun stands for: with another empty verb, or done to the other."""
        forms = [event]
        if event.lemma == PERFORM:  # a verb that does not do something with a thing
            forms += [replace(event, lemma=verb, noun=None) for verb in vocabulary().light]
        if event.noun is not None and event.noun.object is None and event.subject is not None:
            other = other_of(event.subject.who)
            whom = Ref("person", other) if other else Ref("each", "ab", "other")
            done, plain = replace(event.noun, object=whom), best(self._known.frames, event.noun)
            to_other = best(self._known.frames, done)
            if plain is None or (to_other is not None and to_other[0] == plain[0]):  # "makes jumps" jumps at nobody
                forms.append(done)
        for form in forms:
            match = best(self._known.frames, form)
            if match is not None and (form.lemma == event.lemma or not match[2].thing):
                yield match

    def _synonym(self, event: Event) -> Found | None:
        """The act whose verbs mean what this one does, of those whose frames fit."""
        nearest: Found | None = None
        about = vocabulary().verbs["begins"] | vocabulary().verbs["ends"]
        walks = event.object is not None and event.lemma in vocabulary().verbs["goes"]
        deed = event.object is not None and is_act(event.object.lemma) and event.lemma in vocabulary().light
        light = (event.lemma in ("do", "make") and event.object is not None) or deed  # means what its object names
        if walks or light or (event.object is None and event.lemma in about):
            return None  # nobody moves what is walked, as a way is, and others are about other verbs
        most = LEAST_SCORE
        for cost, (name, frame, match) in self._alike(event):
            worth = match.score - _SYNONYM * cost
            if worth > most:
                most, nearest = worth, (name, frame, match)
        return nearest

    def _alike(self, event: Event) -> Iterator[tuple[float, Found]]:
        lemma, event = _phrasal(event)
        if len(wordnet.senses(lemma)) > _MOST_SENSES and wordnet.usual_kind(lemma) in wordnet.BODILY:
            return
        near = ((sense, cost) for sense, cost in wordnet.meanings(lemma) if cost <= _FARTHEST)
        for sense, cost in near:
            for name in self._named.get(sense, ()):
                entry = self._known.entries[name]
                for text in entry.frames:
                    frame = Frame.parse(text, entry.to == "other")
                    if (match := frame.fits(event)) is not None:
                        yield cost, (name, frame, match)
        senses = wordnet.senses(lemma)[:2]
        for rank, own in enumerate(senses):
            bodily = wordnet.kind(own) in wordnet.BODILY
            if not bodily and ("_" in lemma or rank):  # "bows out", "looks", which may also mean "appears"
                continue
            for sense, level in [(own, 0), *((up, 1) for up in wordnet.above(own) if bodily)]:
                for verb, other in self._verbs.get(sense, ()):
                    cost = rank + level + other
                    if verb == lemma or cost > _FARTHEST or ("_" in verb and not bodily):  # "lets down": disappoints
                        continue
                    candidate = best(self._frames, _as(event, verb))
                    if candidate is not None and candidate[2].score >= 0.0:
                        yield cost, candidate

    def nearest(self, event: Event) -> tuple[str, ...]:
        """Names of acts that an event that was not read may mean."""
        near = [name for name, _ in self._known.frames.get(event.lemma, ())]
        for sense, _ in wordnet.meanings(event.lemma, most=4, height=3):
            near += self._named.get(sense, ())
            near += [name for lemma, _ in self._verbs.get(sense, ()) for name, _ in self._frames[lemma][:2]]
        return tuple(dict.fromkeys(near))[:5]


def _joined(lemma: str, particle: str) -> str:
    return f"{lemma}_{particle}" if particle else lemma


def _phrasal(event: Event) -> tuple[str, Event]:
    """WordNet's name of an event's verb and the event without what the name says: "bump_into", "rise_up"."""
    for particle in event.particles:
        if wordnet.senses(name := _joined(event.lemma, particle)):
            words, particles = list(event.words), list(event.particles)
            words.remove(particle)
            particles.remove(particle)
            return name, replace(event, words=words, particles=particles)
    for i, (preposition, ref) in enumerate(event.prepositions):
        if event.object is None and wordnet.senses(name := _joined(event.lemma, preposition)):
            rest = [each for j, each in enumerate(event.prepositions) if j != i]
            return name, replace(event, object=ref, prepositions=rest)
    return event.lemma, event


def _as(event: Event, verb: str) -> Event:
    """The event with another verb, and that one's particle."""
    _, _, particle = verb.partition("_")
    own = [particle] if particle else []
    return replace(event, lemma=verb, noun=None, words=[*event.words, *own], particles=[*event.particles, *own])


@lru_cache(maxsize=4)
def matcher(known: Lexicon) -> Matcher:
    """The matcher of a lexicon, made once."""
    return Matcher(known)


# ---- what other words say of a clause: an object, whom it is done to, acts beside a verb --------------
_SHARING = frozenset(("conj", "comma", "after", "with"))
"""Joints of clauses that may share an object."""


def completed(
    number: int, event: Event, events: Sequence[Event], acts: Sequence[Act], known: Lexicon, alone: bool
) -> Iterator[tuple[Event, float]]:
    """The event with what other words say of it, as the object of "he reads and tears up the letter", and the cost.

    Args:
        number: of the event.
        event: that no act fits as it is.
        events: of the text.
        acts: before it.
        known: the lexicon.
        alone: whether the text names a single person.
    """
    if event.subject is not None and event.subject.kind == "part" and event.object is None:
        above = events[event.beside].subject if event.beside is not None else None
        whose = event.subject.who or (above.who if above is not None and above.kind == "person" else "")
        if len(whose) == 1:  # "an arm hooked around his waist": who hooks it there
            yield replace(event, subject=Ref("person", whose), object=event.subject, state=True), 0.0
    if (limb := event.subject) is not None and limb.kind == "part" and limb.family in closed("limbs"):
        whose = limb.who or ("".join(acts[-1].agents) if acts else "a")
        by = ("with", replace(limb, who=""))  # "his right hand picks it up": with it, he does
        yield replace(event, subject=Ref("person", whose), prepositions=[*event.prepositions, by]), 0.0
    if event.object is not None and _is_implied(event.subject):  # "is frozen" needs nobody who freezes him
        yield replace(event, subject=event.object, object=None), 0.0
    if event.object is not None or event.dative is not None:
        return
    before = (e.object for e in events[:number] if e.lemma == event.lemma and "back" in event.words)
    returned = any(ref is not None and ref.kind == "person" for ref in before)  # "shoves him, and he shoves back"
    if returned and event.subject is not None and (whom := other_of(event.subject.who)):
        yield replace(event, object=Ref("person", whom)), 0.0
    beside = events[event.beside] if event.beside is not None and event.joint in _SHARING else None
    after = [other for other in events if other.beside == number and other.joint in _SHARING]
    for other in (beside, *after):
        if other is not None and other.object is not None and other.subject == event.subject:
            yield replace(event, object=other.object), 0.0
    if (patient := _meant(event, acts, known)) is not None:  # "leans in, but does not kiss"
        yield replace(event, object=Ref("person", patient)), 0.0
    bare = not alone and event.lemma in known.frames and not event.particles and event.joint != "comp"
    bare = bare and event.lemma not in vocabulary().verbs["vague"]  # "leads with arm circles"
    bare = bare and all(ref.kind == "thing" for _, ref in event.prepositions)
    inner = any(other.beside == number and other.joint == "comp" for other in events)
    if event.subject is not None and bare and not inner and (whom := other_of(event.subject.who)):
        yield replace(event, object=Ref("person", whom)), 1.0  # "one pushes and the other falls"


def of_the_last(event: Event, acts: Sequence[Act]) -> Event | None:
    """The event about the other's body, where what is done to it follows what was done to them.

    As in "walks up to the other and covers his eyes", where nothing says whose.
    """
    part, who = event.object, event.subject.who if event.subject is not None else ""
    if part is None or part.kind != "part" or part.who:
        return None
    last = next((act for act in reversed(acts) if "".join(act.agents) == who), None)
    if last is None or last.patient is None or last.direction == "away":  # "turns away and covers his face"
        return None
    handles = not part.bare or (last.part is not None and part.definite)
    return replace(event, object=replace(part, who=last.patient)) if handles else None


def _meant(event: Event, acts: Sequence[Act], known: Lexicon) -> str | None:
    """The other person, where a verb without an object follows what was done to them."""
    last, subject = next(reversed(acts), None), event.subject
    if event.lemma in vocabulary().verbs["sees"] and subject is not None:
        return other_of(subject.who) or None
    if last is None or subject is None or subject.who != "".join(last.agents):
        return None
    bare = not event.particles and not event.prepositions and event.lemma in known.frames
    return last.patient if bare else None


def _is_implied(subject: Ref | None) -> bool:
    """True for the agent of a passive that the words leave out."""
    return subject is not None and subject.kind == "person" and not subject.last


# ---- repeats -------------------------------------------------------------------------------------------
def repeated(event: Event, last: Act, has_inner: bool, known: Lexicon) -> dict[str, Any] | None:
    """Fields by which an event does the last act once more; None where it says something else.

    Args:
        event: whose verb may repeat or refuse an act.
        last: the act before it.
        has_inner: whether a clause depends on the event, as in "mirrors it facing you".
        known: the lexicon, whose acts may be named: "shows a squat".
    """
    verbs, subject, ref = vocabulary().verbs, event.subject, event.object
    holds = event.lemma == "hold" and ref is not None and ref.lemma == "it"  # "salutes and holds it"
    repeats = event.lemma in verbs["repeats"] or holds
    same = closed("same") | {last.thing or last.part, *(["thing"] if "same" in event.words else [])}
    named = ref is None or ref.kind == "person" or ref.lemma in same
    if ref is not None and repeats:
        named = named or ref.kind == "part" or ref.lemma in closed("movements") | known.frames.keys()
    if subject is None or subject.kind != "person" or not named:
        return None
    if has_inner and not (repeats and ref is not None and ref.lemma in closed("same")):
        return None
    declines = event.lemma in verbs["not"] | verbs["wished"]
    if event.lemma != "do" and not repeats and not declines:
        return None
    refused = (event.denied or event.lemma in verbs["not"]) and (ref is None or ref.lemma in same)
    if declines and not refused:
        return None
    agents, other = tuple(subject.who), other_of(subject.who) or "a"
    if len(last.agents) > 1 or (len(agents) > 1 and event.lemma != "do"):
        return None
    both = len(agents) > 1 or last.patient is None
    offer = declines and last.act == "offer-thing" and agents == (last.patient,)
    taken = ("hold-hands" if last.part else "take-from") if offer else last.act  # what does not happen
    sides = OTHER_SIDE if event.lemma == "mirror" else {}
    return {
        "act": taken,
        "agents": agents,
        "patient": None if both else (last.patient if agents == last.agents else other),
        "polarity": "not" if declines or event.denied else "done",
        "modality": "told",
        "order": (),
        "already": False,
        "times": event.times or last.times,
        "part_of": agents[0] if last.part_of in last.agents else last.part_of,
        "side": event.side or sides.get(last.side or "", last.side),
        "direction": sides.get(last.direction or "", last.direction),
    }


# ---- acts beside a verb --------------------------------------------------------------------------------
Find = Callable[[Event], Found | None]

_EACH = Ref("each", "ab", "other")


def seated(event: Event, match: Found, known: Lexicon, told: Iterable[str]) -> Event | None:
    """The event that somebody sits where a phrase says so: "reads in his armchair".

    Args:
        event, match: the verb and its act.
        known: the lexicon.
        told: people of whom the text has told something before.
    """
    seats = vocabulary().seats
    seat = next((ref for word, ref in event.prepositions if word in ("in", "on") and ref.lemma in seats), None)
    if seat is None:
        return None
    shown = kinds(known.entries[match[0]].stage)
    who, other = event.subject, event.object
    if match[2].patient and other is not None and other.kind == "person" and other.last <= seat.first:
        who = other  # "pushes an old man in a wheelchair"
    elif not shown <= BESIDE | {"stay"}:
        return None
    if who is None or set(told) & set(who.who):
        return None
    return Event("sit", who, first=event.first, last=event.last, ongoing=True, state=True)


def formations(event: Event, named: Mapping[str, Span | None]) -> Iterator[Event]:
    """The ways to stand or move together that stand beside a verb, as events: "face each" for "face to face".

    Args:
        event: of the verb.
        named: the formations and where they stand in the text; None for one that only the verb's clause says.
    """
    names = list(named)
    if event.distance is not None and event.times is None and "apart" in event.words:
        names.append("keep apart")
    who = event.subject if event.subject is not None and len(event.subject.who) == 2 else Ref("person", "ab")
    if event.denied:  # "they never touch, always two metres apart"
        names = [name for name in names if name == "keep apart"]
    for name in names:
        verb, _, noun = name.partition(" ")
        if noun in closed("limbs") and event.lemma in closed("strolls"):  # "walks with her arm in arm"
            yield replace(event, words=[*(word for word in event.words if word != FORMATION), noun])
            continue
        own = event.lemma in vocabulary().classes.get(f"own {noun}", ())
        verb = event.lemma if own else verb
        if noun == "unison" and not own:
            if event.lemma not in vocabulary().verbs["goes"] and len(who.who) == 2:
                continue  # what two do is done at once as it is: "they clap in unison"
            noun = "step"
        ongoing = event.ongoing and verb == event.lemma
        formed = Event(verb, who, first=event.first, last=event.last, ongoing=ongoing, said=named.get(name))
        formed.distance = event.distance if noun == "apart" else None
        if verb == "follow":
            formed.subject, formed.object = Ref("person", "b"), Ref("person", "a")
        elif noun in ("apart", "close", "back"):
            formed.words = ["back", "to", "back"] if noun == "back" else [noun]
        elif noun in closed("limbs"):
            formed.object = Ref("part", "ab", noun, noun, "both")
        elif noun in ("each", "line"):
            formed.object = _EACH if noun == "each" else Ref("thing", lemma=noun)
        else:
            formed.prepositions = [("in", Ref("thing", lemma=noun))]
        yield formed


def next_to(event: Event, match: Found, known: Lexicon) -> Iterator[Event]:
    """Where somebody is who gets down beside the other: that they come there first, or stand there."""
    shown = {shape.do for shape in known.entries[match[0]].stage}
    for word, ref in event.prepositions:
        beside = word in ("beside", "alongside") or (word == "to" and "next" in event.words)
        if beside and ref.kind == "person" and match[2].patient and "posture" in shown:
            comes = event.bare(
                "sidle", subject=event.subject, particles=["up"], words=["up"], prepositions=[("to", ref)]
            )
            yield from formations(event, {"form line": None}) if event.ongoing or event.state else (comes,)


def held(event: Event, match: Found, known: Lexicon, find: Find) -> Iterator[tuple[Event, Found]]:
    """The postures that phrases beside an act name: "begs on his knees", but not "leans on his knees"."""
    agents = match[2].agents
    elements = (each for _, frame in known.frames.get(event.lemma, ()) for each in frame.elements)
    rests = event.lemma != "be" and any("on" in each.prepositions and each.slot != "place" for each in elements)
    rests = rests or any(shape.do == "posture" for shape in known.entries[match[0]].stage)
    rest = [event.prepositions[i] for i in match[2].rest if not (rests and event.prepositions[i][0] == "on")]
    for preposition, ref in rest:
        bears = _carries(ref) and (ref.family != "knee" or ref.side == "both")
        open_ = not ref.who and (preposition == "with" or bears)
        if ref.kind != "part" or not (open_ or ref.who == agents) or (preposition == "on" and not _carries(ref)):
            continue
        walks = event.lemma in vocabulary().verbs["goes"] | vocabulary().gaits.keys()
        if walks and ref.family in ("leg", "foot"):  # "limps on the left foot"
            continue
        words = [word for word in event.words if word in closed("arms held")]
        if preposition in ("to", "from") or (preposition == "with" and not words):  # "from foot to foot" rises to none
            continue
        posture = event.bare("stand", subject=Ref("person", agents), words=words, prepositions=[(preposition, ref)])
        posed = find(posture)
        if posed is not None and posed[0] != match[0] and not posed[2].rest and posed[2].score > 1.5:
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
            preposition not in closed("before deeds")
            or ref.kind != "thing"
            or ref.lemma not in deeds(known)
            or (ref.place and preposition != "with")
            or ref.bare
        ):
            continue
        own = any(vocabulary().part(word) for word in event.words)  # "with slow arm circles"
        bodily = is_act(ref.lemma) or own or (preposition == "in" and event.lemma in closed("is there"))
        if ref.lemma in vocabulary().gaits:  # "is in a hurry"
            goes = event.lemma in closed("is there")
        else:  # "walks with a swagger"
            shown = {shape.do for name, _ in known.frames.get(ref.lemma, ()) for shape in known.entries[name].stage}
            goes = preposition == "with" and shown == {"go"}
        if not bodily or goes or ref.lemma in vocabulary().verbs["no_nouns"]:
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
        if preposition == "for" and event.lemma in vocabulary().verbs["wished"]:
            done.modality = "wished"  # "asks her for a dance"
        words = [word for word in event.words if word not in event.particles]
        performed = replace(done, lemma=PERFORM, object=ref, dative=done.object, words=words, noun=done)
        yield preposition, done if ref.lemma in known.frames and not own else performed
        if done.object is None:
            yield preposition, performed
