"""The speed of a released InterGen of the settings, over that of a plain run of the same file."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

import torch

from models.intergen.released import load_released
from models.text.clip import find_vocabulary
from models.threads import CORES
from motion import InputError
from webdemo.inference.engine import Engine
from webdemo.inference.own import read_entries
from webdemo.inference.pipelines.intergen import ReleasedInterGenPipeline
from webdemo.inference.requests import GenerateRequest

from .plain import PlainSampler

PROMPT = "Two people shake hands."
GOAL = 3.0


def measure_released(name: str, *, seconds: float, steps: int, repeats: int) -> dict[str, Any]:
    """Times a model and a :class:`PlainSampler` of the same file, turn by turn.

    Args:
        name: of a released InterGen in the settings.
        seconds: length of the motion.
        steps: denoising steps of each run.
        repeats: how often both are run.

    Returns:
        ``released_plain_step`` and ``released_step``, seconds a step, medians; ``released_plain_over_ours``, the
        median of the ratios of neighbouring runs, and its least and largest; the goal.

    Raises:
        InputError: if the settings have no released InterGen of this name.
    """
    engine = Engine()
    ours: Any = engine.pipeline(name)
    entry = read_entries()[0].get(name)
    if entry is None or not isinstance(ours, ReleasedInterGenPipeline):
        raise InputError(f'{name} is no released InterGen of the settings: name one with method = "intergen".')
    vocabulary = entry.file("vocabulary") if "vocabulary" in entry.files else find_vocabulary()
    whole = load_released(entry.file("checkpoint"), entry.file("mean"), entry.file("std"), vocabulary)
    request = GenerateRequest(prompt=PROMPT, seconds=seconds, steps=steps, model=name, guidance=3.5, cleanup=False)
    plain = PlainSampler(whole.denoiser, ours, request, spacing=ours.spacing)

    def run_plain() -> None:
        torch.set_num_threads(CORES)
        plain.run()

    def run_ours() -> None:
        for _ in engine.run(request):
            pass

    turns = [(_seconds(run_plain) / steps, _seconds(run_ours) / steps) for _ in range(repeats)]
    ratios = [slow / fast for slow, fast in turns]
    return {
        "released_plain_step": statistics.median(slow for slow, _ in turns),
        "released_step": statistics.median(fast for _, fast in turns),
        "released_plain_over_ours": statistics.median(ratios),
        "released_plain_over_ours_least": min(ratios),
        "released_plain_over_ours_largest": max(ratios),
        "released_plain_over_ours_goal": GOAL,
    }


def _seconds(job: Callable[[], None]) -> float:
    began = time.perf_counter()
    job()
    return time.perf_counter() - began
