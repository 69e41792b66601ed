"""Words that are misspelt, and the forms of verbs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from string import ascii_lowercase
from typing import TYPE_CHECKING

from acts.captions import gerund, past, singular
from acts.frames import PREPOSITIONS
from acts.lexicon import Lexicon

from . import wordnet
from .repair import deeds_done, suspects, verbs_taken_for_nouns
from .syntax import is_adverb, is_word
from .vocabulary import closed, is_act, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc


class Speller:
    """Knows the forms of the lexicon's verbs."""

    def __init__(self, known: Lexicon) -> None:
        verbs = vocabulary().verbs
        about = frozenset().union(*(verbs[kind] for kind in ("tried", "pretended", "begins", "ends")))
        self.forms = _forms(frozenset(known.frames) | about)
        self._deeds = deeds(known)
        self._mendable = {*self.forms, *vocabulary().directions, "person", "something", "circle", "position"}

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
        """The verb's form, or the like, that a word without meaning is nearest to, by a letter; None to leave it."""
        if is_word(word) or word in self.forms or len(word) < 4:
            return None
        if vocabulary().is_person(word.rstrip("s")) or is_verb_form(word):
            return None
        near = (form for form in self._mendable & _edited(word) if form[0] == word[0])
        # swapped letters are likelier than wrong ones
        return min(near, key=lambda form: (sorted(word) != sorted(form), form), default=None)

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
        for form, ending in ((verb, ""), (singular(verb), "s"), (gerund(verb), "ing"), (past(verb), "ed")):
            found.setdefault(form, (verb, ending))
    for auxiliary in ("is", "has"):  # which are hardly ever verbs of their own
        found.pop(auxiliary, None)
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


def _edited(word: str) -> set[str]:
    """The words that a wrong, a missing, a further letter or two swapped ones make of one."""
    halves = [(word[:i], word[i:]) for i in range(len(word) + 1)]
    changed = {f"{a}{c}{b[n:]}" for a, b in halves for c in (*ascii_lowercase, "") for n in (0, 1)}
    return changed | {f"{a}{b[1]}{b[0]}{b[2:]}" for a, b in halves if len(b) > 1}


# ---- language ------------------------------------------------------------------------------------------
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
        return "This is not in the Latin alphabet: write in English."
    words = [word for word in "".join(c if c.isalpha() or c == "'" else " " for c in text).split() if len(word) > 1]
    if len(words) >= 4 and not any(word.lower() in closed("english") for word in words):
        unknown = sum(not is_word(word.lower()) for word in words)
        if unknown >= 0.4 * len(words):
            return "This does not seem to be English: write in English."
    return None
