"""Ways over the floor, as the network is given them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from webdemo.inference.actor import Placement
from webdemo.inference.known_parts import KnownPath, Part
from webdemo.inference.story.floor import Way2D
from webdemo.inference.story.plan import Window

Array = NDArray[np.floating]


def path_of(way: Way2D, window: Window, start: int, placement: Placement) -> list[Part]:
    """The part of a way that falls into a window."""
    frames = np.asarray(way.frames) + start
    inside = (frames >= window.start) & (frames < window.stop)
    headings = np.full(len(frames), np.nan) if way.headings is None else way.headings
    at = frames[inside] - window.start + window.past
    return known_paths(way.person, at, way.places[inside], headings[inside], placement)


def known_paths(
    person: int, frames: NDArray[np.integer], places: Array, headings: Array, placement: Placement
) -> list[Part]:
    """A way over the floor of the scene's world, as the network is given it.

    Args:
        person: 0 for a, 1 for b.
        frames: (N,) frames of the window, in order.
        places: (N, 2) x and z in metres.
        headings: (N,) radians from +Z towards +X; NaN where a person may face anywhere.
        placement: from the scene's world to the network's frame.
    """
    base = math.atan2(placement.turn[2, 0], placement.turn[0, 0])
    moved = placement.to_network(np.insert(places, 1, 0.0, axis=1))[:, [0, 2]]
    known = np.isfinite(headings)
    return [
        KnownPath(person, frames[own].tolist(), moved[own], headings[own] - base if turned else None, turned)
        for turned, own in ((True, known), (False, ~known))
        if own.any()
    ]
