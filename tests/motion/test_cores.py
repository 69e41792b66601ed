"""The number of cores that a process counts on."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from motion.cores import usable_cores


@pytest.mark.parametrize(
    ("quota", "cores"),
    [
        ("max 100000", 8),
        ("150000 100000", 2),
        ("10000 100000", 1),
        ("900000 100000", 8),
        ("5 0", 8),
        ("", 8),
        (None, 8),
    ],
)
def test_a_quota_is_rounded_up(quota: str | None, cores: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    if quota is not None:
        (tmp_path / "cpu.max").write_text(quota)
    assert usable_cores(tmp_path / "cpu.max") == cores


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system has no affinity")
def test_a_process_of_one_core_counts_one_and_takes_two_live_streams() -> None:
    core = min(os.sched_getaffinity(0))
    script = f"""
import os
os.sched_setaffinity(0, {{{core}}})
from webdemo.server.settings import Settings
from motion.cores import usable_cores
from models.compiled import THREADS
print(usable_cores(), Settings().live, THREADS)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=300)
    assert done.stdout.split() == ["1", "2", "1"]
