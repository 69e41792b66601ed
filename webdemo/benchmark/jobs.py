"""The jobs that people of the load test ask for: :data:`KINDS` of them, drawn by their own dice."""

from __future__ import annotations

import json
import random
from dataclasses import dataclass
from typing import Any

from webdemo.inference.requests import GenerateRequest
from webdemo.server.queue.turns import units

from . import PROMPTS

SHEET = "render"


@dataclass(frozen=True)
class Job:
    """A request that a simulated person sends.

    Attributes:
        endpoint: name of the endpoint.
        data: its arguments; None stands for an uploaded :data:`CLIP`.
        asked: fields of the request that the result's manifest must hold.
        work: units of work, see :func:`webdemo.server.queue.turns.units`.
    """

    endpoint: str
    data: tuple[Any, ...]
    asked: dict[str, Any]
    work: float


def _generation(dice: random.Random, steps: int) -> Job:
    r = GenerateRequest(
        prompt=dice.choice(PROMPTS),
        seconds=dice.choice((2.0, 4.0, 5.0)),
        seed=dice.randrange(2**32),
        samples=dice.choice((1, 1, 1, 2)),
        steps=dice.choice((max(steps // 2, 1), steps)),
    )
    run = (r.prompt, r.seconds, r.seed, r.samples, r.guidance, r.steps, r.damping, r.sampler, r.model, r.tries)
    return Job("generate", run, json.loads(json.dumps(r.to_dict())), units(r))


def _reaction(dice: random.Random, steps: int) -> Job:
    seed, seconds = dice.randrange(2**32), 2.0
    chosen = (None, "", "a", 0, seconds, "a", seed, 1, 3.0, steps, 0.7, "ddim", "intergen", "offline")
    data = (*chosen, False, "", 0, "", "")
    return Job("react", data, {"kind": "react", "seed": seed, "steps": steps}, seconds * steps + 10)


def _prediction(dice: random.Random, steps: int) -> Job:
    seconds = dice.choice((0.5, 1.0, 1.5))
    data = (None, 1.5, seconds, "motion-mlp", 0, "", 0, "", "")
    return Job("predict", data, {"kind": "predict", "seconds": seconds}, seconds + 10)


def _sheet(dice: random.Random, steps: int) -> Job:
    """A contact sheet, which waits in the queue of events."""
    look = ("png", "bodies", "light", "threequarter", 24, dice.choice((480, 640)), 360)
    return Job(SHEET, (None, *look, "", 0, "", ""), {}, 1.0)


KINDS = (_generation, _generation, _generation, _generation, _reaction, _sheet, _prediction)
"""Jobs are drawn from these, so a kind that stands here twice is twice as frequent; a person's first is fixed."""
