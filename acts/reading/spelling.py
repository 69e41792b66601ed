"""Words that are misspelt, the forms of verbs, and verbs that the parser took for nouns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from string import ascii_lowercase
from typing import TYPE_CHECKING

from acts.captions import gerund, past, singular
from acts.frames import PREPOSITIONS
from acts.lexicon import Lexicon

from . import wordnet
from .people import A_NAME, B_NAME
from .syntax import is_adverb, is_noun_or_side, is_word
from .vocabulary import closed, is_act, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token


class Speller:
    """Knows the forms of the lexicon's verbs."""

    def __init__(self, known: Lexicon) -> None:
        verbs = vocabulary().verbs
        about = frozenset().union(*(verbs[kind] for kind in ("tried", "pretended", "begins", "ends")))
        self.forms = _forms(frozenset(known.frames) | about)
        self._deeds = deeds(known)
        self._mendable = {*self.forms, *vocabulary().directions, "person", "something", "circle", "position"}

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

    def suspects(self, doc: Doc) -> dict[int, tuple[str, str]]:
        """Forms of verbs that were taken for something else, rightly or not: offset → (a safe verb, its lemma)."""
        part, forms = vocabulary().part, self.forms
        return {
            token.idx: (_safe(token, forms[token.lower_][1]), forms[token.lower_][0])
            for token in doc
            if token.lower_ in forms
            and token.lower_ not in vocabulary().directions
            and not is_noun_or_side(token)
            and not (token.dep_ == "conj" and part(token.lemma_.lower()) and part(token.head.lemma_.lower()))
            and forms[token.lower_][1] in ("", "s", "ed")
            and (token.pos_ not in ("VERB", "AUX", "ADP", "ADV") or token.dep_ in ("compound", "amod", "nmod"))
        }


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
    forms: dict[str, tuple[str, str]] = {}
    for verb in verbs:
        for form, ending in ((verb, ""), (singular(verb), "s"), (gerund(verb), "ing"), (past(verb), "ed")):
            forms.setdefault(form, (verb, ending))
    for auxiliary in ("is", "has"):  # which are hardly ever verbs of their own
        forms.pop(auxiliary, None)
    return forms


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
    named = word in words.directions or stem in words.metres or word.endswith("wards")
    if named or is_adverb(word) or is_word(stem) or _names_something(stem):
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
    words = [word for word in re.findall(r"[^\W\d_']+(?:'[^\W\d_]+)*", text.lower()) if len(word) > 1]
    unknown = sum(not is_word(word) for word in words)
    share = 0.01 if not closed("elsewhere").isdisjoint(words) else 0.4 if len(words) >= 4 else 2.0
    if closed("english").isdisjoint(words) and unknown >= share * len(words) > 0:
        return "This does not seem to be English: write in English."
    return None


# ---- verbs that the parser took for nouns, found by where they stand ----------------------------------
_JOINS = frozenset(("and", "then", "but", ",", ";", "or"))
_TAKEN_FOR = frozenset(("NOUN", "PROPN", "ADJ", "INTJ", "X"))
"""Parts of speech for which the parser takes a verb of a list."""
_TAGS = {"VBZ": "s", "VBD": "ed", "VBP": "", "VB": ""}
"""Endings of finite verbs by their tags."""


def others(safe: str) -> tuple[str, ...]:
    """The other safe verbs in the same form, for where the parser takes one for something else after all."""
    forms: list[str] = next((verbs[:-1] for verbs in vocabulary().safe.values() if safe in verbs[:-1]), [])
    return tuple(word for word in forms if word != safe)


def verbs_taken_for_nouns(doc: Doc, forms: Mapping[str, tuple[str, str]]) -> dict[int, tuple[str, str]]:
    """Verbs that were taken for something else: offset → (a safe verb in the same form, the true lemma).

    Args:
        doc: the text as it was parsed.
        forms: the forms of verbs, as form → (lemma, ending).
    """
    mistaken: dict[int, tuple[str, str]] = {}
    last = ""  # the ending of the last finite verb of the sentence
    for token in doc:
        last = "" if token.is_sent_start else last
        form = None if is_noun_or_side(token) else forms.get(token.lower_)
        if form is not None and (
            (_is_other(token) and (_after_person(token, form[1]) or _opens(token, form[1])))
            or _coordinated(token, form[1], last)
            or _is_ordered(token, form[1])
        ):
            mistaken[token.idx] = (_safe(token, form[1]), form[0])
            last = form[1]
        elif token.pos_ in ("VERB", "AUX") and token.tag_ in _TAGS:
            last = _TAGS[token.tag_]
    return mistaken


def deeds_done(doc: Doc, is_deed: Callable[[str], bool]) -> dict[int, tuple[str, str]]:
    """Verbs "do" with a deed as their object that the parser took for a part of a verb: "does slow arm circles".

    Args:
        doc: the text as it was parsed.
        is_deed: tells whether a noun, in the singular, stands for what somebody does.
    """
    do = vocabulary().do
    return {
        t.idx: (do[t.lower_], "do")
        for t in doc
        if t.lower_ in do
        and t.dep_ == "aux"
        and (
            (t.head.pos_ == "NOUN" and is_deed(t.head.lemma_.lower()))  # "does ten jumping jacks while …"
            or any(is_deed(c.lemma_.lower()) and t.i + 2 == c.left_edge.i == t.head.i + 1 for c in t.head.children)
        )
    }


def _is_ordered(token: Token, ending: str) -> bool:
    """True for "swing" in ", swing arms, …", a part of the noun to the parser, and "wave" in "Wave, bow and leave"."""
    begins = token.is_sent_start or token.nbor(-1).text in (",", ";")
    if ending == "" and token.is_sent_start and token.dep_ == "dep" and token.i + 1 < len(token.doc):
        return token.nbor().text == "," and token.head.tag_ == "VB" and not vocabulary().is_person(token.lower_)
    if ending != "" or not begins or token.dep_ != "compound":
        return False
    parts = token.head.tag_ == "NNS" and bool(vocabulary().part(token.head.lemma_.lower()))
    return parts or token.tag_ in ("VB", "VBP")


def _is_other(token: Token) -> bool:
    return token.pos_ in ("NOUN", "PROPN", "ADJ", "ADP", "X", "INTJ") or _swallowed(token)


def _swallowed(token: Token) -> bool:
    """True for a verb whose subject became a part of it, as in a compound."""
    children = list(token.children)
    return any(child.i == token.i - 1 and child.dep_ in ("compound", "nmod", "amod") for child in children) and all(
        child.dep_ not in ("nsubj", "nsubjpass") for child in children
    )


def _next(token: Token) -> Token | None:
    return token.nbor(1) if token.i + 1 < len(token.doc) else None


def _safe(token: Token, ending: str) -> str:
    following = _next(token)
    if following is not None and following.tag_ == "VBG":
        return vocabulary().safe[ending][-1]
    has_object = (
        following is not None
        and following.pos_ in ("DET", "PRON", "PROPN", "NOUN", "ADJ", "NUM")
        and following.lower_ not in PREPOSITIONS
    )
    return vocabulary().safe[ending][not has_object]


def _ends_phrase(token: Token) -> bool:
    """True if what follows cannot be the head of a noun phrase that this word belongs to."""
    following = _next(token)
    return (
        following is None
        or following.pos_ in ("PUNCT", "ADP", "ADV", "PRON", "DET", "SCONJ", "CCONJ", "PART", "NUM")
        or following.tag_ in ("VBG", "PRP$")
        or following.text in (A_NAME, B_NAME)
    )


def _coordinated(token: Token, ending: str, last: str) -> bool:
    """True for a bare noun behind "and" or a comma that has the form of the sentence's last finite verb.

    "He yawns and stretches", "they clink glasses and drink" and "grab her and twirl her".
    """
    if token.pos_ not in _TAKEN_FOR or ending != last or not token.i or not _ends_phrase(token):
        return False
    if vocabulary().part(token.lemma_.lower()) and _is_absolute(token):
        return False
    before = token.nbor(-1)
    if before.lower_ not in _JOINS or token.i < 2:
        return False
    earlier = token.nbor(-2)
    if vocabulary().part(token.lemma_.lower()) and vocabulary().part(earlier.lemma_.lower()):
        return False  # "on hands and knees"
    if token.pos_ == "ADJ" and earlier.pos_ in ("ADJ", "ADV") and earlier.lower_ != "other":
        return False  # "slow and smooth"
    listed = (token.dep_ == "conj" and token.head.pos_ == "VERB") or _before_verb(token)
    listed = listed or (earlier.pos_ == "VERB" and earlier.tag_ in _TAGS)  # "they meet, hug and part"
    if before.text == "," and ending == "" and not listed:
        return False
    following = _next(token)
    plural_list = earlier.tag_ == "NNS" and token.dep_ == "conj" and token.head == earlier
    return not plural_list or following is None or following.lower_ not in ("of", "for")


def _before_verb(token: Token) -> bool:
    """True for the last but one of listed verbs: "run up, hug and then bow", "run up, hug, then bow"."""
    behind = [t for t in token.doc[token.i + 1 : token.i + 6] if t.lower_ == "then" or t.pos_ not in ("ADV", "PUNCT")]
    joined = bool(behind) and (behind[0].pos_ == "CCONJ" or behind[0].lower_ == "then")
    return joined and any(t.tag_ in ("VB", "VBP") for t in behind[1:3])


def _is_absolute(token: Token) -> bool:
    """True for "hands flying to his face" and "hand in hand", which stand beside a clause."""
    following = _next(token)
    return following is not None and (following.tag_ in ("VBG", "VBN") or following.lower_ == "in")


def _opens(token: Token, ending: str) -> bool:
    """True for "Kneeling, …" and "March forward" at the beginning of a sentence, and for "…, kneeling, …" within it."""
    following = _next(token)
    if following is None:
        return False
    if ending == "ing":
        return following.text == "," and (token.is_sent_start or token.nbor(-1).text == ",")
    name = token.tag_ == "NNP" and token.dep_ not in ("nsubj", "nsubjpass", "compound", "poss")
    told = bool(token.is_sent_start) and ending == "" and name and following.pos_ in ("ADV", "ADP")
    return told and not vocabulary().is_person(token.lower_)  # "march forward", which is no month


def _after_person(token: Token, ending: str) -> bool:
    """True if a noun that might be a verb follows its subject."""
    before = token.nbor(-1) if token.i else None
    following = _next(token)
    if before is None or ending == "ing" or (following is not None and following.pos_ == "AUX"):
        return False
    numbered = before.lower_ in ("first", "second", "former", "latter") and token.dep_ not in ("dobj", "pobj")
    one = before.lower_ in ("one", "other", "both") or before.text in (A_NAME, B_NAME) or numbered
    if ending == "" and (before.lower_ in ("one", "other") or token.pos_ == "ADP"):
        return False  # "one knee", "follows A down the street"
    if before.pos_ == "PRON" and not one:
        return before.lower_ in {*closed("subjects"), "who"}
    the_two = before.lower_ == "two" and before.i > 0 and before.nbor(-1).lower_ in ("the", "these", "those")
    counted = any(c.dep_ == "nummod" and c.lower_ != "one" for c in before.children) or (
        before.i > 0 and before.nbor(-1).lower_ in ("two", "both", "2")
    )
    many = before.tag_ in ("NNS", "NNPS") or before.lower_ in ("both", "people") or the_two or counted
    many = many or (ending == "" and _is_paired(before))
    if ending != "s" and not many and not one:
        return False
    if ending == "s" and many and before.lower_ not in ("second", "first"):
        return False
    return (
        one
        or the_two
        or before.lower_ == "both"
        or vocabulary().is_person(before.lemma_.lower())
        or (many and before.lemma_ in vocabulary().both)
    )


def _is_paired(noun: Token) -> bool:
    """True for the second of two people: "a father and his little daughter dance"."""
    at = noun.i - 1
    while at > noun.sent.start and noun.doc[at].pos_ in ("DET", "ADJ", "PRON"):
        at -= 1
    return noun.doc[at].lower_ == "and" and vocabulary().is_person(noun.doc[at - 1].lemma_.lower())
