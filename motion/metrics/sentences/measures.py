"""The figures behind predicates, in a few plain words: "hand 34 cm from the shoulder", "they stay 1.8 m apart".

A measure takes what its predicates take and says how near a motion comes to them at best.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .joints import Array, Motion, stretches
from .paths import WALK, sideways
from .poses import _lift, _wrist_speed
from .shapes import lean_to
from .touches import _hand_gaps, to_joints

_NAMES = ("A", "B")
_LEANS = {"any": "", "left": " to the left", "right": " to the right", "towards": " towards the other"}


def _length(metres: float | np.floating) -> str:
    return f"{100 * metres:.0f} cm" if metres < 1 else f"{metres:.1f} m"


def _gap(m: Motion, joint: str) -> str:
    """The least distance of a joint of one from the same of the other."""
    return _length(np.linalg.norm(m.joint(0, joint) - m.joint(1, joint), axis=-1).min())


def _gone(m: Motion, rate: Array) -> str:
    """The longest way at a rate of 0.15 m/s or more."""
    return _length(max((rate[i:j].sum() for i, j in stretches(rate > 0.15, m.fps)), default=0.0) / m.fps)


def _nearer(m: Motion, who: int) -> Array:
    """(T,) m/s towards the other."""
    return np.sum(m.velocities[who] * m.towards(who), axis=-1)


def _hand_from(m: Motion, who: int, whose: int, part: str, side: object) -> str:
    hands = m.hands(who, side if isinstance(side, str) else "any")
    return f"hand {_length(to_joints(m, hands, whose, part).min())} from the {part}"


def _round(m: Motion, who: int) -> float:
    """Degrees by which somebody goes around the other."""
    line = m.roots[who] - m.roots[1 - who]
    return float(np.ptp(np.degrees(np.unwrap(np.arctan2(line[:, 0], line[:, 1])))))


def _rise(m: Motion, who: int) -> float:
    """Metres that both feet are off the floor."""
    lowest = m.pair(who, "foot")[..., 1].min(axis=0)
    return float(lowest.max() - np.percentile(lowest, 10))


def _hand_height(m: Motion, who: int) -> str:
    lift = float(_lift(m, who).max())
    return f"hand {_length(abs(lift))} {'above' if lift > 0 else 'below'} the shoulder"


def _standing(height: float | np.floating) -> str:
    return f"{100 * min(1.0, float(height)):.0f} % of standing height"


_TABLE: dict[str, Callable[..., str]] = {
    # ---- two bodies ----------------------------------------------------------------------------------
    "hands_meet both_hands_meet": lambda m, *_, **__: f"hands {_length(_hand_gaps(m).min())} apart",
    "hand_on both_hands_on arm_on": lambda m, who, part, side="any", *_, **__: _hand_from(m, who, 1 - who, part, side),
    "hand_to_own": lambda m, who, part, side="any", *_, **__: _hand_from(m, who, who, part, side),
    "hugs": lambda m: f"chests {_gap(m, 'spine3')} apart",
    "heads_near": lambda m, *_, **__: f"heads {_gap(m, 'head')} apart",
    "near touches": lambda m, *_, **__: f"they stay {_length(m.distance.min())} apart",
    "apart": lambda m, *_, **__: f"they get {_length(m.distance.max())} apart",
    "faces": lambda m, who, *_, **__: f"{_NAMES[who]} faces {m.off(who).min():.0f}° away from {_NAMES[1 - who]}",
    "orbits": lambda m, who, *_, **__: f"{_NAMES[who]} goes {_round(m, who):.0f}° around",
    # ---- ways ----------------------------------------------------------------------------------------
    "walks": lambda m, who, metres=0.8, speed=WALK: (
        f"{_NAMES[who]} "
        + (f"reaches {m.speeds[who].max():.1f} m/s" if speed > WALK else f"goes {_gone(m, m.speeds[who])}")
    ),
    "goes_ahead goes_metres sidesteps steps_aside passes follows": (
        lambda m, who, *_, **__: f"{_NAMES[who]} goes {_gone(m, m.speeds[who])}"
    ),
    "goes_way": lambda m, who, way, *_, **__: f"{_NAMES[who]} goes {_gone(m, sideways(m, who, way))} to the {way}",
    "runs": lambda m, who, *_, **__: f"{_NAMES[who]} reaches {m.speeds[who].max():.1f} m/s",
    "walks_to": lambda m, who, *_, **__: f"{_NAMES[who]} comes {_gone(m, _nearer(m, who))} nearer",
    "walks_away": lambda m, who, *_, **__: f"{_NAMES[who]} goes {_gone(m, -_nearer(m, who))} away",
    "backs": lambda m, who, *_, **__: (
        f"{_NAMES[who]} goes {_gone(m, -np.sum(m.velocities[who] * m.forward[who], axis=-1))} backwards"
    ),
    "stays": lambda m, who, *_, **__: (
        f"{_NAMES[who]} gets {_length(np.linalg.norm(m.roots[who] - m.roots[who][0], axis=-1).max())} away from where "
        "they began"
    ),
    "turns turns_to turns_away turns_way revolves": (
        lambda m, who, *_, **__: f"{_NAMES[who]} turns by {np.ptp(m.headings[who]):.0f}°"
    ),
    # ---- one body ------------------------------------------------------------------------------------
    "low sits kneels lies falls": lambda m, who, *_, **__: f"hips down to {_standing(m.height(who).min())}",
    "upright": lambda m, who: f"hips at {_standing(m.height(who)[-1])} at the end",
    "leans": lambda m, who, way, *_, **__: (
        f"trunk leans{_LEANS.get(way, f' {way}')} by {max(0.0, lean_to(m, who, way).max()):.0f}°"
    ),
    "bows": lambda m, who, *_, **__: f"trunk leans by {m.lean(who).max():.0f}°",
    "ducks": lambda m, who, *_, **__: f"head goes down by {_length(m.drop(who).max())}",
    "jumps": lambda m, who, *_, **__: f"both feet rise by {_length(_rise(m, who))}",
    "hand_up waves hands_high hand_over_head arm_level": lambda m, who, *_, **__: _hand_height(m, who),
    "strikes": lambda m, who, *_, **__: f"hand moves at {_wrist_speed(m, who).max():.1f} m/s",
    "foot_up knee_high kicks": lambda m, who, *_, **__: (
        f"foot {_length(np.ptp(m.pair(who, 'ankle')[..., 1], axis=0).max())} high"
    ),
}
MEASURES = {name: said for names, said in _TABLE.items() for name in names.split()}
"""The measures by the name of their predicate."""
