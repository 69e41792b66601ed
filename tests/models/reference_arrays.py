"""Reading the reference arrays: inputs, seeded weights and the outputs that the released networks give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from torch import Tensor

FOLDER = Path(__file__).parents[1] / "data" / "reference"
TOLERANCE = 1e-4


class Reference:
    """One reference file: `ref["name"]` is a tensor, `ref.weights()` the tensors under ``weights/``."""

    def __init__(self, name: str) -> None:
        with np.load(FOLDER / f"{name}.npz", allow_pickle=False) as arrays:
            self.arrays = {key: torch.from_numpy(arrays[key]) for key in arrays.files}

    def __getitem__(self, name: str) -> Tensor:
        return self.arrays[name]

    def weights(self, prefix: str = "") -> dict[str, Tensor]:
        prefix += "weights/"
        return {k.removeprefix(prefix): v for k, v in self.arrays.items() if k.startswith(prefix)}


def assert_equal(found: Tensor, expected: Tensor, tolerance: float = TOLERANCE) -> None:
    assert found.shape == expected.shape
    assert found.dtype == expected.dtype
    assert (found - expected).abs().max().item() < tolerance
