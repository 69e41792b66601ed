"""Language: texts that are not in English, and words that are none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from . import wordnet
from .syntax import is_adverb, is_word
from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc


def unknown(doc: Doc, is_verb: Callable[[str], bool]) -> Iterator[tuple[int, int]]:
    """Stretches of small letters that are no English words, as character offsets in what was parsed."""
    first = last = -1
    for token in doc:
        small = token.text.islower() and token.text.isalpha() and len(token.text) > 3
        if small and not is_word(token.text) and not is_verb(token.text) and not _is_known(token.text):
            first, last = (token.idx if first < 0 else first), token.idx + len(token.text)
        elif first >= 0:
            yield first, last
            first = -1
    if first >= 0:
        yield first, last


def _is_known(word: str) -> bool:
    """True for a noun or an adverb that the parser has not met: of a person, a plural, two words in one, "tiredly"."""
    stem, words = word.removesuffix("s"), vocabulary()
    if is_adverb(word) or is_word(stem) or _names_something(stem) or word in words.directions or word.endswith("wards"):
        return True
    return any(_names_something(stem[:i]) and _names_something(stem[i:]) for i in range(3, len(stem) - 2))


def _names_something(noun: str) -> bool:
    words = vocabulary()
    known = words.is_person(noun) or noun in words.places or words.part(noun) != ""
    return known or wordnet.is_animal(noun) or wordnet.is_act(noun) or wordnet.is_verb(noun)


def other_language(text: str) -> str | None:
    """A sentence for a text that is not in English; None for one that is."""
    letters = [c for c in text if c.isalpha()]
    if not letters:
        return "There are no words in this text: write in English what the two people do."
    if sum(ord(c) < 0x250 for c in letters) < 0.6 * len(letters):
        return "This is not in the Latin alphabet: write in English, or let a director's model read other languages."
    words = [word for word in "".join(c if c.isalpha() or c == "'" else " " for c in text).split() if len(word) > 1]
    if len(words) >= 4 and not any(word.lower() in _ENGLISH for word in words):
        unknown = sum(not is_word(word.lower()) for word in words)
        if unknown >= 0.4 * len(words):
            return "This does not seem to be English: write in English, or let a director's model read other languages."
    return None


_ENGLISH = frozenset(
    [
        "the",
        "a",
        "an",
        "and",
        "to",
        "of",
        "he",
        "she",
        "they",
        "his",
        "her",
        "him",
        "on",
        "in",
        "with",
        "one",
        "each",
        "other",
        "then",
        "while",
        "person",
        "two",
    ]
)
