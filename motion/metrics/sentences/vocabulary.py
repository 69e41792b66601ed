"""The words of the rules that say what happens at each frame, by name, and how they combine.

A predicate takes a :class:`~.joints.Motion`, people (0 is a, 1 is b) and numbers, and gives a (T,) mask. Lengths
are in metres, angles in degrees, speeds in metres a second; the defaults are what a viewer would accept.
:mod:`.paths` holds those of walking and looking, :mod:`.poses` those of bodies and arms, :mod:`.shapes` those
of limbs, levels and unison, :mod:`.touches` those of two people who touch.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .joints import Motion
from .stretches import Mask, stretches

PREDICATES: dict[str, Callable[..., Mask]] = {}
"""The predicates by the name that rules use."""


def predicate(function: Callable[..., Mask]) -> Callable[..., Mask]:
    """Adds a predicate to the vocabulary."""
    PREDICATES[function.__name__] = function
    return function


@predicate
def both(m: Motion, *masks: Mask) -> Mask:
    """All of them at once."""
    return np.logical_and.reduce(masks)


@predicate
def either(m: Motion, *masks: Mask) -> Mask:
    """At least one of them."""
    return np.logical_or.reduce(masks)


@predicate
def without(m: Motion, mask: Mask) -> Mask:
    """The frames where a predicate does not hold."""
    return ~mask


@predicate
def begins(m: Motion, mask: Mask, seconds: float = 0.3) -> Mask:
    """The first ``seconds`` of every stretch: a state that is entered, as a beat of its own."""
    found = np.zeros(m.frames, dtype=bool)
    for i, j in stretches(mask, m.fps):
        found[i : min(j, i + round(seconds * m.fps))] = True
    return found
