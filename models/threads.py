"""The number of PyTorch's threads in a run.

One is as fast as two for all that is small, which is everything but a denoiser that OpenVINO does not run
(:mod:`models.compiled` has threads of its own). Several wait for each other, spinning, after every product: beside a
busy core a pass of two threads takes four times as long as one of one.
"""

from __future__ import annotations

from pathlib import Path

import torch

import models.compiled  # noqa: F401  # reads PyTorch's default as well, before it is changed here
from motion.cores import usable_cores

CORES = min(torch.get_num_threads(), usable_cores())
"""PyTorch's default number of threads, one per core or ``OMP_NUM_THREADS``; no more than the process may use."""


def free_cores(load: Path = Path("/proc/loadavg")) -> int:
    """Cores that nothing else uses at this moment, one at least; all of them where the system does not tell.

    Args:
        load: Linux' file; its fourth field is ``running/all`` threads, this one among those that run.
    """
    try:
        running = int(load.read_text().split()[3].partition("/")[0])
    except (OSError, ValueError, IndexError):
        return CORES
    return max(1, min(CORES, CORES - (running - 1)))


def take_threads(*, plain_denoiser: bool) -> None:
    """Sets PyTorch's threads for a run that begins in this thread.

    Args:
        plain_denoiser: the run has a large network that PyTorch runs.
    """
    torch.set_num_threads(free_cores() if plain_denoiser else 1)
