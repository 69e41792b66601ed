"""What may be asked of the :class:`~webdemo.inference.engine.Engine`, with its limits.

These dataclasses import no torch, so the page, the shell and the API build them before any network loads.
"""

from .predict import PredictRequest, PredictResult
from .sampling import (
    DAMPING,
    GUIDANCE,
    MAX_PROMPT,
    MAX_SEED,
    OWN_STEPS,
    SAMPLES,
    STEPS,
    STRICTNESS,
    TRIES,
    GenerateRequest,
    ReactRequest,
    SamplingRequest,
    replayed,
)

__all__ = [
    "DAMPING",
    "GUIDANCE",
    "MAX_PROMPT",
    "MAX_SEED",
    "OWN_STEPS",
    "SAMPLES",
    "STEPS",
    "STRICTNESS",
    "TRIES",
    "GenerateRequest",
    "PredictRequest",
    "PredictResult",
    "ReactRequest",
    "SamplingRequest",
    "replayed",
]
