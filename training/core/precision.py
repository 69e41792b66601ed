"""Mixed precision where the hardware computes in bfloat16, and float32 elsewhere."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

import torch

from models.compiled import has_bfloat16


def mixed_precision(device: str) -> AbstractContextManager[object]:
    """Autocast to bfloat16 on a GPU, or on a CPU with AVX-512 BF16 or AMX.

    On another CPU, bfloat16 products are emulated and take three times as long as float32.
    """
    kind = torch.device(device).type
    return nullcontext() if kind == "cpu" and not has_bfloat16() else torch.autocast(kind, torch.bfloat16)
