"""Seats under people who sit, tables before them, and door frames about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from motion.metrics.sentences.stretches import stretches
from motion.things import Thing, shape

from .holding import Hands, level, yaw_of
from .uses import Use

Array = NDArray[np.floating]

UNDER_HIP = 0.095
"""Metres from the joints of the hips down to the seat, of a person who sits."""
LOWEST, HIGHEST = 0.28, 0.75
"""Heights in metres between which a seat can be; people who are lower sit on the floor."""
_BESIDE = 1.6
"""Metres between two people, at most, who share a bench."""
_BACK = 0.06
"""Metres by which the middle of a seat lies before the pelvis."""
_AT_TABLE = 0.62
"""Metres from the pelvis to the middle of a table at which somebody sits."""


def seated(hands: Hands, person: int, start: int, stop: int) -> tuple[int, int] | None:
    """The frames of the longest rest with the hips at the height of a seat and the knees bent, or None.

    ``start`` and ``stop`` are those of the act; people stay seated beyond it.
    """
    hips = (hands.joint(person, "left_hip") + hands.joint(person, "right_hip")) / 2
    knees = np.minimum(hands.joint(person, "left_knee")[:, 1], hands.joint(person, "right_knee")[:, 1])
    low = (hips[:, 1] - UNDER_HIP < HIGHEST) & (hips[:, 1] - UNDER_HIP > LOWEST)
    bent = hips[:, 1] - knees < 0.25  # the thighs are nearly level
    still = np.linalg.norm(np.gradient(hips, axis=0), axis=1) * hands.fps < 0.35
    found = [
        (i, j) for i, j in stretches(low & bent & still, hands.fps, pause=0.3) if j > start and i < stop + hands.fps
    ]
    if not found:
        return None
    best = max(found, key=lambda each: each[1] - each[0])
    return best if best[1] - best[0] >= 0.4 * hands.fps else None


def furniture(hands: Hands, uses: Sequence[Use]) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """The seats, tables and door frames of some uses, each with the people whom it is for."""
    taken: set[tuple[int, int]] = set()
    for use in uses:
        if use.does == "passes":
            yield from _doors(hands, use)
        if use.does != "sits":
            continue
        rests = {who: rest for who in use.agents if (rest := seated(hands, who, use.start, use.stop))}
        rests = {who: rest for who, rest in rests.items() if (who, rest[0]) not in taken}
        taken |= {(who, rest[0]) for who, rest in rests.items()}
        spots = {who: _spot(hands, who, rest) for who, rest in rests.items()}
        kind = use.kind or "chair"
        if len(spots) == 2 and kind == "bench" and (shared := _shared(hands, use, spots)):
            yield use, tuple(spots), shared
        else:
            for who, (hips, ahead, height) in spots.items():
                yield use, (who,), _seat(kind, use.name, hips, ahead, height, hands.frames)
        if use.on and spots:
            yield from _tables(hands, use, spots)


Spot = tuple[Array, Array, float]
"""The place where hips rest (3,), the way they face (3,), and the height of a seat under them."""


def _spot(hands: Hands, person: int, rest: tuple[int, int]) -> Spot:
    part = slice(*rest)
    hips = ((hands.joint(person, "left_hip") + hands.joint(person, "right_hip")) / 2)[part]
    knees = ((hands.joint(person, "left_knee") + hands.joint(person, "right_knee")) / 2)[part]
    ahead = level(np.median(knees - hips, axis=0))
    return np.median(hips, axis=0), ahead, float(np.percentile(hips[:, 1], 20) - UNDER_HIP)


def _seat(kind: str, name: str, hips: Array, ahead: Array, height: float, frames: int) -> Thing:
    place = hips + _BACK * ahead
    yaw = yaw_of(ahead)
    if kind == "bed":  # people sit on its side
        place, yaw = place - 0.3 * ahead, yaw - np.pi / 2
    return Thing.at_rest(kind, shape(kind, height=round(height, 2)), place * [1, 0, 1], yaw, frames, name)


def _shared(hands: Hands, use: Use, spots: dict[int, Spot]) -> Thing | None:
    """One bench for two who sit beside each other."""
    (one, one_ahead, low), (other, other_ahead, high) = spots.values()
    gap = float(np.linalg.norm((other - one)[[0, 2]]))
    ahead = level(one_ahead + other_ahead)
    across = abs(float((other - one) @ ahead))
    if gap > _BESIDE or one_ahead @ other_ahead < 0.7 or across > 0.3:
        return None
    width = round(min(max(gap + 0.8, 1.3), 2.6), 1)
    place = ((one + other) / 2 + _BACK * ahead) * [1, 0, 1]
    mesh = shape("bench", height=round(min(low, high), 2), width=width)
    return Thing.at_rest("bench", mesh, place, yaw_of(ahead), hands.frames, use.name)


def _tables(hands: Hands, use: Use, spots: dict[int, Spot]) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """One table between two who face each other across less than two metres, or one before each."""
    pairs = list(spots.values())
    if len(pairs) == 2 and pairs[0][1] @ pairs[1][1] < -0.5:
        gap = float(np.linalg.norm((pairs[0][0] - pairs[1][0])[[0, 2]]))
        if gap < 2.4:
            middle = (pairs[0][0] + pairs[1][0]) / 2 * [1, 0, 1]
            mesh = shape("table", width=round(max(min(1.2, (gap - 0.7) / 0.9), 0.5), 2))
            yield use, tuple(spots), Thing.at_rest("table", mesh, middle, yaw_of(pairs[0][1]), hands.frames)
            return
    for who, (hips, ahead, _) in spots.items():
        place = (hips + (_AT_TABLE + 0.2) * ahead) * [1, 0, 1]
        yield use, (who,), Thing.at_rest(use.on, shape(use.on), place, yaw_of(-ahead), hands.frames)


def _doors(hands: Hands, use: Use) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """A door frame half way along the path of the person who goes furthest."""
    part = slice(use.start, max(use.stop, use.start + 1))
    ways = {who: hands.joint(who, "pelvis")[part] for who in use.agents}
    who = max(ways, key=lambda person: float(np.linalg.norm((ways[person][-1] - ways[person][0])[[0, 2]])))
    way = ways[who]
    ahead = way[-1] - way[0]
    if np.linalg.norm(ahead[[0, 2]]) < 1.0:
        return
    middle = way[int(np.linalg.norm((way - way[0])[:, [0, 2]], axis=1).searchsorted(np.linalg.norm(ahead[[0, 2]]) / 2))]
    door = Thing.at_rest(
        "door frame", shape("door frame"), middle * [1, 0, 1], yaw_of(level(ahead)), hands.frames, "door"
    )
    yield use, use.agents, door
