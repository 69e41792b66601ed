"""From syntax to events: the verbs of a text with their arguments, denials, modality and order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from acts.frames import Event, Ref

from .arguments import Arguments, is_kept
from .clauses import MARKS, is_finite, may_be_main
from .people import Cast, reference
from .syntax import is_ongoing
from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_CLAUSES = frozenset(
    (
        "ROOT",
        "conj",
        "advcl",
        "relcl",
        "ccomp",
        "xcomp",
        "acl",
        "pcomp",
        "parataxis",
        "dep",
        "csubj",
        "appos",
        "prep",
    )
)
_LEAVES = frozenset(("leave", "find"))
"""Verbs whose object does what follows, beside those that cause or see it."""
_NOUNMARKS = {"after": "main-after", "following": "main-after", "upon": "main-after", "before": "after"}
"""Prepositions behind which a noun stands for an act of its own."""
_THEN = frozenset(
    ("then", "afterwards", "afterward", "finally", "next", "later", "subsequently", "eventually", "lastly")
)
_SOMEBODY = frozenset(("him", "her", "his", "me", "my"))
_AT_ONCE = frozenset(("simultaneously", "meanwhile"))
_NEARLY = frozenset(("almost", "nearly"))


class Reader:
    """Takes a parsed text apart into events."""

    def __init__(
        self, doc: Doc, verbs: frozenset[str], lemmas: dict[int, str], forms: Mapping[str, tuple[str, str]]
    ) -> None:
        self.doc = doc
        self.cast = Cast()
        self.events: list[Event] = []
        self._verbs = verbs
        self._lemmas = lemmas
        self._forms = forms
        self._of: dict[int, int] = {}
        self._subjects: dict[int, Ref | None] = {}
        self._mains: list[int] = []
        """The verbs of main clauses so far, by token."""
        self._main: dict[int, bool] = {}
        self._heads: dict[int, Token | None] = {}
        self._clauses: dict[int, bool] = {}
        self._joints: list[tuple[Event, Token, str, int | None]] = []
        self._words = vocabulary()
        self._arguments = Arguments(self.cast, verbs)

    def read(self) -> list[Event]:
        """The events, in the order of the text."""
        for token in self.doc:
            if self._is_clause(token):
                self._event(token)
            elif token.dep_ == "conj" and token.head.i in self._of:
                self._gapped(token)
        self._states()
        self._resolve()
        return self.events

    def _states(self) -> None:
        """Adds what phrases say that hang on the nouns of people: "the lady on the bench" sits."""
        for i, (verb, who) in sorted(self.cast.states.items()):
            phrase = self.doc[i]
            clause = next((t for t in phrase.ancestors if t.i in self._of), None)
            event = Event(
                verb,
                Ref("person", who),
                first=phrase.idx,
                last=phrase.idx + len(phrase),
                ongoing=True,
                state=True,
            )
            self._joints.append((event, phrase, "with", clause.i if clause is not None else None))
            self.events.append(event)

    def _resolve(self) -> None:
        """Gives each event the number of the one beside which it lies."""
        for number, (event, token, kind, head) in enumerate(self._joints):
            if head is None:  # a main clause follows the last sentence's last event
                first = token.sent.start_char
                before = [i for i, other in enumerate(self.events) if other.first < first]
                event.joint, event.beside = ("after", before[-1]) if before else ("", None)
            else:
                event.joint, event.beside = kind, self._of.get(head, number - 1 if number else None)
            if event.beside == number:
                event.joint, event.beside = "", None

    def lemma(self, token: Token) -> str:
        """The lemma of a verb, with what is known better than by the parser."""
        known = self._lemmas.get(token.i)
        if known is None and token.lemma_.lower() not in self._verbs and token.lower_ in self._forms:
            known = self._forms[token.lower_][0]  # "stares" is no "star"
        return known or token.lemma_.lower()

    def _is_clause(self, token: Token) -> bool:
        if token.i not in self._clauses:
            self._clauses[token.i] = self._has_verb(token)
        return self._clauses[token.i]

    def _has_verb(self, token: Token) -> bool:
        if token.dep_ == "amod":  # "the sleeping baby"
            return (
                token.tag_ == "VBG"
                and self.lemma(token) in self._verbs
                and self._words.is_person(token.head.lemma_.lower())
            )
        if token.dep_ != "ROOT" and any(c.lower_ == "where" and c.dep_ == "advmod" for c in token.children):
            return False  # "to where she came from" is a place
        if is_kept(token):
            return False
        if token.pos_ in ("VERB", "AUX") and token.dep_ not in ("aux", "auxpass", "compound", "punct"):
            return True
        if token.dep_ == "pobj" and token.pos_ == "NOUN" and token.head.lower_ in _NOUNMARKS:
            known = self.lemma(token) in self._verbs and token.tag_ == "NN"  # "after a quick hug"
            return (
                known
                and token.head.head.pos_ in ("VERB", "AUX")
                and not self._words.is_person(token.lemma_.lower())
            )
        if token.dep_ == "ROOT" and token.pos_ in ("NOUN", "PROPN", "ADJ", "INTJ", "ADV", "ADP", "X"):
            return self.lemma(token) in self._verbs or token.i in self._lemmas
        return token.dep_ in ("conj", "pcomp") and token.i in self._lemmas

    def _event(self, token: Token) -> None:
        lemma = self.lemma(token)
        head = self._head(token)
        subject = self._subject(token, head)
        event = Event(lemma, subject, first=token.idx, last=token.idx + len(token.text))
        kind, beside = self._joint(token, head)
        if self._is_main(token):
            self._mains.append(token.i)
        event.ongoing = is_ongoing(token, lemma)
        self._polarity(token, head, event)
        agent = self._arguments.fill(token, event)
        passive = any(child.dep_ in ("nsubjpass", "auxpass", "agent") for child in token.children)
        if passive and token.tag_ == "VBN":
            agent = agent or (_other_person(subject) if subject is not None else None)
            if agent is None and subject is not None and subject.kind == "thing":  # "is held out to her"
                agent = next((_other_person(r) for _, r in event.prepositions if r.kind == "person"), None)
            if event.object is not None and event.dative is None:  # "she is given a book"
                event.dative, event.subject = subject, agent
            else:
                event.object, event.subject = subject, agent
        if event.object is None and event.dative is not None:
            event.object, event.dative = event.dative, None
        self._arguments.light(event)
        if (
            token.dep_ == "acl"
            and token.tag_ != "VBG"
            and event.subject is not None
            and event.subject.kind == "part"
        ):
            event.object, event.subject = (
                event.subject,
                self._owner(event.subject, head),
            )  # "with both arms raised"
            event.ongoing, kind = True, "with"
        self._of[token.i] = len(self.events)
        if kind == "comp" and beside in self._of and self._of[beside] < len(self.events):
            above = self.events[self._of[beside]]
            above.words.append(lemma)
            if above.object is None and subject is not None and subject is not above.subject:
                above.object = subject  # "helps him stand": in the syntax, he is only the second verb's
        self._joints.append((event, token, kind, beside))
        self.events.append(event)

    def _owner(self, part: Ref, head: Token | None) -> Ref | None:
        """The person whose part of the body a phrase names: its owner, or whose clause it stands in."""
        if part.who:
            return Ref("person", part.who, first=part.first, last=part.last)
        return self._subjects.get(head.i) if head is not None else None

    def _gapped(self, token: Token) -> None:
        """Adds the clause whose verb is left out: "A waves with the right hand and B with the left"."""
        ref = reference(token, self.cast, "")
        if ref.kind != "person" or all(child.dep_ not in ("prep", "dobj") for child in token.children):
            return
        before = self.events[self._of[token.head.i]]
        event = Event(
            before.lemma, ref, before.object, before.dative, denied=before.denied, modality=before.modality,
            first=token.idx, last=token.idx + len(token.text),
        )  # fmt: skip
        self._arguments.fill(token, event)
        self._joints.append((event, token, "with", token.head.i))
        self.events.append(event)

    def _head(self, token: Token) -> Token | None:
        """The verb on which a clause hangs; a finite one goes with a finite one: "does not want to …, and pushes"."""
        if token.i not in self._heads:
            clauses = (head for head in token.ancestors if self._is_clause(head))
            first = next(clauses, None)
            if first is not None and token.dep_ == "conj" and token.tag_ in ("VBZ", "VBD"):
                finite = (h for h in (first, *clauses) if is_finite(h))
                first = self._nearer(token, next(finite, first))
            self._heads[token.i] = first
        return self._heads[token.i]

    def _nearer(self, token: Token, head: Token) -> Token:
        """The main clause behind ``head`` with its own subject: "he talks, but she turns and covers her ears"."""
        if any(child.dep_ in ("nsubj", "nsubjpass") for child in token.children):
            return head
        later = [self.doc[i] for i in self._mains if head.i < i < token.i and self.doc[i].sent == token.sent]
        return next((t for t in reversed(later) if any(c.dep_ == "nsubj" for c in t.children)), head)

    def _is_main(self, token: Token) -> bool:
        """True for a clause that stands by itself in the order of the text."""
        passed: list[int] = []
        above: Token | None = token
        while above is not None and above.i not in self._main and above.dep_ != "ROOT" and may_be_main(above):
            passed.append(above.i)
            above = self._head(above) if above.dep_ in ("conj", "parataxis") else above.head
        main = above is not None and self._main.get(above.i, above.dep_ == "ROOT")
        self._main.update((i, main) for i in passed)
        return main

    def _subject(self, token: Token, head: Token | None) -> Ref | None:
        """The subject of a clause, found once, and before its turn where an earlier clause has the same."""
        waiting = [(token, head)]
        while (above := waiting[-1][1]) is not None and above.i not in self._subjects:
            if len(waiting) > len(self.doc) or any(
                c.dep_ in ("nsubj", "nsubjpass") for c in waiting[-1][0].children
            ):
                break
            waiting.append((above, self._head(above)))
        for clause, its_head in reversed(waiting):  # from above, so that none calls another in turn
            if clause.i not in self._subjects:
                self._subjects[clause.i] = self._subject_of(clause, its_head)
        return self._subjects[token.i]

    def _subject_of(self, token: Token, head: Token | None) -> Ref | None:
        moving = (
            c for aux in token.children if aux.dep_ == "aux" for c in aux.children
        )  # "he comes running"
        for child in (*token.children, *moving):
            if child.dep_ in ("nsubj", "nsubjpass", "csubj", "expl"):
                if child.tag_ in ("WP", "WDT") and token.dep_ == "relcl":
                    return self._antecedent(token)
                ref = reference(child, self.cast, "")
                if child.lower_ in ("nobody", "neither", "none") or (
                    child.lower_ == "one" and "no" in {c.lower_ for c in child.children}
                ):
                    return Ref("person", "ab", child.lower_, first=ref.first, last=ref.last)
                if child.lower_ in ("both", "each", "all") and ref.kind != "person":
                    return Ref("person", "ab", child.lower_, first=ref.first, last=ref.last)
                return ref
            if child.dep_ == "poss" and token.dep_ == "ccomp" and head is not None:  # "helps her walk"
                helper = self._subjects.get(head.i)
                return reference(child, self.cast, helper.who if helper is not None else "")
            if child.dep_ == "det" and child.lower_ in (
                "both",
                "all",
                "each",
            ):  # "the music starts, both freeze"
                return Ref("person", "ab", child.lower_, first=child.idx, last=child.idx + len(child.text))
        if (named := self._named_before(token)) is not None:
            return named
        if token.dep_ in ("relcl", "acl") or token.dep_ == "amod":
            return self._antecedent(token)
        if head is not None:
            own = self._subject(head, self._head(head))
            if token.dep_ in ("xcomp", "ccomp"):  # "makes her laugh", "asks him to sit"
                above = self._event_of(head)
                verbs = self._words.verbs
                if (
                    above is not None
                    and above.object is not None
                    and above.object.kind == "person"
                    and (
                        above.lemma in verbs["causes"] | verbs["sees"] | _LEAVES
                        or above.lemma in verbs["wished"]
                    )
                ):
                    return above.object
            return own
        main = next((i for i in reversed(self._mains) if self.doc[i].sent == token.sent), None)
        if (
            main is not None and main < token.i
        ):  # "creeps up, covers her eyes", where the second became the main one
            return self._subjects.get(main)
        if token.dep_ == "ROOT" or head is None:
            alone = any(
                t.lower_ in _SOMEBODY for t in token.subtree
            )  # "grab her by the wrist" is said to one
            if alone:
                self.cast.address("a")
            return Ref("person", "a" if alone else "ab", "", first=token.idx, last=token.idx)
        return None

    def _named_before(self, token: Token) -> Ref | None:
        """The person named right before a verb whom the parser took for a part of it, or for another's object.

        As in "while Beth crouches" and "he runs to Beth and Beth lifts him".
        """
        before = token.nbor(-1) if token.i and token.tag_ == "VBZ" else None
        if before is None or before.tag_ != "NNP" or before.dep_ not in ("conj", "compound"):
            return None
        ref = reference(before, self.cast, "")
        return ref if ref.kind == "person" else None

    def _antecedent(self, token: Token) -> Ref | None:
        noun = token.head
        if (known := self.cast.seen.get(noun.i)) is not None:
            return known
        who = self.cast.person(noun, "") if noun.pos_ in ("NOUN", "PROPN", "PRON", "ADJ", "NUM") else None
        if who:
            return Ref("person", who, noun.lemma_.lower(), first=noun.idx, last=noun.idx + len(noun.text))
        return reference(noun, self.cast, "") if noun.pos_ in ("NOUN", "PROPN") else None

    def _polarity(self, token: Token, head: Token | None, event: Event) -> None:
        children = {
            child.lower_
            for child in token.children
            if child.dep_ in ("neg", "det", "preconj", "advmod", "cc")
        }
        event.denied = any(child.dep_ == "neg" for child in token.children) or bool(
            children & {"never", "hardly", "barely"}
        )
        if event.subject is not None and event.subject.lemma in ("nobody", "neither", "none", "noone"):
            event.denied = True
        for child in token.children:
            if child.dep_ in ("nsubj", "nsubjpass") and any(
                c.lower_ in ("no", "neither") for c in child.children
            ):
                event.denied = True
            if child.dep_ == "aux" and child.lower_ in (
                "could",
                "would",
                "should",
                "might",
                "may",
                "must",
                "ought",
            ):
                event.modality = "wished"
        if children & _NEARLY:
            event.modality = "tried"
        if token.dep_ == "pcomp" and (
            token.head.lower_ in ("without", "instead", "from") or token.head.head.lower_ == "instead"
        ):
            event.denied = True
        if head is None or token.dep_ not in ("xcomp", "ccomp", "pcomp", "advcl"):
            if head is not None and token.dep_ == "conj":
                above = self._event_of(head)
                if above is not None and not any(c.dep_ in ("nsubj", "nsubjpass") for c in token.children):
                    if above.denied and token.head.i == head.i and self._conjunction(token) == "or":
                        event.denied = True
                    if above.modality != "told" and head.dep_ in ("xcomp", "ccomp"):
                        event.modality, event.denied = above.modality, event.denied or above.denied
            return
        above = self._event_of(head)
        if above is None or token.dep_ == "advcl":
            return
        verbs = self._words.verbs
        for kind in ("tried", "pretended", "wished", "offered"):
            if above.lemma in verbs[kind]:
                event.modality = kind
                event.denied = event.denied or above.denied
        if above.lemma in verbs["not"]:
            event.denied = not above.denied
        elif above.lemma in verbs["begins"] | verbs["causes"]:
            event.denied = event.denied or above.denied
            event.modality = above.modality if event.modality == "told" else event.modality
        elif above.lemma in verbs["ends"]:
            event.denied = True
        elif above.lemma == "be" and "about" in above.words:
            event.modality = "wished"

    def _event_of(self, head: Token) -> Event | None:
        number = self._of.get(head.i)
        return self.events[number] if number is not None and number < len(self.events) else None

    @staticmethod
    def _conjunction(token: Token) -> str:
        return next((child.lower_ for child in token.head.children if child.dep_ == "cc"), "")

    def _joint(self, token: Token, head: Token | None) -> tuple[str, int | None]:
        """The place of a clause in time beside another, as (kind, the token of that one's verb).

        The token is None for a main clause, which comes after the sentence before; the kind is "then" where the text
        says so in a word of its own.
        """
        marks = {c.lower_ for c in token.children if c.dep_ in ("mark", "advmod", "prep", "cc", "intj")}
        above = head if head is not None else next((t for t in token.ancestors if self._is_clause(t)), None)
        previous = max((i for i in self._of if i < token.i), default=None)
        if marks & _THEN or (above is not None and token.dep_ == "conj" and self._then_before(token)):
            return "then", previous
        if marks & _AT_ONCE:
            return "with", previous
        if self._is_main(token):
            mains = [i for i in self._mains if self.doc[i].sent.start == token.sent.start]
            return ("conj", mains[-1]) if mains else ("after", None)
        if above is None:
            return "after", None
        if token.dep_ == "pobj":
            return _NOUNMARKS.get(token.head.lower_, "with"), above.i
        if token.dep_ == "pcomp":
            return MARKS.get(token.head.lower_, "with"), above.i
        if token.dep_ == "advcl":
            for mark in marks:
                if mark in MARKS:
                    return MARKS[mark], above.i
            return "while", above.i
        if token.dep_ == "amod":
            return "while", above.i
        if token.dep_ in ("acl", "relcl"):
            return ("while" if token.tag_ == "VBG" else "with"), above.i
        if token.dep_ in ("xcomp", "ccomp"):
            return "comp", above.i
        return "conj", above.i

    def _then_before(self, token: Token) -> bool:
        """True if "then" stands between a clause and the verb before it."""
        before = max((i for i in self._of if i < token.i), default=0)
        return any(self.doc[i].lower_ in _THEN for i in range(before, token.i))


def _other_person(ref: Ref) -> Ref | None:
    other = {"a": "b", "b": "a"}.get(ref.who)
    return Ref("person", other) if ref.kind == "person" and other else None
