"""Words that are misspelt, and the forms of verbs."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from acts.frames import PREPOSITIONS
from acts.lexicon import Lexicon

from . import wordnet
from .repair import deeds_done, suspects, verbs_taken_for_nouns
from .syntax import is_word
from .vocabulary import is_act, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc


class Speller:
    """Knows the forms of the lexicon's verbs."""

    def __init__(self, known: Lexicon) -> None:
        verbs = vocabulary().verbs
        about = frozenset().union(*(verbs[kind] for kind in ("tried", "pretended", "begins", "ends")))
        self.forms = _forms(frozenset(known.frames) | about)
        self._deeds = deeds(known)

    def is_form(self, word: str) -> bool:
        """True for a form of a verb of the lexicon."""
        return word in self.forms

    def is_deed(self, noun: str) -> bool:
        """True for a noun, in the singular, that stands for what somebody does, as "lunge" and "high-five"."""
        return noun in self._deeds

    def knows(self, word: str) -> bool:
        """True for a form of a verb, of the lexicon or of WordNet, and for a noun of what somebody does."""
        return word in self.forms or is_verb_form(word) or self.is_deed(word.removesuffix("s"))

    def mended(self, word: str) -> str | None:
        """The verb's form that a word without meaning is nearest to, within one letter or two; None to leave it."""
        if is_word(word) or word in self.forms or len(word) < 4:
            return None
        if vocabulary().is_person(word.rstrip("s")) or is_verb_form(word):
            return None
        found = [form for form in self.forms if abs(len(form) - len(word)) < 2 and form[0] == word[0]]
        near = [
            (sorted(word) != sorted(form), form)  # swapped letters are likelier than wrong ones
            for form in found
            if _distance(word, form) <= 1
        ]
        return min(near)[1] if near else None

    def verbs_found(self, doc: Doc) -> dict[int, tuple[str, str]]:
        """Verbs that were taken for something else: offset → (a safe verb in the same form, the true lemma)."""
        return verbs_taken_for_nouns(doc, self.forms) | deeds_done(doc, self.is_deed)

    def suspects(self, doc: Doc) -> dict[int, tuple[str, str]]:
        """Forms of verbs that were taken for something else, rightly or not, in the same form."""
        return suspects(doc, self.forms)


@lru_cache(maxsize=4)
def deeds(known: Lexicon) -> frozenset[str]:
    """Nouns that stand for acts: those of verbs, and those of which entries say that somebody does them."""
    verbs = vocabulary().verbs
    said = (frame for verb in ("do", "perform", "throw") for _, frame in known.frames.get(verb, ()))
    nouns = {word for frame in said for element in frame.elements for word in element.words}
    of_verbs = {verb for verb in known.frames if is_act(verb)}
    return frozenset((nouns | of_verbs) - PREPOSITIONS - verbs["no_deeds"])


@lru_cache(maxsize=4)
def _forms(verbs: frozenset[str]) -> dict[str, tuple[str, str]]:
    """The forms of verbs, as form → (lemma, ending)."""
    found: dict[str, tuple[str, str]] = {}
    for verb in verbs:
        stem = verb[:-1] if verb.endswith("e") else verb
        double = stem + stem[-1] if len(verb) < 5 and verb[-1] not in "aeiouwxy" and verb[-2:-1] in "aeiou" else stem
        third = verb + "es" if verb.endswith(("s", "sh", "ch", "x", "z", "o")) else verb + "s"
        if verb.endswith("y") and verb[-2:-1] not in "aeiou":
            third, double = verb[:-1] + "ies", verb
        for form, ending in ((verb, ""), (third, "s"), (double + "ing", "ing"), (double + "ed", "ed")):
            found.setdefault(form, (verb, ending))
    return found


def is_verb_form(word: str) -> bool:
    """True for a regular form of a verb that WordNet knows, as "clings"."""
    stems = {word}
    for ending in ("s", "es", "ed", "ing"):
        if word.endswith(ending):
            stem = word[: -len(ending)]
            stems |= {stem, f"{stem}e"}
            if ending in ("ed", "ing") and stem[-2:-1] == stem[-1:]:
                stems.add(stem[:-1])
    return any(wordnet.is_verb(stem) for stem in stems)


def _distance(one: str, other: str) -> int:
    """Edits, of which a swap of neighbours is one, between two words; 2 for two or more."""
    if one == other:
        return 0
    if len(one) == len(other):
        differ = [i for i, (x, y) in enumerate(zip(one, other, strict=True)) if x != y]
        if len(differ) == 1:
            return 1
        swapped = len(differ) == 2 and differ[1] == differ[0] + 1
        return 1 if swapped and one[differ[0]] == other[differ[1]] and one[differ[1]] == other[differ[0]] else 2
    short, long = sorted((one, other), key=len)
    return 1 if any(long[:i] + long[i + 1 :] == short for i in range(len(long))) else 2
