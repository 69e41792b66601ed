"""English for the captions: forms of verbs, articles, patterns with alternatives, and mirrored sentences."""

from __future__ import annotations

import re
from functools import cache

from .wording import DOUBLED, IRREGULAR


def conjugate(verb: str, form: str) -> str:
    """A verb in a form: "s" (waves), "plural" (wave), "ing" (waving) or "inf" (wave)."""
    index = ("s", "plural", "ing", "inf").index(form)
    if verb in IRREGULAR:
        return IRREGULAR[verb][index]
    stem, hyphen, rest = verb.partition("-")
    if hyphen:  # high-five: the last part is inflected
        return f"{stem}-{conjugate(rest, form)}"
    if form in ("plural", "inf"):
        return verb
    if form == "s":
        if re.search(r"(s|x|z|ch|sh)$", verb):
            return verb + "es"
        return verb[:-1] + "ies" if re.search(r"[^aeiou]y$", verb) else verb + "s"
    if verb in DOUBLED:
        return verb + verb[-1] + "ing"
    return (verb[:-1] if re.search(r"[^eo]e$", verb) else verb) + "ing"


_SWAP = {"left": "right", "clockwise": "counterclockwise", "leftwards": "rightwards"}
_SWAP.update({value: key for key, value in _SWAP.items()} | {"anticlockwise": "clockwise"})


def mirror_caption(text: str) -> str:
    """The caption of the mirrored motion: left and right, clockwise and counterclockwise change places."""

    def other(match: re.Match[str]) -> str:
        word = match.group(0)
        swapped = _SWAP[word.lower()]
        return swapped.upper() if word.isupper() else swapped.capitalize() if word[0].isupper() else swapped

    return re.sub(rf"\b({'|'.join(_SWAP)})\b", other, text, flags=re.IGNORECASE)


@cache
def expand(pattern: str) -> tuple[str, ...]:
    """All strings that a pattern with alternatives ``(a|b|)`` stands for."""
    match = re.search(r"\(([^()]*\|[^()]*)\)", pattern)
    if match is None:
        return (pattern,)
    head, tail = pattern[: match.start()], pattern[match.end() :]
    return tuple(
        dict.fromkeys(s for choice in match.group(1).split("|") for s in expand(head + choice + tail))
    )


def article(match: re.Match[str]) -> str:
    """The indefinite article that the word behind it asks for, with a blank: "a " or "an "."""
    word = match.group(2).lower()
    vowel = word[0] in "aeiou" and not re.match(r"one|uni|use|eu", word)
    return match.group(1) + ("n " if vowel else " ")
