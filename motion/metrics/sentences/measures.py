"""The figures behind predicates, in a few plain words: "hand 34 cm from the shoulder", "they stay 1.8 m apart".

A measure has the name and the arguments of its predicate and says how near a motion comes to it at best.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .joints import Array, Motion
from .poses import _lift, _wrist_speed
from .shapes import lean_to
from .touches import _hand_gaps, to_joints

MEASURES: dict[str, Callable[..., str]] = {}
"""The measures by the name of their predicate."""
_NAMES = ("A", "B")


def measure(*names: str) -> Callable[[Callable[..., str]], Callable[..., str]]:
    """Adds a measure under the names of its predicates."""

    def add(function: Callable[..., str]) -> Callable[..., str]:
        MEASURES.update(dict.fromkeys(names, function))
        return function

    return add


def _cm(metres: float) -> str:
    return f"{100 * metres:.0f} cm" if metres < 1 else f"{metres:.1f} m"


def _gone(m: Motion, rate: Array) -> float:
    """Metres at a rate of 0.1 m/s or more."""
    return float(rate[rate > 0.1].sum() / m.fps)


# ---- two bodies ------------------------------------------------------------------------------------------
@measure("hands_meet", "both_hands_meet")
def _hands(m: Motion, *_: object, **__: object) -> str:
    return f"hands {_cm(float(_hand_gaps(m).min()))} apart"


@measure("hand_on", "both_hands_on", "arm_on")
def _hand_on(m: Motion, who: int, part: str, side: str = "any", gap: float = 0.0) -> str:
    hands = m.hands(who, side if isinstance(side, str) else "any")
    gaps = to_joints(m, hands, 1 - who, part)
    return f"hand {_cm(float(gaps.min()))} from the {part}"


@measure("hand_to_own")
def _own(m: Motion, who: int, part: str, side: str = "any", gap: float = 0.0) -> str:
    return f"hand {_cm(float(to_joints(m, m.hands(who, side), who, part).min()))} from the {part}"


@measure("hugs")
def _chests(m: Motion) -> str:
    gap = np.linalg.norm(m.joint(0, "spine3") - m.joint(1, "spine3"), axis=-1).min()
    return f"chests {_cm(float(gap))} apart"


@measure("heads_near")
def _heads(m: Motion, metres: float = 0.0) -> str:
    gap = np.linalg.norm(m.joint(0, "head") - m.joint(1, "head"), axis=-1).min()
    return f"heads {_cm(float(gap))} apart"


@measure("near", "touches")
def _near(m: Motion, metres: float = 0.0) -> str:
    return f"they stay {_cm(float(m.distance.min()))} apart"


@measure("apart")
def _apart(m: Motion, metres: float) -> str:
    return f"they get {_cm(float(m.distance.max()))} apart"


@measure("faces")
def _faces(m: Motion, who: int, degrees: float = 0.0) -> str:
    return f"{_NAMES[who]} faces {m.off(who).min():.0f}° away from {_NAMES[1 - who]}"


@measure("orbits")
def _orbits(m: Motion, who: int, *_: object) -> str:
    line = m.roots[who] - m.roots[1 - who]
    angle = np.degrees(np.unwrap(np.arctan2(line[:, 0], line[:, 1])))
    return f"{_NAMES[who]} goes {np.ptp(angle):.0f}° around"


# ---- ways ------------------------------------------------------------------------------------------------
@measure("walks", "goes_ahead", "goes_way", "goes_metres", "sidesteps", "steps_aside", "passes", "follows")
def _walks(m: Motion, who: int, *_: object, **__: object) -> str:
    return f"{_NAMES[who]} goes {_gone(m, m.speeds[who]):.1f} m"


@measure("runs")
def _runs(m: Motion, who: int, metres: float = 0.0) -> str:
    return f"{_NAMES[who]} reaches {m.speeds[who].max():.1f} m/s"


@measure("walks_to")
def _to(m: Motion, who: int, metres: float = 0.0) -> str:
    return f"{_NAMES[who]} comes {_gone(m, np.sum(m.velocities[who] * m.towards(who), axis=-1)):.1f} m nearer"


@measure("walks_away")
def _away(m: Motion, who: int, metres: float = 0.0) -> str:
    gone = _gone(m, -np.sum(m.velocities[who] * m.towards(who), axis=-1))
    return f"{_NAMES[who]} goes {gone:.1f} m away"


@measure("backs")
def _backs(m: Motion, who: int, metres: float = 0.0) -> str:
    return f"{_NAMES[who]} goes {_gone(m, -np.sum(m.velocities[who] * m.forward[who], axis=-1)):.1f} m backwards"


@measure("stays")
def _stays(m: Motion, who: int, metres: float = 0.0) -> str:
    away = np.linalg.norm(m.roots[who] - m.roots[who][0], axis=-1).max()
    return f"{_NAMES[who]} gets {_cm(float(away))} away from where they began"


@measure("turns", "turns_to", "turns_away", "turns_way", "revolves")
def _turns(m: Motion, who: int, *_: object, **__: object) -> str:
    return f"{_NAMES[who]} turns by {np.ptp(m.headings[who]):.0f}°"


# ---- one body --------------------------------------------------------------------------------------------
@measure("low", "sits", "kneels", "lies", "falls")
def _low(m: Motion, who: int, share: float = 0.0) -> str:
    return f"hips down to {100 * min(1.0, float(m.height(who).min())):.0f} % of standing height"


@measure("upright")
def _upright(m: Motion, who: int) -> str:
    return f"hips at {100 * min(1.0, float(m.height(who)[-1])):.0f} % of standing height at the end"


@measure("leans")
def _leans(m: Motion, who: int, way: str, degrees: float = 0.0) -> str:
    said = {"any": "", "left": " to the left", "right": " to the right", "towards": " towards the other"}
    return f"trunk leans{said.get(way, f' {way}')} by {max(0.0, lean_to(m, who, way).max()):.0f}°"


@measure("bows")
def _bows(m: Motion, who: int, *_: object, **__: object) -> str:
    return f"trunk leans by {m.lean(who).max():.0f}°"


@measure("ducks")
def _ducks(m: Motion, who: int, drop: float = 0.0) -> str:
    return f"head goes down by {_cm(float(m.drop(who).max()))}"


@measure("jumps")
def _jumps(m: Motion, who: int, rise: float = 0.0) -> str:
    lowest = m.pair(who, "foot")[..., 1].min(axis=0)
    return f"both feet rise by {_cm(float(lowest.max() - np.percentile(lowest, 10)))}"


@measure("hand_up", "waves", "hands_high", "hand_over_head", "arm_level")
def _hand_up(m: Motion, who: int, *_: object, **__: object) -> str:
    lift = float(_lift(m, who).max())
    return f"hand {_cm(abs(lift))} {'above' if lift > 0 else 'below'} the shoulder"


@measure("strikes")
def _strikes(m: Motion, who: int, *_: object, **__: object) -> str:
    return f"hand moves at {_wrist_speed(m, who).max():.1f} m/s"


@measure("foot_up", "knee_high", "kicks")
def _foot_up(m: Motion, who: int, *_: object, **__: object) -> str:
    heights = m.pair(who, "ankle")[..., 1]
    return f"foot {_cm(float(np.abs(heights[0] - heights[1]).max()))} high"
