"""The entry of one family in the phrase book; the package's docstring explains the notation."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """The words of one family.

    Attributes:
        frames: how the two verb phrases are joined: "reply" (b answers a), "order" (one after the other)
            or "while" (at the same time).
        a, b: verb phrases of the two people.
        both: verb phrases with the two people as the subject.
        nouns: keyword-like prompts.
        sentences: whole sentences.
    """

    frames: str
    a: tuple[str, ...] = ()
    b: tuple[str, ...] = ()
    both: tuple[str, ...] = ()
    nouns: tuple[str, ...] = ()
    sentences: tuple[str, ...] = ()


WATCH = (
    "*watch( {them}|)",
    "*look on",
    "*stand (still |)and *watch",
    "*watch {other}",
    "*stand by",
    "*stand still",
)
"""What somebody does who only looks on; shared by families of several kinds."""
