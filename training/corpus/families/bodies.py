"""Hands on the other's body: hugging, patting, pushing, whispering, helping."""

from __future__ import annotations

import numpy as np

from webdemo.motion.skeleton import SMPL22

from ..compose import Array
from ..contact import (
    UP,
    axes,
    bend,
    envelope,
    impulse,
    lean_to,
    nod,
    on_body,
    reach,
    reach_arm,
    settle,
    shift_hips,
    towards,
)
from ..library import Library, pick
from ..scene import Scene
from ..stage import Rng, act, beside, forward, pad, seconds, stride
from . import register
from .gestures import about
from .meeting import Encounter, chosen_side, come_together, conclude, opposite, side_by_side


def _timing(rng: Rng, meet: Encounter, *, last: int = 10) -> tuple[int, int, int]:
    """Frames at which a hand arrives, lets go and is back."""
    arrive = meet.start + int(rng.integers(16, 24))
    leave = max(meet.stop - last, arrive + 12)
    return arrive, leave, leave + int(rng.integers(16, 24))


@register("hug", needs=("walk", "idle", "walk-back"), weight=3.0, contact=True)
def hug(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.4, 0.46), (1.8, 3.2), near=0.12, leave=0.0)
    if rng.random() < 0.7:  # they step apart again
        steps = stride(rng, library, "walk-back", rng.uniform(0.4, 0.8)).motion
        rest = len(meet.a) - meet.stop
        if rest > 6:
            meet.a, _ = act(rng, library, (0, meet.a[: meet.stop + 14]), (None, steps), tail=16)
            meet.b = pad(rng, library, meet.b, len(meet.a))
    a, b = meet.bodies(gaze=(0.4, 0.4))
    frames = len(a)
    start = max(meet.start - 10, 0)
    arrive, leave = start + int(rng.integers(24, 32)), max(meet.stop - 4, start + 44)
    lag = int(rng.integers(0, 12))
    weights = [envelope(frames, start + late, arrive + late, leave, leave + 24) for late in (0, lag)]
    # Each head goes past the other's: the trunks lean in and a little to the same own side.
    over = pick(rng, ("left", "right"))
    upright = (a, b)
    a, b = (
        lean_to(
            body,
            towards(body[:, 0], other[:, 0]) + (0.35 if over == "right" else -0.35) * axes(body)[0],
            weight * rng.uniform(0.08, 0.16),
        )
        for body, other, weight in zip(upright, upright[::-1], weights, strict=True)
    )
    under = opposite(over)
    # On the side where a's arm goes over, b's goes under it, since the two face each other.
    solved = []
    for body, other, weight in ((a, b, weights[0]), (b, a, weights[1])):
        sign = 1.0 if over == "right" else -1.0  # one's right hand comes to the other's left
        high = on_body(other, "spine3", 0.13 * sign, rng.uniform(0.06, 0.14), -rng.uniform(0.05, 0.1))
        low = on_body(other, "spine2", -0.15 * sign, rng.uniform(0.0, 0.06), -rng.uniform(0.02, 0.07))
        elbow_high, elbow_low = (1.0, 0.1, 0.25), (1.0, -0.45, 0.2)
        body = reach_arm(body, over, high, weight, elbow=elbow_high)
        solved.append(reach_arm(body, under, low, weight, elbow=elbow_low))
    touches = [
        (f"{side}_wrist", joint, arrive, leave) for side, joint in ((over, "spine3"), (under, "spine2"))
    ]
    return conclude(rng, library, "hug", meet, *solved, touches=touches)


def _pats(rng: Rng, frames: int, arrive: int, leave: int) -> Array:
    """(frames,) metres by which a patting hand is lifted off."""
    time = (np.arange(frames) - arrive) / 30
    inside = envelope(frames, arrive, arrive + 4, max(leave - 6, arrive + 5), max(leave, arrive + 9))
    return rng.uniform(0.05, 0.1) * inside * (0.5 - 0.5 * np.cos(2 * np.pi * rng.uniform(2.2, 3.2) * time))


@register("pat-back", needs=("idle",), weight=1.5, contact=True)
def pat_back(rng: Rng, library: Library) -> Scene:
    side, named = chosen_side(rng)
    meet = _standing_beside(rng, library, side, (1.6, 2.6))
    a, b = meet.bodies(gaze=(0.8, 0.5))
    arrive, leave, end = _timing(rng, meet)
    weight = envelope(len(a), meet.start, arrive, leave, end)
    b = bend(b, np.cross(UP, axes(b)[1]) * 0.08 * weight[:, None])
    lift = _pats(rng, len(a), arrive, leave)
    hand = on_body(b, "spine3", -0.04 if side == "left" else 0.04, rng.uniform(-0.04, 0.04), -0.14)
    hand = hand - axes(b)[1] * lift[:, None]
    a = reach(a, {side: hand}, weight, elbow=(0.8, -0.7, -0.2))
    return conclude(
        rng, library, "pat-back", meet, a, b,
        touches=[(f"{side}_wrist", "spine3", arrive, leave)], side=side if named else None,
    )  # fmt: skip


def _standing_beside(rng: Rng, library: Library, side: str, hold: tuple[float, float]) -> Encounter:
    """b stands to the side of a's hand that acts; a is half turned to b and a little behind."""
    start, length = seconds(rng, 0.4, 1.2), seconds(rng, *hold)
    frames = start + length + seconds(rng, 0.8, 1.4)
    sign = 1.0 if side == "right" else -1.0
    a, b = library.idle(rng, frames), library.idle(rng, frames)
    if rng.random() < 0.4:  # a comes up
        steps = stride(rng, library, "walk", rng.uniform(0.8, 1.8)).motion
        a, _ = act(rng, library, (0, steps), tail=length + 40)
        start = len(steps)
        b = library.idle(rng, len(a))
    middle = start + length // 3
    origin, angle = forward(a, middle)
    b = beside(
        b,
        origin,
        angle,
        rng.uniform(0.42, 0.5),
        -sign * rng.uniform(0.1, 0.2),
        -sign * rng.uniform(1.0, 1.4),
        frame=middle,
    )
    return Encounter(a, b, start, start + length)


def _hand_on_shoulder(rng: Rng, library: Library, family: str, *, pat: bool) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.58, 0.72), (1.6, 3.0))
    a, b = meet.bodies()
    side, named = chosen_side(rng)
    arrive, leave, end = _timing(rng, meet)
    weight = envelope(len(a), meet.start, arrive, leave, end)
    hand = on_body(b, f"{opposite(side)}_shoulder", 0.0, 0.06, 0.05)
    if pat:
        hand = hand + UP * _pats(rng, len(a), arrive, leave)[:, None]
    a = reach(a, {side: hand}, weight, elbow=(0.6, -0.9, 0.0))
    if rng.random() < 0.5:
        b = nod(b, weight * rng.uniform(0.05, 0.25))
    return conclude(
        rng, library, family, meet, a, b,
        touches=[(f"{side}_wrist", f"{opposite(side)}_shoulder", arrive, leave)],
        side=side if named else None,
    )  # fmt: skip


@register("pat-shoulder", needs=("walk", "idle"), weight=1.3, contact=True)
def pat_shoulder(rng: Rng, library: Library) -> Scene:
    return _hand_on_shoulder(rng, library, "pat-shoulder", pat=True)


@register("hand-on-shoulder", needs=("walk", "idle"), weight=1.3, contact=True)
def hand_on_shoulder(rng: Rng, library: Library) -> Scene:
    return _hand_on_shoulder(rng, library, "hand-on-shoulder", pat=False)


@register("arm-around", needs=("idle",), weight=1.2, contact=True)
def arm_around(rng: Rng, library: Library) -> Scene:
    side = pick(rng, ("left", "right"))
    meet = side_by_side(rng, library, rng.uniform(0.42, 0.5), (2.0, 4.0), side=side)
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.5), rng.uniform(0, 0.5)))
    arrive, leave, end = _timing(rng, meet, last=0)
    weight = envelope(len(a), meet.start, arrive, leave, end)
    sign = 1.0 if side == "left" else -1.0  # b's far shoulder is on the side on which b stands
    # Up over the shoulders first, then down on the far one.
    hand = on_body(b, f"{side}_shoulder", 0.02 * sign, 0.05, -0.04)
    left, _ = axes(a)
    a = lean_to(a, left * sign, weight * rng.uniform(0.04, 0.09))
    a = reach(
        a, {side: hand + UP * (0.12 * (1 - weight[:, None]))}, weight, elbow=(0.3, -0.4, -1.0), twist=-0.25
    )
    return conclude(
        rng, library, "arm-around", meet, a, b,
        touches=[(f"{side}_wrist", f"{side}_shoulder", arrive, leave)],
        side=side if rng.random() < 0.6 else None,
    )  # fmt: skip


@register("push", needs=("walk", "idle", "walk-back"), weight=2.0, contact=True)
def push(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.52, 0.62), (1.0, 1.5), leave=0.0)
    hit = meet.start + int(rng.integers(14, 20))
    steps = stride(rng, library, "walk-back", rng.uniform(0.5, 1.3)).motion
    meet.b, _ = act(rng, library, (0, meet.b[: hit + 9]), (None, steps), tail=seconds(rng, 0.6, 1.2))
    frames = max(len(meet.a), len(meet.b))
    meet.a, meet.b = (pad(rng, library, person, frames) for person in (meet.a, meet.b))
    a, b = meet.bodies(gaze=(0.7, 0.6))
    line = towards(a[:, 0], b[:, 0])
    blow_ = impulse(frames, hit - 1, rise=7, fall=24)
    give = blow_ * rng.uniform(0.25, 0.45)
    stood = b
    b = lean_to(b, line, give)
    b = nod(b, give * 0.6)
    left, _ = axes(b)
    for sign, side in ((1, "left"), (-1, "right")):  # the arms fly up a little
        flung = b[:, SMPL22.index(f"{side}_wrist")] + (-0.25 * line + 0.15 * UP + 0.12 * sign * left)
        b = reach_arm(b, side, flung, blow_ * 0.8, elbow=(0.8, -0.6, -0.2))
    weight = envelope(frames, hit - 15, hit - 1, hit + 4, hit + 24)
    a = lean_to(a, line, envelope(frames, hit - 10, hit + 2, hit + 4, hit + 26) * rng.uniform(0.12, 0.25))
    chest = {
        side: on_body(stood, "spine3", 0.11 * sign, 0.02, 0.13) + 0.1 * line * give[:, None]
        for side, sign in (
            ("left", -1),
            ("right", 1),
        )  # face to face, one's left hand comes to the right breast
    }
    drawn = 1 - envelope(frames, hit - 10, hit, hit + 30, hit + 31)
    chest = {side: point - 0.14 * line * drawn[:, None] for side, point in chest.items()}
    a = reach(a, chest, weight, elbow=(0.8, -0.9, -0.2))
    meet.events["distance"] = "part"
    touches = [(f"{side}_wrist", "spine3", hit - 2, hit + 3) for side in ("left", "right")]
    return conclude(rng, library, "push", meet, a, b, touches=touches)


@register("whisper", needs=("walk", "idle"), weight=1.3, contact=True)
def whisper(rng: Rng, library: Library) -> Scene:
    side, _ = chosen_side(rng)
    meet = _standing_beside(rng, library, side, (2.0, 3.5))
    a, b = meet.bodies(gaze=(0.9, 0.1))
    arrive, leave, end = _timing(rng, meet)
    weight = envelope(len(a), meet.start, arrive, leave, end)
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
    mouth = (
        a[:, head]
        + 0.1 * way
        + np.array([0, -0.06, 0])
        + 0.07 * (axes(a)[0] if side == "left" else -axes(a)[0])
    )
    a = reach_arm(a, side, mouth, weight, elbow=(0.7, -0.8, 0.2))
    return conclude(rng, library, "whisper", meet, a, b, touches=[])


@register("help-up", needs=("walk", "idle"), weight=1.2, contact=True)
def help_up(rng: Rng, library: Library) -> Scene:
    meet = come_together(rng, library, rng.uniform(0.82, 0.95), (3.0, 4.0), leave=0.1)
    a, b = meet.bodies()
    frames = len(a)
    side, named = chosen_side(rng)
    grasp = meet.start + int(rng.integers(22, 30))
    risen = grasp + int(rng.integers(34, 48))
    low = 1 - envelope(frames, grasp + 4, risen, frames, frames + 1)
    back = -axes(b)[1]
    b = shift_hips(b, (low * rng.uniform(0.42, 0.5))[:, None] * -UP + (low * 0.12)[:, None] * back)
    b = lean_to(b, -back, low * rng.uniform(0.5, 0.7))
    b = nod(b, -low * 0.45)
    bow = envelope(frames, meet.start, grasp, grasp + 6, risen)
    a = lean_to(a, towards(a[:, 0], b[:, 0]), bow * rng.uniform(0.3, 0.45))
    # The joined hands rise with b.
    own, other = a[:, SMPL22.index(f"{side}_shoulder")], b[:, SMPL22.index(f"{side}_shoulder")]
    point = 0.5 * own + 0.5 * other
    point[:, 1] = 1.02 - 0.32 * low
    line = towards(own, other) * 0.04
    leave = risen + int(rng.integers(4, 12))
    weights = (
        envelope(frames, meet.start + 2, grasp, leave, leave + 20),
        envelope(frames, meet.start + 8, grasp, leave, leave + 22),
    )
    a = reach(a, {side: point - line}, weights[0])
    b = reach(b, {side: point + line}, weights[1])
    a, b = settle(a, b, (side, side), weights, apart=0.08)
    wrist = f"{side}_wrist"
    return conclude(
        rng,
        library,
        "help-up",
        meet,
        a,
        b,
        touches=[(wrist, wrist, grasp, leave)],
        side=side if named else None,
    )


@register("tap-turn", needs=("walk", "idle"), weight=1.3, contact=True)
def tap_turn(rng: Rng, library: Library) -> Scene:
    side, named = chosen_side(rng)
    steps = stride(rng, library, "walk", rng.uniform(1.0, 2.0)).motion
    a, _ = act(rng, library, (0, steps), tail=170)
    start = len(steps)
    arrive = start + int(rng.integers(14, 20))
    leave = arrive + int(rng.integers(14, 24))
    turn_at = leave - int(rng.integers(0, 6))
    walk = stride(rng, library, "walk", rng.uniform(0.35, 0.6)).motion
    angle = (np.pi + rng.normal(0, 0.15)) * (1 if side == "left" else -1)
    b, _ = act(
        rng, library, (0, library.idle(rng, turn_at + 12)), (None, about(rng, walk, angle=angle)), tail=50
    )
    frames = min(len(a), len(b), turn_at + 100)
    a, b = a[:frames], b[:frames]
    origin, heading = forward(a, start + 10)
    sign = 1.0 if side == "right" else -1.0
    b = beside(
        b,
        origin,
        heading,
        rng.uniform(0.5, 0.58),
        -sign * rng.uniform(0.0, 0.1),
        rng.normal(0, 0.1),
        frame=start + 10,
    )
    meet = Encounter(a, b, start, leave)
    pa, pb = meet.bodies(gaze=(0.6, 0.6))
    weight = envelope(frames, start, arrive, leave, leave + 18)
    hand = on_body(pb, f"{side}_shoulder", 0.0, 0.06, -0.06)
    held = hand.copy()
    held[turn_at + 4 :] = hand[min(turn_at + 4, frames - 1)]
    held = held + UP * _pats(rng, frames, arrive, leave)[:, None]
    pa = reach(pa, {side: held}, weight, elbow=(0.6, -0.9, 0.0))
    return conclude(
        rng, library, "tap-turn", meet, pa, pb,
        touches=[(f"{side}_wrist", f"{side}_shoulder", arrive, turn_at)], side=side if named else None,
    )  # fmt: skip
