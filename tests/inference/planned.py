"""Motions of a sentence, of which the tests look at what was planned."""

from __future__ import annotations

from typing import Any

import numpy as np

from motion import SMPL22
from webdemo.inference import Engine, GenerateRequest

from .runs import positions, run

QUICK: dict[str, Any] = {"steps": 3, "seed": 1}
FEET = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]
WRISTS = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]


def made(engine: Engine, prompt: str, **fields: Any) -> np.ndarray:
    return positions(run(engine, GenerateRequest(prompt=prompt, **{"seconds": 4.0, **QUICK, **fields})))


def heights(motion: np.ndarray, person: int) -> np.ndarray:
    return motion[person, :, 0, 1]
