"""Clauses in the syntax: how they lie beside each other, which are main ones, and the characters that they take."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from typing import TYPE_CHECKING

from acts.events import Event

from .syntax import is_adverb, is_kept, is_noun_or_side
from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

MARKS = {
    "while": "while",
    "as": "while",
    "whereas": "while",
    "whilst": "while",
    "by": "while",
    "with": "while",
    "when": "main-after",
    "after": "main-after",
    "once": "main-after",
    "upon": "main-after",
    "until": "main-until",
    "till": "main-until",
    "before": "after",
    "because": "with",
    "so": "after",
    "without": "while",
    "instead": "with",
}
"""How a clause with this word lies beside its main clause; "main-after" puts the main clause behind it."""

NOUNMARKS = {"after": "main-after", "following": "main-after", "upon": "main-after", "before": "after"}
"""Prepositions behind which a noun stands for an act of its own."""


def is_finite(token: Token) -> bool:
    """True for a verb with a tense, which has a subject of its own."""
    return token.tag_ not in ("VBG", "VBN") and token.dep_ not in ("xcomp", "pcomp")


def may_be_main(token: Token) -> bool:
    """True for a clause that is a main one if the one above it is."""
    if token.dep_ == "ccomp":  # of two clauses with nothing but a comma between them, the first
        return token.i < token.head.i and any(c.dep_ in ("nsubj", "nsubjpass") for c in token.children)
    if token.dep_ == "advcl":
        marks = any(c.dep_ in ("mark", "aux") or c.lower_ in MARKS for c in token.children)
        return not marks and token.tag_ in ("VB", "VBP", "VBZ")
    return token.dep_ in ("conj", "parataxis")


class ClauseTree:
    """The clauses of a parsed text: which tokens are verbs of one, on which verb each hangs, which are main ones.

    Args:
        doc: the parsed text.
        verbs: lemmas that some entry reads.
        lemmas: lemmas known better than by the parser, by token.
        forms: (lemma, tag) of a verb's form, where the parser knows no such verb.
        held: words, by token, that only say how a part of the body is held.
    """

    def __init__(
        self,
        doc: Doc,
        verbs: frozenset[str],
        lemmas: Mapping[int, str],
        forms: Mapping[str, tuple[str, str]],
        held: Set[int] = frozenset(),
    ) -> None:
        self.doc = doc
        self.mains: list[int] = []
        """The verbs of main clauses read so far, by token."""
        self._verbs = verbs
        self._lemmas = lemmas
        self._forms = forms
        self._held = held
        self._words = vocabulary()
        self._main: dict[int, bool] = {}
        self._heads: dict[int, Token | None] = {}
        self._clauses: dict[int, bool] = {}

    def main_before(self, token: Token) -> int | None:
        """The last main clause's verb in the sentence of ``token``."""
        sentence = token.sent
        return next((i for i in reversed(self.mains) if sentence.start <= i < sentence.end), None)

    def lemma(self, token: Token) -> str:
        """The lemma of a verb, with what is known better than by the parser."""
        known = self._lemmas.get(token.i)
        if known is None and token.lemma_.lower() not in self._verbs and token.lower_ in self._forms:
            known = self._forms[token.lower_][0]  # "stares" is no "star"
        return known or token.lemma_.lower()

    def is_clause(self, token: Token) -> bool:
        """True for the verb of a clause, and for a noun that stands for an act."""
        if token.i not in self._clauses:
            self._clauses[token.i] = self._has_verb(token)
        return self._clauses[token.i]

    def _has_verb(self, token: Token) -> bool:
        if token.i in self._held or is_adverb(token.lower_) or is_noun_or_side(token):
            return False
        if token.dep_ == "amod" and token.tag_ not in ("VBP", "VBZ"):  # "the sleeping baby"
            return (
                token.tag_ == "VBG"
                and self.lemma(token) in self._verbs
                and self._words.is_person(token.head.lemma_.lower())
            )
        event = token.dep_ == "relcl" and token.head.lemma_.lower() not in self._words.places
        beneath = token.subtree if token.dep_ == "pcomp" else token.children
        if token.dep_ != "ROOT" and not event and any(c.lower_ == "where" for c in beneath):
            return False  # "to where she came from" is a place, and "a tango where he dips her" none
        if is_kept(token):
            return False
        if token.dep_ == "acomp" and token.head.lemma_ in ("remain", "stay") and token.tag_ == "VBN":
            return False  # "who remains seated"
        if token.pos_ in ("VERB", "AUX") and token.dep_ not in ("aux", "auxpass", "compound", "punct"):
            return True
        if token.dep_ == "pobj" and token.pos_ == "NOUN" and token.head.lower_ in NOUNMARKS:
            known = self.lemma(token) in self._verbs and token.tag_ == "NN"  # "after a quick hug"
            known = known and not self._words.part(token.lemma_.lower())
            return known and token.head.head.pos_ in ("VERB", "AUX") and not self._words.is_person(token.lemma_.lower())
        if token.dep_ == "ROOT" and token.pos_ in ("NOUN", "PROPN", "ADJ", "INTJ", "ADV", "ADP", "X"):
            return self.lemma(token) in self._verbs or token.i in self._lemmas
        return token.dep_ in ("conj", "pcomp", "advcl", "dep") and token.i in self._lemmas

    def head(self, token: Token) -> Token | None:
        """The verb on which a clause hangs; a finite one goes with a finite one: "does not want to …, and pushes"."""
        if token.i not in self._heads:
            clauses = (head for head in token.ancestors if self.is_clause(head))
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
        later = [self.doc[i] for i in self.mains if head.i < i < token.i and self.doc[i].sent == token.sent]
        return next((t for t in reversed(later) if any(c.dep_ == "nsubj" for c in t.children)), head)

    def is_main(self, token: Token) -> bool:
        """True for a clause that stands by itself in the order of the text."""
        passed: list[int] = []
        above: Token | None = token
        while above is not None and above.i not in self._main and above.dep_ != "ROOT" and may_be_main(above):
            passed.append(above.i)
            above = self.head(above) if above.dep_ in ("conj", "parataxis") else above.head
        main = above is not None and self._main.get(above.i, above.dep_ == "ROOT")
        self._main.update((i, main) for i in passed)
        return main


def spans(doc: Doc, events: Sequence[Event]) -> Iterator[tuple[int, int]]:
    """The characters of each event's clause: its verb and what hangs on it, without other events' clauses."""
    heads = {event.first: event for event in events}
    at = {token.idx: token for token in doc}
    for event in events:
        token = at[event.first]
        own = [token]
        waiting = [token]
        while waiting:
            for child in waiting.pop().children:
                if (child.idx in heads and heads[child.idx] is not event) or child.dep_ in ("punct", "cc", "mark"):
                    continue
                own.append(child)
                waiting.append(child)
        yield min(t.idx for t in own), max(t.idx + len(t.text) for t in own)


def tells_on(clause: Token) -> bool:
    """True for a relative clause that goes on with what is told: "kicks the ball to B, who stops it"."""
    noun = clause.head
    back = any(c.dep_ == "dobj" and c.lower_ in ("him", "her", "them") for c in clause.children)
    return back or any(t.text == "," for t in clause.doc[noun.i : clause.i])
