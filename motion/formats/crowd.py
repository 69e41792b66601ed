"""Recordings, as readers find them in a file: everybody, as the file has them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.rigs import RigMotion

if TYPE_CHECKING:
    from .glb_animations import Animations

MAX_PEOPLE = 6


@dataclass(frozen=True, eq=False)
class Recording:
    """Everybody in a file, in its own axes.

    Attributes:
        people: on joints that are known, or on rigs of their own; up to :data:`MAX_PEOPLE`, who share one clock.
        usual_up: the axis that points up in such files, if there is one: it is taken unless the people stand along
            another.
        on_floor: heights count from nowhere, so that the lowest joint of all people is put on the floor.
        animations: those of a .glb file, and which of them this is.
        beside: what a duet holds beside two people: roles, manifest, things, grips and looks.
    """

    people: tuple[Clip, ...] | tuple[RigMotion, ...]
    usual_up: str = "y"
    on_floor: bool = False
    animations: Animations | None = None
    beside: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Crowd:
    """Three people or more in one world; they share one clock."""

    people: tuple[Clip, ...]


Motion = Clip | Duet | Crowd


def gathered(
    people: tuple[Clip, ...], label: str, *, everyone: bool, beside: Mapping[str, Any] | None = None
) -> Motion:
    """One person as a clip, two as a duet, more as a crowd.

    Raises:
        InputError: for more than :data:`MAX_PEOPLE`; for more than two unless ``everyone`` is wanted.
    """
    if len(people) > MAX_PEOPLE:
        raise InputError(f"{label} holds {len(people)} people: give {MAX_PEOPLE} or fewer a file.")
    if len(people) > 2 and not everyone:
        raise InputError(
            f"{label} holds {len(people)} people: choose one on the React tab, or save one or two of them."
        )
    if len(people) > 2:
        return Crowd(people)
    return Duet(*people, **(beside or {})) if len(people) == 2 else people[0]


def clips_of(motion: Motion) -> tuple[Clip, ...]:
    """Everybody in a motion."""
    return (motion,) if isinstance(motion, Clip) else motion.people
