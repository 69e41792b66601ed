"""Looks of the two people of a scene: the bodies that ship, chosen by what words say about them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .errors import InputError

LOOKS = ("man", "woman", "old-man", "old-woman")
"""Names of the bodies in ``static/bodies``."""
UNSAID = ("man", "woman")
"""The looks of a and b where nothing is said."""


def looks_of(people: Sequence[tuple[str, str]]) -> tuple[str, str]:
    """The looks of two people.

    A person whose sex is not said takes the one that the other has not, so that the two can be told apart. A child
    wears an adult's body: motion is made at an adult's size.

    Args:
        people: (sex, age) of a and b; sex "m", "f" or "", age "old", "child" or "".
    """
    (one, _), (other, _) = people
    if not one and not other:
        sexes = ("m", "f")
    else:
        opposite = {"m": "f", "f": "m"}
        sexes = (one or opposite[other], other or opposite[one])
    a, b = (
        ("old-" if age == "old" else "") + ("man" if sex == "m" else "woman")
        for sex, (_, age) in zip(sexes, people, strict=True)
    )
    return a, b


def checked(looks: Any) -> tuple[str, str]:
    """Two names of :data:`LOOKS` from outside.

    Raises:
        InputError: for anything else.
    """
    if isinstance(looks, (list, tuple)) and len(looks) == 2 and all(look in LOOKS for look in looks):
        return looks[0], looks[1]
    raise InputError(f"The looks of two people are two of {', '.join(LOOKS)}.")
