"""The memory and the seconds for a motion that a released network needs here, from the shapes in its file.

Torch is not imported. The machine's speed is that of a matrix product in NumPy, measured once in a process.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import time
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from motion import InputError
from motion.formats.files import write_text

FRAMES = 150
"""Frames of the motion whose seconds are estimated: five seconds."""
LOADING = 2.1
"""Largest memory while a network is loaded, as a multiple of its float32 weights; measured in docs/own-model.md."""
RESERVE = 0.8e9
"""Bytes of PyTorch, OpenVINO and a motion's own tensors."""
_SIDE = 512
EFFICIENCY = 0.8
"""Share of the speed of a large product that the products of a network reach."""


@dataclass(frozen=True)
class Cost:
    """The memory and the time that a network needs.

    Attributes:
        parameters: of the network and its text side.
        loading: bytes of memory while it is loaded.
        seconds: for five seconds of motion.
        steps: denoising steps of that estimate; 1 for a network that does not denoise.
    """

    parameters: int
    loading: float
    seconds: float
    steps: int

    def sentence(self) -> str:
        """For the place where the model is chosen."""
        steps = f" in {self.steps} steps" if self.steps > 1 else ""
        return (
            f"{self.parameters / 1e6:.0f} million parameters, about {self.loading / 1e9:.1f} GB of memory; 5 seconds "
            f"of motion{steps} take about {_seconds(self.seconds)} on this machine."
        )

    def check(self, name: str, free: float | None = None) -> None:
        """Raises InputError if the network does not fit into the memory that is free."""
        free = free_memory() if free is None else free
        if self.loading > free:
            raise InputError(
                f"The model {name} needs about {self.loading / 1e9:.1f} GB of memory and {free / 1e9:.1f} GB are free: "
                "end other programs, or choose a smaller model or a larger machine."
            )


def cost_of(outline: Outline, moving: str, *, passes: int, steps: int) -> Cost:
    """The cost of a network.

    Args:
        outline: of the tensors that are loaded.
        moving: part of the names of matrices that multiply every frame.
        passes: people and halves of the guidance that a step computes.
        steps: denoising steps.
    """
    sizes = {name: math.prod(shape) for name, shape in outline.items()}
    busy = sum(size for name, size in sizes.items() if moving in name and len(outline[name]) == 2)
    work = 2.0 * busy * FRAMES * passes * steps
    parameters = sum(sizes.values())
    return Cost(parameters, 4 * parameters * LOADING + RESERVE, work / (EFFICIENCY * operations_per_second()), steps)


@cache
def operations_per_second() -> float:
    """Floating-point operations per second of a float32 product on all cores.

    The products are short and the fastest one counts: other programs interrupt most of them.
    """
    a, b = (np.random.default_rng(0).standard_normal((_SIDE, _SIDE)).astype(np.float32) for _ in range(2))
    best = math.inf
    for _ in range(12):
        began = time.perf_counter()
        a @ b
        best = min(best, time.perf_counter() - began)
    return 2 * _SIDE**3 / best


def free_memory(meminfo: Path = Path("/proc/meminfo")) -> float:
    """Bytes that programs can still take; all of the machine's where the system does not say what is free."""
    try:
        for line in meminfo.read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    return total_memory()


def total_memory() -> float:
    """Bytes of memory of the machine; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError, AttributeError):
        return math.inf


def _seconds(value: float) -> str:
    if value < 1:
        return "a second or less"
    return f"{value:.0f} s" if value < 120 else f"{value / 60:.0f} minutes"


Outline = dict[str, tuple[int, ...]]
"""Tensor name → shape."""


def outline_of(path: Path, network: str) -> Outline:
    """The outline of a checkpoint; the first look at a file imports torch, later ones read a small cache.

    Raises:
        WeightsError: if the file cannot be read as plain tensors, see :func:`models.released.read_tensors`.
    """
    known = _remembered(path)
    if known is not None:
        return known
    from models.released import read_tensors

    outline = {name: tuple(tensor.shape) for name, tensor in read_tensors(path, network=network).items()}
    with suppress(OSError):  # a folder that cannot be written costs the next start a second
        file = _cache(path)
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, json.dumps(outline))
    return outline


def _remembered(path: Path) -> Outline | None:
    try:
        found = json.loads(_cache(path).read_text())
        return {str(name): tuple(int(size) for size in shape) for name, shape in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _cache(path: Path) -> Path:
    """The cache's file for this state of a checkpoint."""
    stat = path.stat()
    text = f"{path.resolve()} {stat.st_size} {stat.st_mtime_ns}"
    base = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    return base / "pas-de-deux" / "outlines" / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
