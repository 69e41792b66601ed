"""WordNet 3.0 on words: which verbs mean what an act's verbs mean, and which nouns are people.

The tables beside this module are an extract; ``python -m acts.reading.wordnet FOLDER`` makes them anew from WordNet's
``dict`` folder (Debian's ``wordnet-base``). Its licence is in ``WORDNET-LICENSE``.
"""

from __future__ import annotations

import bisect
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

_HERE = Path(__file__).parent
VERBS, PEOPLE, NOUNS = _HERE / "verbs.tsv", _HERE / "people.tsv", _HERE / "nouns.tsv"
_PERSON, _ACT = "18", "04"
"""WordNet's numbers for the lexicographer's files of people and of acts."""


_STARTS = (
    "00001740",
    "00109660",
    "00588221",
    "00740595",
    "01072280",
    "01156852",
    "01205714",
    "01617210",
    "01759344",
    "01831549",
    "02105828",
    "02199608",
    "02367050",
    "02603699",
    "02756558",
)
_KINDS = (
    "body",
    "change",
    "cognition",
    "communication",
    "competition",
    "consumption",
    "contact",
    "creation",
    "emotion",
    "motion",
    "perception",
    "possession",
    "social",
    "stative",
    "weather",
)
"""WordNet's kinds of verbs; their synsets stand in this order, each kind from the number in ``_STARTS`` on."""
BODILY = frozenset(("body", "competition", "consumption", "contact", "motion"))
"""WordNet's kinds of verbs that bodies show; others are matched only with verbs of the same meaning."""


class _Verbs(NamedTuple):
    senses: dict[str, tuple[str, ...]]
    above: dict[str, tuple[str, ...]]


class PersonNoun(NamedTuple):
    """The sex ("m", "f" or "") and age ("child", "old" or "") that a noun gives a person."""

    sex: str
    age: str


@cache
def _verbs() -> _Verbs:
    senses: dict[str, tuple[str, ...]] = {}
    above: dict[str, tuple[str, ...]] = {}
    for line in VERBS.read_text(encoding="utf-8").splitlines():
        kind, key, *rest = line.split("\t")
        (senses if kind == "v" else above)[key] = tuple(rest[0].split()) if rest else ()
    return _Verbs(senses, above)


@cache
def people() -> dict[str, PersonNoun]:
    """Nouns whose most frequent sense is a person."""
    found = {}
    for line in PEOPLE.read_text(encoding="utf-8").splitlines():
        noun, sex, age = line.split("\t")
        found[noun] = PersonNoun(sex, age)
    return found


@cache
def _nouns() -> dict[str, frozenset[str]]:
    """Nouns by kind: "animal", "person" for a rarer sense, "act" for those of what a verb so spelt means."""
    found: dict[str, set[str]] = {}
    for line in NOUNS.read_text(encoding="utf-8").splitlines():
        noun, kind = line.split("\t")
        found.setdefault(kind, set()).add(noun)
    return {kind: frozenset(nouns) for kind, nouns in found.items()}


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
    return lemma in _verbs().senses


def synset(name: str) -> str | None:
    """The synset that a name such as "carry.v.01" stands for; None if there is none."""
    lemma, _, number = name.rpartition(".v.")
    senses = _verbs().senses.get(lemma, ())
    return senses[int(number) - 1] if number.isdigit() and 0 < int(number) <= len(senses) else None


def senses(lemma: str) -> tuple[str, ...]:
    """The synsets of a verb, the most frequent first."""
    return _verbs().senses.get(lemma, ())


def above(sense: str) -> tuple[str, ...]:
    """The synsets above one: its hypernyms."""
    return _verbs().above.get(sense, ())


def kind(sense: str) -> str:
    """The kind of a verb's synset: "body", "motion", "contact", "cognition", …."""
    return _KINDS[bisect.bisect_right(_STARTS, sense) - 1]


def usual_kind(lemma: str) -> str:
    """The kind of a verb in its first sense; "body" for a verb that WordNet lacks."""
    return kind((senses(lemma) or _STARTS)[0])


def meanings(lemma: str, most: int = 3, height: int = 2) -> list[tuple[str, float]]:
    """The synsets of a verb and those above them, with what choosing each costs, the likeliest first.

    Args:
        lemma: of the verb.
        most: senses that are looked at; each costs 1 more than the one before.
        height: steps up; each costs 1.
    """
    verbs, found = _verbs(), dict[str, float]()
    for rank, sense in enumerate(verbs.senses.get(lemma, ())[:most]):
        level, cost = [sense], float(rank)
        for _ in range(height + 1):
            for each in level:
                found[each] = min(cost, found.get(each, cost))
            level, cost = [up for each in level for up in verbs.above.get(each, ())], cost + 1.0
    return sorted(found.items(), key=lambda item: item[1])


def build(folder: Path) -> None:
    """Writes the tables from WordNet's files."""
    rows, ups = [], []
    for line in _lines(folder / "index.verb"):
        fields = line.split()
        lemma, count, skipped = fields[0], int(fields[2]), int(fields[3])
        if lemma.count("_") < 2:  # "bump_into" is a verb and its particle
            rows.append(f"v\t{lemma}\t{' '.join(fields[6 + skipped :][:count])}")
    for line in _lines(folder / "data.verb"):
        fields = line.split("|")[0].split()
        pointers = fields[5 + 2 * int(fields[3], 16) - 1 :]
        above = [pointers[i + 1] for i, sign in enumerate(pointers) if sign == "@" and pointers[i + 2] == "v"]
        if above:
            ups.append(f"s\t{fields[0]}\t{' '.join(above)}")
    VERBS.write_text("\n".join([*rows, *ups]) + "\n", encoding="utf-8")
    above_of: dict[str, list[str]] = {}
    file_of: dict[str, str] = {}
    words_of: dict[str, set[str]] = {}
    spelt: dict[str, set[str]] = {}  # "ball", but not "Ball"
    for line in _lines(folder / "data.noun"):
        fields = line.split("|")[0].split()
        file_of[fields[0]] = fields[1]
        count = int(fields[3], 16)
        spelt[fields[0]] = {fields[4 + 2 * i] for i in range(count)}
        words_of[fields[0]] = {word.lower() for word in spelt[fields[0]]}
        pointers = fields[4 + 2 * count :]
        above_of[fields[0]] = [pointers[i + 1] for i, sign in enumerate(pointers) if sign in ("@", "@i")]
    roots = {
        word: {key for key, words in words_of.items() if file_of[key] == _PERSON and word in words}
        for word in ("male_person", "female_person", "juvenile_person", "golden_ager", "child")
    }
    animal = {key for key, words in words_of.items() if words >= {"animal", "fauna"}}
    lines, nouns = [], []
    for line in _lines(folder / "index.noun"):
        fields = line.split()
        noun, senses = fields[0], fields[6 + int(fields[3]) :]
        first = senses[0]
        if "_" in noun or not noun.isalpha():
            continue
        closure: set[str] = set()
        waiting = [first]
        while waiting:
            key = waiting.pop()
            if key not in closure:
                closure.add(key)
                waiting += above_of[key]
        if closure & animal and file_of[first] != _PERSON:
            nouns.append(f"{noun}\tanimal")
        if is_verb(noun) and any(file_of[sense] == _ACT for sense in senses[:3]):
            nouns.append(f"{noun}\tact")
        if file_of[first] != _PERSON:
            if any(file_of[sense] == _PERSON and noun in spelt[sense] for sense in senses[1:]):
                nouns.append(f"{noun}\tperson")
            continue
        sex = "m" if closure & roots["male_person"] else "f" if closure & roots["female_person"] else ""
        young = closure & (roots["juvenile_person"] | roots["child"])
        age = "child" if young else "old" if closure & roots["golden_ager"] else ""
        lines.append(f"{noun}\t{sex}\t{age}")
    PEOPLE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    NOUNS.write_text("\n".join(nouns) + "\n", encoding="utf-8")


def _lines(path: Path) -> list[str]:
    return [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("  ")]


if __name__ == "__main__":
    build(Path(sys.argv[1]))
