"""Sentences about two people, taken apart into what each of them does."""

from __future__ import annotations

import re
from collections.abc import Sequence

from .clauses import clauses

_DOES = {
    "pushed": "pushes", "shoved": "shoves", "knocked": "knocks", "kicked": "kicks", "punched": "punches",
    "slapped": "slaps", "hit": "hits", "struck": "strikes", "tapped": "taps", "patted": "pats", "hugged": "hugs",
    "embraced": "embraces", "kissed": "kisses", "touched": "touches", "pulled": "pulls", "dragged": "drags",
    "lifted": "lifts", "helped": "helps", "supported": "supports", "led": "leads", "guided": "guides",
    "carried": "carries", "held": "holds", "grabbed": "grabs", "caught": "catches", "thrown": "throws",
    "comforted": "comforts", "greeted": "greets", "followed": "follows", "chased": "chases",
    "approached": "approaches", "stopped": "stops",
}  # fmt: skip
"""Verbs in the passive voice and as their agent does them."""
_PASSIVE = re.compile(
    rf"^(?:is|are|gets?) (?:being )?(?P<verb>{'|'.join(_DOES)})\b(?P<rest>.*?) by (?!the (?:hand|arm|wrist|shoulder))"
)

_NAMED = re.compile(r"\bperson ([ab])\b((?:'s\b)?)")


def of_each(sentence: str) -> tuple[str, str]:
    """A sentence for person a and one for person b; "" for who is not said to do anything.

    Both are "" where a part of the sentence is about both people, or about nobody: then the whole sentence says it
    best.
    """
    found = clauses(sentence)
    if any(clause.who == "ab" or not clause.subject for clause in found):
        return "", ""
    acts: dict[str, list[str]] = {"a": [], "b": []}
    for clause in found:
        acts[clause.who].append(_from_outside(clause.words, clause.who))
        if (passive := _PASSIVE.match(clause.words)) is not None:
            rest = _from_outside(passive["rest"], clause.who)
            acts["b" if clause.who == "a" else "a"].append(f"{_DOES[passive['verb']]} the other person{rest}")
    return _sentence(acts["a"]), _sentence(acts["b"])


def _from_outside(words: str, who: str) -> str:
    """The words without the names: who does it is "them", and the other one "the other person"."""

    def named(match: re.Match[str]) -> str:
        if match[1] != who:
            return f"the other person{match[2]}"
        return "their" if match[2] else "them"

    return _NAMED.sub(named, words)


def _sentence(acts: Sequence[str]) -> str:
    return f"One person {' and '.join(acts)}." if acts else ""
