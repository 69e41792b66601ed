"""Touches between hands, and between a hand and the other's body, for people who already stand in place.

A touch takes a generator, the positions of two people (T, 22, 3), the frames between which they stand within reach, and
a side, that of a's hand. It returns the changed positions and what touches: (joint of a, joint of b, first frame, last
frame).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from motion import FPS
from motion.skeleton import OTHER_SIDE, SMPL22
from motion.vectors import FLAT, unit

from .compose import ARMS, Array
from .contact import (
    ELBOW_DOWN,
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
Touch = Callable[[Rng, Array, Array, int, int, str], Touched]


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
    away: tuple[Array, Array] = (np.zeros(3), np.zeros(3)),
    elbow: tuple[float, float, float] = ELBOW_DOWN,
) -> tuple[Array, Array]:
    """Brings hands of the two together; ``away``, (T, 3) for each person, offsets their wrist from there."""
    targets: tuple[dict[str, Array], dict[str, Array]] = ({}, {})
    for own, other in pairs:
        points = meeting(a, b, own, other, height=height, apart=apart)
        for person, side in enumerate((own, other)):
            targets[person][side] = points[person] + away[person]
    a, b = reach(a, targets[0], weights[0], elbow=elbow), reach(b, targets[1], weights[1], elbow=elbow)
    for own, other in pairs:
        a, b = settle(a, b, (own, other), weights, apart=apart, away=away, elbow=elbow)
    return a, b


def handshake(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """Two people walk up to each other and shake hands."""
    arrive, leave, end = timing(rng, start, stop)
    frames, late = len(a), int(rng.integers(0, 10))
    weights = (
        envelope(frames, start, arrive - 2, leave, end),
        envelope(frames, start + late, arrive, leave, end + int(rng.integers(-3, 4))),
    )
    shake = shaking(frames, arrive, leave, hertz=rng.uniform(2.0, 3.0), size=rng.uniform(0.02, 0.045))
    height = rng.uniform(0.98, 1.1)
    a, b = glance(rng, a, weights[0]), glance(rng, b, weights[1])
    away, apart = shake[:, None] * UP, rng.uniform(0.06, 0.09)
    a, b = meet_hands(a, b, ((side, side),), weights, height=height, apart=apart, away=(away, away))
    return a, b, [(f"{side}_wrist", f"{side}_wrist", arrive, leave)]


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
    out = 1.0 if side == "left" else -1.0
    solved = []
    for body in (a, b):
        _, shoulder, elbow, wrist = ARMS[side]
        upper, lower = SMPL22.bone_lengths[[elbow, wrist]]
        (left, ahead), bent = axes(body), upper * unit(middle - body[:, shoulder])
        hand = body[:, shoulder] + bent + lower * unit(-0.75 * out * left + 0.5 * UP + 0.25 * ahead)
        solved.append(reach_arm(body, side, hand, weight, elbow=(0.5, -0.4, 1.0)))
    joint = f"{side}_elbow"
    return solved[0], solved[1], [(joint, joint, hit, stop)]


def hand_over(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """A hands something to B."""
    taking = side if rng.random() < 0.7 else OTHER_SIDE[side]
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


def hug(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """``side``: the arm that goes over the other's shoulder."""
    arrive, leave = start + int(rng.integers(22, 30)), max(stop, start + 48)
    lags = (0, int(rng.integers(0, 12)))
    weights = [envelope(len(a), start + late, arrive + late, leave, leave + 24) for late in lags]
    # Each head goes past the other's: the trunks lean in and a little to the same own side.
    sign, upright, leant = 1.0 if side == "right" else -1.0, (a, b), []
    for body, other, weight in zip(upright, upright[::-1], weights, strict=True):
        way = towards(body[:, 0], other[:, 0]) + 0.35 * sign * axes(body)[0]
        leant.append(lean_to(body, way, weight * rng.uniform(0.08, 0.16)))
    # On the side where a's arm goes over, b's goes under it: one's right hand comes to the other's left.
    under, solved = OTHER_SIDE[side], []
    for body, other, weight in zip(leant, leant[::-1], weights, strict=True):
        high = on_body(other, "spine3", 0.13 * sign, rng.uniform(0.06, 0.14), -rng.uniform(0.05, 0.1))
        low = on_body(other, "spine2", -0.15 * sign, rng.uniform(0.0, 0.06), -rng.uniform(0.02, 0.07))
        body = reach_arm(body, side, high, weight, elbow=(1.0, 0.1, 0.25))
        solved.append(reach_arm(body, under, low, weight, elbow=(1.0, -0.45, 0.2)))
    touches = [(f"{hand}_wrist", joint, arrive, leave) for hand, joint in ((side, "spine3"), (under, "spine2"))]
    return solved[0], solved[1], touches


def pats(rng: Rng, frames: int, arrive: int, leave: int) -> Array:
    """(frames,) metres by which a patting hand is lifted off."""
    time = (np.arange(frames) - arrive) / FPS
    inside = envelope(frames, arrive, arrive + 4, max(leave - 6, arrive + 5), max(leave, arrive + 9))
    return rng.uniform(0.05, 0.1) * inside * (0.5 - 0.5 * np.cos(2 * np.pi * rng.uniform(2.2, 3.2) * time))


@dataclass(frozen=True)
class HandOn:
    """A hand laid on the other's body.

    Attributes:
        joint: of the other; "{side}" is the side of the hand, "{far}" the other one.
        at: metres that the wrist is beside it, outwards on the hand's side, up and ahead of the other.
        lifted: up and ahead of the other, the way on which a hand that pats is lifted off; None of one that rests.
        elbow: direction of the elbow.
    """

    joint: str
    at: tuple[float, float, float]
    lifted: tuple[float, float] | None = None
    elbow: tuple[float, float, float] = (0.6, -0.9, 0.0)

    def __call__(self, rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
        """The touch of two people (T, 22, 3) from one frame to another, with the hand of a side."""
        arrive, leave, end = timing(rng, start, stop)
        weight = envelope(len(a), start, arrive, leave, end)
        joint, (out, up, ahead) = self.joint.format(side=side, far=OTHER_SIDE[side]), self.at
        if self.lifted:
            lift = pats(rng, len(a), arrive, leave)
            up, ahead = up + lift * self.lifted[0], ahead + lift * self.lifted[1]
        hand = on_body(b, joint, out if side == "left" else -out, up, ahead)
        a = reach(a, {side: hand}, weight, elbow=self.elbow)
        return a, nod(b, weight * rng.uniform(0.0, 0.2)), [(f"{side}_wrist", joint, arrive, leave)]


def arm_around(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b stands on a's ``side``, both look the same way."""
    arrive, leave, end = timing(rng, start, stop, last=0)
    weight = envelope(len(a), start, arrive, leave, end)
    sign = 1.0 if side == "left" else -1.0  # b's far shoulder is on the side on which b stands
    # Up over the shoulders first, then down on the far one.
    hand = on_body(b, f"{side}_shoulder", 0.02 * sign, 0.05 + 0.12 * (1 - weight), -0.04)
    a = lean_to(a, sign * axes(a)[0], weight * rng.uniform(0.04, 0.09))
    a = reach(a, {side: hand}, weight, elbow=(0.3, -0.4, -1.0), twist=-0.25)
    return a, b, [(f"{side}_wrist", f"{side}_shoulder", arrive, leave)]


def whisper(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b stands beside and a little in front of a."""
    arrive, leave, end = timing(rng, start, stop)
    weight = envelope(len(a), start, arrive, leave, end)
    head, middle = SMPL22.index("head"), (arrive + leave) // 2
    b = lean_to(b, towards(b[:, 0], a[:, 0]), weight * rng.uniform(0.04, 0.12))
    way = towards(a[:, head], b[:, head])
    for _ in range(2):
        missing = float(np.linalg.norm((b - a)[middle, head][[0, 2]])) - rng.uniform(0.2, 0.25)
        a = lean_to(a, way, weight * float(np.clip(missing / 0.62, -0.2, 0.4)))
    mouth = on_body(a, "head", 0.07 if side == "left" else -0.07, -0.06, 0.0) + 0.1 * way
    return reach_arm(a, side, mouth, weight, elbow=(0.7, -0.8, 0.2)), b, []


def help_up(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
    """b goes down, crouches and rises by a's hand."""
    grasp = start + int(rng.integers(32, 40))
    risen = grasp + int(rng.integers(34, 48))
    leave = risen + int(rng.integers(4, 12))
    low = envelope(len(a), start - 2, start + 28, grasp + 4, risen)
    _, ahead = axes(b)
    b = shift_hips(b, low[:, None] * (-rng.uniform(0.42, 0.5) * UP - 0.12 * ahead))
    b = nod(lean_to(b, ahead, low * rng.uniform(0.5, 0.7)), -low * 0.45)
    bow = envelope(len(a), start + 8, grasp, grasp + 6, risen)
    a = lean_to(a, towards(a[:, 0], b[:, 0]), bow * rng.uniform(0.3, 0.45))
    # The joined hands rise with b.
    own, other = (body[:, SMPL22.index(f"{side}_shoulder")] for body in (a, b))
    point = (own + other) / 2
    point[:, 1] = 1.02 - 0.32 * low
    line = towards(own, other) * 0.04
    weights = [envelope(len(a), start + 10 + late, grasp, leave, leave + 20) for late in (0, 6)]
    a = reach(a, {side: point - line}, weights[0])
    b = reach(b, {side: point + line}, weights[1])
    a, b = settle(a, b, (side, side), (weights[0], weights[1]), apart=0.08)
    return a, b, [(f"{side}_wrist", f"{side}_wrist", grasp, leave)]


def joined_hands(*pairs: tuple[str, str], height: float, carried: bool = False) -> Touch:
    """Hands that hold each other, pairs of a's and b's; ``carried`` along between two who walk."""

    def make(rng: Rng, a: Array, b: Array, start: int, stop: int, side: str) -> Touched:
        weight = envelope(len(a), start, start + 16, stop, stop + 22)
        line, off = towards(a[:, 0], b[:, 0]), np.zeros(3)
        if carried:
            swing = 0.25 * FLAT * (a[:, ARMS[pairs[0][0]][3]] - a[:, 0])
            off = 0.05 * axes(a)[1] + swing - line * np.sum(swing * line, axis=-1, keepdims=True)
        a, b = meet_hands(a, b, pairs, (weight, weight), height=height, away=(off, off))
        return a, b, [(f"{own}_wrist", f"{other}_wrist", start + 16, stop) for own, other in pairs]

    return make


def chosen_side(rng: Rng) -> str:
    """The hand that acts, mostly the right one."""
    return "right" if rng.random() < 0.75 else "left"
