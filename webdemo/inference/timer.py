"""Measures the duration of a run and its stages."""

from __future__ import annotations

import time
from dataclasses import dataclass

from .results import Progress


@dataclass
class StageTimer:
    """Seconds since a run began, and by stage.

    Attributes:
        began: ``time.perf_counter()`` at the start.
        stages: stage → seconds.
    """

    began: float
    stages: dict[str, float]

    @classmethod
    def start(cls) -> StageTimer:
        """A timer that begins now."""
        return cls(time.perf_counter(), {})

    @property
    def elapsed(self) -> float:
        """Seconds since the run began."""
        return time.perf_counter() - self.began

    def progress(self, stage: str, step: int = 0, total: int = 1, unit: str = "step") -> Progress:
        """A progress event with the time so far."""
        return Progress(stage=stage, step=step, total=total, elapsed=self.elapsed, unit=unit)

    def lap(self, stage: str, since: float) -> float:
        """Adds the time since ``since`` to a stage; returns now."""
        now = time.perf_counter()
        self.stages[stage] = round(self.stages.get(stage, 0.0) + now - since, 4)
        return now
