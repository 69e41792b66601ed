"""Measures of planned motion beside the network's own and recorded motion, by kind of act.

``python -m webdemo benchmark --motion`` makes the sentences of ``motion.toml`` with and without their plans and prints
medians over people (:mod:`motion.metrics.quality`), so that walks are compared with walks. ``recorded.json`` has
the same measures of recorded people, by kind.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motion import Duet
from motion.metrics.quality import Naturalness, naturalness
from webdemo.inference.engine import Engine
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result

HERE = Path(__file__).parent
RECORDED = HERE / "recorded.json"
SEEDS = 2
"""Motions of each sentence."""
COLUMNS = ("planned", "network alone", "recorded")
MEASURES: Mapping[str, tuple[str, str, float]] = {
    "standing_foot": ("standing foot, cm/s", "{:.1f}", 1.0),
    "jerk": ("jerk, 95th percentile, m/s³", "{:.0f}", 110.0),
    "fastest": ("fastest joint, m/s (recorded: 99.9th percentile)", "{:.1f}", math.nan),
    "mirror_gap": ("gap of the hands' mirror images, cm", "{:.0f}", 20.0),
    "slow_arms": ("energy of the arms under 1 Hz", "{:.0%}", 0.5),
    "twisted": ("frames with the trunk twisted by more than 60°", "{:.1%}", 0.001),
    "deep": ("frames with a limb deeper than 2 cm", "{:.1%}", 0.01),
}
"""Label, format and goal of each measure. That of the fastest joint is what was recorded."""
_RARE = ("twisted", "deep")
"""Measures of what should hardly happen, of which means are taken."""


@dataclass(frozen=True)
class Asked:
    """A sentence of a kind of act, its seconds, and the people who are measured."""

    words: str
    seconds: float
    people: str = "ab"


def kinds() -> dict[str, tuple[Asked, ...]]:
    """The sentences of each kind of act."""
    listed = tomllib.loads((HERE / "motion.toml").read_text(encoding="utf-8"))["kind"]
    return {kind["name"]: tuple(Asked(**each) for each in kind["sentences"]) for kind in listed}


def run_motion(*, steps: int = 8) -> dict[str, Any]:
    """Prints the table and gives its figures: ``{kind: {measure: {column: value}}}`` and the kind ``all``.

    Args:
        steps: DDIM steps.
    """
    real = json.loads(RECORDED.read_text(encoding="utf-8"))
    people: dict[str, tuple[list[Naturalness], list[Naturalness]]] = {}
    engine = Engine()
    for kind, sentences in kinds().items():
        people[kind] = ([], [])
        for asked in sentences:
            for seed in range(SEEDS):
                for measured, planned in zip(people[kind], (True, False), strict=True):
                    measured += _measured(_made(engine, asked, steps, seed, planned), asked.people)
    figures = {kind: _figures(measured, real.get(kind, {})) for kind, measured in people.items()}
    everyone = [[each for pair in people.values() for each in pair[column]] for column in (0, 1)]
    figures["all"] = _figures(everyone, real.get("all", {}))
    print(table(figures))
    return figures


def _made(engine: Engine, asked: Asked, steps: int, seed: int, planned: bool) -> Duet:
    fields: dict[str, Any] = {"steps": steps, "seed": seed, "split": planned, "planned": planned}
    *_, result = engine.run(GenerateRequest(prompt=asked.words, seconds=asked.seconds, **fields))
    assert isinstance(result, Result) and isinstance(result.duets[0], Duet)  # the last event of a run
    return result.duets[0]


def _measured(duet: Duet, people: str = "ab") -> list[Naturalness]:
    pair = duet.positions.astype(np.float64)
    return [naturalness(pair[i], duet.fps, pair[1 - i]) for i in ("ab".index(who) for who in people)]


def _figures(columns: Sequence[Sequence[Naturalness]], real: Mapping[str, float]) -> dict[str, dict[str, float]]:
    return {
        measure: {
            **{name: _median(measure, measured) for name, measured in zip(COLUMNS, columns, strict=False)},
            COLUMNS[2]: real.get(measure, math.nan),
        }
        for measure in MEASURES
    }


def _median(measure: str, people: Iterable[Naturalness]) -> float:
    """The median over people; of what should not happen at all, such as a limb in the other's body, the mean."""
    values = np.array([getattr(person, measure) for person in people], dtype=np.float64)
    values = values[np.isfinite(values)]
    if not len(values):
        return math.nan
    return float(values.mean() if measure in _RARE else np.median(values))


def table(figures: Mapping[str, Mapping[str, Mapping[str, float]]]) -> str:
    """The figures as text: a line a kind, planned / network alone / recorded of each measure."""
    lines = []
    for measure, (label, form, goal) in MEASURES.items():
        aim = "" if math.isnan(goal) else f"; goal {form.format(goal)}"
        lines.append(f"\n{label}{aim}\n{'':10}" + "".join(f"{name:>15}" for name in COLUMNS))
        for kind, row in figures.items():
            cells = [row[measure][name] for name in COLUMNS]
            shown = ["–" if math.isnan(cell) else form.format(cell) for cell in cells]
            lines.append(f"{kind:10}" + "".join(f"{cell:>15}" for cell in shown))
    return "\n".join(lines)
