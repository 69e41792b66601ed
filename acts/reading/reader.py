"""From syntax to events: the verbs of a text with their arguments, denials, modality and order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from acts.frames import Event, Ref, best
from acts.lexicon import Lexicon

from . import wordnet
from .arguments import Arguments
from .ellipsis import Absolute, absolutes
from .people import A_NAME, B_NAME, Cast
from .subjects import Subjects, give_roles, goes_on, is_passive, names_one, reference, state_of
from .syntax import ClauseTree, has, is_ongoing, seems, tells_on
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_LISTED = frozenset(("conj", "xcomp", "advcl", "dep"))
"""Relations of clauses behind another that "then" may join to it: "sits down, then getting up"."""
_MEANING = frozenset(("NOUN", "PROPN", "VERB", "ADV", "ADJ"))
"""Parts of speech of words with a meaning of their own."""
_WITHIN = frozenset(("compound", "amod", "poss", "nmod", "det", "nummod"))
"""Relations of words that only say more about the one above them."""


class Reader:
    """Takes a parsed text apart into events."""

    def __init__(
        self, doc: Doc, known: Lexicon, lemmas: Mapping[int, str], forms: Mapping[str, tuple[str, str]]
    ) -> None:
        verbs = frozenset(known.frames)
        self.doc = doc
        self.cast = Cast()
        self.cast.alone = names_one(doc)
        self._absolutes = {absolute.preposition.i: absolute for absolute in absolutes(doc)}
        held = {token.i for absolute in self._absolutes.values() for token in (absolute.state, absolute.part)}
        placed = {phrase.i for absolute in self._absolutes.values() for phrase in absolute.placed()}
        self._tree = ClauseTree(doc, verbs, lemmas, forms, held)
        self._subjects = Subjects(self._tree, self.cast, self._event_of)
        self._arguments = Arguments(self.cast, known, held | self._absolutes.keys() | placed)
        self._words, self._known = vocabulary(), known
        self._of: dict[int, int] = {}
        self._joints: list[tuple[Event, Token, str, int | None]] = []

    def read(self) -> list[Event]:
        """The events, in the order of the text."""
        for token in self.doc:
            if self._tree.is_clause(token):
                self._event(token)
            elif token.dep_ == "conj" and token.head.i in self._of:
                self._gapped(token)
        self._states()
        self._postures()
        self._sort()
        self._resolve()
        return [event for event, *_ in self._joints]

    def without_subject(self) -> int:
        """The number of verbs that lack their subject."""
        subjects = ((self._joints[number][0].subject, self.doc[i].tag_) for i, number in self._of.items())
        return sum(who is not None and not who.lemma and tag in ("VBZ", "VBD", "NNS", "NN") for who, tag in subjects)

    def missed(self) -> Iterator[Token]:
        """Words with a meaning of their own that no event has taken up."""
        held = {t.i for absolute in self._absolutes.values() for t in (absolute.part, absolute.state)}
        seen = self._arguments.seen | self._of.keys() | self.cast.seen.keys() | held
        for token in self.doc:
            within = token.dep_ in _WITHIN or (token.dep_ == "advmod" and token.head.pos_ == "NUM")  # "about two"
            own = not within and token.i not in seen
            own = (own and token.lower_ not in closed("then") | closed("at once")) or self._is_swallowed(token)
            if token.pos_ in _MEANING and own:
                yield token

    def _is_swallowed(self, token: Token) -> bool:
        """True for a person whom the parser took for a part of the noun behind: "the man waves"."""
        person = self._words.is_usual_person
        named = token.text in (A_NAME, B_NAME) or person(token.lemma_.lower())
        named = named and not person(token.head.lemma_.lower())  # "the police officer"
        return named and token.dep_ in ("compound", "nmod", "amod") and token.head.i > token.i

    def _states(self) -> None:
        """Adds what phrases say that hang on the nouns of people: "the lady on the bench" sits."""
        for i, (verb, who) in sorted(self.cast.states.items()):
            phrase = self.doc[i]
            clause = next((t for t in phrase.ancestors if t.i in self._of), None)
            last = phrase.idx + len(phrase)
            event = Event(verb, Ref("person", who), first=phrase.idx, last=last, ongoing=True, state=True)
            self._joints.append((event, phrase, "with", clause.i if clause is not None else None))

    def _postures(self) -> None:
        """Adds how parts of the body are held beside a clause: "with arms crossed"."""
        for each in self._absolutes.values():
            clause = self._clause_of(each)
            subject = self._holder(each, clause)
            who = subject.who if subject is not None and subject.kind == "person" else ""
            ref = reference(each.part, self.cast, who)
            owner = Ref("person", ref.who) if ref.who and each.state.lower_ != "behind" else subject
            first = each.part.idx if each.verb == "put" or each.state.i > each.part.i else each.state.idx
            event = Event(
                each.verb or self._tree.lemma(each.state),
                owner,
                ref,
                first=first,
                last=first + len(each.part),
                ongoing=True,
                state=True,
            )
            if each.verb == "put":
                self._arguments.place(each.state, who, event)
            elif each.verb == "hold" or each.state.lower_ in self._words.directions:
                event.words.append(each.state.lower_)
                event.direction = self._words.directions.get(each.state.lower_)
            else:
                for phrase in (c for c in each.state.children if c.dep_ in ("prep", "advmod", "prt")):
                    self._arguments.place(phrase, who, event)
            for phrase in each.placed():
                self._arguments.place(phrase, who, event)
            self._joints.append((event, each.preposition, "with", clause.i if clause is not None else None))

    def _holder(self, absolute: Absolute, clause: Token | None) -> Ref | None:
        """The person who holds a part of the body so: the clause's subject, where nothing says another."""
        before = absolute.preposition.nbor(-1) if absolute.preposition.i else absolute.preposition
        if clause is None:  # "a person with one hand on the hip", "Both hands behind the back, chin up."
            held = self.cast.seen.get(before.i) or reference(before, self.cast, "")
            return held if held.kind == "person" else Ref("person", "ab")
        subject = self._joints[self._of[clause.i]][0].subject
        if before.pos_ in ("NOUN", "PROPN") and absolute.state.lower_ == "behind":
            return self.cast.seen.get(before.i, subject)  # "cuffs the thief, hands behind his back"
        return subject

    def _clause_of(self, absolute: Absolute) -> Token | None:
        """The clause beside which a part of the body is held: the one above, else the nearest of its sentence."""
        sentence = absolute.preposition.sent
        above = next((t for t in absolute.preposition.ancestors if t.i in self._of), None)
        own = [self.doc[i] for i in self._of if sentence.start <= i < sentence.end]
        before = [token for token in own if token.i < absolute.preposition.i]
        return before[-1] if before and (above is None or above.i < before[-1].i) else above or next(iter(own), None)

    def _sort(self) -> None:
        """Puts what is held from the start of a sentence before its verbs."""
        order = sorted(range(len(self._joints)), key=lambda number: self._joints[number][0].first)
        self._joints = [self._joints[number] for number in order]
        place = {number: i for i, number in enumerate(order)}
        self._of = {token: place[number] for token, number in self._of.items()}

    def _resolve(self) -> None:
        """Gives each event the number of the one beside which it lies."""
        for number, (event, token, kind, head) in enumerate(self._joints):
            if head is None:  # a main clause follows the last sentence's last event
                first = token.sent.start_char
                before = [i for i, (other, *_) in enumerate(self._joints) if other.first < first]
                event.joint, event.beside = ("after", before[-1]) if before else ("", None)
            else:
                event.joint, event.beside = kind, self._of.get(head, number - 1 if number else None)
            if event.beside == number:
                event.joint, event.beside = "", None

    def _event(self, token: Token) -> None:
        lemma = "be" if seems(token) else self._tree.lemma(token)
        head = self._tree.head(token)
        subject = self._subjects.of(token, head)
        event = Event(lemma, subject, first=token.idx, last=token.idx + len(token.text))
        event.goes = wordnet.usual_kind(lemma) == "motion"
        kind, beside = self._joint(token, head)
        if self._tree.is_main(token, told=kind == "then"):
            self._tree.mains.append(token.i)
        event.ongoing = is_ongoing(token, lemma)
        self._polarity(token, head, event)
        agent = self._arguments.fill(token, event)
        above = self._event_of(token.head) if goes_on(token) else None
        state = None if agent is not None else state_of(token, event, self._known)
        event = state or event
        if state is None and (above is not None or is_passive(token)):
            agent = agent or (above.subject if above is not None else None)  # "is dipped by him and then spun out"
            give_roles(token, event, agent)
        if event.object is None and event.dative is not None:
            event.object, event.dative = event.dative, None
        self._arguments.light(event)
        if token.dep_ == "acl" and token.tag_ != "VBG" and event.subject is not None and event.subject.kind == "part":
            event.object, event.subject = (event.subject, self._owner(event.subject, head))  # "with both arms raised"
            event.ongoing, kind = True, "with"
        self.cast.focus = event.subject.who if event.subject is not None and self._is_mutual(event) else ""
        self._of[token.i] = len(self._joints)
        if kind == "comp" and beside is not None and (above := self._event_of(self.doc[beside])) is not None:
            above.words.append(lemma)
            if above.object is None and subject is not None and subject is not above.subject:
                above.object = subject  # "helps him stand": in the syntax, he is only the second verb's
        self._joints.append((event, token, kind, beside))

    def _is_mutual(self, event: Event) -> bool:
        """True for what the two do together even where one is named first."""
        match = best(self._known.frames, event)
        return match is not None and self._known.entries[match[0]].mutual

    def _owner(self, part: Ref, head: Token | None) -> Ref | None:
        """The person whose part of the body a phrase names: its owner, or whose clause it stands in."""
        if part.who:
            return Ref("person", part.who, first=part.first, last=part.last)
        return self._subjects.found(head)

    def _gapped(self, token: Token) -> None:
        """Adds the clause whose verb is left out: "A waves with the right hand and B with the left"."""
        ref = reference(token, self.cast, "")
        if ref.kind != "person" or not has(token, "prep", "dobj"):
            self.cast.seen.pop(token.i, None)
            return
        before = self._joints[self._of[token.head.i]][0]
        said = {"subject": ref, "object": before.object, "dative": before.dative, "ongoing": False, "state": False}
        event = before.bare(before.lemma, **said, first=token.idx, last=token.idx + len(token.text))
        self._arguments.fill(token, event)
        self._joints.append((event, token, "with", token.head.i))

    def _polarity(self, token: Token, head: Token | None, event: Event) -> None:
        children = {child.lower_ for child in token.children if child.dep_ in ("neg", "det", "preconj", "advmod", "cc")}
        subjects = [child for child in token.children if child.dep_ in ("nsubj", "nsubjpass")]
        marks = {c.lower_ for c in token.children if c.dep_ in ("mark", "prep")}
        above = token.head
        instead = {above.lower_, above.head.lower_, *(c.lower_ for c in above.children)} & {"instead"}
        event.denied = (
            has(token, "neg")
            or bool(children & {"never", "hardly", "barely"})
            or (event.subject is not None and event.subject.lemma in closed("nobody"))
            or any(c.lower_ in ("no", "neither") for child in subjects for c in child.children)
            or (token.dep_ == "advcl" and "than" in marks)  # "rather than shake hands, they bow"
            or (token.dep_ == "pcomp" and (bool(instead) or above.lower_ in ("without", "from")))
        )
        if any(child.dep_ == "aux" and child.lower_ in closed("may") for child in token.children):
            event.modality = "wished"
        if children & closed("nearly"):
            event.modality = "tried"
        if token.dep_ == "advcl" and ({"as", "if"} <= marks or {"as", "though"} <= marks or "like" in marks):
            event.modality = "pretended"  # "walks up as if to hug"
        if token.dep_ == "pcomp" and above.lower_ == "like" and not seems(above.head):
            event.modality = "pretended"  # "moves the arms like rowing a boat"
        if token.dep_ == "xcomp" and above.pos_ == "ADJ":  # "too proud to cry", "unable to stop", "ready to box"
            kinds = self._words.adjectives
            event.denied |= above.lower_ in kinds["not"] or any(c.lower_ == "too" for c in above.children)
            event.modality = "wished" if above.lower_ in kinds["wished"] else event.modality
        self._inherited(token, head, event)

    def _inherited(self, token: Token, head: Token | None, event: Event) -> None:
        """Takes over what the verb above says of a clause: that it is denied, tried, wished or prevented."""
        marks = {child.lower_ for child in token.children if child.dep_ == "mark"}
        if head is not None and token.dep_ == "advcl" and "before" in marks:
            stops = self._event_of(head)
            if stops is not None and stops.lemma in self._words.verbs["prevents"]:
                event.modality = "wished"  # "catches him before he falls"
        # "asks the princess to dance", "signals for him to leave"
        asked = token.tag_ == "VB" and (token.dep_ == "acl" or (token.dep_ == "advcl" and "for" in marks))
        if head is None or not (asked or token.dep_ in ("xcomp", "ccomp", "pcomp", "advcl")):
            if head is not None and token.dep_ == "conj":
                above = self._event_of(head)
                own = has(token, "nsubj", "nsubjpass")
                if above is not None and not own and above.denied and token.head.i == head.i:
                    event.denied = event.denied or any(c.lower_ == "or" for c in head.children)
                below = head.dep_ in ("xcomp", "ccomp") or token.tag_ in ("VB", "VBG")
                if above is not None and not own and above.modality != "told" and below:
                    event.modality, event.denied = above.modality, event.denied or above.denied
            return
        above = self._event_of(head)
        if above is None or (token.dep_ == "advcl" and not asked):
            return
        verbs = self._words.verbs
        if above.lemma in closed("says") and token.tag_ == "VB":  # "says hit me"
            event.modality = "wished"
        for kind in ("tried", "pretended", "wished", "offered"):
            if above.lemma in verbs[kind]:
                event.modality = kind
                event.denied = event.denied or above.denied
        if above.lemma in verbs["not"]:
            named = has(token, "nsubj", "nsubjpass")  # "refuses what he holds out"
            event.denied = event.denied if named else not above.denied
        elif above.lemma in verbs["begins"] | verbs["causes"]:
            event.denied = event.denied or above.denied
            event.modality = above.modality if event.modality == "told" else event.modality
        elif above.lemma in verbs["ends"]:
            event.denied = True

    def _event_of(self, head: Token) -> Event | None:
        number = self._of.get(head.i)
        return self._joints[number][0] if number is not None and number < len(self._joints) else None

    def _joint(self, token: Token, head: Token | None) -> tuple[str, int | None]:
        """The place of a clause in time beside another, as (kind, the token of that one's verb).

        The token is None for a main clause, which comes after the sentence before; the kind is "then" where the text
        says so in a word of its own.
        """
        bare = (c for c in token.children if all(below.dep_ != "pobj" for below in c.children))
        marks = [c.lower_ for c in bare if c.dep_ in ("mark", "advmod", "prep", "cc", "intj")]
        above = head if head is not None else next((t for t in token.ancestors if self._tree.is_clause(t)), None)
        previous = max((i for i in self._of if i < token.i), default=None)
        own = next((kind for mark in marks if (kind := self._words.marks.get(mark))), "")
        later = above is not None and above.i < token.i and token.dep_ in _LISTED and not own
        then = any(t.lower_ in closed("then") for t in self.doc[previous or 0 : token.i])
        if not closed("then").isdisjoint(marks) or (later and then):
            return "then", previous
        if not closed("at once").isdisjoint(marks) and token.dep_ != "xcomp":
            return "with", previous
        if self._tree.is_main(token):
            main = next(reversed(self._tree.mains), None)
            if main is None or self.doc[main].sent.start != token.sent.start:
                return "after", None
            between = self.doc[main : token.i]
            joined = not has(token, "nsubj", "nsubjpass") or any(t.pos_ == "CCONJ" for t in between)
            joined = joined or any(c.dep_ == "npadvmod" for c in self.doc[main].lefts)  # "each time he bows, she …"
            kind = "conj" if joined else "comma"  # "he kicks the ball, she dives"
            return "after" if any(t.text == ";" for t in between) else kind, main
        if above is None:
            return "after", None
        if token.dep_ == "pobj":
            return self._words.noun_marks.get(token.head.lower_, "with"), above.i
        if token.dep_ == "pcomp":
            return self._words.marks.get(token.head.lower_, "with"), above.i
        if token.dep_ == "advcl":  # of the nearest in a list: "walks up and hides when she turns"
            if any(t.lower_ in closed("then") for t in self.doc[token.i : above.i]) and previous is not None:
                return own or "while", previous  # "A spins while B claps, then they bow"
            listed = (i for i in self._of if above.i < i < token.i and self.doc[i].dep_ == "conj")
            nearest = max((i for i in listed if above in self.doc[i].ancestors), default=above.i)
            return own or "while", nearest if own in ("main-after", "main-until", "after") else above.i
        if token.dep_ == "amod":
            return "while", above.i
        if token.dep_ == "relcl" and token.i > above.i and token.tag_ != "VBG" and tells_on(token):
            return "who", above.i
        if token.dep_ in ("acl", "relcl") and not (token.dep_ == "acl" and token.tag_ == "VBZ"):
            return ("while" if token.tag_ == "VBG" else "with"), above.i
        if token.dep_ in ("xcomp", "ccomp"):
            told = any(c.lower_ == "who" and c.dep_ == "nsubj" for c in token.children)  # "…, who limps"
            return "while" if told else "comp", above.i
        if above.i > token.i:  # "they hug and then part", where the second became the main one
            self._tree.mains.append(token.i)
            return "after", None
        return "conj", above.i
