"""Touches between hands, and between a hand and the other's body, for people who already stand in place.

Each function takes the positions of two people (T, 22, 3) and the frames between which they stand within reach. It
returns the changed positions and the touches: (joint of a, joint of b, first frame, last frame).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from motion.skeleton import SMPL22
from motion.vectors import unit

from .compose import ARMS, Array
from .contact import (
    UP,
    axes,
    bend,
    envelope,
    lean_to,
    meeting,
    nod,
    on_body,
    reach,
    reach_arm,
    settle,
    shaking,
    shift_hips,
    towards,
)

Rng = np.random.Generator
Touches = list[tuple[str, str, int, int]]
Touched = tuple[Array, Array, Touches]

HIGH_ELBOW = (0.6, -0.7, 0.2)
_WRIST = {side: chain[3] for side, chain in ARMS.items()}


@dataclass(frozen=True)
class Touch:
    """One way to touch.

    Attributes:
        make: (rng, a, b, start, stop, side of a's hand) -> positions and touches.
        distance: metres between the roots, face to face.
        hold: seconds within reach.
    """

    make: Callable[[Rng, Array, Array, int, int, str], Touched]
    distance: tuple[float, float]
    hold: tuple[float, float]


def opposite(side: str) -> str:
    """The other side: "left" for "right" and the other way around."""
    return "left" if side == "right" else "right"


def timing(rng: Rng, start: int, stop: int, *, last: int = 10) -> tuple[int, int, int]:
    """Frames at which a hand arrives, lets go and is back."""
    arrive = start + int(rng.integers(16, 24))
    leave = max(stop - last, arrive + 12)
    return arrive, leave, leave + int(rng.integers(16, 24))


def glance(rng: Rng, body: Array, weight: Array) -> Array:
    """A nod towards the hands, sometimes."""
    return nod(body, weight * rng.uniform(0.1, 0.3)) if rng.random() < 0.6 else body


def meet_hands(
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
    """Brings hands of the two together; ``away``, (T, 3) for each person, offsets their wrist from there."""
    targets: tuple[dict[str, Array], dict[str, Array]] = ({}, {})
    for own, other in pairs:
        points = meeting(a, b, own, other, height=height, apart=apart)
        for person, side in enumerate((own, other)):
            targets[person][side] = points[person] + (away[person] if away is not None else 0.0)
    a, b = reach(a, targets[0], weights[0], elbow=elbow), reach(b, targets[1], weights[1], elbow=elbow)
    for own, other in pairs:
        a, b = settle(a, b, (own, other), weights, apart=apart, away=away, elbow=elbow)
    return a, b


def handshake(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """Two people walk up to each other and shake hands."""
    frames, lead = len(a), int(rng.integers(0, 12))
    arrive = start + lead + int(rng.integers(16, 24))
    leave = max(stop - int(rng.integers(8, 14)), arrive + 18)
    end = leave + int(rng.integers(14, 22))
    weights = (
        envelope(frames, start, arrive - 2, leave, end),
        envelope(frames, start + lead, arrive, leave, end + int(rng.integers(-3, 4))),
    )
    shake = shaking(frames, arrive, leave, hertz=rng.uniform(2.0, 3.0), size=rng.uniform(0.02, 0.045))
    height = rng.uniform(0.98, 1.1)
    a, b = glance(rng, a, weights[0]), glance(rng, b, weights[1])
    away = shake[:, None] * UP
    apart = rng.uniform(0.06, 0.09)
    a, b = meet_hands(a, b, ((side, side),), weights, height=height, apart=apart, away=(away, away))
    wrist = f"{side}_wrist"
    return a, b, [(wrist, wrist, arrive, leave)]


@dataclass(frozen=True)
class Slap:
    """Hands that rise, meet for a moment and return.

    Attributes:
        mirrored: both hands of each meet, left on right; else the same hand of each.
        height: of the meeting point, metres.
        offering: probability that a holds the hand out and b strikes it; otherwise both strike.
        approach: how far a striking hand comes from behind and from above, as a share of its path.
        elbow: direction of the elbows.
        pause: frames for which the hands stay together.
        apart: metres between the wrists.
    """

    height: tuple[float, float]
    offering: float
    mirrored: bool = False
    approach: tuple[float, float] = (1.0, 0.15)
    elbow: tuple[float, float, float] = HIGH_ELBOW
    pause: tuple[int, int] = (1, 5)
    apart: float = 0.075

    def __call__(self, rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
        """The touch of two people (T, 22, 3) from one frame to another, with the hands of a side."""
        pairs = (("left", "right"), ("right", "left")) if self.mirrored else ((side, side),)
        offered = float(rng.random() < self.offering)
        frames = len(a)
        up_a = start + int(rng.integers(14, 20))
        hit = up_a + int(rng.integers(8, 22))
        up_b = max(hit - int(rng.integers(8, 14)), start + 12)
        stop = hit + int(rng.integers(*self.pause))
        end = stop + int(rng.integers(20, 28))
        weights = (
            envelope(frames, start, up_a, stop + 4, end),
            envelope(frames, start + 2 if offered == 0 else max(up_b - 20, 0), up_b, stop + 4, end + 2),
        )
        swing = 1 - envelope(frames, hit - 7, hit, stop, stop + 8)
        gap = rng.uniform(0.12, 0.2)
        line = towards(a[:, 0], b[:, 0])
        back, above = self.approach
        away = (
            swing[:, None] * gap * (1 - offered) * (-back * line + above * UP),
            swing[:, None] * gap * (1 + offered * 0.5) * (back * line + above * UP),
        )
        height = rng.uniform(*self.height)
        a, b = meet_hands(a, b, pairs, weights, height=height, apart=self.apart, away=away, elbow=self.elbow)
        return a, b, [(f"{own}_wrist", f"{other}_wrist", hit - 1, stop + 1) for own, other in pairs]


def elbow_bump(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """Two people bump elbows."""
    hit = start + int(rng.integers(20, 28))
    stop = hit + int(rng.integers(3, 9))
    weight = envelope(len(a), start, hit, stop, stop + int(rng.integers(18, 26)))
    middle = (on_body(a, f"{side}_shoulder", 0, -0.12, 0) + on_body(b, f"{side}_shoulder", 0, -0.12, 0)) / 2
    a, b = (bend(body, UP * ((0.5 if side == "right" else -0.5) * weight)[:, None]) for body in (a, b))
    solved = []
    for body in (a, b):
        left, forward = axes(body)
        out = left if side == "left" else -left
        _, shoulder, elbow, wrist = ARMS[side]
        upper, lower = SMPL22.bone_lengths[[elbow, wrist]]
        bent = body[:, shoulder] + upper * unit(middle - body[:, shoulder])
        hand = bent + lower * unit(-0.75 * out + 0.5 * UP + 0.25 * forward)
        solved.append(reach_arm(body, side, hand, weight, elbow=(0.5, -0.4, 1.0)))
    joint = f"{side}_elbow"
    return solved[0], solved[1], [(joint, joint, hit, stop)]


def hand_over(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """A hands something to B."""
    taking = side if rng.random() < 0.7 else opposite(side)
    frames = len(a)
    offered = start + int(rng.integers(16, 24))
    grasp = offered + int(rng.integers(4, 16))
    release = grasp + int(rng.integers(5, 12))
    done = release + int(rng.integers(12, 18))
    weights = (
        envelope(frames, start, offered, release, done),
        envelope(frames, max(grasp - 20, 0), grasp, release + 4, release + int(rng.integers(26, 40))),
    )
    # b draws the thing in after a has let go: the hand goes to the own belly first.
    height = rng.uniform(1.0, 1.15)
    points = meeting(a, b, side, taking, height=height, apart=rng.uniform(0.08, 0.095))
    drawn = envelope(frames, release, release + 14, frames, frames + 1)[:, None]
    own = on_body(b, "spine1", 0.1 if taking == "left" else -0.1, 0.12, 0.28)
    a, b = glance(rng, a, weights[0]), glance(rng, b, weights[1])
    a = reach(a, {side: points[0]}, weights[0])
    b = reach(b, {taking: points[1] * (1 - drawn) + own * drawn}, weights[1])
    return a, b, [(f"{side}_wrist", f"{taking}_wrist", grasp, release)]


def joined_hands(
    a: Array, b: Array, sides: tuple[str, str], height: float, forward: float, weight: Array
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


def hug(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """``side``: the arm that goes over the other's shoulder."""
    frames = len(a)
    start = max(start - 10, 0)
    arrive, leave = start + int(rng.integers(24, 32)), max(stop - 4, start + 44)
    lag = int(rng.integers(0, 12))
    weights = [envelope(frames, start + late, arrive + late, leave, leave + 24) for late in (0, lag)]
    # Each head goes past the other's: the trunks lean in and a little to the same own side.
    upright = (a, b)
    a, b = (
        lean_to(
            body,
            towards(body[:, 0], other[:, 0]) + (0.35 if side == "right" else -0.35) * axes(body)[0],
            weight * rng.uniform(0.08, 0.16),
        )
        for body, other, weight in zip(upright, upright[::-1], weights, strict=True)
    )
    under = opposite(side)
    # On the side where a's arm goes over, b's goes under it, since the two face each other.
    solved = []
    for body, other, weight in ((a, b, weights[0]), (b, a, weights[1])):
        sign = 1.0 if side == "right" else -1.0  # one's right hand comes to the other's left
        high = on_body(other, "spine3", 0.13 * sign, rng.uniform(0.06, 0.14), -rng.uniform(0.05, 0.1))
        low = on_body(other, "spine2", -0.15 * sign, rng.uniform(0.0, 0.06), -rng.uniform(0.02, 0.07))
        body = reach_arm(body, side, high, weight, elbow=(1.0, 0.1, 0.25))
        solved.append(reach_arm(body, under, low, weight, elbow=(1.0, -0.45, 0.2)))
    touches = [(f"{hand}_wrist", joint, arrive, leave) for hand, joint in ((side, "spine3"), (under, "spine2"))]
    return solved[0], solved[1], touches


def pats(rng: Rng, frames: int, arrive: int, leave: int) -> Array:
    """(frames,) metres by which a patting hand is lifted off."""
    time = (np.arange(frames) - arrive) / 30
    inside = envelope(frames, arrive, arrive + 4, max(leave - 6, arrive + 5), max(leave, arrive + 9))
    return rng.uniform(0.05, 0.1) * inside * (0.5 - 0.5 * np.cos(2 * np.pi * rng.uniform(2.2, 3.2) * time))


def pat_back(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b stands beside and a little in front of a."""
    arrive, leave, end = timing(rng, start, stop)
    weight = envelope(len(a), start, arrive, leave, end)
    b = bend(b, np.cross(UP, axes(b)[1]) * 0.08 * weight[:, None])
    lift = pats(rng, len(a), arrive, leave)
    hand = on_body(b, "spine3", -0.04 if side == "left" else 0.04, rng.uniform(-0.04, 0.04), -0.14)
    hand = hand - axes(b)[1] * lift[:, None]
    a = reach(a, {side: hand}, weight, elbow=(0.8, -0.7, -0.2))
    return a, b, [(f"{side}_wrist", "spine3", arrive, leave)]


@dataclass(frozen=True)
class HandOnShoulder:
    """A hand laid on the other's shoulder; with ``pat`` it pats."""

    pat: bool

    def __call__(self, rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
        """The touch of two people (T, 22, 3) from one frame to another, with the hands of a side."""
        arrive, leave, end = timing(rng, start, stop)
        weight = envelope(len(a), start, arrive, leave, end)
        hand = on_body(b, f"{opposite(side)}_shoulder", 0.0, 0.06, 0.05)
        if self.pat:
            hand = hand + UP * pats(rng, len(a), arrive, leave)[:, None]
        a = reach(a, {side: hand}, weight, elbow=(0.6, -0.9, 0.0))
        if rng.random() < 0.5:
            b = nod(b, weight * rng.uniform(0.05, 0.25))
        return a, b, [(f"{side}_wrist", f"{opposite(side)}_shoulder", arrive, leave)]


def arm_around(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b stands on a's ``side``, both look the same way."""
    arrive, leave, end = timing(rng, start, stop, last=0)
    weight = envelope(len(a), start, arrive, leave, end)
    sign = 1.0 if side == "left" else -1.0  # b's far shoulder is on the side on which b stands
    # Up over the shoulders first, then down on the far one.
    hand = on_body(b, f"{side}_shoulder", 0.02 * sign, 0.05, -0.04)
    left, _ = axes(a)
    a = lean_to(a, left * sign, weight * rng.uniform(0.04, 0.09))
    raised = hand + UP * (0.12 * (1 - weight[:, None]))
    a = reach(a, {side: raised}, weight, elbow=(0.3, -0.4, -1.0), twist=-0.25)
    return a, b, [(f"{side}_wrist", f"{side}_shoulder", arrive, leave)]


def whisper(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b stands beside and a little in front of a."""
    arrive, leave, end = timing(rng, start, stop)
    weight = envelope(len(a), start, arrive, leave, end)
    head = SMPL22.index("head")
    b = lean_to(b, towards(b[:, 0], a[:, 0]), weight * rng.uniform(0.04, 0.12))
    middle = (arrive + leave) // 2
    way = towards(a[:, head], b[:, head])
    near = rng.uniform(0.2, 0.25)
    for _ in range(2):
        missing = float(np.linalg.norm((b - a)[middle, head][[0, 2]])) - near
        a = lean_to(a, way, weight * float(np.clip(missing / 0.62, -0.2, 0.4)))
    missing = float(np.linalg.norm((b - a)[middle, head][[0, 2]])) - near
    a = shift_hips(a, way * (weight * np.clip(missing, 0, 0.15))[:, None])
    mouth = a[:, head] + 0.1 * way + np.array([0, -0.06, 0]) + 0.07 * (axes(a)[0] if side == "left" else -axes(a)[0])
    return reach_arm(a, side, mouth, weight, elbow=(0.7, -0.8, 0.2)), b, []


def help_up(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b crouches from the first frame on and rises by a's hand."""
    frames = len(a)
    grasp = start + int(rng.integers(22, 30))
    risen = grasp + int(rng.integers(34, 48))
    low = 1 - envelope(frames, grasp + 4, risen, frames, frames + 1)
    back = -axes(b)[1]
    b = shift_hips(b, (low * rng.uniform(0.42, 0.5))[:, None] * -UP + (low * 0.12)[:, None] * back)
    b = lean_to(b, -back, low * rng.uniform(0.5, 0.7))
    b = nod(b, -low * 0.45)
    bow = envelope(frames, start, grasp, grasp + 6, risen)
    a = lean_to(a, towards(a[:, 0], b[:, 0]), bow * rng.uniform(0.3, 0.45))
    # The joined hands rise with b.
    own, other = on_body(a, f"{side}_shoulder", 0, 0, 0), on_body(b, f"{side}_shoulder", 0, 0, 0)
    point = 0.5 * own + 0.5 * other
    point[:, 1] = 1.02 - 0.32 * low
    line = towards(own, other) * 0.04
    leave = risen + int(rng.integers(4, 12))
    weights = (
        envelope(frames, start + 2, grasp, leave, leave + 20),
        envelope(frames, start + 8, grasp, leave, leave + 22),
    )
    a = reach(a, {side: point - line}, weights[0])
    b = reach(b, {side: point + line}, weights[1])
    a, b = settle(a, b, (side, side), weights, apart=0.08)
    wrist = f"{side}_wrist"
    return a, b, [(wrist, wrist, grasp, leave)]


def chosen_side(rng: Rng) -> str:
    """The hand that acts, mostly the right one."""
    return "right" if rng.random() < 0.75 else "left"


TOUCHES: dict[str, Touch] = {
    "handshake": Touch(handshake, (0.82, 0.98), (1.5, 3.2)),
    "high-five": Touch(Slap((1.48, 1.65), 0.5), (0.76, 0.92), (1.3, 2.0)),
    "low-five": Touch(Slap((0.9, 1.02), 1.0, approach=(0.2, 1.2), elbow=(0.45, -1.0, -0.25)), (0.68, 0.82), (1.3, 2.0)),
    "high-ten": Touch(Slap((1.45, 1.6), 0.4, mirrored=True), (0.66, 0.8), (1.3, 2.0)),
    "fist-bump": Touch(
        Slap((1.1, 1.26), 0.5, elbow=(0.7, -1.0, -0.2), pause=(2, 9), apart=0.09), (0.82, 0.98), (1.3, 2.0)
    ),
    "elbow-bump": Touch(elbow_bump, (0.46, 0.54), (1.3, 2.0)),
    "hand-over": Touch(hand_over, (0.85, 1.02), (1.8, 2.8)),
    "pat-shoulder": Touch(HandOnShoulder(True), (0.58, 0.72), (1.6, 3.0)),
    "hand-on-shoulder": Touch(HandOnShoulder(False), (0.58, 0.72), (1.6, 3.0)),
}
"""What two people who face each other do with their hands, by name."""
