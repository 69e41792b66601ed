"""Hands that meet: shaking, slapping, bumping, holding and giving."""

from __future__ import annotations

import numpy as np

from ..compose import ARMS, Array
from ..contact import (
    UP,
    axes,
    bend,
    envelope,
    meeting,
    nod,
    on_body,
    pose_arm,
    reach,
    settle,
    shaking,
    towards,
)
from ..library import Library
from ..scene import Scene
from ..stage import Rng
from . import register
from .meeting import Encounter, abreast, chosen_side, come_together, conclude, opposite, side_by_side

HIGH_ELBOW = (0.6, -0.7, 0.2)
_WRIST = {side: chain[3] for side, chain in ARMS.items()}


def _meet_hands(
    a: Array,
    b: Array,
    pairs: tuple[tuple[str, str], ...],
    weights: tuple[Array, Array],
    *,
    height: float,
    apart: float = 0.08,
    away: tuple[Array, Array] | None = None,
    elbow: tuple[float, float, float] = (0.45, -1.0, -0.25),
) -> tuple[Array, Array]:
    """Brings hands of the two together; ``away`` (T, 3) each moves a person's wrist off the meeting point."""
    targets: tuple[dict[str, Array], dict[str, Array]] = ({}, {})
    for own, other in pairs:
        points = meeting(a, b, own, other, height=height, apart=apart)
        for person, side in enumerate((own, other)):
            targets[person][side] = points[person] + (away[person] if away is not None else 0.0)
    a, b = reach(a, targets[0], weights[0], elbow=elbow), reach(b, targets[1], weights[1], elbow=elbow)
    for own, other in pairs:
        a, b = settle(a, b, (own, other), weights, apart=apart, away=away, elbow=elbow)
    return a, b


def _glance(rng: Rng, body: Array, weight: Array) -> Array:
    """A nod towards the hands, sometimes."""
    return nod(body, weight * rng.uniform(0.1, 0.3)) if rng.random() < 0.6 else body


@register("handshake", needs=("walk", "idle"), weight=3.0, contact=True)
def handshake(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.82, 0.98), (1.5, 3.2))
    a, b = meet.bodies()
    side, named = chosen_side(rng)
    frames, lead = len(a), int(rng.integers(0, 12))
    arrive = meet.start + lead + int(rng.integers(16, 24))
    leave = max(meet.stop - int(rng.integers(8, 14)), arrive + 18)
    end = leave + int(rng.integers(14, 22))
    weights = (
        envelope(frames, meet.start, arrive - 2, leave, end),
        envelope(frames, meet.start + lead, arrive, leave, end + int(rng.integers(-3, 4))),
    )
    shake = shaking(frames, arrive, leave, hertz=rng.uniform(2.0, 3.0), size=rng.uniform(0.02, 0.045))
    height = rng.uniform(0.98, 1.1)
    a, b = _glance(rng, a, weights[0]), _glance(rng, b, weights[1])
    away = shake[:, None] * UP
    a, b = _meet_hands(
        a, b, ((side, side),), weights, height=height, apart=rng.uniform(0.06, 0.09), away=(away, away)
    )
    wrist = f"{side}_wrist"
    return conclude(
        rng,
        library,
        "handshake",
        meet,
        a,
        b,
        touches=[(wrist, wrist, arrive, leave)],
        side=side if named else None,
    )


def _slap(
    rng: Rng,
    library: Library,
    family: str,
    pairs: tuple[tuple[str, str], ...],
    *,
    distance: tuple[float, float],
    height: tuple[float, float],
    offered: float = 0.0,
    approach: tuple[float, float] = (1.0, 0.15),
    elbow: tuple[float, float, float] = HIGH_ELBOW,
    pause: tuple[int, int] = (1, 5),
    apart: float = 0.075,
    named: bool = False,
) -> Scene:
    """Hands that are brought up, meet for a moment and go back.

    Args:
        offered: 0 both strike; 1 a holds the hand out and b strikes it.
        approach: share of the way that a striking hand comes from behind and from above.
        pause: frames for which the hands stay together.
    """
    meet = come_together(rng, library, rng.uniform(*distance), (1.3, 2.0))
    a, b = meet.bodies()
    frames = len(a)
    up_a = meet.start + int(rng.integers(14, 20))
    hit = up_a + int(rng.integers(8, 22))
    up_b = max(hit - int(rng.integers(8, 14)), meet.start + 12)
    stop = hit + int(rng.integers(*pause))
    end = stop + int(rng.integers(20, 28))
    weights = (
        envelope(frames, meet.start, up_a, stop + 4, end),
        envelope(frames, meet.start + 2 if offered == 0 else max(up_b - 20, 0), up_b, stop + 4, end + 2),
    )
    swing = 1 - envelope(frames, hit - 7, hit, stop, stop + 8)
    gap = rng.uniform(0.12, 0.2)
    line = towards(a[:, 0], b[:, 0])
    back, above = approach
    away = (
        swing[:, None] * gap * (1 - offered) * (-back * line + above * UP),
        swing[:, None] * gap * (1 + offered * 0.5) * (back * line + above * UP),
    )
    a, b = _meet_hands(a, b, pairs, weights, height=rng.uniform(*height), apart=apart, away=away, elbow=elbow)
    touches = [(f"{own}_wrist", f"{other}_wrist", hit - 1, stop + 1) for own, other in pairs]
    return conclude(rng, library, family, meet, a, b, touches=touches, side=pairs[0][0] if named else None)


@register("high-five", needs=("walk", "idle"), weight=2.5, contact=True)
def high_five(rng: Rng, library: Library) -> Scene:
    side, named = chosen_side(rng)
    return _slap(
        rng, library, "high-five", ((side, side),), distance=(0.76, 0.92), height=(1.48, 1.65), named=named,
        offered=float(rng.random() < 0.5),
    )  # fmt: skip


@register("low-five", needs=("walk", "idle"), weight=1.2, contact=True)
def low_five(rng: Rng, library: Library) -> Scene:
    side, named = chosen_side(rng)
    return _slap(
        rng, library, "low-five", ((side, side),), distance=(0.68, 0.82), height=(0.9, 1.02), offered=1.0,
        approach=(0.2, 1.2), elbow=(0.45, -1.0, -0.25), named=named,
    )  # fmt: skip


@register("high-ten", needs=("walk", "idle"), weight=1.5, contact=True)
def high_ten(rng: Rng, library: Library) -> Scene:
    return _slap(
        rng, library, "high-ten", (("left", "right"), ("right", "left")), distance=(0.66, 0.8),
        height=(1.45, 1.6), offered=float(rng.random() < 0.4),
    )  # fmt: skip


@register("fist-bump", needs=("walk", "idle"), weight=1.5, contact=True)
def fist_bump(rng: Rng, library: Library) -> Scene:
    side, named = chosen_side(rng)
    return _slap(
        rng, library, "fist-bump", ((side, side),), distance=(0.82, 0.98), height=(1.1, 1.26), apart=0.09,
        offered=float(rng.random() < 0.5), elbow=(0.7, -1.0, -0.2), pause=(2, 9), named=named,
    )  # fmt: skip


@register("elbow-bump", needs=("walk", "idle"), weight=1.0, contact=True)
def elbow_bump(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.46, 0.54), (1.3, 2.0))
    a, b = meet.bodies()
    side, named = chosen_side(rng)
    hit = meet.start + int(rng.integers(20, 28))
    stop = hit + int(rng.integers(3, 9))
    weight = envelope(len(a), meet.start, hit, stop, stop + int(rng.integers(18, 26)))
    middle = (on_body(a, f"{side}_shoulder", 0, -0.12, 0) + on_body(b, f"{side}_shoulder", 0, -0.12, 0)) / 2
    a, b = (bend(body, UP * ((0.5 if side == "right" else -0.5) * weight)[:, None]) for body in (a, b))
    solved = []
    for body in (a, b):
        left, forward = axes(body)
        out = left if side == "left" else -left
        upper = middle - on_body(body, f"{side}_shoulder", 0, 0, 0)
        solved.append(pose_arm(body, side, upper, -0.75 * out + 0.5 * UP + 0.25 * forward, weight))
    a, b = solved
    joint = f"{side}_elbow"
    return conclude(
        rng,
        library,
        "elbow-bump",
        meet,
        a,
        b,
        touches=[(joint, joint, hit, stop)],
        side=side if named else None,
    )


@register("hand-over", needs=("walk", "idle"), weight=2.0, contact=True)
def hand_over(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.85, 1.02), (1.8, 2.8), leave=0.25)
    a, b = meet.bodies()
    side, named = chosen_side(rng)
    taking = side if rng.random() < 0.7 else opposite(side)
    frames = len(a)
    offered = meet.start + int(rng.integers(16, 24))
    grasp = offered + int(rng.integers(4, 16))
    release = grasp + int(rng.integers(5, 12))
    done = release + int(rng.integers(12, 18))
    weights = (
        envelope(frames, meet.start, offered, release, done),
        envelope(frames, max(grasp - 20, 0), grasp, release + 4, release + int(rng.integers(26, 40))),
    )
    # b draws the thing in after a has let go: the hand goes to the own belly first.
    height = rng.uniform(1.0, 1.15)
    points = meeting(a, b, side, taking, height=height, apart=rng.uniform(0.08, 0.095))
    drawn = envelope(frames, release, release + 14, frames, frames + 1)[:, None]
    own = on_body(b, "spine1", 0.1 if taking == "left" else -0.1, 0.12, 0.28)
    a, b = _glance(rng, a, weights[0]), _glance(rng, b, weights[1])
    a = reach(a, {side: points[0]}, weights[0])
    b = reach(b, {taking: points[1] * (1 - drawn) + own * drawn}, weights[1])
    return conclude(
        rng, library, "hand-over", meet, a, b,
        touches=[(f"{side}_wrist", f"{taking}_wrist", grasp, release)], side=side if named else None,
    )  # fmt: skip


def _joined(
    rng: Rng,
    meet: Encounter,
    a: Array,
    b: Array,
    sides: tuple[str, str],
    height: float,
    forward: float,
    weight: Array,
) -> tuple[Array, Array]:
    """Hands that hold each other, carried along between the two."""
    points = meeting(a, b, *sides, height=height, apart=0.07)
    line = towards(points[0], points[1])
    ahead = forward * axes(a)[1]
    swing = 0.25 * (a[:, _WRIST[sides[0]]] - a[:, 0])
    ahead = ahead + swing * np.array([1.0, 0.0, 1.0]) - line * np.sum(swing * line, axis=-1, keepdims=True)
    return (
        reach(a, {sides[0]: points[0] + ahead}, weight, twist=0.25, lean=0.1),
        reach(b, {sides[1]: points[1] + ahead}, weight, twist=0.25, lean=0.1),
    )


@register("hold-hands", needs=("idle",), weight=1.3, contact=True)
def hold_hands(rng: Rng, library: Library) -> Scene:
    side = "left" if rng.random() < 0.5 else "right"
    meet = side_by_side(rng, library, rng.uniform(0.5, 0.65), (2.0, 4.0), side=side)
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.6), rng.uniform(0, 0.6)))
    arrive, end = meet.start + 20, min(meet.stop + 20, len(a) - 1)
    weight = envelope(len(a), meet.start, arrive, meet.stop, end)
    if rng.random() < 0.4:  # they hold hands all along
        arrive, weight = 0, np.ones(len(a))
    a, b = _joined(rng, meet, a, b, (side, opposite(side)), rng.uniform(0.78, 0.86), 0.06, weight)
    touches = [(f"{side}_wrist", f"{opposite(side)}_wrist", arrive, meet.stop)]
    return conclude(rng, library, "hold-hands", meet, a, b, touches=touches)


@register("walk-hand-in-hand", needs=("walk",), weight=1.3, contact=True)
def walk_hand_in_hand(rng: Rng, library: Library) -> Scene:
    side = "left" if rng.random() < 0.5 else "right"
    gap = rng.uniform(0.55, 0.68) * (1 if side == "left" else -1)
    meet = abreast(rng, library, float(rng.normal(0, 0.03)), gap, int(rng.uniform(3, 6) * 30))
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.4), rng.uniform(0, 0.4)))
    weight = np.ones(len(a))
    a, b = _joined(rng, meet, a, b, (side, opposite(side)), rng.uniform(0.78, 0.86), 0.05, weight)
    meet.events["distance"] = "keep"
    touches = [(f"{side}_wrist", f"{opposite(side)}_wrist", 0, len(a))]
    return conclude(rng, library, "walk-hand-in-hand", meet, a, b, touches=touches)


@register("lead-by-hand", needs=("walk",), weight=1.3, contact=True)
def lead_by_hand(rng: Rng, library: Library) -> Scene:
    side = "left" if rng.random() < 0.5 else "right"
    left = rng.uniform(0.2, 0.4) * (1 if side == "left" else -1)
    meet = abreast(rng, library, -rng.uniform(0.6, 0.75), left, int(rng.uniform(3, 6) * 30))
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.5), rng.uniform(0.3, 0.6)))
    weight = np.ones(len(a))
    taking = opposite(side) if rng.random() < 0.6 else side
    a, b = _joined(rng, meet, a, b, (side, taking), rng.uniform(0.85, 0.95), 0.0, weight)
    meet.events["distance"] = "keep"
    touches = [(f"{side}_wrist", f"{taking}_wrist", 0, len(a))]
    return conclude(rng, library, "lead-by-hand", meet, a, b, touches=touches)
