"""The number of processor cores that this process may use."""

from __future__ import annotations

import math
import os
from pathlib import Path


def usable_cores(quota: Path = Path("/sys/fs/cgroup/cpu.max")) -> int:
    """Cores that this process may use, one at least: as its affinity and its container's quota allow.

    Args:
        quota: Linux' file of a container's share of the processor: microseconds, or ``max``, in a period.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        share, period = quota.read_text().split()
        cores = min(cores, math.ceil(int(share) / int(period)))
    except (OSError, ValueError, ZeroDivisionError):  # no such file, or no limit
        pass
    return max(1, cores)
