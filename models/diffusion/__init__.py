"""The diffusion that every network here trains and samples with: schedule, guidance and sampling loop."""

from .sampling import SamplingStep, TwoPersonDenoiser, classifier_free, denoise, guide, sample_noise, sample_steps
from .schedule import (
    TRAIN_TIMESTEPS,
    NoiseSchedule,
    SamplerError,
    SamplerName,
    cosine_betas,
    make_scheduler,
    top_timesteps,
)

__all__ = [
    "TRAIN_TIMESTEPS",
    "NoiseSchedule",
    "SamplerError",
    "SamplerName",
    "SamplingStep",
    "TwoPersonDenoiser",
    "classifier_free",
    "cosine_betas",
    "denoise",
    "guide",
    "make_scheduler",
    "sample_noise",
    "sample_steps",
    "top_timesteps",
]
