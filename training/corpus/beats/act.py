"""One thing that a person can do alone, and a record of how it was done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .play import Play


@dataclass(frozen=True)
class Done:
    """A performed act.

    Attributes:
        start, stop: its frames on the person's timeline.
        side: the hand or foot that leads.
        style: the actor's manner.
    """

    start: int
    stop: int
    side: str | None = None
    style: str = "normal"


Make = Callable[[Play, int], Done]


@dataclass(frozen=True)
class Act:
    """One thing that a person can do.

    Attributes:
        make: (play, person) -> how it was done.
        needs: source actions it is made of.
        weight: how often it is drawn.
        room: metres that must be free in front.
    """

    make: Make
    needs: tuple[str, ...]
    weight: float = 1.0
    room: float = 0.9
