"""The number of cores that a process counts on."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from motion.cores import usable_cores


@pytest.mark.parametrize(("quota", "cores"), [("max 100000", 8), ("150000 100000", 2), ("5 0", 8), (None, 8)])
def test_a_quota_is_rounded_up(quota: str | None, cores: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    if quota is not None:
        (tmp_path / "cpu.max").write_text(quota)
    assert usable_cores(tmp_path / "cpu.max") == cores
