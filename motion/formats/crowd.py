"""Several people in one file, of whom one or two are chosen."""

from __future__ import annotations

from dataclasses import dataclass

from motion.clip import Clip, Duet
from motion.errors import InputError

MAX_PEOPLE = 6


@dataclass(frozen=True, eq=False)
class Crowd:
    """Three people or more in one world; they share one clock."""

    people: tuple[Clip, ...]


Motion = Clip | Duet | Crowd


def gathered(people: tuple[Clip, ...], label: str, *, everyone: bool) -> Motion:
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
    return Duet(*people) if len(people) == 2 else people[0]


def clips_of(motion: Motion) -> tuple[Clip, ...]:
    """Everybody in a motion."""
    return (motion,) if isinstance(motion, Clip) else motion.people
