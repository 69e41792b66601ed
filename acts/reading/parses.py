"""Parses of a text: with its full stop, as it was written, and with verbs where the parser may have missed them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from . import wordnet
from .people import is_somebody
from .spelling import Speller, deeds_done, others, verbs_taken_for_nouns
from .syntax import has, parse
from .vocabulary import vocabulary
from .wording import Text, prepared

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_MOST = 8
"""Parses of one text, at most."""
_MOST_CHARACTERS = 900
"""Characters of all of them together, which keeps a long text fast."""


@dataclass(frozen=True)
class Parse:
    """One parse.

    Attributes:
        text: what was parsed.
        doc: its syntax.
        lemmas: true lemmas, by token, of verbs that others stand for.
        cost: how unlikely it is beside the parser's own, in words that it must explain more.
    """

    text: Text
    doc: Doc
    lemmas: Mapping[int, str] = field(default_factory=dict)
    cost: float = 0.0

    def changed(self, changes: Mapping[int, tuple[str, str]], cost: float = 0.0) -> Parse:
        """The parse with safe verbs in the place of others; the new words may be longer, but are as many.

        A verb within a word, as "counter" in "counter-clockwise", stays.
        """
        whole = [t for t in self.doc if t.idx in changes and self.text.word(t.idx) == t.text]
        safe = {token.idx: changes[token.idx][0] for token in whole}
        lemmas = {token.i: changes[token.idx][1] for token in whole}
        text = self.text.replaced(safe)
        doc = parse(text.parsed)
        if missed := [self.doc[i].idx for i in lemmas if not _is_verb(doc[i])]:
            for instead in zip(*(others(safe[at]) for at in missed), strict=False):
                other = self.text.replaced(safe | dict(zip(missed, instead, strict=True)))
                again = parse(other.parsed)
                if all(_is_verb(again[i]) for i in lemmas):
                    text, doc = other, again
                    break
        return Parse(text, doc, {**self.lemmas, **lemmas}, cost)


def _is_verb(token: Token) -> bool:
    return token.pos_ == "VERB" and token.dep_ != "aux"


def parses(text: str, speller: Speller) -> Iterator[Parse]:
    """The parses of a text as it was written, the likeliest first."""
    written = prepared(text, speller)
    whole = written.ended()
    left = max(min(_MOST, _MOST_CHARACTERS // max(len(text), 1)) - 1, 0)
    first = _stopped(whole or written, speller)
    yield first
    if whole is not None and left > 0:
        yield _stopped(written, speller)
        left -= 1
    for at, change in list(speller.suspects(first.doc).items())[:left]:
        base = not change[0].endswith(("s", "ed"))  # is a noun more often
        other = first.changed({at: change}, 1.0 if base else 0.5)
        if all(other.doc[i].pos_ == "VERB" for i in other.lemmas):
            yield other


def _stopped(text: Text, speller: Speller) -> Parse:
    """The parse of a text with the stops that it lacks."""
    parsed = _with_verbs(text, speller)
    missing = frozenset(parsed.text.number(token.idx) for token in breaks(parsed.doc, parsed.lemmas))
    return _with_verbs(text.broken(missing), speller) if missing else parsed


def _with_verbs(text: Text, speller: Speller) -> Parse:
    doc, forms = parse(text.parsed), speller.forms
    lemmas = {t.i: forms[t.lower_][0] for t in doc if t.pos_ == "VERB" and t.lower_ in forms and t.lemma_ not in forms}
    parsed = Parse(text, doc, lemmas)  # "rides" is of "ride", and not of "rid"
    changes = verbs_taken_for_nouns(doc, forms) | deeds_done(doc, speller.is_deed)
    return parsed.changed(changes) if changes else parsed


# ---- missing stops -------------------------------------------------------------------------------------
_FINITE = frozenset(("VBZ", "VBD", "VBP"))
_BELOW = frozenset(("ccomp", "acl", "csubj", "pcomp"))
"""Relations of clauses that follow a noun or a verb without a word between."""
_LINKS = frozenset(("SCONJ", "CCONJ", "PUNCT", "PART", "AUX"))
_SENSES = 3
"""Senses of a verb that are looked at: one that bodies show takes no clause."""


def breaks(doc: Doc, lemmas: Mapping[int, str]) -> Iterator[Token]:
    """The words before which a stop is missing, each the first of the next clause's subject.

    Args:
        doc: a parsed text.
        lemmas: true lemmas, by token, of verbs that others stand for.
    """
    before: Token | None = None
    below = False
    for token in doc:
        if before is not None and token.lower_ == "and" and _joins_person(token):
            yield token
        if token.is_sent_start or token.pos_ in ("PUNCT", "CCONJ"):
            before, below = None, False
        elif token.pos_ == "SCONJ" or token.tag_ in ("WRB", "WP", "WDT") or token.dep_ == "mark":
            below = True
        elif (token.tag_ in _FINITE and token.pos_ == "VERB") or has(token, "nsubj"):
            if (
                token.tag_ in _FINITE
                and before is not None
                and not below
                and (noun := _subject_behind(token, before, lemmas)) is not None
            ):
                yield noun.left_edge
            before = token


def _joins_person(conjunction: Token) -> bool:
    """True where a thing is joined to a person who acts: "A holds the ladder and B climbs it"."""
    thing, doc = conjunction.head, conjunction.doc
    if thing.pos_ != "NOUN" or thing.i > conjunction.i or is_somebody(thing.lemma_.lower()):
        return False
    person = next((c for c in thing.children if c.dep_ == "conj" and c.i > conjunction.i), None)
    if person is None or not is_somebody(person.lemma_.lower()):
        return False
    behind = doc[person.right_edge.i + 1] if person.right_edge.i + 1 < len(doc) else person
    return (behind.tag_ in _FINITE and behind.pos_ == "VERB") or any(
        t.tag_ in _FINITE and t.dep_ != "relcl" for t in doc[person.i + 1 : person.right_edge.i + 1]
    )


def _subject_behind(verb: Token, before: Token, lemmas: Mapping[int, str]) -> Token | None:
    """A verb's subject, where it directly follows the clause of the verb ``before``."""
    subject = next((c for c in verb.children if c.dep_ == "nsubj" and c.i < verb.i), None)
    if subject is None:
        return _taken_along(verb, before)
    first = subject.left_edge
    if first.i <= before.i:
        return None
    last = first.nbor(-1)
    begun = last.head == verb and last.lower_ not in vocabulary().directions  # "… then she waves"
    if begun or last.pos_ in _LINKS or subject.tag_ in ("WP", "WDT"):
        return None
    return None if _is_below(verb, before, lemmas) else subject


def _is_below(verb: Token, before: Token, lemmas: Mapping[int, str]) -> bool:
    """True for a clause that a verb or a noun takes without a word between: "sees she waves", "the ball he throws"."""
    if verb.dep_ == "ccomp" and verb.head == before:
        senses = wordnet.senses(lemmas.get(before.i, before.lemma_.lower()))[:_SENSES]
        return all(wordnet.kind(sense) not in wordnet.BODILY for sense in senses)
    if verb.dep_ == "relcl":  # of a noun, whose place in the clause is empty
        clauses = (verb, *(c for c in verb.children if c.dep_ == "conj"))
        return all(c.dep_ != "dobj" or c.pos_ != "PRON" for clause in clauses for c in clause.children)
    return verb.dep_ in _BELOW


def _taken_along(verb: Token, before: Token) -> Token | None:
    """The person right before a verb whom the parser took for an object of the verb ``before``."""
    at = verb.i - 1
    while at > before.i and verb.doc[at].pos_ == "ADV":
        at -= 1
    noun = verb.doc[at]
    if at <= before.i or verb.tag_ not in ("VBZ", before.tag_):
        return None
    if noun.dep_ not in ("dobj", "pobj", "conj", "appos", "attr", "dep", "npadvmod", "dative"):
        return None
    return noun if is_somebody(noun.lemma_.lower()) else None
