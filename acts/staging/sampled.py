"""The places and headings of a planned way that the network is given."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .track import Track

Array = NDArray[np.floating]

EVERY = 30
"""Frames between two given places."""
STEP = math.pi / 3
"""Radians of a turn between two given headings."""


@dataclass(frozen=True, eq=False)
class Way2D:
    """The places and headings of one person at some frames of a beat.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N frames of the beat, in order.
        places: (N, 2) metres.
        headings: (N,) radians; None where they may look where they like.
    """

    person: int
    frames: Sequence[int]
    places: Array
    headings: Array | None


def sampled(who: int, track: Track, *, first: bool) -> Way2D | None:
    """The way at every :data:`EVERY` frames and at the last one that is planned; also where it begins, if ``first``."""
    known = np.flatnonzero(np.isfinite(track.places[:, 0]))
    if not len(known):
        return None
    wanted = {
        *known[known % EVERY == EVERY - 1].tolist(),
        *(track.dense & set(known.tolist())),
        int(known[-1]),
        *([0] if first else []),
    }
    frames = [f for f in _with_turns(sorted(wanted), track.headings) if np.isfinite(track.places[f, 0])]
    headings = track.headings[frames]
    facing = np.isfinite(headings)
    return Way2D(who, frames, track.places[frames], np.where(facing, headings, np.nan) if facing.any() else None)


def _with_turns(frames: Sequence[int], headings: Array) -> list[int]:
    """The frames, with more of them where somebody turns: a network that is free there turns them within a few."""
    found = list(frames)
    for first, last in itertools.pairwise([0, *frames]):
        turned = abs(headings[last] - headings[first])
        if turned > STEP:  # false where either heading is free
            gone = np.abs(headings[first : last + 1] - headings[first])
            each = turned / math.ceil(turned / STEP)
            found += [first + int(np.argmax(gone >= share)) for share in np.arange(each, turned - 0.01, each)]
    return sorted(set(found))
