"""Closed classes of words: people, parts of the body, numbers, units, directions, and verbs about other verbs."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

from . import wordnet

FORMATION = "together"
"""The adverb as which the parser gets a formation."""


def _sets(table: Mapping[str, str]) -> dict[str, frozenset[str]]:
    """The words of each line of a table."""
    return {name: frozenset(words.split()) for name, words in table.items()}


class Vocabulary:
    """The words of ``words.toml``, and WordNet's nouns of people."""

    def __init__(self, tables: Mapping[str, Any]) -> None:
        self._people, self._names = _sets(tables["people"]), _sets(tables["names"])
        self.places = frozenset(tables["places"]["nouns"].split())
        self.seats = frozenset(tables["places"]["seats"].split())
        self._states = {
            (preposition, noun): verb.strip()
            for verb, (prepositions, nouns) in tables["states"].items()
            for preposition in prepositions.split()
            for noun in nouns.split()
        }
        self.both = frozenset(tables["groups"]["both"].split())
        self._parts = {word: family for family, text in tables["body"].items() for word in text.split()}
        named = ["directions", "speeds", "gaits", "likeness", "marks", "noun_marks", "shorthand"]
        named += ["numbers", "metres", "seconds"]
        by_word = {table: {w: name for name, text in tables[table].items() for w in text.split()} for table in named}
        self.directions, self.likeness = by_word["directions"], by_word["likeness"]
        """How somebody moves who moves like one of these."""
        self.shorthand = by_word["shorthand"]
        self.numbers = {word: int(number) for word, number in by_word["numbers"].items()}
        measures = ("metres", "seconds", "speeds", "gaits")
        floats = ({word: float(value) for word, value in by_word[name].items()} for name in measures)
        self.metres, self.seconds, self.speeds, self.gaits = floats
        """Units of length and time, and factors of speed of adverbs and of verbs, beside a walk."""
        self.marks, self.noun_marks = by_word["marks"], by_word["noun_marks"]
        """How a clause with one of these words lies beside its main clause, and an act that a noun behind one names."""
        sides, ways = (("left", "right"), ("right", "left")), tables["to_sides"]["phrases"]
        self.to_sides = [tuple(words.format(*two).split()) for words in ways for two in sides]
        self.verbs = _sets(tables["verbs"])
        self.safe = {ending.strip("-"): words.split() for ending, words in tables["safe verbs"].items()}
        """Forms, by ending, of a verb with, of two without an object and of one before another verb."""
        self.do: dict[str, str] = tables["do"]
        """Forms of "do", and of a verb in the same form that is no part of another."""
        self.light: tuple[str, ...] = tuple(tables["verbs"]["light"].split())
        """Verbs that mean what their object names, in the order in which they are tried."""
        self.adjectives = _sets(tables["adjectives"])
        """Adjectives that say of what follows that it is not done, or only wished."""
        joined = {
            " ".join(words): said.format(*words)
            for phrase, said in tables["phrases"].items()
            for words in product(*(word.split("|") for word in phrase.split()))
        }
        self.formations = {
            tuple(phrase.split()): name for name, listed in tables["formations"].items() for phrase in listed
        }
        """Ways to stand or move together, by the words that say them."""
        joined = {" ".join(words): FORMATION for words in self.formations} | joined
        self.phrases: dict[str, list[tuple[tuple[str, ...], str]]] = {}
        """What the parser takes apart and one word for it, the longest first, by the first word."""
        for phrase in sorted(joined, key=len, reverse=True):
            words = tuple(phrase.split())
            self.phrases.setdefault(words[0], []).append((words, joined[phrase]))
        self.requests = sorted((tuple(text.split()) for text in tables["requests"]["phrases"]), key=len, reverse=True)
        """What asks for a motion before it says which, the longest first."""
        self.limits = _sets(tables["limits"])
        """What the stage cannot do, as a sentence, by the words that ask for it."""
        self.classes = _sets(tables["classes"])

    def is_person(self, lemma: str) -> bool:
        """True for the lemma of a noun that names a person."""
        known = lemma in wordnet.people() or self.is_usual_person(lemma)
        return known and lemma not in self._people["not"] and lemma not in self._parts

    def is_usual_person(self, lemma: str) -> bool:
        """True for the nouns of people that stand in ``words.toml``, and not for WordNet's rarer ones."""
        return any(lemma in self._people[key] for key in ("m", "f", "child", "more"))

    def sex(self, lemma: str) -> str:
        """ "m", "f" or "" for a noun of a person, or a name, in small letters."""
        usual = next((sex for sex in "mf" if lemma in self._people[sex] | self._names[sex]), None)
        return usual or wordnet.people().get(lemma, "")

    def age(self, lemma: str) -> str:
        """ "child", "old" or "" for a noun of a person."""
        return next((age for age in ("child", "old") if lemma in self._people[age]), "")

    def state(self, preposition: str, lemma: str) -> str:
        """The verb that a phrase of place implies for its person ("on the bench": sit); "" for other phrases."""
        return self._states.get((preposition, lemma), "")

    def part(self, lemma: str) -> str:
        """The family of a part of the body; "" for other nouns."""
        return self._parts.get(lemma, "")

    def named_part(self, word: str) -> str:
        """The family of a part of the body that a word names in the singular or plural; "" for other words."""
        one = {"feet": "foot"}.get(word, word)
        return self.part(one) or self.part(one.removesuffix("s"))


def is_act(noun: str) -> bool:
    """True for a noun that may stand for what somebody does, as "hug", "bow" and "lunge"."""
    return noun in vocabulary().verbs["nouns"] or wordnet.is_act(noun)


@cache
def vocabulary() -> Vocabulary:
    """The vocabulary, read once."""
    return Vocabulary(tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8")))


def closed(name: str) -> frozenset[str]:
    """A closed class of words, by its name in ``words.toml``: those with which an owner is named, say."""
    return vocabulary().classes[name]
