"""Everything that a run yields: progress, then a result, unless it is cancelled."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from motion import Clip, Duet


@dataclass(frozen=True, kw_only=True)
class Progress:
    """An event during a run.

    Attributes:
        stage: "load", "text", "sample", "finish".
        step: finished steps of the stage.
        total: all steps of the stage.
        elapsed: seconds since the request began.
        unit: what is counted: "step" for denoising steps, "frame", "pass".
        attempt: the number of the try, from 1, of ``attempts``.
    """

    stage: str
    step: int = 0
    total: int = 1
    elapsed: float = 0.0
    unit: str = "step"
    attempt: int = 1
    attempts: int = 1


@dataclass(frozen=True, kw_only=True)
class Result:
    """The result of a request.

    Attributes:
        duets: one a sample; a prediction for one person is that person's clip.
        manifest: request, plan, model, weights hash, versions: all that reproduces the result.
        readouts: one dictionary of interaction measures a sample (see :mod:`motion.metrics`), each
            measure with its value ``before`` and ``after`` the damping and clean-up where both exist; of a
            sentence also the share of the motion that was laid out for the network, ``planned`` (0 to 1).
        timings: seconds by stage.
        notes: sentences the user should read, such as a prompt far from all training captions.
        run: its id in the history; "" where none keeps it.
    """

    duets: tuple[Duet | Clip, ...]
    manifest: dict[str, Any]
    readouts: tuple[dict[str, Any], ...] = ()
    timings: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    run: str = ""


class Cancelled(Exception):
    """The run was cancelled by its owner; nothing was written."""
