"""A verb of a text with its arguments, and whom or what these stand for: what frames are held against."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class Ref:
    """The person, part of the body or thing that a noun or pronoun stands for.

    Attributes:
        kind: "person", "part", "self", "each" (each other), "thing", "third" (a person who is neither of the two).
        who: the people, "a", "b" or "ab"; of a part or a thing, its owner, "" where the words leave that open.
        lemma: of the head.
        family: of a part: "hand", "head", ….
        side: of a part, "left", "right" or "both".
        place: a thing where people can be, as a room.
        bare: a thing in the singular without an article, as in "in surprise"; a part without a possessive.
        definite: of a part, behind "the".
        first, last: character offsets in the text that was parsed.
    """

    kind: Literal["person", "part", "self", "each", "thing", "third"]
    who: str = ""
    lemma: str = ""
    family: str = ""
    side: str = ""
    place: bool = False
    bare: bool = False
    definite: bool = False
    first: int = 0
    last: int = 0


@dataclass
class Event:
    """A verb of the text with its arguments.

    Attributes:
        lemma: of the verb.
        subject, object, dative: its arguments.
        words: lemmas of particles, adverbs and complements beside it.
        particles: those of ``words`` that belong to the verb, as "up" in "picks up".
        prepositions: (preposition, argument).
        denied, modality: of the clause.
        ongoing: it goes on when the clause begins, as in "is sitting" and "keeps walking".
        state: a phrase says it that hangs on a noun, as in "the lady on the bench".
        joint: how it is joined to event ``beside``, as in :class:`acts.plan.Relation`.
        first, last: character offsets in the text that was parsed.
        goes: its verb means that somebody moves, so that a particle may just say where to, as in "jumps out".
        adverbs, seconds, times, distance, direction, side: modifiers.
    """

    lemma: str
    subject: Ref | None = None
    object: Ref | None = None
    dative: Ref | None = None
    words: list[str] = field(default_factory=list)
    particles: list[str] = field(default_factory=list)
    prepositions: list[tuple[str, Ref]] = field(default_factory=list)
    denied: bool = False
    ongoing: bool = False
    state: bool = False
    modality: str = "told"
    joint: str = ""
    beside: int | None = None
    first: int = 0
    last: int = 0
    adverbs: list[str] = field(default_factory=list)
    seconds: float | None = None
    times: int | None = None
    distance: float | None = None
    direction: str | None = None
    side: str | None = None
    goes: bool = False
    noun: Event | None = None
    """The same with the verb that its noun stands for: "gives a hug" as "hugs"."""
