"""Reactions of forty seconds to dancers: ``python -m training.evaluate.long_reactions --takes DIR``.

Chopin's thesis (section 3.5) makes long reactions of InterFormer from parts, each from the last pose of the one
before. Here the actors are recorded dancers, on whom no model was trained: a folder of ``NAME_a.bvh`` and
``NAME_b.bvh``, such as the twelve salsa takes of CMU MoCap. InterFormer gets the whole take, as on the page; ReGenNet
takes ten seconds, so it is asked part by part. All begin in the recorded first pose and are told no words.

The figures are given by ten seconds, so that it shows whether a reactor drifts off or comes to rest.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import Duet, InputError
from motion.formats import read_pair
from motion.metrics import foot_skate, pelvis_distance
from motion.transforms import resample
from motion.vectors import wrapped
from training.core.shell import add_options, exit_code
from training.corpus.duets import pairs_in
from training.evaluate.futures import facings
from training.evaluate.online import NEAR
from webdemo.inference import Engine, ReactRequest, Result

Array = NDArray[np.floating]
React = Callable[[Array], Array]
"""(2, T, 22, 3) people → (T, 22, 3) the reactor."""

FPS, PART, LONGEST = 30.0, 300, 1200
"""Frames a second, of a part, and of a take at most."""
COLUMNS = (
    "Pelvises m", "Frames under 20 cm %", "Facing °", "Speed over the recorded", "Jerk m/s³", "Foot skate cm/s",
    "From the recorded reactor m",
)  # fmt: skip


def takes(folder: Path, only: Collection[str] = ()) -> list[Array]:
    """Pairs of dancers (2, T, 22, 3) at 30 fps, forty seconds at most; ``only`` names takes, all by default.

    Raises:
        InputError: if the folder holds no pair that lasts ten seconds.
    """
    found = []
    for name, a, b in pairs_in(folder):
        if only and name not in only:
            continue
        duet = read_pair(a, b)
        people = duet.positions.astype(np.float64)
        if duet.fps != FPS:
            people = np.stack([resample(person, duet.fps, FPS) for person in people])
        if people.shape[1] >= PART:
            found.append(people[:, :LONGEST])
    if not found:
        raise InputError(f"{folder} holds no NAME_a.bvh beside NAME_b.bvh of ten seconds or more.")
    return found


def whole(engine: Engine, fields: Mapping[str, Any], people: Array) -> Array:
    """The reactor of one request, from the recorded first pose."""
    actor = Duet.from_positions(people, fps=FPS).a
    request = ReactRequest(actor=actor, first_pose=people[1, 0], **fields)
    result = next(event for event in engine.run(request) if isinstance(event, Result))
    return np.asarray(result.duets[0].b.positions)


def in_parts(react: React, people: Array) -> Array:
    """The reactor, ten seconds at a time, each part from the last pose of the one before.

    A last part of less than a second begins earlier, so that a network takes it.
    """
    frames = people.shape[1]
    made = people[1].copy()
    first = 0
    while first < frames - 1:
        last = min(first + PART, frames)
        begin = min(first, max(0, last - int(FPS) - 1))
        part = np.stack([people[0, begin:last], made[begin:last]])
        made[first + 1 : last] = react(part)[first + 1 - begin :]
        first = last - 1
    return made


def figures(people: Array, reactor: Array) -> Array:
    """The measures of :data:`COLUMNS` of a part: (2, T, 22, 3) people and another reactor (T, 22, 3)."""
    made = np.stack([people[0], reactor])
    gap = pelvis_distance(Duet.from_positions(made, fps=FPS))
    third = np.diff(reactor, n=3, axis=0) * FPS**3
    speeds = [np.linalg.norm(np.diff(person, axis=0), axis=-1).mean() for person in (reactor, people[1])]
    return np.array([
        gap.mean(), 100 * (gap < NEAR).mean(), np.degrees(np.abs(wrapped(facings(made)[1]))).mean(),
        speeds[0] / speeds[1], np.linalg.norm(third, axis=-1).mean(),
        foot_skate(Duet.from_positions(made, fps=FPS)).speed, np.linalg.norm(reactor - people[1], axis=-1).mean(),
    ])  # fmt: skip


def by_part(pairs: Sequence[Array], reactors: Sequence[Array]) -> list[tuple[int, Array]]:
    """Takes and mean figures of each ten seconds; of a take's last part, at least five count."""
    found: list[tuple[int, Array]] = []
    for first in range(0, LONGEST, PART):
        parts = [
            figures(people[:, first : first + PART], reactor[first : first + PART])
            for people, reactor in zip(pairs, reactors, strict=True)
            if people.shape[1] >= first + PART // 2
        ]
        if parts:
            found.append((len(parts), np.mean(parts, axis=0)))
    return found


def methods(engine: Engine, seed: int) -> dict[str, React]:
    """The reactors that are compared, by name."""
    regennet: dict[str, Any] = {"model": "regennet", "steps": 5, "damping": 0.0, "seed": seed}
    return {
        "Recorded": lambda people: people[1],
        "Zero velocity": lambda people: np.repeat(people[1, :1], people.shape[1], axis=0),
        "InterFormer": partial(whole, engine, {"model": "interformer", "seed": seed}),
        "ReGenNet, online": partial(in_parts, partial(whole, engine, regennet | {"mode": "online"})),
        "ReGenNet, offline": partial(in_parts, partial(whole, engine, regennet | {"mode": "offline"})),
    }


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.long_reactions", description=__doc__)
    parser.add_argument("--takes", type=Path, required=True, help="folder of NAME_a.bvh and NAME_b.bvh")
    add_options(parser, "weights", "seed")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    pairs, engine = takes(options.takes), Engine(options.weights)
    print(f"| Reactor | Seconds (takes) | {' | '.join(COLUMNS)} |")
    print("|---|---|" + "---:|" * len(COLUMNS))
    for name, react in methods(engine, options.seed).items():
        for place, (count, values) in enumerate(by_part(pairs, [react(people) for people in pairs])):
            cells = " | ".join(f"{value:.2f}" for value in values)
            print(f"| {name} | {10 * place} to {10 * place + 10} ({count}) | {cells} |", flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
