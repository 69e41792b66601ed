"""ReGenNet online in front of actors that it never saw: ``python -m training.evaluate.online --corpus DIR …``.

The actors are those of a corpus' test scenes and, with ``--data``, those of the test lists of SBU and K3HI. Nobody
tells the network what the actor does. The figures are what a classifier does not see: whether people touch where they
should, and only there, whether they walk through one another, shake or slide.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import Duet, InputError
from motion.formats.files import write_text
from motion.metrics import contact_events, foot_skate, pelvis_distance
from training.core.shell import add_options, exit_code
from training.corpus.pairs import load_pairs
from training.evaluate.judge.reactions import LONGEST
from training.evaluate.reactions import SHORTEST
from training.prepare import load_corpus
from webdemo.inference import Engine, ReactRequest, Result
from webdemo.inference.methods import WEIGHTS

Array = NDArray[np.floating]

FPS = 30.0
NEAR = 0.2
"""Metres between two pelvises that stand in one another."""
COLUMNS = {
    "due": "Contact where due %",
    "undue": "Contact where none is due %",
    "near": "Frames with pelvises under 20 cm %",
    "nearest": "Nearest pelvises m",
    "jerk": "Jerk m/s³",
    "skate": "Foot skate cm/s",
    "off": "From the recorded reactor m",
}
"""Heads of the table by measure."""


@dataclass(frozen=True)
class Measures:
    """The measures of one reaction.

    Attributes:
        touches: whether the two touch at any time.
        due: whether they do in the recorded or composed scene.
        near: percentage of the frames whose pelvises are nearer than :data:`NEAR`.
        nearest: least distance of the pelvises, metres.
        jerk: of the reactor's joints, m/s³.
        skate: of the feet of both, cm/s.
        off: mean distance of the reactor's joints from the scene's reactor, metres.
    """

    touches: bool
    due: bool
    near: float
    nearest: float
    jerk: float
    skate: float
    off: float


def measures(scene: Array, reactor: Array) -> Measures:
    """The measures of a reactor (T, 22, 3) to person a of a scene (2, T, 22, 3), both in metres at 30 fps."""
    made = Duet.from_positions(np.stack([scene[0], reactor]), fps=FPS)
    gap = pelvis_distance(made)
    third = np.diff(reactor.astype(np.float64), n=3, axis=0) * FPS**3
    return Measures(
        touches=bool(contact_events(made)),
        due=bool(contact_events(Duet.from_positions(scene, fps=FPS))),
        near=float(100 * (gap < NEAR).mean()),
        nearest=float(gap.min()),
        jerk=float(np.linalg.norm(third, axis=-1).mean()),
        skate=foot_skate(made).speed,
        off=float(np.linalg.norm(reactor - scene[1], axis=-1).mean()),
    )


def means(found: Sequence[Measures]) -> dict[str, float]:
    """The table's figures of many reactions, by the keys of :data:`COLUMNS`; nan where no scene counts."""

    def touching(due: bool) -> float:
        of = [one.touches for one in found if one.due == due]
        return 100 * float(np.mean(of)) if of else float("nan")

    others = ("near", "nearest", "jerk", "skate", "off")
    return {"due": touching(True), "undue": touching(False)} | {
        name: float(np.mean([getattr(one, name) for one in found])) for name in others
    }


def held_out_scenes(corpus: Path | None, data: Path | None, cache: Path | None) -> dict[str, list[Array]]:
    """Test scenes (2, T, 22, 3), ten seconds at most, by where they are from."""
    found: dict[str, list[Array]] = {}
    if corpus:
        motions, index = load_corpus(corpus)
        found["composed"] = [
            np.array(motions[row["start"] : row["start"] + min(row["frames"], LONGEST)]).swapaxes(0, 1)
            for row in index
            if row["split"] == "test" and row["frames"] >= SHORTEST
        ]
    if data:
        found["recorded"] = [
            scene.positions[:, :LONGEST]
            for scene in load_pairs(data, cache)
            if scene.split != "train" and scene.positions.shape[1] >= SHORTEST
        ]
    if not any(found.values()):
        raise InputError("There is no test scene: give --corpus or --data with a test split.")
    return found


def reaction(engine: Engine, scene: Array, *, given: bool, seed: int) -> Array:
    """The reactor (T, 22, 3) that the network makes online, without words; ``given``: their first pose is."""
    actor = Duet.from_positions(scene, fps=FPS).a
    pose = scene[1, 0] if given else None
    request = ReactRequest(actor=actor, model="regennet", mode="online", steps=5, seed=seed, first_pose=pose)
    result = next(event for event in engine.run(request) if isinstance(event, Result))
    return np.asarray(result.duets[0].b.positions)


def rows(
    scenes: dict[str, list[Array]], weights: Sequence[Path], samples: int
) -> Iterator[tuple[str, dict[str, float]]]:
    """Name and figures of each line of the table."""
    for kind, chosen in scenes.items():
        if not chosen:
            continue
        yield f"{kind}, {len(chosen)} scenes: as they are", means([measures(one, one[1]) for one in chosen])
        for folder in weights:
            engine = Engine(folder)
            for given in (True, False):
                made = [
                    measures(one, reaction(engine, one, given=given, seed=seed))
                    for seed in range(samples)
                    for one in chosen
                ]
                begin = "first pose given" if given else "first pose open"
                yield f"{kind}: {folder}, {begin}", means(made)


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.online", description=__doc__)
    parser.add_argument("--corpus", type=Path, help="folder of `python -m training.corpus`")
    parser.add_argument("--data", type=Path, help="folder that holds sbu and k3hi")
    add_options(parser, "cache")
    parser.add_argument(
        "--weights", type=Path, nargs="+", default=[WEIGHTS],
        help="folders that hold a folder regennet (models/weights)",
    )  # fmt: skip
    parser.add_argument("--samples", type=int, default=1, help="reactions to every actor (1)")
    parser.add_argument("--out", type=Path, help="JSON file for the figures, which are printed too")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    scenes = held_out_scenes(options.corpus, options.data, options.cache)
    print(f"| Reactor | {' | '.join(COLUMNS.values())} |")
    print("|---" * (1 + len(COLUMNS)) + "|")
    found = {}
    for name, figures in rows(scenes, options.weights, options.samples):
        found[name] = figures
        print(f"| {name} | {' | '.join(f'{figures[key]:.2f}' for key in COLUMNS)} |", flush=True)
    if options.out:
        write_text(options.out, json.dumps(found, indent=1))


if __name__ == "__main__":
    raise SystemExit(main())
