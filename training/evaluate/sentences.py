"""Scores motions of eighty sentences from elsewhere: ``python -m training.evaluate.sentences``.

Draws four seeds of each sentence of :mod:`motion.metrics.sentences` with any weights folder and
judges them by the sentences' own rules. What was drawn is kept, so that a run that was stopped goes on, rules
can be judged again in seconds, and the motions of two models can be looked at in pairs
(:mod:`training.evaluate.blind`).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from motion import InputError
from motion.metrics.sentences import load_sentences, read_sentences
from motion.metrics.sentences.scores import score, table
from training.core.shell import add_options, exit_code, write_scores
from training.evaluate.judge.draw import Sampling
from training.evaluate.judge.kept_motions import draw_missing, motions_folder
from training.evaluate.judge.listening import listening, said
from webdemo.inference.engine import WEIGHTS
from webdemo.inference.pipelines.intergen import InterGenPipeline


def evaluate(options: argparse.Namespace) -> dict[str, Any]:
    """Scores as :func:`motion.metrics.sentences.scores.table` takes them; draws what is missing."""
    known = read_sentences(options.sentences) if options.sentences else load_sentences()
    sentences = [s for s in known if not options.only or {s.id, *s.tags} & set(options.only)]
    if not sentences:
        raise InputError(f"No sentence has the name or tag {', '.join(options.only)}: see sentences.json.")
    sampling = Sampling(
        steps=options.steps,
        guidance=options.guidance,
        damping=options.damping,
    )
    generator = InterGenPipeline(options.weights)
    motions = motions_folder(options.cache, generator.digest, sampling)
    seeds = range(options.seeds)
    missing = draw_missing(generator, sentences, seeds, sampling, motions, minutes=options.minutes)
    duets = [[motions.read(s, k) for k in seeds if motions.path(s, k).is_file()] for s in sentences]
    settings = {
        "steps": options.steps,
        "guidance": options.guidance,
        "damping": options.damping,
        "seeds": options.seeds,
        "weights_sha256": generator.digest,
        "motions": str(motions.folder.name),
    }
    about = (
        f"{len(sentences)} sentences, {sum(map(len, duets))} motions, seeds 0 to {options.seeds - 1}; "
        f"DDIM-{options.steps}, guidance {options.guidance:g}, damping {options.damping:g}, weights "
        f"{generator.digest[:12]}"
    )
    if missing:
        about += f"; stopped by --minutes with {missing} motions missing"
    listened = listening([[pair.positions for pair in each] for each in duets])
    about += f".{said(listened)}"
    return score(sentences, duets) | {"about": about, "settings": settings, "listening": listened}


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m training.evaluate.sentences",
        description="Judge a generator on sentences that no training has seen.",
    )
    parser.add_argument("--weights", type=Path, default=WEIGHTS / "intergen", help="its folder")
    parser.add_argument("--cache", type=Path, required=True, help="folder that keeps the motions")
    add_options(parser, "out", "table", "steps", "guidance", "damping")
    parser.add_argument("--beside", type=Path, help="JSON file of another run, shown beside this one")
    parser.add_argument("--seeds", type=int, default=4, help="motions of each sentence (4)")
    parser.add_argument("--sentences", type=Path, help="others than the eighty, as a file of their kind")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="only these sentences or tags")
    parser.add_argument("--minutes", type=float, default=0.0, help="draw no more after this; 0: no limit")
    options = parser.parse_args(argv)
    if options.seeds < 1 or options.steps < 1:
        parser.error("--seeds and --steps must be at least 1.")

    def job() -> None:
        beside = _read(options.beside) if options.beside else None
        scores = evaluate(options)
        write_scores(options, scores, table(scores, beside))

    return exit_code(job)


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text())
        return {key: found[key] for key in ("tags", "conditions", "physical")}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path.name} holds no scores: name the --out file of another run.") from error


if __name__ == "__main__":
    sys.exit(main())
