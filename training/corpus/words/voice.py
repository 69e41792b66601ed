"""Names of two people, their pronouns, and verb agreement."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ..grammar import conjugate

Rng = np.random.Generator


@dataclass(frozen=True)
class Cast:
    """Names of two people.

    Attributes:
        first: names of a and b at their first mention.
        later: names of a and b afterwards.
        pronouns: "he", "she" or "they" of each.
        group: name of both together, or None for a general word.
        in_turn: gives the first name to the person mentioned first ("one", "the other").
    """

    first: tuple[str, str]
    later: tuple[str, str]
    pronouns: tuple[str, str] = ("they", "they")
    group: str | None = None
    in_turn: bool = False


CASES = {
    "they": ("they", "them", "their", "themselves"),
    "he": ("he", "him", "his", "himself"),
    "she": ("she", "her", "her", "herself"),
}
_PLAIN = (
    Cast(("one person", "the other"), ("the first person", "the other"), in_turn=True),
    Cast(("one person", "the other person"), ("the first person", "the other person"), in_turn=True),
    Cast(("one person", "another person"), ("the first person", "the second person"), in_turn=True),
    Cast(("a person", "another person"), ("the first person", "the second person"), in_turn=True),
    Cast(("a person", "someone else"), ("the first person", "the other one"), in_turn=True),
    Cast(("someone", "another person"), ("the first person", "the other person"), in_turn=True),
    Cast(("somebody", "somebody else"), ("the first person", "the second"), in_turn=True),
    Cast(("one", "the other"), ("the first", "the other"), in_turn=True),
    Cast(("one of them", "the other"), ("the first one", "the other"), in_turn=True),
    Cast(("the first person", "the second person"), ("the first person", "the second person"), in_turn=True),
    Cast(("the first", "the second"), ("the first", "the second"), in_turn=True),
    Cast(("person A", "person B"), ("person A", "person B"), in_turn=True),
    Cast(("person 1", "person 2"), ("person 1", "person 2"), in_turn=True),
    Cast(("a man", "another man"), ("the first man", "the second man"), ("he", "he"), "two men", True),
    Cast(("a woman", "another woman"), ("the first woman", "the other"), ("she", "she"), "two women", True),
    Cast(("one friend", "the other"), ("the first friend", "the other"), group="two friends", in_turn=True),
    Cast(("one player", "the other"), ("the first player", "the other"), group="two players", in_turn=True),
)
_ROLES = {
    "he": ("a man", "a boy", "an old man", "a young man", "a tall man", "his father", "a waiter", "a gentleman",
           "the husband", "a grandfather", "a policeman", "a guy", "an actor", "the king"),
    "she": ("a woman", "a girl", "an old woman", "a young woman", "her mother", "a waitress", "a lady", "the wife",
            "a grandmother", "a policewoman", "an actress", "the queen"),
    "they": ("a friend", "a stranger", "a child", "a teacher", "a student", "a dancer", "a neighbour", "a guest",
             "a colleague", "a doctor", "a player", "a coach", "a tourist", "a shopkeeper", "a customer", "a guard",
             "a thief", "a soldier", "an athlete", "a clown", "a singer", "a passer-by", "a visitor", "a partner"),
}  # fmt: skip
_NAMES = {
    "he": ("Ben", "Tom", "Paul", "Omar", "Leo", "Jack"),
    "she": ("Anna", "Mia", "Eva", "Lena", "Zoe", "Rosa"),
}
_GROUPS = ("two people", "the two", "both people", "they", "a pair", "both of them", "the two of them", "two friends",
           "two persons")  # fmt: skip


def draw_cast(rng: Rng) -> Cast:
    """Half of the time plain words ("one person"), else roles or names."""
    kind = rng.random()
    if kind < 0.5:
        return _PLAIN[int(rng.integers(len(_PLAIN)))]
    genders = [
        ("he", "she"),
        ("she", "he"),
        ("he", "they"),
        ("they", "she"),
        ("they", "they"),
        ("she", "they"),
    ]
    pronouns = genders[int(rng.integers(len(genders)))]
    if kind < 0.62 and "they" not in pronouns:
        names = tuple(_NAMES[p][int(rng.integers(6))] for p in pronouns)
        return Cast(names, names, pronouns)
    if kind < 0.75 and "they" not in pronouns:
        plain = {"he": "a man", "she": "a woman"}
        names = tuple(plain[p] for p in pronouns)
    else:
        names = tuple(_ROLES[p][int(rng.integers(len(_ROLES[p])))] for p in pronouns)
        if names[0] == names[1] or any(name.startswith(("his", "her")) for name in names[:1]):
            return draw_cast(rng)
        if names[1].startswith(("his", "her")) and not names[1].startswith(
            {"he": "his", "she": "her"}.get(pronouns[0], "-")
        ):
            return draw_cast(rng)
    later = tuple(re.sub(r"^an? ", "the ", name) for name in names)
    return Cast(names, later, pronouns)


class Voice:
    """Writes one caption: tracks who has been mentioned, and fills in the tokens of phrases and sentences.

    Args:
        cast: the names; with ``in_turn`` they are assigned in order of first mention.
        sides: "left", "right", "both" or None for a and b, set for each beat.
    """

    def __init__(self, rng: Rng, cast: Cast) -> None:
        self.rng, self.cast = rng, cast
        self.sides: tuple[str | None, str | None] = (None, None)
        self.mentioned: list[int] = []
        self.failed = False

    # ---- names ------------------------------------------------------------------------------------------
    def _slot(self, person: int) -> int:
        """The index of the person's name."""
        if not self.cast.in_turn:
            return person
        order = [*self.mentioned, *(p for p in (person,) if p not in self.mentioned)]
        return order.index(person)

    def name(self, person: int) -> str:
        """The name or pronoun of a person at this place of the sentence."""
        slot = self._slot(person)
        if person in self.mentioned:
            return self.cast.later[slot]
        self.mentioned.append(person)
        return self.cast.first[slot]

    def pronoun(self, person: int) -> tuple[str, str, str, str]:
        """A person's pronoun in its four cases."""
        return CASES[self.cast.pronouns[self._slot(person)]]

    @property
    def clear(self) -> bool:
        """True if a pronoun says who is meant."""
        one, other = self.cast.pronouns
        return one != other and "they" not in (one, other)

    def case(self, person: int, case: str) -> str:
        """A pronoun, or the name where a pronoun would not be clear or would not agree."""
        he, him, his, himself = self.pronoun(person)
        fresh = person not in self.mentioned
        if case == "himself":
            return himself
        if case == "his":
            if fresh or (
                not self.clear and self.mentioned and self.mentioned[-1:] != [person] and he != "they"
            ):
                return possessive(self.name(person))
            return his
        if fresh or not (self.clear or (case == "him" and he == "they")):
            return self.name(person)
        return he if case == "he" else him

    def own(self, person: int) -> str:
        """his, her, their: of the subject of the phrase."""
        return self.pronoun(person)[2]

    def group(self) -> str:
        """The two together: a general word, the cast's, or both names."""
        if self.mentioned:
            return ("they", "the two", "both of them", "the two of them", "both")[int(self.rng.integers(5))]
        self.mentioned = [0, 1]
        if self.cast.group and self.rng.random() < 0.7:
            return self.cast.group
        if self.rng.random() < 0.5 and not self.cast.in_turn:
            return f"{self.cast.first[0]} and {self.cast.first[1]}"
        return _GROUPS[int(self.rng.integers(len(_GROUPS)))]

    # ---- text -------------------------------------------------------------------------------------------
    _TOKENS = re.compile(
        r"\*[A-Za-z][\w-]*|@(?:he|him|his|himself)\b|#(?:he|him|his|himself)\b|%side|%other|\b[AB]'s\b|\b[AB]\b"
    )

    def phrase(self, text: str, person: int, form: str) -> str:
        """A verb phrase of ``person``; person -1: of both."""
        return self._fill(text, person, 1 - person if person >= 0 else -1, form)

    def sentence(self, text: str, a: int) -> str:
        """A whole sentence in which A is person ``a``."""
        return self._fill(text, a, 1 - a, "s", whole=True)

    def _fill(self, text: str, subject: int, other: int, form: str, *, whole: bool = False) -> str:
        def one(match: re.Match[str]) -> str:
            token = match.group(0)
            if token[0] == "*":
                return conjugate(token[1:], form)
            if token in ("%side", "%other"):
                side = self.sides[max(subject if token == "%side" else other, 0)]
                if side not in ("left", "right"):
                    self.failed = True
                    return ""
                return side
            if token[0] in "AB":
                person = subject if token[0] == "A" else other
                name = self.name(person)
                return possessive(name) if token.endswith("'s") else name
            person, case = (subject if token[0] == "@" else other), token[1:]
            if person < 0:
                return {"he": "they", "him": "them", "his": "their", "himself": "themselves"}[case]
            if token[0] == "@" and not whole:
                return (
                    self.name(person)
                    if case == "he" and not self.clear
                    else self.pronoun(person)[("he", "him", "his", "himself").index(case)]
                )
            return self.case(person, case)

        return self._TOKENS.sub(one, text)


def possessive(name: str) -> str:
    """A name with an apostrophe: "the girl's", "the boys'"."""
    return f"{name}'" if name.endswith("s") else f"{name}'s"


def finished(text: str) -> str:
    """Capitalised, with a full stop, single spaces."""
    text = re.sub(r"\s+", " ", text).strip()
    text = re.sub(r"\s+([,.;!?])", r"\1", text)
    text = re.sub(r"([.!?] )([a-z])", lambda m: m.group(1) + m.group(2).upper(), text)
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else text + "."
