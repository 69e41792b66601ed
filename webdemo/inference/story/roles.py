"""Sentences that name person A and person B, taken apart into what each of them does."""

from __future__ import annotations

import re

_NAMED = r"person\s+[ab]\b"
_JOIN = r"\b(?:and|but|while|as|whereas|so|until)\b"
_CUT = re.compile(
    rf"(?:[,;]\s*|\s+)(?:{_JOIN})?\s*(?:then\s+|finally\s+)?(?={_NAMED}(?!'s)\s+(?!and\b|or\b))"
    rf"|\.\s+(?={_NAMED})",
    re.IGNORECASE,
)
_SUBJECT = re.compile(
    rf"^(?:first\s+|while\s+|as\s+|when\s+)?(?P<who>{_NAMED})(?!'s)(?!\s+(?:and|or)\b)", re.IGNORECASE
)
_BOTH = re.compile(
    r"\b(?:they|both|the two|two people|each other|together)\b"
    rf"|(?:^|[,.;]\s*|\b(?:then|while|as|and)\s+){_NAMED}\s+(?:and|or)\s+{_NAMED}",
    re.IGNORECASE,
)
_OBJECT = re.compile(
    r"\b(?:to|at|with|of|on|by|from|past|towards?|around|behind|for|before|over|near|beside|after|and|than|the)\s*$",
    re.IGNORECASE,
)


def of_each(sentence: str) -> tuple[str, str]:
    """A sentence for person a and one for person b; "" for who is not said to do anything.

    Both are "" where the sentence names nobody, or also says what both do: then the whole sentence says it best.
    """
    if not re.search(_NAMED, sentence, re.IGNORECASE) or _BOTH.search(sentence):
        return "", ""
    found: dict[str, list[str]] = {"a": [], "b": []}
    for clause in _clauses(sentence.strip().rstrip(".")):
        subject = _SUBJECT.match(clause)
        if subject is None:
            return "", ""
        who = subject["who"][-1].lower()
        rest = clause[subject.end() :].strip(" ,;")
        if rest:
            found[who].append(_from_outside(rest, who))
    return _sentence(found["a"]), _sentence(found["b"])


def _clauses(sentence: str) -> list[str]:
    """The sentence cut before every named person who is a subject, not an object as in "waves to person B"."""
    parts: list[str] = []
    start = 0
    for match in _CUT.finditer(sentence):
        joined = bool(re.search(_JOIN, match[0], re.IGNORECASE))
        marked = joined or bool(re.search(r"[,;.]", match[0]))
        object_ = not joined and _OBJECT.search(sentence[: match.end()])
        if marked and not object_ and sentence[start : match.start()].strip():
            parts.append(sentence[start : match.start()].strip())
            start = match.end()
    return [*parts, sentence[start:].strip()]


def _from_outside(words: str, who: str) -> str:
    """The words without the names: who does it is "them", and the other one "the other person"."""
    other = "b" if who == "a" else "a"
    words = re.sub(rf"person\s+{other}\b", "the other person", words, flags=re.IGNORECASE)
    words = re.sub(rf"person\s+{who}'s\b", "their", words, flags=re.IGNORECASE)
    return re.sub(rf"person\s+{who}\b", "them", words, flags=re.IGNORECASE)


def _sentence(acts: list[str]) -> str:
    return f"One person {', then '.join(acts)}." if acts else ""
