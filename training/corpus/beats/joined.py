"""Beats in which the two go or stand joined, hand in hand, an arm around the other or round each other, or go past."""

from __future__ import annotations

import numpy as np

from motion.vectors import wrapped

from ..compose import Array, steer
from ..contact import envelope
from ..cues import STILL
from ..library import pick, stride
from ..touches import Touches, arm_around, joined_hands, meet_hands, opposite
from .moves import abreast, ahead, come, leftwards, side_by_side
from .play import Effect, Play, bearing


def arm_around_beat(play: Play, i: int) -> None:
    """i stands beside the other and puts an arm around them."""
    rng = play.rng
    begun = play.sync()
    _, side = side_by_side(play, i, rng.uniform(0.43, 0.5))
    start = play.sync()
    if start - begun > 30:
        play.note(("join-side", STILL), begun, end=start, i=1 - i, minor=True)
    length = play.seconds(1.8, 3.0)
    for person in play.people:
        person.hold(length + 20)
    hand, own_rng = "left" if side > 0 else "right", np.random.default_rng(rng.integers(2**32))
    play.effect(start, start + length + 36, lambda a, b: arm_around(own_rng, a, b, 2, length, hand), i=i)
    play.note(("arm-around", STILL), start, i=i, sides=(hand, None))


def _held(sides: tuple[str, str], height: float, start: int, arrive: int, leave: int) -> Effect:
    """Hands joined from ``arrive`` to ``leave``, frames of the scene; the window begins at ``start``."""

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        weight = envelope(len(a), 0, arrive - start, leave - start, leave - start + 22)
        a, b = joined_hands(a, b, sides, height, 0.05, weight)
        return a, b, [(f"{sides[0]}_wrist", f"{sides[1]}_wrist", arrive - start, leave - start)]

    return effect


def hand_in_hand(play: Play, i: int) -> None:
    """They take each other by the hand and walk on, or stand so."""
    rng = play.rng
    begun = play.sync()
    gap = rng.uniform(0.55, 0.66)
    if rng.random() < 0.25:
        _, side = side_by_side(play, i, gap)
        start = play.sync()
        for person in play.people:
            person.hold(play.seconds(1.8, 3.0))
        name, stop = "hold-hands", play.frames
    else:
        start, stop, _, side = abreast(play, i, gap, (2.0, 2.8 if play.brisk else 4.2))
        name = "walk-hand-in-hand"
    if start - begun > 35:
        play.note(("join-side", STILL), begun, end=start - 14, i=1 - i, minor=True)
    hand = "left" if side > 0 else "right"
    taken = max(start - 14, begun)
    letting = play.frames - (0 if rng.random() < 0.5 else 8)
    play.effect(
        taken, letting + 22, _held((hand, opposite(hand)), rng.uniform(0.78, 0.86), taken, taken + 16, letting), i=i
    )
    play.note((name, name), taken, i=i)
    for k in (0, 1):
        play.look(k, start, stop, float(rng.uniform(0, 0.5)))


def carousel(play: Play, i: int) -> None:
    """Face to face, hands joined, they go round each other."""
    rng = play.rng
    start = come(play, i, rng.uniform(0.72, 0.86))
    side = pick(rng, ("left", "right"))
    radius = play.gap / 2
    walk = stride(rng, play.library, f"walk-{side}", radius * rng.uniform(2.5, 5.5), side=side)
    step = walk.motion.root[-1] - walk.motion.root[0]
    course = wrapped(float(np.arctan2(step[0], step[2]) - walk.motion.headings.mean()))
    aim = course - (1 if side == "left" else -1) * np.pi / 2
    steps = np.linalg.norm(np.diff(walk.motion.root[:, [0, 2]], axis=0), axis=-1)
    # Who steps to the left around a point ahead turns to the right.
    turn = (-1 if side == "left" else 1) * np.concatenate([[0.0], np.cumsum(steps)]) / radius
    for person in play.people:
        person.hold(16)
    for person in play.people:
        person.perform(steer(walk.motion, turn), aim=aim)
    stop = play.sync()
    for person in play.people:
        person.hold(14)
    height = rng.uniform(0.95, 1.1)

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        last = stop - start
        weight = envelope(len(a), 0, 18, last - 6, last + 14)
        pairs = (("left", "right"), ("right", "left"))
        a, b = meet_hands(a, b, pairs, (weight, weight), height=height, apart=0.08)
        return a, b, [(f"{own}_wrist", f"{to}_wrist", 18, last - 6) for own, to in pairs]

    play.effect(start, stop + 14, effect, i=i)
    play.note(("ring", "ring"), start, i=i)


def walk_past(play: Play, i: int) -> None:
    """Both go past each other without stopping."""
    rng = play.rng
    start = play.sync()
    styles = []
    aside = pick(rng, (-1, 1)) * rng.uniform(0.8, 1.1)
    spots = [person.spot for person in play.people]
    for k in (i, 1 - i):
        person, goal = play.people[k], spots[1 - k]
        way = bearing(goal - person.spot)
        target = goal + aside * leftwards(way) + rng.uniform(0.3, 0.8) * ahead(way)
        # Each keeps to their own side from the middle on.
        styles.append(person.go(target, None, stop=False).style)
    play.note(("walk-past", "walk-past"), start, i=i, styles=tuple(styles))


def skip_past(play: Play, i: int) -> None:
    """i skips past the other, who stands."""
    rng = play.rng
    start = play.sync()
    own, other = play.people[i], play.people[1 - i]
    way = bearing(other.spot - own.spot)
    aside = pick(rng, (-1, 1)) * rng.uniform(0.8, 1.1)
    target = other.spot + aside * leftwards(way) + rng.uniform(0.4, 1.2) * ahead(way)
    own.go(target, None, action="skip", stop=False)
    play.note(("skip", STILL), start, i=i)
