"""Names of two people in captions, at their first mention and later, and pronouns."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

Rng = np.random.Generator


@dataclass(frozen=True)
class Cast:
    """Names of two people.

    Attributes:
        first: names at the first mention, of the person named first and of the other.
        later: their names afterwards.
        pronouns: "he", "she" or "they" of each.
        group: name of both together; None for "two people".
    """

    first: tuple[str, str]
    later: tuple[str, str]
    pronouns: tuple[str, str] = ("they", "they")
    group: str | None = None


OBJECTS = {"he": "him", "she": "her"}
OWN = {"they": "their", "he": "his", "she": "her"}
_PLAIN = (
    Cast(("one person", "the other person"), ("the first person", "the second person")),
    Cast(("one person", "another person"), ("the first person", "the second person")),
    Cast(("a person", "another person"), ("the first person", "the second person")),
    Cast(("someone", "another person"), ("the first person", "the second person")),
    Cast(("the first person", "the second person"), ("the first person", "the second person")),
    Cast(("person A", "person B"), ("person A", "person B"), group="person A and person B"),
    Cast(("person 1", "person 2"), ("person 1", "person 2"), group="person 1 and person 2"),
    Cast(("a man", "another man"), ("the first man", "the second man"), ("he", "he"), "two men"),
    Cast(("a woman", "another woman"), ("the first woman", "the second woman"), ("she", "she"), "two women"),
    Cast(("one friend", "the other friend"), ("the first friend", "the second friend"), group="two friends"),
    Cast(("one player", "the other player"), ("the first player", "the second player"), group="two players"),
    Cast(("one dancer", "the other dancer"), ("the first dancer", "the second dancer"), group="two dancers"),
)
_LISTS = {
    "he": (
        "a man, a man, a boy, an old man, a young man, a waiter, a gentleman, a policeman, a father, a brother, a "
        "husband, a grandfather, a king, a businessman, an actor, a guy"
    ),
    "she": (
        "a woman, a woman, a girl, an old woman, a young woman, a waitress, a lady, an actress, a mother, a "
        "sister, a wife, a grandmother, a queen, a businesswoman, a bride, a daughter"
    ),
    "they": (
        "a stranger, a child, a teacher, a student, a dancer, a neighbour, a guest, a colleague, a doctor, a "
        "player, a coach, a tourist, a customer, a guard, a soldier, a visitor, a boxer, a runner, a nurse, a "
        "clown, a thief, a driver, a boss, a worker, a passenger, a patient, a toddler, a partner, an opponent, a "
        "rival, an artist, a cook, a drunk, a commuter, a shopkeeper, a referee, a hiker, a monk, a pilot, a "
        "farmer"
    ),
}
_ROLES = {pronoun: names.split(", ") for pronoun, names in _LISTS.items()}


def draw_cast(rng: Rng, *, joint: bool = False) -> Cast:
    """Three of five times plain words ("one person"), else roles; of two who begin together mostly plain words."""
    if rng.random() < (0.85 if joint else 0.6):
        return _PLAIN[int(rng.integers(len(_PLAIN)))]
    pairs = (("he", "she"), ("she", "he"), ("he", "they"), ("they", "she"), ("they", "they"), ("she", "they"))
    pronouns = pairs[int(rng.integers(len(pairs)))]
    one, other = (_ROLES[p][int(rng.integers(len(_ROLES[p])))] for p in pronouns)
    if one == other:
        return draw_cast(rng, joint=joint)
    later = tuple(re.sub("^an? ", "the ", name) for name in (one, other))
    return Cast((one, other), (later[0], later[1]), pronouns, f"{one} and {other}")


class Names:
    """The names of a and b through one caption.

    Attributes:
        order: the people in the order in which the caption names them.
    """

    def __init__(self, rng: Rng, cast: Cast) -> None:
        self.rng, self.cast = rng, cast
        self.order: list[str] = []
        self.named: set[str] = set()
        self.together = False

    def _slot(self, who: str) -> int:
        if who not in self.order:
            self.order.append(who)
        return self.order.index(who)

    def _name(self, who: str) -> str:
        slot = self._slot(who)
        fresh = who not in self.named
        self.named.add(who)
        if fresh and self.together and self.cast.group is None:  # "two people …, one of them …"
            return ("one of them", "the other")[slot] if len(self.named) < 2 or slot else self.cast.later[slot]
        return self.cast.first[slot] if fresh and not self.together else self.cast.later[slot]

    def subject(self, people: str) -> str:
        """The subject of a clause: "a", "b" or "ab"."""
        if len(people) == 1:
            return self._name(people)
        if self.together or self.named:
            if len(self.named) == 1 and not self.together:
                self._name("b" if "a" in self.named else "a")
            self.together = True
            return ("they", "the two", "the two of them")[int(self.rng.integers(3))]  # "both" may be hands
        self.together = True
        for who in "ab":
            self._slot(who)
        group = self.cast.group
        return group or ("two people", "two people", "the two people", "they")[int(self.rng.integers(4))]

    def object(self, who: str, *, pronoun: bool = True) -> str:
        """The other person as an object; once named, half of the time "him" or "her" where a ``pronoun`` may stand."""
        known = self.cast.pronouns[self._slot(who)]
        if pronoun and who in self.named and known != "they" and self.rng.random() < 0.5:
            return OBJECTS[known]
        return self._name(who)

    def own(self, people: tuple[str, ...]) -> str:
        """ "his", "her" or "their": of the subject."""
        return "their" if len(people) == 2 else OWN[self.cast.pronouns[self._slot(people[0])]]
