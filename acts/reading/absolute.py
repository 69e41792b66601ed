"""Phrases that say how a part of the body is held beside an act: "with arms crossed", "hands up", "a hand on his back".

They have no verb with a tense, and the parser hangs them on whatever is near, so they are found by how they stand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from acts.frames import PREPOSITIONS

from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_WITHIN = frozenset(("DET", "PRON", "NUM", "ADJ"))
_PARTICIPLES = {"outstretched": "extend", "outspread": "spread", "upraised": "raise", "uplifted": "raise"}
"""Participles that are no verbs, and the verb of what they show."""
_BEFORE = frozenset((",", ";", ":", "-", "", "and"))
_OWNERS = frozenset(["his", "her", "their", "its", "my", "your", "each", "both", "one", "the", "left", "right"])
_PLACES = frozenset(("on", "behind", "above", "around", "over", "against"))
_STATES = frozenset(("straight", "upright", "together", "parallel", "loose", "relaxed", "soft", "tense"))
"""Adjectives of how a part is held that are no directions."""
_LONGEST = 4
"""Words before the part of the body, at most."""


@dataclass(frozen=True)
class Absolute:
    """One such phrase.

    Attributes:
        preposition: the word "with".
        part: the noun.
        verb: the lemma of what is done with the part, "" for the lemma of ``state``.
        state: the participle, adverb or preposition that says how it is held.
    """

    preposition: Token
    part: Token
    verb: str
    state: Token


def absolutes(doc: Doc) -> Iterator[Absolute]:
    """The phrases of a text, in its order."""
    for token in doc:
        if token.lower_ == "with" and (found := _behind(token)) is not None:
            yield found


def _behind(preposition: Token) -> Absolute | None:
    words, doc = vocabulary(), preposition.doc
    at = preposition.i + 1
    before: Token | None = None
    while at < len(doc) and not words.part(doc[at].lemma_.lower()):
        if at - preposition.i >= _LONGEST or not (doc[at].pos_ in _WITHIN or doc[at].tag_ == "VBN"):
            return None
        held = doc[at].tag_ == "VBN" and doc[at].lower_ not in words.directions
        before = doc[at] if held or doc[at].lower_ in _PARTICIPLES else before
        at += 1
    if at == len(doc):
        return None
    part = doc[at]
    straight = at + 1 < len(doc) and doc[at + 1].lower_ in _STATES
    if words.part(part.lemma_.lower()) == "back" and not straight:  # "with her back to him" is a way to stand
        return None
    if before is not None:
        return Absolute(preposition, part, _PARTICIPLES.get(before.lower_, ""), before)
    after = doc[at + 1] if at + 1 < len(doc) else None
    if after is None:
        return None
    if after.lower_ in _PARTICIPLES:
        return Absolute(preposition, part, _PARTICIPLES[after.lower_], after)
    if after.lower_ in _STATES:
        return Absolute(preposition, part, "hold", after)
    if after.tag_ in ("VBN", "VBD", "VBG"):
        return Absolute(preposition, part, "", after)
    direction = words.directions.get(after.lower_)
    ends = at + 2 == len(doc) or doc[at + 2].pos_ in ("PUNCT", "CCONJ", "SCONJ", "ADV", "ADP")
    if direction and ends:
        verb = {"up": "raise", "down": "lower"}.get(direction, "extend")
        return Absolute(preposition, part, verb, after)
    if after.lower_ == "in" and any(t.lower_ == "air" for t in doc[at + 2 : at + 4]):
        return Absolute(preposition, part, "raise", after)
    alone = after.lower_ == "behind" or _acts_alone(preposition)
    if after.lower_ in PREPOSITIONS - {"of", "to"} and alone and not ends:
        return Absolute(preposition, part, "put", after)
    return None


def _acts_alone(preposition: Token) -> bool:
    """True if the verb has no object: what touches somebody "with a hand on the back" touches the back."""
    verb = next((t for t in preposition.ancestors if t.pos_ in ("VERB", "AUX")), None)
    return verb is None or all(child.dep_ not in ("dobj", "nsubjpass") for child in verb.children)


def stands_absolutely(lower: Callable[[int], str], has_verb: Callable[[int], bool], i: int) -> bool:
    """True if the words from ``i`` on are such a phrase without its "with": "…, hands up, …", "…, her head down".

    Args:
        lower: gives the words of a text by their number, in small letters; "" beyond its ends.
        has_verb: tells whether a verb stands between a word and the next mark.
        i: the first word.
    """
    words = vocabulary()
    if lower(i - 1) not in _BEFORE:  # "cuffs the thief hands behind his back"
        behind = lower(i + 3) if lower(i + 2) in _OWNERS else lower(i + 2)
        own = words.part(lower(i).removesuffix("s")) and words.part(behind) and lower(i + 1) in _PLACES
        return bool(own) and words.is_person(lower(i - 1)) and lower(i).endswith("s")
    at = i
    while lower(at) in _OWNERS and at < i + 3:
        at += 1
    part = lower(at).removesuffix("s") if not words.part(lower(at)) else lower(at)
    part = {"feet": "foot", "knee": "knee"}.get(part, part)
    if not words.part(part) or (lower(i - 1) in ("", "and") and at > i and lower(i) == "the"):
        return False
    after, behind = lower(at + 1), lower(at + 2)
    if lower(i - 1) == "and" and at == i:
        return False
    held = after in _PARTICIPLES or after in words.verbs["held"]
    ends = not behind.isalpha() or behind in ("and", "while", "as", "then")
    placed = after in PREPOSITIONS - {"of", "to", "with"} and behind.isalpha() and after not in words.directions
    if placed and at == i and lower(i).endswith("s"):  # "hands over a parcel" is an act
        placed = any(words.part(lower(k).removesuffix("s")) for k in range(at + 2, at + 5))
    return held or ((after in words.directions or after in _STATES) and ends) or (placed and not has_verb(at + 1))
