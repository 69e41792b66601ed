"""Noise schedules and samplers.

Sources: the cosine noise level is Nichol & Dhariwal, "Improved Denoising Diffusion Probabilistic
Models", section 3.2, eq. 17; the samplers are DDIM (Song et al. 2021) and DPM-Solver++ multistep
(Lu et al. 2022) as `diffusers` implements them.

Words: ``betas`` (T,) are the noise variances, ``alphas_cumprod`` (T,) is ᾱ, ``x0`` is a clean sample,
``xt`` a noised one, ``t`` a timestep in 0 … T−1. The networks predict x0 unless they say otherwise
(BiGraphDiff predicts the noise).
"""

from __future__ import annotations

import importlib
import math
import threading
from collections.abc import Callable
from functools import cache
from typing import Any, Literal, Protocol

import numpy as np
import torch
from torch import Tensor

from motion.errors import InputError

TRAIN_TIMESTEPS = 1000
_IMPORTING = threading.Lock()
SamplerName = Literal["ddim", "dpm++", "ddpm"]
Spacing = Literal["leading", "top"]


class SamplerError(InputError):
    """The sampler or its number of steps cannot be used."""


def cosine_betas() -> np.ndarray:
    """β_t = min(1 − ᾱ(t+1)/ᾱ(t), 0.999) with ᾱ(u) = cos²((u/T + 0.008)/1.008 · π/2); float64, (T,).

    By hand, since the `betas_for_alpha_bar` of `diffusers` gives float32, and ᾱ of chosen timesteps is formed
    from these.
    """
    u = np.arange(TRAIN_TIMESTEPS + 1, dtype=np.float64) / TRAIN_TIMESTEPS
    alpha_bar = np.cos((u + 0.008) / 1.008 * math.pi / 2) ** 2
    return np.minimum(1 - alpha_bar[1:] / alpha_bar[:-1], 0.999)


class Scheduler(Protocol):
    """The part of a `diffusers` scheduler that sampling uses; ``timesteps`` are (steps,) int64, largest first."""

    timesteps: Tensor

    def set_timesteps(self, *args: Any, **options: Any) -> None:
        """Sets ``timesteps``: a number of them, or the ``timesteps`` themselves."""
        ...

    def step(self, model_output: Tensor, timestep: Any, sample: Tensor, /, **options: Any) -> Any:
        """One step back from ``sample`` at ``timestep``; its ``prev_sample`` is the next one."""
        ...


class NoiseSchedule:
    """The forward process q(xt | x0) on :func:`cosine_betas`, with its factors worked out once, for training.

    By hand, since the `add_noise` of `diffusers` takes √(1 − ᾱ) of a float32 ᾱ, which is off by 6e-6 at small t.

    `sqrt_alphas_cumprod` and `sqrt_one_minus_alphas_cumprod` are float32 (T,) on `device`.
    """

    def __init__(self, *, device: torch.device | str = "cpu") -> None:
        alphas_cumprod = torch.from_numpy(np.cumprod(1 - cosine_betas()))
        self.timesteps = TRAIN_TIMESTEPS
        self.alphas_cumprod = alphas_cumprod.float().to(device)
        self.sqrt_alphas_cumprod = alphas_cumprod.sqrt().float().to(device)
        self.sqrt_one_minus_alphas_cumprod = (1 - alphas_cumprod).sqrt().float().to(device)

    def q_sample(self, x0: Tensor, t: Tensor, noise: Tensor) -> Tensor:
        """xt = √ᾱ_t · x0 + √(1 − ᾱ_t) · noise, for x0 and noise (B, …) and t (B,)."""
        shape = (-1,) + (1,) * (x0.dim() - 1)
        signal = self.sqrt_alphas_cumprod[t].view(shape)
        spread = self.sqrt_one_minus_alphas_cumprod[t].view(shape)
        return signal * x0 + spread * noise


def top_timesteps(steps: int, total: int = TRAIN_TIMESTEPS) -> np.ndarray:
    """(steps,) int64 timesteps from T − 1 down, close to each other at first: (T − 1)·(1 − (i / steps)²).

    Sampling begins with pure noise. A first timestep below T − 1 would have the network take it for a motion
    that shines through (Lin et al. 2024, "Common Diffusion Noise Schedules and Sample Steps are Flawed"),
    and in a motion's many numbers, which say much the same, what happens is decided above 0.9 T.
    """
    wanted = np.rint((total - 1) * (1 - (np.arange(steps) / steps) ** 2)).astype(np.int64)
    # Each below the one before, with room for those that follow: at many steps they lie too close.
    below = np.minimum.accumulate(wanted + np.arange(steps)) - np.arange(steps)
    return np.maximum(below, np.arange(steps)[::-1])


def _diffusers(name: str) -> Any:
    """A scheduler class of `diffusers`, imported with the first sampling: it takes some seconds."""
    with _IMPORTING:  # its lazy modules cannot be imported by two threads at once
        return getattr(importlib.import_module("diffusers"), name)


@cache
def _ddim_class() -> Callable[..., Scheduler]:
    """DDIM on any timesteps: that of `diffusers` on the noise levels of those alone.

    `DDIMScheduler` takes no timesteps of one's own, as DPM-Solver++ and DDPM do.
    """

    class ChosenDDIM(_diffusers("DDIMScheduler")):  # type: ignore[misc]
        def __init__(
            self, betas: np.ndarray, timesteps: np.ndarray, prediction: str, device: torch.device | str
        ) -> None:
            kept = np.cumprod(1 - betas)[timesteps[::-1]]
            steps = len(timesteps)
            super().__init__(
                num_train_timesteps=steps,
                trained_betas=1 - kept / np.concatenate([[1.0], kept[:-1]]),
                prediction_type=prediction,
                clip_sample=False,
                set_alpha_to_one=True,
            )
            self.set_timesteps(steps, device=device)
            self.places = {int(t): steps - 1 - i for i, t in enumerate(timesteps)}
            self.timesteps = torch.from_numpy(timesteps.copy()).to(device)

        def step(self, model_output: Tensor, timestep: int, *args: Any, **options: Any) -> Any:
            return super().step(model_output, self.places[int(timestep)], *args, **options)

    return ChosenDDIM


def make_scheduler(
    name: SamplerName,
    steps: int,
    *,
    betas: np.ndarray | None = None,
    prediction: Literal["sample", "epsilon"] = "sample",
    spacing: Spacing = "leading",
    device: torch.device | str = "cpu",
) -> Scheduler:
    """A fresh `diffusers` scheduler with its timesteps set, largest first.

    ``ddim`` uses the timesteps 0, T/steps, 2T/steps, … as InterGen does; ``dpm++`` is second-order multistep
    on timesteps from 0 up to the λ clipping that `diffusers` asks for with cosine schedules; ``ddpm`` is
    ancestral sampling. With ``spacing="top"`` each of them uses the timesteps of :func:`top_timesteps`.
    A scheduler keeps the history of one sampling run: make a new one for each.

    Raises SamplerError for an unknown name, or a number of steps that the sampler cannot spread over T.
    """
    betas = cosine_betas() if betas is None else np.asarray(betas)
    total = len(betas)
    if not 1 <= steps <= total:
        raise SamplerError(f"{steps} sampling steps cannot be used: choose between 1 and {total}.")
    common = {"num_train_timesteps": total, "trained_betas": betas, "prediction_type": prediction}
    chosen = top_timesteps(steps, total) if spacing == "top" else None
    scheduler: Scheduler
    if name == "ddim" and chosen is not None:
        return _ddim_class()(betas, chosen, prediction, device)
    if name == "ddim":
        # Leading spacing strides by T // steps. Where that leaves out the top of the noise, the first
        # sample, which is pure noise, would be taken for a half-denoised one.
        if steps * (total // steps) < 0.8 * total:
            raise SamplerError(
                f"{steps} DDIM steps do not spread over {total} timesteps: use at most {total // 4}, "
                f"or {total // 2} or {total}."
            )
        scheduler = _diffusers("DDIMScheduler")(
            **common, clip_sample=False, set_alpha_to_one=True, timestep_spacing="leading", steps_offset=0
        )
    elif name == "dpm++":
        scheduler = _diffusers("DPMSolverMultistepScheduler")(
            **common, algorithm_type="dpmsolver++", solver_order=2, lambda_min_clipped=-5.1
        )
    elif name == "ddpm":
        scheduler = _diffusers("DDPMScheduler")(**common, clip_sample=False, timestep_spacing="leading")
    else:
        raise SamplerError(f"There is no sampler named {name!r}: choose ddim, dpm++ or ddpm.")
    if chosen is None:
        scheduler.set_timesteps(steps, device=device)
    else:
        scheduler.set_timesteps(timesteps=chosen.tolist(), device=device)
    return scheduler
