"""Hands that meet: shaking, slapping, bumping, holding and giving."""

from __future__ import annotations

from functools import partial

import numpy as np

from ..contact import envelope
from ..cues import STILL
from ..library import Library
from ..scene import Scene
from ..stage import Rng
from ..touches import TOUCHES, chosen_side, joined_hands, opposite
from . import register
from .meeting import abreast, come_together, conclude, side_by_side


def _together(name: str, rng: Rng, library: Library) -> Scene:
    """The two come together and touch as ``name`` says."""
    touch = TOUCHES[name]
    meet = come_together(rng, library, rng.uniform(*touch.distance), touch.hold)
    side, named = chosen_side(rng)
    a, b, touches = touch.make(rng, *meet.bodies(), meet.start, meet.stop, side)
    named = named and name != "high-ten"
    return conclude(library, name, meet, a, b, touches=touches, side=side if named else None)


for _name, _weight, *_shows in (
    ("handshake", 3.0, "shake-hands"),
    ("high-five", 2.5, "high-five"),
    ("low-five", 1.2, "low-five"),
    ("high-ten", 1.5, "high-five@both"),
    ("fist-bump", 1.5, "fist-bump"),
    ("elbow-bump", 1.0, "elbow-bump"),
    ("hand-over", 2.0, "hand-over", "take-from"),
    ("pat-shoulder", 1.3, "pat:shoulder", STILL),
    ("hand-on-shoulder", 1.3, "hand-on:shoulder", STILL),
):
    register(_name, *_shows, needs=("walk", "idle"), weight=_weight, contact=True)(partial(_together, _name))


@register("hold-hands", "hold-hands", needs=("idle",), weight=1.3, contact=True)
def hold_hands(rng: Rng, library: Library) -> Scene:
    """Two people stand side by side and hold hands."""
    side = "left" if rng.random() < 0.5 else "right"
    meet = side_by_side(rng, library, rng.uniform(0.5, 0.65), (2.0, 4.0), side=side)
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.6), rng.uniform(0, 0.6)))
    arrive, end = meet.start + 20, min(meet.stop + 20, len(a) - 1)
    weight = envelope(len(a), meet.start, arrive, meet.stop, end)
    if rng.random() < 0.4:  # they hold hands all along
        arrive, weight = 0, np.ones(len(a))
    a, b = joined_hands(a, b, (side, opposite(side)), rng.uniform(0.78, 0.86), 0.06, weight)
    touches = [(f"{side}_wrist", f"{opposite(side)}_wrist", arrive, meet.stop)]
    return conclude(library, "hold-hands", meet, a, b, touches=touches)


@register("walk-hand-in-hand", "walk-hand-in-hand", needs=("walk",), weight=1.3, contact=True)
def walk_hand_in_hand(rng: Rng, library: Library) -> Scene:
    """Two people walk hand in hand."""
    side = "left" if rng.random() < 0.5 else "right"
    gap = rng.uniform(0.55, 0.68) * (1 if side == "left" else -1)
    meet = abreast(rng, library, float(rng.normal(0, 0.03)), gap, int(rng.uniform(3, 6) * 30))
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.4), rng.uniform(0, 0.4)))
    weight = np.ones(len(a))
    a, b = joined_hands(a, b, (side, opposite(side)), rng.uniform(0.78, 0.86), 0.05, weight)
    meet.events["distance"] = "keep"
    touches = [(f"{side}_wrist", f"{opposite(side)}_wrist", 0, len(a))]
    return conclude(library, "walk-hand-in-hand", meet, a, b, touches=touches)


@register("lead-by-hand", "lead", "follow", needs=("walk",), weight=1.3, contact=True)
def lead_by_hand(rng: Rng, library: Library) -> Scene:
    """A leads B by the hand."""
    side = "left" if rng.random() < 0.5 else "right"
    left = rng.uniform(0.2, 0.4) * (1 if side == "left" else -1)
    meet = abreast(rng, library, -rng.uniform(0.6, 0.75), left, int(rng.uniform(3, 6) * 30))
    a, b = meet.bodies(gaze=(rng.uniform(0, 0.5), rng.uniform(0.3, 0.6)))
    weight = np.ones(len(a))
    taking = opposite(side) if rng.random() < 0.6 else side
    a, b = joined_hands(a, b, (side, taking), rng.uniform(0.85, 0.95), 0.0, weight)
    meet.events["distance"] = "keep"
    touches = [(f"{side}_wrist", f"{taking}_wrist", 0, len(a))]
    return conclude(library, "lead-by-hand", meet, a, b, touches=touches)
