"""Reading the reference arrays: inputs, seeded weights and the outputs that the released networks give."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

FOLDER = Path(__file__).parents[1] / "data" / "reference"
TOLERANCE = 1e-4


def made_weights(shapes: Mapping[str, tuple[int, ...]], seed: int) -> dict[str, Tensor]:
    """Weights made from their names, for references whose weights are too large to store.

    Normal with a deviation of 0.05; the scales of norms are around 1, running variances above it.
    """
    weights = {}
    for name, shape in shapes.items():
        rng = np.random.default_rng(zlib.crc32(name.encode()) + seed)
        w = (0.05 * rng.standard_normal(shape)).astype(np.float32)
        if name.endswith("running_var"):
            w = abs(w) + 1
        elif name.endswith("num_batches_tracked"):
            w = np.int64(1)
        elif name.endswith("weight") and any(part in name for part in ("norm", "blocker", "ln_", "clip_ln")):
            w = w + 1
        weights[name] = torch.as_tensor(w)
    return weights


class Reference:
    """One reference file: `ref["name"]` is a tensor, `ref.weights()` the tensors under ``weights/``.

    Where the file names its weights and does not hold them, `ref.made_weights()` makes them.
    """

    def __init__(self, name: str) -> None:
        with np.load(FOLDER / f"{name}.npz", allow_pickle=False) as file:
            arrays = {key: file[key] for key in file.files}
        names, sizes = (arrays.pop(key, np.array([])).tolist() for key in ("names", "shapes"))
        self.shapes = {
            name: tuple(int(n) for n in size.split(",") if n) for name, size in zip(names, sizes, strict=True)
        }
        self.arrays = {key: torch.as_tensor(value) for key, value in arrays.items()}

    def made_weights(self) -> dict[str, Tensor]:
        """See :func:`made_weights`."""
        return made_weights(self.shapes, int(self["seed"]))

    def __getitem__(self, name: str) -> Tensor:
        return self.arrays[name]

    def weights(self, prefix: str = "") -> dict[str, Tensor]:
        prefix += "weights/"
        return {k.removeprefix(prefix): v for k, v in self.arrays.items() if k.startswith(prefix)}


def assert_equal(found: Tensor, expected: Tensor, tolerance: float = TOLERANCE) -> None:
    assert found.shape == expected.shape
    assert found.dtype == expected.dtype
    assert (found - expected).abs().max().item() < tolerance
