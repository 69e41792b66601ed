"""Scores roles: role swaps and touches by region: ``python -m training.evaluate.roles``.

The two people of generated and of recorded motion are exchanged. Where an extractor of features hears roles,
retrieval must fall: it is counted over all test scenes and over those whose words give the two people
different parts. Touches by pair of body regions stand beside those of the recorded motion of the same words.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from motion import Duet, InputError
from motion.metrics import contact_precision_recall
from motion.metrics.generation import r_precision
from motion.metrics.sentences.scores import share
from motion.transforms import canonicalize
from training.core.shell import add_options, exit_code, write_scores
from training.corpus.families import load_families
from training.evaluate.extractor import load_extractor
from training.evaluate.judge.draw import Sampling, draw
from training.evaluate.judge.prompts import choose, real_duet
from training.evaluate.judge.report import physical
from training.evaluate.judge.retrieval import POOL, Features
from training.prepare import load
from webdemo.inference.engine import WEIGHTS
from webdemo.inference.pipelines.intergen import InterGenPipeline

POOLS = 20
"""Drawings of the pools of retrieval, over which R-precision is averaged."""


def of_two_parts(family: str) -> bool:
    """True if a family gives the two people different parts."""
    known = load_families().get(family)
    return known is not None and known.shows[:1] != known.shows[-1:]


def exchanged(duet: Duet) -> Duet:
    """The duet with its people exchanged, in the frame of every scene: the first at the origin, facing +Z.

    Without that the features would hear the place and not the roles.
    """
    swapped = duet.swapped()
    return swapped.with_positions(canonicalize(swapped.positions))


def swap_scores(
    duets: Sequence[Duet],
    captions: Sequence[str],
    features: Features,
    asked: Sequence[bool],
    *,
    seed: int = 0,
) -> dict[str, Any]:
    """Retrieval as the duets are and with their people exchanged.

    Args:
        asked: for every duet whether its words give the two people different parts.

    Returns:
        ``as_is`` and ``swapped``: R-precision top 1 to 3; ``nearer``: of the duets of two parts, how many
        are nearer to their words as they are than with people exchanged, and how many there are.

    Raises:
        InputError: if there are fewer duets than a pool of retrieval holds.
    """
    if len(duets) < POOL:
        raise InputError(f"{len(duets)} scenes are fewer than the {POOL} of retrieval: take more.")
    text = features.text(captions)
    kinds = {"as_is": features.motion(duets), "swapped": features.motion([exchanged(d) for d in duets])}
    gap = {name: np.linalg.norm(motion - text, axis=-1) for name, motion in kinds.items()}
    chosen = np.array(asked, dtype=bool)
    found: dict[str, Any] = {}
    for name, motion in kinds.items():
        rng = np.random.default_rng(seed)
        found[name] = np.mean([r_precision(motion, text, rng=rng, pool=POOL) for _ in range(POOLS)], axis=0)
        found[name] = [round(float(value), 4) for value in found[name]]
    nearer = gap["as_is"] < gap["swapped"]
    return found | {"nearer": [int(nearer[chosen].sum()), int(chosen.sum())]}


def evaluate(options: argparse.Namespace) -> dict[str, Any]:
    """All scores of the module."""
    scenes = load(options.scenes)
    rows = choose(scenes, options.prompts, seed=options.seed)
    tasks = [task for task, _ in rows]
    real = [real_duet(scenes, row) for _, row in rows]
    generator = InterGenPipeline(options.weights)
    sampling = Sampling(
        seed=options.seed, steps=options.steps, guidance=options.guidance, damping=options.damping
    )
    drawn = dict(draw(generator, tasks, sampling))
    made = [drawn[i] for i in range(len(tasks))]
    features = Features(load_extractor(options.extractor))
    captions, asked = [task.caption for task in tasks], [of_two_parts(task.family) for task in tasks]
    return {
        "about": f"{len(tasks)} test captions, seed {options.seed}; DDIM-{options.steps}, guidance "
        f"{options.guidance:g}, damping {options.damping:g}, weights {generator.digest[:12]}.",
        "roles": {
            "generated": swap_scores(made, captions, features, asked, seed=options.seed),
            "recorded": swap_scores(real, captions, features, asked, seed=options.seed),
        },
        "contacts": contact_precision_recall(made, real),
        "contacts_swapped": contact_precision_recall([duet.swapped() for duet in made], real),
        "physical": {"generated": physical(made), "recorded": physical(real)},
    }


def table(scores: dict[str, Any]) -> str:
    """The scores as Markdown."""
    lines = [scores["about"], "", "| Roles | Generated | Recorded |", "|---|---|---|"]
    made, real = scores["roles"]["generated"], scores["roles"]["recorded"]
    for place in range(3):
        cells = [
            f"{found['as_is'][place]:.3f} → {found['swapped'][place]:.3f} exchanged" for found in (made, real)
        ]
        lines.append(f"| R-precision top {place + 1} | {' | '.join(cells)} |")
    cells = [share(*found["nearer"]) for found in (made, real)]
    lines.append(f"| nearer to their words than exchanged, where the parts differ | {' | '.join(cells)} |")
    lines += ["", "| Touch | Precision | Recall | Recall, people exchanged |", "|---|---|---|---|"]
    for name, found in scores["contacts"].items():
        other = scores["contacts_swapped"][name]["recall"]
        lines.append(
            f"| {name} | {share(*found['precision'])} | {share(*found['recall'])} | {share(*other)} |"
        )
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.roles", description=__doc__)
    add_options(parser, "scenes", "out", "table", "seed", "steps", "guidance", "damping")
    parser.add_argument("--extractor", type=Path, required=True, help="training.evaluate.extractor's file")
    parser.add_argument("--weights", type=Path, default=WEIGHTS / "intergen", help="its folder")
    parser.add_argument("--prompts", type=int, default=192, help="how many captions (192)")
    options = parser.parse_args(argv)
    if options.prompts < POOL:
        parser.error(f"--prompts must be at least {POOL}, the size of a pool of retrieval.")

    def job() -> None:
        scores = evaluate(options)
        write_scores(options, scores, table(scores))

    return exit_code(job)


if __name__ == "__main__":
    sys.exit(main())
