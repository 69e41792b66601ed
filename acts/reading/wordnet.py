"""WordNet 3.0 on words: which verbs mean what an act's verbs mean, and which nouns are people.

The tables beside this module are an extract, which this module made in commit 360d5918 of WordNet's ``dict`` folder
(Debian's ``wordnet-base``). Its licence is in ``WORDNET-LICENSE``.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

_HERE = Path(__file__).parent
VERBS, PEOPLE, NOUNS = _HERE / "verbs.tsv", _HERE / "people.tsv", _HERE / "nouns.tsv"
BODILY = frozenset(("body", "competition", "consumption", "contact", "motion"))
"""WordNet's kinds of verbs that bodies show; others are matched only with verbs of the same meaning."""


@cache
def _verbs(table: str) -> dict[str, tuple[str, ...]]:
    """A table of verbs: "v" has their synsets, "s" those above one, and "k" the first synset of each kind."""
    rows = (line.split("\t") for line in VERBS.read_text(encoding="utf-8").splitlines())
    return {key: tuple(rest[0].split()) if rest else () for name, key, *rest in rows if name == table}


@cache
def people() -> dict[str, str]:
    """Nouns whose most frequent sense is a person, with the sex that each gives them: "m", "f" or ""."""
    rows = (line.split("\t") for line in PEOPLE.read_text(encoding="utf-8").splitlines())
    return {noun: sex for noun, sex, _ in rows}


@cache
def _nouns() -> dict[str, frozenset[str]]:
    """Nouns by kind: "animal", "person" for a rarer sense, "act" for those of what a verb so spelt means."""
    by_kind: dict[str, set[str]] = {}
    for line in NOUNS.read_text(encoding="utf-8").splitlines():
        noun, kind = line.split("\t")
        by_kind.setdefault(kind, set()).add(noun)
    return {kind: frozenset(nouns) for kind, nouns in by_kind.items()}


def is_animal(noun: str) -> bool:
    """True for a noun whose most frequent sense is an animal."""
    return noun in _nouns()["animal"]


def may_be_person(noun: str) -> bool:
    """True for a noun with a sense that is a person, as "model" and "base"."""
    return noun in people() or noun in _nouns()["person"]


def is_act(noun: str) -> bool:
    """True for a noun that may stand for what somebody does, as "hug", "bow" and "lunge"."""
    return noun in _nouns()["act"]


def is_verb(lemma: str) -> bool:
    """True if WordNet knows a verb of this lemma."""
    return lemma in _verbs("v")


def synset(name: str) -> str | None:
    """The synset that a name such as "carry.v.01" stands for; None if there is none."""
    lemma, _, number = name.rpartition(".v.")
    senses = _verbs("v").get(lemma, ())
    return senses[int(number) - 1] if number.isdigit() and 0 < int(number) <= len(senses) else None


def senses(lemma: str) -> tuple[str, ...]:
    """The synsets of a verb, the most frequent first."""
    return _verbs("v").get(lemma, ())


def above(sense: str) -> tuple[str, ...]:
    """The synsets above one: its hypernyms."""
    return _verbs("s").get(sense, ())


def kind(sense: str) -> str:
    """The kind of a verb's synset: "body", "motion", "contact", "cognition", …."""
    return [name for name, (first,) in _verbs("k").items() if first <= sense][-1]


def usual_kind(lemma: str) -> str:
    """The kind of a verb in its first sense; "body" for a verb that WordNet lacks."""
    own = senses(lemma)
    return kind(own[0]) if own else "body"


def meanings(lemma: str, most: int = 3, height: int = 2) -> list[tuple[str, float]]:
    """The synsets of a verb and those above them, with what choosing each costs, the likeliest first.

    Args:
        lemma: of the verb.
        most: senses that are looked at; each costs 1 more than the one before.
        height: steps up; each costs 1.
    """
    costs = dict[str, float]()
    for rank, sense in enumerate(senses(lemma)[:most]):
        level, cost = [sense], float(rank)
        for _ in range(height + 1):
            for each in level:
                costs[each] = min(cost, costs.get(each, cost))
            level, cost = [up for each in level for up in above(each)], cost + 1.0
    return sorted(costs.items(), key=lambda item: item[1])
