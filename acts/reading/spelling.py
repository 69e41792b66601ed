"""Words that are misspelt, and verbs that the parser took for nouns."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from acts.lexicon import Lexicon

from .people import A_NAME, B_NAME
from .syntax import is_word
from .vocabulary import vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_SAFE = {
    "s": ("admires", "arrives"),
    "ing": ("admiring", "arriving"),
    "ed": ("admired", "arrived"),
    "": ("admire", "arrive"),
}
"""Forms of a verb with and of one without an object that the parser takes for nothing else."""


class Speller:
    """Knows the forms of the lexicon's verbs."""

    def __init__(self, known: Lexicon) -> None:
        self.forms = _forms(frozenset(known.frames))

    def is_form(self, word: str) -> bool:
        """True for a form of a verb of the lexicon."""
        return word in self.forms

    def mended(self, word: str) -> str | None:
        """The verb's form that a word without meaning is nearest to, within one letter or two; None to leave it."""
        if is_word(word) or word in self.forms or len(word) < 4:
            return None
        if vocabulary().is_person(word.rstrip("s")):
            return None
        found = [form for form in self.forms if abs(len(form) - len(word)) < 2 and form[0] == word[0]]
        near = [(distance, form) for form in found if (distance := _distance(word, form)) <= 1]
        return min(near)[1] if near else None

    def verbs_found(self, doc: Doc) -> dict[int, tuple[str, str]]:
        """Verbs that were taken for something else: offset → (a safe verb in the same form, the true lemma)."""
        return {
            token.idx: (_SAFE[form[1]][not self._has_object(token)], form[0])
            for token in doc
            if (token.pos_ in ("NOUN", "PROPN", "ADJ", "X", "INTJ") or self._swallowed(token))
            and (form := self.forms.get(token.lower_)) is not None
            and self._after_person(token, form[1])
        }

    @staticmethod
    def _swallowed(token: Token) -> bool:
        """True for a verb whose subject became a part of it, as in a compound."""
        children = list(token.children)
        return any(
            child.i == token.i - 1 and child.dep_ in ("compound", "nmod", "amod") for child in children
        ) and all(child.dep_ not in ("nsubj", "nsubjpass") for child in children)

    @staticmethod
    def _has_object(token: Token) -> bool:
        following = token.nbor(1) if token.i + 1 < len(token.doc) else None
        return following is not None and following.pos_ in ("DET", "PRON", "PROPN", "NOUN", "ADJ", "NUM")

    @staticmethod
    def _after_person(token: Token, ending: str) -> bool:
        """True if a noun that might be a verb follows its subject."""
        before = token.nbor(-1) if token.i else None
        if (
            before is None
            or ending == "ing"
            or (token.i + 1 < len(token.doc) and token.nbor(1).pos_ == "AUX")
        ):
            return False
        one = before.lower_ in ("one", "other", "both") or before.text in (A_NAME, B_NAME)
        if before.pos_ == "PRON" and not one:
            return before.lower_ in (
                "i",
                "you",
                "he",
                "she",
                "they",
                "we",
                "who",
                "someone",
                "somebody",
                "nobody",
                "everyone",
            )
        many = before.tag_ in ("NNS", "NNPS") or before.lower_ in ("both", "people")
        if ending != "s" and not many and not one:
            return False
        if ending == "s" and many:
            return False
        return (
            one
            or vocabulary().is_person(before.lemma_.lower())
            or (many and before.lemma_ in vocabulary().both)
        )


@lru_cache(maxsize=4)
def _forms(verbs: frozenset[str]) -> dict[str, tuple[str, str]]:
    """The forms of verbs, as form → (lemma, ending)."""
    found: dict[str, tuple[str, str]] = {}
    for verb in verbs:
        stem = verb[:-1] if verb.endswith("e") else verb
        double = (
            stem + stem[-1]
            if len(verb) < 5 and verb[-1] not in "aeiouwxy" and verb[-2:-1] in "aeiou"
            else stem
        )
        third = verb + "es" if verb.endswith(("s", "sh", "ch", "x", "z", "o")) else verb + "s"
        if verb.endswith("y") and verb[-2:-1] not in "aeiou":
            third, double = verb[:-1] + "ies", verb
        for form, ending in ((verb, ""), (third, "s"), (double + "ing", "ing"), (double + "ed", "ed")):
            found.setdefault(form, (verb, ending))
    return found


def _distance(one: str, other: str) -> int:
    """Edits, of which a swap of neighbours is one, between two words; 2 for two or more."""
    if one == other:
        return 0
    if len(one) == len(other):
        differ = [i for i, (x, y) in enumerate(zip(one, other, strict=True)) if x != y]
        if len(differ) == 1:
            return 1
        swapped = len(differ) == 2 and differ[1] == differ[0] + 1
        return (
            1 if swapped and one[differ[0]] == other[differ[1]] and one[differ[1]] == other[differ[0]] else 2
        )
    short, long = sorted((one, other), key=len)
    return 1 if any(long[:i] + long[i + 1 :] == short for i in range(len(long))) else 2
