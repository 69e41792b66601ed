"""Random poses."""

from __future__ import annotations

import numpy as np
import torch


def poses(seed: int, *size: int) -> torch.Tensor:
    return torch.from_numpy(np.random.default_rng(seed).normal(size=size)).float()
