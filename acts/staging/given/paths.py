"""Ways over the floor, as the network is given them."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from motion.placement import Placement

from ..bodies.gaits import low_gait
from ..parts import KnownPath, Part
from ..sampled import Way2D
from .stretch import Stretch

Array = NDArray[np.floating]

OFTEN = 3
"""Frames between two given poses of a person who goes low over the floor."""
GETS_DOWN = 40
"""Frames in which somebody gets down on hands and knees."""


def path_of(way: Way2D, stretch: Stretch) -> list[Part]:
    """The part of a way that falls into a window."""
    frames = np.asarray(way.frames)
    inside = np.isin(frames, stretch.shown(frames))
    headings = np.full(len(frames), np.nan) if way.headings is None else way.headings
    at = np.asarray(stretch.in_window(frames[inside]), dtype=int)
    return known_paths(way.person, at, way.places[inside], headings[inside], stretch.placement)


def given_gait(gait: str, person: int, down: Collection[int], stretch: Stretch) -> list[Part]:
    """The poses of a person who crawls or walks on the knees along a way.

    Args:
        gait: of :data:`acts.staging.bodies.gaits.GAITS`.
        person: 0 for a, 1 for b.
        down: the people who are down already when the beat begins; the others get down first.
        stretch: the beat.
    """
    course = stretch.course(person)
    poses = low_gait(gait, course.places, course.headings)
    first = GETS_DOWN if stretch.start and person not in down else 0
    frames = np.union1d(np.arange(first, stretch.frames, OFTEN), [stretch.frames - 1])
    frames = stretch.shown(frames)
    return [stretch.given(person, frames, poses[frames])] if len(frames) else []


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
