"""Clauses in the syntax: how they lie beside each other, which are main ones, and the characters that they take."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from acts.frames import Event

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

MARKS = {
    "while": "while", "as": "while", "whereas": "while", "whilst": "while", "by": "while", "with": "while",
    "when": "main-after", "after": "main-after", "once": "main-after", "upon": "main-after", "until": "main-until",
    "till": "main-until", "before": "after", "because": "with", "so": "after", "without": "while", "instead": "with",
}  # fmt: skip
"""How a clause with this word lies beside its main clause; "main-after" puts the main clause behind it."""


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


def spans(doc: Doc, events: Sequence[Event]) -> Iterator[tuple[int, int]]:
    """The characters of each event's clause: its verb and what hangs on it, without other events' clauses."""
    heads = {event.first: event for event in events}
    for event in events:
        token = next(t for t in doc if t.idx == event.first)
        own = [token]
        waiting = [token]
        while waiting:
            for child in waiting.pop().children:
                if (child.idx in heads and heads[child.idx] is not event) or child.dep_ in (
                    "punct",
                    "cc",
                    "mark",
                ):
                    continue
                own.append(child)
                waiting.append(child)
        yield min(t.idx for t in own), max(t.idx + len(t.text) for t in own)
