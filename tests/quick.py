"""The modules of ``pytest -m quick``, which ``tests/quick.txt`` lists."""

from __future__ import annotations

from pathlib import Path

TESTS = Path(__file__).resolve().parent
LEFT_OUT = ("e2e", "server/attacks", "server/cluster", "benchmark")
"""Folders that need a browser, a network of processes or an idle machine."""


def is_left_out(folder: str) -> bool:
    """Whether a folder of tests, relative to ``tests``, is or lies in one of :data:`LEFT_OUT`."""
    return any(f"{folder}/".startswith(f"{left}/") for left in LEFT_OUT)


def listed() -> set[Path]:
    """The modules in ``tests/quick.txt``, relative to ``tests``."""
    return {Path(name) for name in (TESTS / "quick.txt").read_text().split()}
