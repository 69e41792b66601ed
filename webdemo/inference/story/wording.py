"""Sentences as people write them, in the present tense and in the plain words of the phrasebook."""

from __future__ import annotations

import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

PHRASEBOOK = Path(__file__).with_name("phrasebook.toml")
_OBJECT = (
    r"(person [ab]|him|them|it|each other|one another|her(?! \w)"
    r"|her(?= (?:and|then|with|by|on|in|at|to|from|off|down|up|over|behind|while|until|as|\w+ing|\w+ly|a|into|but|"
    r"so|or|who|when|before|after|towards|around|round|again|out|away|back|hard|along|across|through|for)\b)"
    r"|(?:the|an?|another|his|her|their) (?!(?:\w+ )?(?:hand|arm|shoulder|back|face|head|leg|foot|side|way|eye|knee|"
    r"seat|chair)s?\b)(?:other |old |young |little |first |second )?\w+(?: (?:person|man|woman|one))?)"
)
_SLOTS = {
    "o": _OBJECT,
    "os": r"(?:his|her|their|each other's|(?:person [ab]|the \w+)'s)",
    "his": r"(?:his|her|their|its|the|a)",
    "he": r"(?:he|she|they|it)",
    "self": r"(?:him|her|them|it)sel(?:f|ves)",
}
_END = (
    r"(?=\s*(?:$|[.,;:!?]|(?:and|then|while|as|when|until|before|after|but|again|together|at once|slowly|"
    r"quickly)\b))"
)
"""Ends a phrase of one word, which means something else with an object: "drops" and "drops the ball"."""
_NO_OBJECT = (
    r"\b(?! (?:the|an?|his|her|their|its?|him|them|person|each)\b)"
    r"(?!(?<=over) to (?!(?:the|one|his|her) (?:\w+ )?side\b))"
)
"""Ends a phrase with a particle: "turns up the music" is no arrival, and "moves over to him" no step aside."""
_PARTICLE = re.compile(r"\b(?:up|down|out|over|off|on|in|by|back|around|about|behind|past)$")
_PAST = {
    "be": "was|were|been", "bear": "bore", "beat": "beat", "become": "became", "bend": "bent",
    "bite": "bit", "blow": "blew", "break": "broke", "bring": "brought", "catch": "caught", "come": "came",
    "creep": "crept", "do": "did", "draw": "drew", "drive": "drove", "fall": "fell", "find": "found",
    "flee": "fled", "fling": "flung", "fly": "flew", "get": "got", "give": "gave", "go": "went",
    "hang": "hung", "have": "had", "hide": "hid", "hit": "hit", "hold": "held", "keep": "kept",
    "kneel": "knelt", "lead": "led", "leap": "leapt", "leave": "left", "lie": "lay",
    "lose": "lost", "make": "made", "meet": "met", "pay": "paid", "put": "put", "ride": "rode",
    "rise": "rose", "run": "ran", "see": "saw", "seek": "sought", "shake": "shook", "shoot": "shot",
    "sink": "sank", "sit": "sat", "slide": "slid", "slink": "slunk", "speed": "sped",
    "spin": "spun", "split": "split", "spread": "spread", "spring": "sprang", "stand": "stood",
    "steal": "stole", "stick": "stuck", "stride": "strode", "sweep": "swept", "swing": "swung",
    "take": "took", "tear": "tore", "throw": "threw", "wind": "wound",
}  # fmt: skip
_SILENT = re.compile(r"(?:[^aeiou]l|[vcuzs]|[^aeiou]g|[aeo]r|[ai][tm]|ok|ip)$")
"""Ends of stems that have lost an e before -ed and -ing; a guess where it does not matter."""
_KEPT = {"ss", "ll", "ff", "zz"}
"""Double letters that stems have of their own, and not because of -ed."""
_MANY = re.compile(r"\b(?:they|both|we|people|men|women|children|(?:two|the) (?:\w+ )?\w+s)(?: \w+ly)? $")
"""A plural subject right before its verb."""
_SINGULAR = {verb: f"{verb}es" if verb in ("do", "go") else f"{verb}s" for verb in _PAST} | {
    "be": "is",
    "have": "has",
}


def singular(verb: str) -> str:
    """A verb's base form in the third person singular: "passes"."""
    if verb in _SINGULAR:
        return _SINGULAR[verb]
    if re.search(r"(?:s|sh|ch|x|z)$", verb):
        return f"{verb}es"
    return f"{verb[:-1]}ies" if re.search(r"[^aeiou]y$", verb) else f"{verb}s"


def participle(verb: str) -> str:
    """A verb's base form with -ing: "running"."""
    if verb == "be":
        return "being"
    if verb == "lie":
        return "lying"
    stem = verb[:-1] if re.search(r"[^e]e$", verb) else verb
    return f"{stem}{stem[-1]}ing" if _doubles(verb) else f"{stem}ing"


def past(verb: str) -> tuple[str, ...]:
    """The past forms of a verb's base form."""
    if verb in _PAST:
        return tuple(_PAST[verb].split("|"))
    if verb.endswith("e"):
        return (f"{verb}d",)
    if re.search(r"[^aeiou]y$", verb):
        return (f"{verb[:-1]}ied",)
    return (f"{verb}{verb[-1]}ed" if _doubles(verb) else f"{verb}ed",)


def _doubles(verb: str) -> bool:
    return bool(re.fullmatch(r"[^aeiou]*[aeiou][^aeiouwxy]", verb))


@dataclass(frozen=True)
class _Phrase:
    """A phrase that begins with one form of its verb.

    Attributes:
        rest: matches what follows the verb.
        plain: the plain words in the same form.
        plural: the same after a plural subject.
        length: characters of the phrase.
    """

    rest: re.Pattern[str]
    plain: str
    plural: str
    length: int


@cache
def _phrases() -> dict[str, list[_Phrase]]:
    """The phrases by their first word, the longest first."""
    found: dict[str, list[_Phrase]] = defaultdict(list)
    for plain, phrases in tomllib.loads(PHRASEBOOK.read_text(encoding="utf-8")).items():
        verb, _, object_ = plain.partition(" ")
        for phrase in phrases:
            first, _, rest = phrase.partition(" ")
            pattern = re.sub(r"\\{(\w+)\\}", lambda m: _SLOTS[m[1]], re.escape(rest).replace(r"\ ", " "))
            end = _NO_OBJECT if _PARTICLE.search(rest) else r"\b"
            compiled = re.compile(f" {pattern}{end}" if rest else _END)
            for own, form in _forms(first, verb):
                many = verb if own in past(first) else form
                one, several = (f"{word} {object_}".strip() for word in (form, many))
                found[own].append(_Phrase(compiled, one, several, len(phrase)))
    for listed in found.values():
        listed.sort(key=lambda phrase: -phrase.length)
    return found


def _forms(first: str, verb: str) -> Iterator[tuple[str, str]]:
    """The forms of a phrase's verb with those of the plain verb; the past becomes the present.

    A base form that is a past form as well, as "hit" is, counts as the past.
    """
    if first not in past(first):
        yield first, verb
    yield singular(first), singular(verb)
    yield participle(first), participle(verb)
    for form in past(first):
        yield form, singular(verb)
    if first == "be":
        yield "are", verb


def in_plain_words(text: str) -> str:
    """A text in lower case with everyday phrases put into plain words: "legs it" becomes "runs away"."""
    found, at = "", 0
    for word in re.finditer(r"\b[a-z][\w-]*", text):
        if word.start() < at:
            continue
        for phrase in _phrases().get(word[0], ()):
            match = phrase.rest.match(text, word.end())
            if match is None:
                continue
            other = match[1] if match.re.groups else "the other"
            found += text[at : word.start()]
            found += (phrase.plural if _MANY.search(found) else phrase.plain).replace("{o}", other)
            at = match.end()
            break
    return found + text[at:]


@cache
def _irregular() -> dict[str, str]:
    """Irregular past forms and their present; without those of "be", and those that are like the base form."""
    return {form: singular(verb) for verb in _PAST if verb != "be" for form in past(verb) if form != verb}


def past_forms() -> tuple[str, ...]:
    """The irregular past forms that :func:`in_present` knows."""
    return tuple(_irregular())


def in_present(words: str) -> str:
    """An act with its first verb in the present: "went away" becomes "goes away"."""
    first, _, rest = words.partition(" ")
    if first in _irregular():
        return f"{_irregular()[first]} {rest}".strip()
    if not re.fullmatch(r"\w{2,}ed", first) or first in ("seated", "tired", "perched", "need", "speed"):
        return words
    stem = first[:-2]
    if stem.endswith("i"):
        return f"{stem[:-1]}ies {rest}".strip()
    if len(stem) > 2 and stem[-1] == stem[-2] and stem[-2:] not in _KEPT:
        return f"{stem[:-1]}s {rest}".strip()
    if _SILENT.search(stem) and stem[-2:] not in _KEPT:
        stem += "e"
    return f"{singular(stem)} {rest}".strip()
