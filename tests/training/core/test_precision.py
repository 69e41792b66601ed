"""Mixed precision is used only where the hardware computes in it."""

import pytest
import torch

from training.core.loop import mixed_precision


@pytest.mark.parametrize(
    ("capability", "wanted"), [(None, torch.float32), ("avx512_bf16", torch.bfloat16), ("amx_bf16", torch.bfloat16)]
)
def test_a_cpu_without_bfloat16_computes_in_float32(
    monkeypatch: pytest.MonkeyPatch, capability: str | None, wanted: torch.dtype
) -> None:
    found = {"avx512_f": True, "avx512_bf16": False, "amx_bf16": False} | ({capability: True} if capability else {})
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: found)
    with mixed_precision("cpu"):
        product = torch.ones(2, 2) @ torch.ones(2, 2)
    assert product.dtype == wanted
