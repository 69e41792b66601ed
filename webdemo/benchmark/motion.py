"""Measures of planned motion beside the network's own and recorded motion, by kind of act.

``python -m webdemo benchmark --motion`` makes the sentences of ``motion.toml`` with and without their plans and prints
medians over people (:mod:`motion.metrics.quality`), so that walks are compared with walks. What was recorded is in
``recorded.json``; ``--recorded FOLDER`` measures it anew.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motion import Clip, Duet, InputError
from motion.formats.files import write_text
from motion.metrics.quality import Naturalness, joint_speeds, naturalness

HERE = Path(__file__).parent
RECORDED = HERE / "recorded.json"
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
_SHORTEST = 30
"""Frames of a recording that is measured."""


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


def run_motion(
    *, steps: int = 8, seeds: int = 2, recorded: Path | None = None, only: Sequence[str] = ()
) -> dict[str, Any]:
    """Prints the table and gives its figures: ``{kind: {measure: {column: value}}}`` and the kind ``all``.

    Args:
        steps: DDIM steps.
        seeds: motions of each sentence.
        recorded: a folder with a folder of motion files for each kind; measured and written to ``recorded.json``.
        only: these kinds alone.

    Raises:
        InputError: for an unknown kind, or a folder without recordings.
    """
    listed = kinds()
    if unknown := [kind for kind in only if kind not in listed]:
        raise InputError(f"There is no kind of act {unknown[0]!r}: choose from {', '.join(listed)}.")
    if recorded is not None:
        write_text(RECORDED, json.dumps(measured_folder(recorded, listed), indent=1) + "\n")
    real = json.loads(RECORDED.read_text(encoding="utf-8")) if RECORDED.is_file() else {}
    people: dict[str, tuple[list[Naturalness], list[Naturalness]]] = {}
    make = _maker(steps)
    for kind, sentences in listed.items():
        if only and kind not in only:
            continue
        people[kind] = ([], [])
        for asked in sentences:
            for seed in range(seeds):
                for found, planned in zip(people[kind], (True, False), strict=True):
                    found += _measured(make(asked, seed, planned), asked.people)
    figures = {kind: _figures(found, real.get(kind, {})) for kind, found in people.items()}
    everyone = [[each for pair in people.values() for each in pair[column]] for column in (0, 1)]
    figures["all"] = _figures(everyone, real.get("all", {}))
    print(table(figures))
    return figures


def _maker(steps: int) -> Callable[[Asked, int, bool], Duet]:
    from webdemo.inference.engine import Engine
    from webdemo.inference.requests import GenerateRequest
    from webdemo.inference.run import Result

    engine = Engine()

    def make(asked: Asked, seed: int, planned: bool) -> Duet:
        request = GenerateRequest(
            prompt=asked.words, seconds=asked.seconds, steps=steps, seed=seed, split=planned, planned=planned
        )
        *_, result = engine.run(request)
        assert isinstance(result, Result)  # the last event of a run
        duet = result.duets[0]
        assert isinstance(duet, Duet)  # both people are made
        return duet

    return make


def _measured(duet: Duet, people: str = "ab") -> list[Naturalness]:
    pair = duet.positions.astype(np.float64)
    return [naturalness(pair[i], duet.fps, pair[1 - i]) for i in ("ab".index(who) for who in people)]


def _figures(columns: Sequence[Sequence[Naturalness]], real: Mapping[str, float]) -> dict[str, dict[str, float]]:
    return {
        measure: {
            **{name: _median(measure, found) for name, found in zip(COLUMNS, columns, strict=False)},
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


def measured_folder(folder: Path, listed: Iterable[str]) -> dict[str, dict[str, float]]:
    """Medians over the people recorded in ``folder/KIND``, for each kind and for all of them.

    Raises:
        InputError: where none of the kinds has a recording that can be read.
    """
    found: dict[str, list[tuple[Naturalness, np.ndarray]]] = {}
    for kind in listed:
        people = [each for path in sorted((folder / kind).glob("*")) for each in _recorded(path)]
        if people:
            found[kind] = people
    if not found:
        raise InputError(
            f"{folder} holds no recordings: give a folder with a folder of motion files for each kind of act, such as "
            f"{folder / 'walk'}."
        )
    found["all"] = [each for people in found.values() for each in people]
    return {kind: _real(people) for kind, people in found.items()}


def _real(people: Sequence[tuple[Naturalness, np.ndarray]]) -> dict[str, float]:
    figures = {measure: _median(measure, [one for one, _ in people]) for measure in MEASURES}
    figures["fastest"] = float(np.percentile(np.concatenate([speeds.ravel() for _, speeds in people]), 99.9))
    rounded = {measure: round(value, 4) for measure, value in figures.items() if math.isfinite(value)}
    return {"people": len(people), **rounded}


def _recorded(path: Path) -> list[tuple[Naturalness, np.ndarray]]:
    """The people of a file with their joints' speeds; none where it cannot be read or is too short."""
    from motion.formats import can_read, read, read_pair

    partner = path.with_name(path.name.replace("_a.", "_b."))
    paired = "_b." in path.name and path.with_name(path.name.replace("_b.", "_a.")).is_file()
    if not path.is_file() or not can_read(path.suffix) or paired:  # b is read with a
        return []
    try:
        motion = read_pair(path, partner) if partner != path and partner.is_file() else read(path)
    except InputError as error:
        print(f"{path.name} is left out: {error}")
        return []
    if motion.num_frames < _SHORTEST:
        return []
    if isinstance(motion, Clip):
        positions = motion.positions.astype(np.float64)
        return [(naturalness(positions, motion.fps), joint_speeds(positions, motion.fps))]
    speeds = [joint_speeds(person, motion.fps) for person in motion.positions.astype(np.float64)]
    return list(zip(_measured(motion), speeds, strict=True))


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
