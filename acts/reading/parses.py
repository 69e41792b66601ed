"""Parses of a text: with its full stop, as it was written, and with verbs where the parser may have missed them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .repair import others
from .run_on import breaks
from .spelling import Speller
from .syntax import parse
from .text import Text

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


def parses(written: Text, speller: Speller) -> Iterator[Parse]:
    """The parses of a text, the likeliest first."""
    whole = written.ended()
    left = max(min(_MOST, _MOST_CHARACTERS // max(len(written.original), 1)) - 1, 0)
    first, *others = _stopped(whole or written, speller)
    yield first
    yield from others[:left]
    if whole is not None and left > 0:
        yield _stopped(written, speller)[0]
        left -= 1
    for at, change in list(speller.suspects(first.doc).items())[:left]:
        base = not change[0].endswith(("s", "ed"))  # is a noun more often
        other = first.changed({at: change}, 1.0 if base else 0.5)
        if all(other.doc[i].pos_ == "VERB" for i in other.lemmas):
            yield other


def _stopped(text: Text, speller: Speller) -> list[Parse]:
    """The parses of a text with the stops that it lacks; one if there is no doubt where they stand."""
    found = _with_verbs(text, speller)
    missing = [
        frozenset(found.text.number(token.idx) for token in breaks(found.doc, found.lemmas, within))
        for within in (False, True)
    ]
    return [_with_verbs(text.broken(at), speller) if at else found for at in dict.fromkeys(missing)]


def _with_verbs(text: Text, speller: Speller) -> Parse:
    found = Parse(text, parse(text.parsed))
    changes = speller.verbs_found(found.doc)
    return found.changed(changes) if changes else found
