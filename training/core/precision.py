"""Mixed precision where the hardware computes in bfloat16, and float32 elsewhere."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

import torch


def mixed_precision(device: str) -> AbstractContextManager[object]:
    """Autocast to bfloat16 on a GPU, or on a CPU with AVX-512 BF16 or AMX.

    On another CPU, bfloat16 products are emulated and take three times as long as float32.
    """
    if torch.device(device).type == "cpu":
        found = torch.cpu.get_capabilities()
        if not (found.get("avx512_bf16") or found.get("amx_bf16")):
            return nullcontext()
    return torch.autocast(torch.device(device).type, torch.bfloat16)
