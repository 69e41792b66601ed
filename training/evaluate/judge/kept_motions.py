"""Motions of the sentences by one generator, kept in a folder, so an interrupted run can resume."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

from motion.metrics.sentences import Sentence
from motion.metrics.sentences.kept import FPS, Motions
from training.evaluate.judge.draw import Sampling, draw
from training.evaluate.judge.rules import Task
from webdemo.inference.pipelines.intergen import InterGenPipeline


def motions_folder(cache: Path, digest: str, sampling: Sampling) -> Motions:
    """The folder for motions of these weights and settings."""
    name = f"{digest[:12]}-ddim{sampling.steps}-g{sampling.guidance:g}-d{sampling.damping:g}"
    return Motions(cache / name)


def draw_missing(
    generator: InterGenPipeline,
    sentences: Sequence[Sentence],
    seeds: Sequence[int],
    sampling: Sampling,
    motions: Motions,
    *,
    minutes: float = 0.0,
) -> int:
    """Draws what the folder does not hold yet; the page gives the same motion for a sentence and its seed.

    Args:
        minutes: draw no more after this time; 0 is no limit.

    Returns:
        motions that are still missing.
    """
    wanted = [(s, k) for k in seeds for s in sentences if not motions.path(s, k).is_file()]
    tasks = [Task(s.words, "", {}, round(FPS * s.seconds)) for s, _ in wanted]
    motions.folder.mkdir(parents=True, exist_ok=True)
    began, done = time.perf_counter(), 0
    for i, duet in draw(generator, tasks, sampling, [k for _, k in wanted]):
        motions.write(*wanted[i], duet)
        done += 1
        seconds = time.perf_counter() - began
        print(f"\r{done} of {len(wanted)} drawn, {seconds:.0f} s", end="", file=sys.stderr, flush=True)
        if minutes and seconds > 60 * minutes:
            break
    if done:
        print(file=sys.stderr)
    return len(wanted) - done
