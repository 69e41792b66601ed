"""The entry of the lexicon that an event means: by its frames, or by those of a verb of like meaning."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from acts.frames import Event, Frame, Match, Ref, best
from acts.lexicon import Lexicon
from acts.plan import other_of

from . import wordnet
from .ellipsis import PERFORM
from .vocabulary import is_act, vocabulary

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
        found = max(self._said_by_noun(event), key=lambda each: each[2].score, default=None)
        if found is None or found[2].score < LEAST_SCORE:
            found = self._synonym(event)
        return found

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
            found = best(self._known.frames, form)
            if found is not None and (form.lemma == event.lemma or not found[2].thing):
                yield found

    def _synonym(self, event: Event) -> Found | None:
        """The act whose verbs mean what this one does, of those whose frames fit."""
        found: Found | None = None
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
                most, found = worth, (name, frame, match)
        return found

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
                    found = best(self._frames, _as(event, verb))
                    if found is not None and found[2].score >= 0.0:
                        yield cost, found

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
