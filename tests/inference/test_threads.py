"""A run takes the cores that are free, and one where more would not help."""

import subprocess
import sys
from pathlib import Path

import pytest
import torch

from models import compiled as threads
from webdemo.inference.engine import Engine
from webdemo.inference.requests import GenerateRequest

ROOT = Path(__file__).resolve().parents[2]
LOADING = """
import types
from webdemo.inference import methods
from webdemo.inference.engine import Engine
seen = []
def load(folder):
    import torch
    seen.append(torch.get_num_threads())
    return types.SimpleNamespace()
methods.method = lambda name: types.SimpleNamespace(needs=(), weights=None, load=load)
Engine().pipeline("any")
from models.compiled import CORES, THREADS
print(seen[0], THREADS, CORES)
"""


@pytest.mark.parametrize(("running", "free"), [(1, 4), (2, 3), (4, 1), (30, 1), (0, 4)])
def test_what_runs_is_counted(running: int, free: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "CORES", 4)
    monkeypatch.setattr(threads, "_LOAD", tmp_path / "loadavg")
    (tmp_path / "loadavg").write_text(f"0.10 0.20 0.30 {running}/345 6789\n")
    assert threads.free_cores() == free


@pytest.mark.parametrize(("compiled", "expected"), [(True, 1), (False, 3)])
def test_a_run_takes_more_than_one_thread_only_for_a_plain_network(
    compiled: bool, expected: int, engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[int] = []
    monkeypatch.setattr(torch, "set_num_threads", taken.append)
    monkeypatch.setattr(threads, "free_cores", lambda: 3)
    monkeypatch.setattr(engine.pipeline("intergen"), "compiled", compiled)
    list(engine.run(GenerateRequest(prompt="Two people wave.", seconds=1.0, steps=1, damping=0.0)))
    assert taken[-1] == expected


def test_a_network_is_loaded_by_one_thread_and_passes_keep_theirs() -> None:
    """Two threads would wait for each other, spinning: three times the processor time beside other work."""
    said = subprocess.run([sys.executable, "-c", LOADING], capture_output=True, text=True, check=True, cwd=ROOT)
    loading, passes, cores = map(int, said.stdout.split())
    assert loading == 1 and passes == min(cores, 8)
