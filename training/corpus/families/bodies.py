"""Hands on the other's body: hugging, patting, pushing, whispering, helping."""

from __future__ import annotations

import numpy as np

from motion.skeleton import SMPL22

from ..contact import UP, axes, envelope, impulse, lean_to, nod, on_body, reach, reach_arm, towards
from ..cues import STILL
from ..library import Library, pick
from ..scene import Scene
from ..stage import Rng, act, beside, forward, pad, seconds, stride
from ..touches import arm_around as touch_arm_around
from ..touches import chosen_side, pats
from ..touches import help_up as touch_help_up
from ..touches import hug as touch_hug
from ..touches import pat_back as touch_pat_back
from ..touches import whisper as touch_whisper
from . import register
from .gestures import about
from .meeting import Encounter, come_together, conclude, side_by_side


@register("hug", "hug", needs=("walk", "idle", "walk-back"), weight=3.0, contact=True)
def hug(rng: Rng, library: Library) -> Scene:
    """Two people walk up to each other and hug."""
    meet = come_together(rng, library, rng.uniform(0.4, 0.46), (1.8, 3.2), near=0.12, leave=0.0)
    if rng.random() < 0.7:  # they step apart again
        steps = stride(rng, library, "walk-back", rng.uniform(0.4, 0.8)).motion
        rest = len(meet.a) - meet.stop
        if rest > 6:
            meet.a, _ = act(rng, library, (0, meet.a[: meet.stop + 14]), (None, steps), tail=16)
            meet.b = pad(rng, library, meet.b, len(meet.a))
    over = pick(rng, ("left", "right"))
    a, b, touches = touch_hug(rng, *meet.bodies(gaze=(0.4, 0.4)), meet.start, meet.stop, over)
    return conclude(library, "hug", meet, a, b, touches=touches)


@register("pat-back", "pat:back", STILL, needs=("idle",), weight=1.5, contact=True)
def pat_back(rng: Rng, library: Library) -> Scene:
    """A pats B on the back."""
    side, named = chosen_side(rng)
    meet = _standing_beside(rng, library, side, (1.6, 2.6))
    a, b, touches = touch_pat_back(rng, *meet.bodies(gaze=(0.8, 0.5)), meet.start, meet.stop, side)
    return conclude(library, "pat-back", meet, a, b, touches=touches, side=side if named else None)


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


@register("arm-around", "arm-around", STILL, needs=("idle",), weight=1.2, contact=True)
def arm_around(rng: Rng, library: Library) -> Scene:
    """Two people stand side by side, and A puts an arm around B."""
    side = pick(rng, ("left", "right"))
    meet = side_by_side(rng, library, rng.uniform(0.42, 0.5), (2.0, 4.0), side=side)
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.5), rng.uniform(0, 0.5)))
    a, b, touches = touch_arm_around(rng, a, b, meet.start, meet.stop, side)
    return conclude(
        library, "arm-around", meet, a, b, touches=touches, side=side if rng.random() < 0.6 else None
    )


@register(
    "push", "push", "stumble", relation="reply", needs=("walk", "idle", "walk-back"), weight=2.0, contact=True
)
def push(rng: Rng, library: Library) -> Scene:
    """A pushes B, who stumbles back."""
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
    return conclude(library, "push", meet, a, b, touches=touches)


@register("whisper", "whisper", "listen", needs=("walk", "idle"), weight=1.3, contact=True)
def whisper(rng: Rng, library: Library) -> Scene:
    """A whispers something in B's ear."""
    side, _ = chosen_side(rng)
    meet = _standing_beside(rng, library, side, (2.0, 3.5))
    a, b, _ = touch_whisper(rng, *meet.bodies(gaze=(0.9, 0.1)), meet.start, meet.stop, side)
    return conclude(library, "whisper", meet, a, b, touches=[])


@register("help-up", "help-up", "stand-up", needs=("walk", "idle"), weight=1.2, contact=True)
def help_up(rng: Rng, library: Library) -> Scene:
    """A helps B up from a crouch."""
    meet = come_together(rng, library, rng.uniform(0.82, 0.95), (3.0, 4.0), leave=0.1)
    side, named = chosen_side(rng)
    a, b, touches = touch_help_up(rng, *meet.bodies(), meet.start, meet.stop, side)
    return conclude(library, "help-up", meet, a, b, touches=touches, side=side if named else None)


@register(
    "tap-turn", "pat:shoulder", "turn-to", relation="reply", needs=("walk", "idle"), weight=1.3, contact=True
)
def tap_turn(rng: Rng, library: Library) -> Scene:
    """A taps B's shoulder from behind, and B turns around."""
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
    held = held + UP * pats(rng, frames, arrive, leave)[:, None]
    pa = reach(pa, {side: held}, weight, elbow=(0.6, -0.9, 0.0))
    return conclude(
        library, "tap-turn", meet, pa, pb,
        touches=[(f"{side}_wrist", f"{side}_shoulder", arrive, turn_at)], side=side if named else None,
    )  # fmt: skip
