"""The arguments and modifiers of a verb: objects, prepositions, particles, counts, measures and directions."""

from __future__ import annotations

import re
from collections.abc import Set
from dataclasses import replace
from typing import TYPE_CHECKING

from acts.frames import Event, Ref
from acts.lexicon import Lexicon, kind_of

from . import wordnet
from .people import Cast, states_of
from .spelling import deeds
from .subjects import reference
from .syntax import adverb_of, has, hung_on, is_adverb, is_kept
from .vocabulary import closed, is_act, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Token

_MODIFIERS = frozenset(("prt", "advmod", "acomp", "attr", "oprd", "npadvmod", "amod", "neg", "intj", "compound"))


class Arguments:
    """Fills an event with what hangs on its verb.

    Args:
        cast: the people of the text so far.
        known: the lexicon.
        postures: prepositions, by token, of phrases that say how a part of the body is held.
    """

    def __init__(self, cast: Cast, known: Lexicon, postures: Set[int] = frozenset()) -> None:
        self.cast = cast
        self._postures = postures
        self._verbs, self._deeds = known.frames.keys(), deeds(known)
        self._words = vocabulary()
        self.seen: set[int] = set()
        """Tokens that have been taken up."""

    def fill(self, token: Token, event: Event) -> Ref | None:
        """Takes up the children of a verb; returns the agent of a passive."""
        subject = event.subject
        who = subject.who if subject is not None and subject.kind == "person" else ""
        agent: Ref | None = None
        for child in hung_on(token):
            if subject is not None and self.cast.seen.get(child.i) is subject:  # "…, said the witch"
                continue
            if child.i in self._postures and child.dep_ in ("prt", "advmod"):  # "stands with shoulders up"
                continue
            bare = not has(child, "poss", "det")
            if child.dep_ == "aux" and child.lower_ in ("come", "comes", "came"):  # "comes running"
                event.words.append("come")
            elif (
                child.dep_ in ("dobj", "obj")
                and bare
                and (child.lower_ in self._words.directions or child.pos_ == "ADV" or child.lower_ == "times")
            ):
                self._modifier(child, event)
            elif child.dep_ in ("dobj", "obj", "npadvmod") and (way := self._way(child, event)):  # "walks down a ramp"
                event.prepositions.append((way, self._argument(child, who, event)))
            elif child.dep_ in ("dobj", "obj") and self._is_measure(child, event):  # "walk a few steps"
                self._measured(child, who, event)
            elif child.dep_ in ("dobj", "obj") or (child.dep_ == "nsubj" and child.i > token.i):
                self._object(child, who, event)
            elif child.dep_ in ("dative", "iobj") and child.pos_ != "ADP":
                event.dative = self._argument(child, who, event)
            elif child.dep_ == "agent":
                agent = next((self._argument(n, who, event) for n in child.children if n.dep_ == "pobj"), None)
                if agent is not None and agent.kind == "part":  # "is pulled by the elbow"
                    event.prepositions.append(("by", agent))
                    agent = None
            elif child.dep_ in ("prep", "dative") or (child.dep_ == "prt" and has(child, "pobj")):
                self._preposition(child, who, event)
            elif child.dep_ in ("ccomp", "xcomp", "advcl", "oprd") and (
                (child.pos_ in ("ADP", "ADV") and not has(child, "mark"))
                or (child.pos_ == "ADJ" and child.left_edge.i == token.i + 1)
            ):
                for noun in child.children:  # "lifts the second person up" and "shakes him awake", as a clause
                    if noun.dep_ in ("nsubj", "pobj") and event.object is None:
                        event.object = self._argument(noun, who, event)
                if child.pos_ == "ADJ":
                    self._modifier(child, event)
                else:
                    event.words.append(child.lower_)
                    event.particles.append(child.lower_)
            elif is_kept(child):
                event.words.append(child.lower_)
            elif (
                child.dep_ in _MODIFIERS
                or (child.pos_ == "INTJ" and child.i > token.i)
                or (child.dep_ in ("xcomp", "ccomp", "advcl") and (child.pos_ == "ADJ" or is_adverb(child.lower_)))
            ):
                self._modifier(child, event)
            else:
                continue
            self.seen.add(child.i)
        return agent

    def _measured(self, noun: Token, who: str, event: Event) -> None:
        """Takes up a length or a time that stands as an object: "walk a few steps to the left"."""
        lasts = self._words.seconds.get(noun.lemma_.lower())
        event.words += [] if lasts else [noun.lemma_.lower()]
        event.seconds = self._amount(noun) * lasts if lasts else event.seconds
        for child in noun.children:
            self._count(child, noun, event)
            self._direction(child.lower_, event)
            if child.dep_ == "prep":
                self._preposition(child, who, event)

    def _is_measure(self, noun: Token, event: Event) -> bool:
        lemma = noun.lemma_.lower()
        lasts = lemma in self._words.seconds and has(noun, "nummod")
        return (lemma in closed("lengths") or lasts) and event.lemma not in self._words.verbs["light"]

    def _way(self, noun: Token, event: Event) -> str:
        """The preposition of a way: "walks down a ramp", "walks (in) a circle around her"; "" for other nouns."""
        goes = event.lemma in self._words.verbs["goes"] and not self._words.part(noun.lemma_.lower())
        before = noun.doc[max(noun.left_edge.i - 1, 0)]
        if goes and before.dep_ in ("prt", "advmod") and before.lower_ in closed("along"):
            return before.lower_
        return "in" if goes and noun.lemma_.lower() in closed("paths") else ""

    def _object(self, token: Token, who: str, event: Event) -> None:
        """Takes up an object; of two, as in "hands the knight his sword", the person is the receiver."""
        ref = self._argument(token, who, event)
        things = (c for c in token.children if c.dep_ == "appos" and c.left_edge.i == token.i + 1)
        if ref.kind == "person" and (thing := next(things, None)) is not None:  # "shows the boy a cup"
            event.object, ref, token = ref, self._argument(thing, who, event), thing
        if event.object is not None and event.object.kind == "person" and ref.kind != "person":
            event.dative = event.object
        if ref.kind == "thing" and token.tag_ == "NN":
            self.cast.thing, self.cast.thing_of = ref, who  # a sofa that is carried is no place
        event.object = ref

    def _argument(self, token: Token, who: str, event: Event) -> Ref:
        self.seen.add(token.i)
        way = self._words.directions.get(token.lower_)
        turns = way in closed("of the clock")
        inner = ("compound", "poss") if turns else ("compound",)
        within = next((c for c in token.children if c.dep_ in inner or c.lower_ == "other"), None)
        moved = within is not None and way is not None and self._words.part(within.lemma_.lower())
        if within is not None and (moved or turns):
            event.words += [token.lower_] if moved else []
            self._direction(token.lower_, event)
            for often in (c for c in token.children if c.lemma_ == "time" or c.lower_ in closed("so often")):
                self._modifier(often, event)
            token = within  # "in a circle clockwise", "around her clockwise", "waves the hand sideways"
        if (part := self._named_by(token)) is not None:
            token = part
        person = self._words.is_person(token.lemma_.lower())
        states = {phrase.i for phrase, _ in states_of(token)} if person else set()
        for child in token.children:
            if child.dep_ in ("compound", "amod"):
                sided = child.lower_ in ("left", "right") and self._words.part(token.lemma_.lower())
                event.words += [] if sided else [child.lemma_.lower()]
                if self._words.directions.get(child.lower_) in closed("of the clock"):
                    self._direction(child.lower_, event)
                if child.lower_ in ("left", "right") and is_act(token.lemma_.lower()) and not self._others(token, who):
                    event.side = event.side or child.lower_  # "a left hook"
                    event.direction = event.direction or child.lower_ * (token.lemma_ == "turn") or None
            owner = child.lower_ == "of" and self._words.part(token.lemma_.lower())  # "the arms of the other"
            if child.dep_ == "prep" and (owner or child.i in states):
                continue
            if child.dep_ == "prep":  # "puts a hand on his shoulder": the place may hang on the noun
                self._preposition(child, who, event)
            elif child.dep_ == "nummod" or child.lower_ in self._words.numbers:
                self._count(child, token, event)
            elif child.dep_ == "prt" or (child.dep_ in ("appos", "advmod") and child.lower_ in self._words.directions):
                # "helps him up off the floor", "in a circle, clockwise"
                self._modifier(child, event)
            elif child.lower_ == "no" and child.dep_ == "det":
                event.denied = not event.denied
        return reference(token, self.cast, who)

    def _named_by(self, spot: Token) -> Token | None:
        """The part of the body of which a noun names a spot: "the top of his head"; None for other nouns."""
        of = next((c for c in spot.children if c.lower_ == "of"), None)
        parts = (c for c in of.children if self._words.part(c.lemma_.lower())) if of is not None else ()
        part = next(iter(parts), None) if spot.lemma_.lower() in closed("spots") else None
        self.seen |= {spot.i, of.i, part.i} if of is not None and part is not None else set()
        return part

    def _others(self, noun: Token, who: str) -> bool:
        """True for what the other does: "parries A's left punch"."""
        return self.cast.owner(noun, who) not in ("", who)

    def place(self, token: Token, who: str, event: Event) -> None:
        """Takes up the phrase of a preposition or an adverb: "on his back", "forward"."""
        if token.dep_ == "prep":
            self._phrase(token, who, event)
        else:
            self._modifier(token, event)

    def _preposition(self, token: Token, who: str, event: Event) -> None:
        if token.i not in self._postures:
            self._phrase(token, who, event)

    def _phrase(self, token: Token, who: str, event: Event) -> None:
        taken = False
        self.seen.add(token.i)
        for child in token.children:
            self.seen.add(child.i)
            if child.dep_ == "pcomp":
                taken = True
                if child.pos_ in ("ADV", "ADP"):  # "from behind", "from two metres away"
                    event.words += [token.lower_, child.lower_]
                    for measure in (c for c in child.children if c.dep_ == "npadvmod" and self._is_length(c)):
                        self._modifier(measure, event)
            elif child.dep_ in ("pobj", "obj"):
                taken = True
                part = next((c for c in child.children if child.lemma_ == "time" and self._words.part(c.lower_)), None)
                if part is not None:  # "on the back four times"
                    event.times, child = int(self._amount(child)), part
                self._likeness(child, token, event)
                if self._measure(child, token, event):
                    continue
                event.prepositions.append((token.lower_, self._instrument(child, who, event)))
                if child.lower_ == "air" and event.direction is None:
                    event.direction = "up"  # "into the air"
                for more in child.conjuncts:
                    if more.i > child.i and more.pos_ in ("NOUN", "PRON", "PROPN"):
                        event.prepositions.append((token.lower_, self._argument(more, who, event)))
            elif child.dep_ == "advmod" and is_adverb(child.lower_):  # "runs wildly around her"
                self._modifier(child, event)
            elif child.dep_ == "prep":  # "up to her", "over to him", "out of the room"
                event.words.append(token.lower_)
                self._preposition(child, who, event)
                taken = True
        if token.lower_ == "from":  # "from behind"
            event.adverbs += [
                f"from {c.lower_}" for c in token.children if c.lower_ in closed("from where") and not c.n_rights
            ]
        if not taken:
            event.words.append(token.lower_)
            event.particles.append(token.lower_)
            self._direction(token.lower_, event)

    def _instrument(self, noun: Token, who: str, event: Event) -> Ref:
        """The argument of a preposition; what is done "with his hand" is done with one's own, if that may be."""
        ref = self._argument(noun, who, event)
        own = noun.head.lower_ == "with" and ref.kind == "part" and len(who) == 1
        return replace(ref, who="") if own and not self.cast.sex(who) else ref

    def _measure(self, noun: Token, preposition: Token, event: Event) -> bool:
        """Takes up "for five seconds" and "to the left"; False for other phrases."""
        lemma = noun.lemma_.lower()
        if preposition.lower_ in ("for", "within", "after", "over") and lemma in self._words.seconds:
            event.seconds = self._amount(noun) * self._words.seconds[lemma]
            return True
        if preposition.lower_ == "for" and lemma in closed("lengths"):  # "walks forward for three steps"
            for child in noun.children:
                self._count(child, noun, event)
            return True
        words = {child.lower_ for child in noun.children}
        if (
            lemma in ("direction", "side")
            and preposition.lower_ in ("in", "to", "toward", "towards")
            and len(words) < 4
        ):
            lemma = next((word for word in ("left", "right") if word in words), lemma)  # "in the right direction"
        if preposition.lower_ in ("in", "to", "on", "toward", "towards", "with") and lemma in ("left", "right"):
            event.side = lemma  # "mirrors her with the right" leaves the hand out
            event.direction = event.direction if preposition.lower_ == "with" else lemma
            event.words.append(lemma)
            return True
        return False

    def _likeness(self, noun: Token, preposition: Token, event: Event) -> None:
        """Notes "like an old man" and "in a friendly way" as the adverb of how one moves so."""
        said = [c.lower_ for c in noun.children if c.dep_ in ("amod", "compound")]
        if preposition.lower_ == "in" and noun.lower_ in closed("ways"):
            event.adverbs += [adverb_of(adjective) for adjective in said]
        elif preposition.lower_ == "like":
            named = (noun.lemma_.lower(), *said)  # of "an old king", old
            adverbs = [self._words.likeness[word] for word in named if word in self._words.likeness]
            event.adverbs += adverbs[-1:]

    def _amount(self, noun: Token, otherwise: float = 1.0) -> float:
        """The number that stands with a noun, and another where none does."""
        children = sorted(noun.children, key=lambda each: each.tag_ == "DT")  # "a few steps" are not one
        return next((value for child in children if (value := self._number(child)) is not None), otherwise)

    def _number(self, word: Token) -> float | None:
        known, text = self._words.numbers.get(word.lower_), word.text.replace(",", ".")
        return float(text) if known is None and re.fullmatch(r"\d{1,3}(\.\d+)?", text) else known

    def _is_length(self, noun: Token) -> bool:
        """True for a unit of length; feet are one behind a number and a verb, and not where one stands on them."""
        lemma = noun.lemma_.lower()
        measured = noun.tag_ == "NNS" and noun.dep_ in ("npadvmod", "dobj", "obj")
        return lemma in self._words.metres and (measured or not self._words.part(lemma))

    def _count(self, number: Token, noun: Token, event: Event) -> None:
        value = self._number(number)
        lemma = noun.lemma_.lower()
        if value is None or self._words.is_person(lemma) or lemma == "degree" or number.lower_ in ("a", "an"):
            return
        if lemma in self._words.seconds:  # "on count five", "with a delay of one second"
            return
        act = event.lemma in closed("does") or is_act(lemma) or lemma in self._deeds | closed("paths") | closed("times")
        if self._is_length(noun):
            event.distance = value * self._words.metres[lemma]
            event.times = int(value) if lemma in ("step", "pace") else event.times
        elif value <= 100 and act and not (self._words.part(lemma) or kind_of(lemma)):  # and not "three balls"
            event.times = max(int(value), 1)

    def _modifier(self, token: Token, event: Event) -> None:
        self.seen.add(token.i)
        text, lemma = token.lower_, token.lemma_.lower()
        if token.pos_ == "INTJ" or token.dep_ == "intj":  # "says no"
            event.words.append(text)
            return
        if text in closed("denials") or token.dep_ == "neg":
            return
        if lemma == "time":
            event.times = int(self._amount(token, 0.0)) or event.times  # "this time" is no number
            return
        if token.dep_ == "npadvmod" and self._is_length(token):
            event.distance = self._amount(token) * self._words.metres[lemma]
            event.times = int(self._amount(token)) if lemma in ("step", "pace") else event.times
            event.words.append(lemma)
            return
        if text in closed("so often"):
            event.times = self._words.numbers[text]
            for child in (c for c in token.children if c.dep_ == "advmod"):  # "spins around twice"
                self._modifier(child, event)
            return
        if token.dep_ == "prt":
            event.particles.append(text)
        event.words.append(text if token.dep_ in ("prt", "advmod") else lemma)
        if text in ("left", "right"):
            event.side = text
        if all(child.lower_ != "forth" for child in token.children):  # "back and forth" is no way back
            self._direction(text, event)
        adverb = token.dep_ == "advmod" or (token.dep_ == "conj" and token.head.dep_ == "advmod") or is_adverb(text)
        if adverb and (text.endswith("ly") or text in self._words.speeds):
            event.adverbs.append(text)
        for child in token.children:
            if child.dep_ == "prep":
                self._preposition(child, event.subject.who if event.subject else "", event)
            elif (
                lemma != "time" and child.lemma_ == "time" and (often := self._number(token))
            ):  # "three times clockwise"
                event.times = int(often)
                self.seen.add(child.i)
            elif child.dep_ == "npadvmod" and self._words.part(child.lemma_.lower()) and event.object is None:
                event.object = self._argument(child, event.subject.who if event.subject else "", event)
            elif child.dep_ in ("advmod", "npadvmod", "amod", "compound", "nummod") or (
                child.dep_ == "conj" and child.pos_ in ("ADV", "ADJ", "NOUN", "ADP")
            ):
                self._modifier(child, event)
            elif child.dep_ == "pobj":  # "up and down the room"
                event.prepositions.append((text, self._argument(child, "", event)))

    def _direction(self, text: str, event: Event) -> None:
        name = self._words.directions.get(text)
        if name in ("left", "right"):
            event.side = event.side or name
            event.words += [name] if name != text else []
        if event.direction is None and text in self._words.directions:
            event.direction = self._words.directions[text]

    def light(self, event: Event) -> None:
        """Turns "gives him a hug" and "takes a bow" into the verb that their noun stands for."""
        noun = event.object
        if noun is not None and noun.kind == "thing" and noun.lemma == event.lemma:  # "dances a slow dance"
            event.object = noun = None
        if noun is not None and noun.kind == "thing" and noun.lemma in self._verbs and is_act(noun.lemma):
            for kind in ("tried", "wished", "not", "pretended", "offered"):  # "wants a hug", "refuses the dance"
                if event.lemma in self._words.verbs[kind] and event.lemma not in ("hope", "promise"):
                    if kind == "offered" and wordnet.usual_kind(noun.lemma) == "consumption":
                        continue  # "offers her a drink" hands something over
                    event.lemma, event.object, event.dative = noun.lemma, event.dative, None
                    event.modality = event.modality if kind == "not" else kind
                    event.denied = event.denied != (kind == "not")
                    return
        if event.lemma not in self._words.verbs["light"] or noun is None or noun.kind != "thing" or noun.place:
            return
        if event.lemma in closed("shows") and noun.lemma in self._deeds:  # "shows her a handstand": does one
            event.lemma, event.dative = "do", None
        if noun.lemma not in self._verbs or noun.lemma in ("step", "hand") or not is_act(noun.lemma):
            return
        if wordnet.usual_kind(noun.lemma) == "consumption" and noun.lemma not in self._words.verbs["nouns"]:
            return  # "offers her a drink" hands something over
        event.noun = replace(event, lemma=noun.lemma, object=event.dative, dative=None)
        giver = next((i for i, (p, ref) in enumerate(event.prepositions) if p == "from" and ref.kind == "person"), -1)
        if event.lemma in closed("receives") and giver >= 0:  # "gets a massage from her": she massages him
            rest = [each for i, each in enumerate(event.prepositions) if i != giver]
            event.noun = replace(
                event.noun, subject=event.prepositions[giver][1], object=event.subject, prepositions=rest
            )
