"""The diffusion that every network here trains and samples with.

Sources: the cosine noise level is Nichol & Dhariwal, "Improved Denoising Diffusion Probabilistic
Models", section 3.2, eq. 17; the samplers are DDIM (Song et al. 2021) and DPM-Solver++ multistep
(Lu et al. 2022) as `diffusers` implements them.

Words: ``betas`` (T,) are the noise variances, ``alphas_cumprod`` (T,) is ᾱ, ``x0`` is a clean sample,
``xt`` a noised one, ``t`` a timestep in 0 … T−1. The networks predict x0 unless they say otherwise
(BiGraphDiff predicts the noise).
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import torch
from torch import Tensor

from webdemo.motion.errors import InputError

if TYPE_CHECKING:
    from diffusers import DDIMScheduler, DDPMScheduler, DPMSolverMultistepScheduler

    Scheduler = DDIMScheduler | DDPMScheduler | DPMSolverMultistepScheduler

TRAIN_TIMESTEPS = 1000
_IMPORTING = threading.Lock()
SamplerName = Literal["ddim", "dpm++", "ddpm"]
Spacing = Literal["leading", "top"]


class SamplerError(InputError):
    """The sampler or its number of steps cannot be used."""


def cosine_betas(timesteps: int = TRAIN_TIMESTEPS, *, max_beta: float = 0.999) -> np.ndarray:
    """β_t = min(1 − ᾱ(t+1)/ᾱ(t), max_beta) with ᾱ(u) = cos²((u/T + 0.008)/1.008 · π/2); float64, (T,)."""
    u = np.arange(timesteps + 1, dtype=np.float64) / timesteps
    alpha_bar = np.cos((u + 0.008) / 1.008 * math.pi / 2) ** 2
    return np.minimum(1 - alpha_bar[1:] / alpha_bar[:-1], max_beta)


class NoiseSchedule:
    """The forward process q(xt | x0) with its factors worked out once, for training.

    `sqrt_alphas_cumprod` and `sqrt_one_minus_alphas_cumprod` are float32 (T,) on `device`.
    """

    def __init__(self, betas: np.ndarray | None = None, *, device: torch.device | str = "cpu") -> None:
        betas = cosine_betas() if betas is None else np.asarray(betas, dtype=np.float64)
        alphas_cumprod = torch.from_numpy(np.cumprod(1 - betas))
        self.timesteps = len(betas)
        self.alphas_cumprod = alphas_cumprod.float().to(device)
        self.sqrt_alphas_cumprod = alphas_cumprod.sqrt().float().to(device)
        self.sqrt_one_minus_alphas_cumprod = (1 - alphas_cumprod).sqrt().float().to(device)

    def q_sample(self, x0: Tensor, t: Tensor, noise: Tensor) -> Tensor:
        """xt = √ᾱ_t · x0 + √(1 − ᾱ_t) · noise, for x0 and noise (B, …) and t (B,)."""
        shape = (-1,) + (1,) * (x0.dim() - 1)
        signal = self.sqrt_alphas_cumprod[t].view(shape)
        spread = self.sqrt_one_minus_alphas_cumprod[t].view(shape)
        return signal * x0 + spread * noise


def classifier_free(
    predict: Callable[[Tensor, Tensor, Tensor, Tensor | None], Tensor],
    x: Tensor,
    t: Tensor,
    cond: Tensor,
    mask: Tensor | None = None,
    *,
    scale: float,
) -> Tensor:
    """Classifier-free guidance, scale · D(x, cond) + (1 − scale) · D(x, 0), both halves in one batch.

    At scale 1 the unconditional half has no weight and is not run.

    Args:
        predict: D of (x, t, cond, mask); a condition of zeros is none.
        x, t, cond, mask: as D takes them, (B, …).
    """
    if scale == 1:
        return predict(x, t, cond, mask)
    both = predict(
        torch.cat([x, x]),
        torch.cat([t, t]),
        torch.cat([cond, torch.zeros_like(cond)]),
        None if mask is None else torch.cat([mask, mask]),
    )
    conditional, unconditional = both.chunk(2)
    return scale * conditional + (1 - scale) * unconditional


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


@cache
def _ddim_class() -> type[DDIMScheduler]:
    """DDIM on any timesteps: that of `diffusers` on the noise levels of those alone."""
    from diffusers import DDIMScheduler

    class ChosenDDIM(DDIMScheduler):
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

    ``ddim`` uses the timesteps 0, T/steps, 2T/steps, … as InterGen does, or with ``spacing="top"`` those of
    :func:`top_timesteps`; ``dpm++`` is second-order multistep with the λ clipping that `diffusers` asks for
    with cosine schedules; ``ddpm`` is ancestral sampling. A scheduler keeps the history of one sampling run:
    make a new one for each.

    Raises SamplerError for an unknown name, or a number of steps that the sampler cannot spread over T.
    """
    # diffusers takes 2 s to import, so it is loaded with the first sampling and not with the page; its lazy
    # modules cannot be imported by two threads at once.
    with _IMPORTING:
        from diffusers import DDIMScheduler, DDPMScheduler, DPMSolverMultistepScheduler

    betas = cosine_betas() if betas is None else np.asarray(betas)
    total = len(betas)
    if not 1 <= steps <= total:
        raise SamplerError(f"{steps} sampling steps cannot be used: choose between 1 and {total}.")
    common = {"num_train_timesteps": total, "trained_betas": betas, "prediction_type": prediction}
    if name == "ddim" and spacing == "top":
        return _ddim_class()(betas, top_timesteps(steps, total), prediction, device)
    if name == "ddim":
        # Leading spacing strides by T // steps. Where that leaves out the top of the noise, the first
        # sample, which is pure noise, would be taken for a half-denoised one.
        if steps * (total // steps) < 0.8 * total:
            raise SamplerError(
                f"{steps} DDIM steps do not spread over {total} timesteps: use at most {total // 4}, "
                f"or {total // 2} or {total}."
            )
        scheduler = DDIMScheduler(
            **common, clip_sample=False, set_alpha_to_one=True, timestep_spacing="leading", steps_offset=0
        )
    elif name == "dpm++":
        scheduler = DPMSolverMultistepScheduler(
            **common, algorithm_type="dpmsolver++", solver_order=2, lambda_min_clipped=-5.1
        )
    elif name == "ddpm":
        scheduler = DDPMScheduler(**common, clip_sample=False, timestep_spacing="leading")
    else:
        raise SamplerError(f"There is no sampler named {name!r}: choose ddim, dpm++ or ddpm.")
    scheduler.set_timesteps(steps, device=device)
    return scheduler


@dataclass(frozen=True)
class SamplingStep:
    """What one step of `sample_steps` gives: `step` of `total` done, x_{t−1} and the predicted x0."""

    step: int
    total: int
    timestep: int
    sample: Tensor
    predicted: Tensor


def sample_steps(
    predict: Callable[[Tensor, Tensor], Tensor],
    noise: Tensor,
    scheduler: Scheduler,
    *,
    eta: float = 0.0,
    generator: torch.Generator | None = None,
    correct: Callable[[Tensor, int], Tensor] | None = None,
) -> Iterator[SamplingStep]:
    """Denoise `noise` (B, …) a step at a time, so that the caller can report progress or stop between.

    `predict(xt, t)` is the network, t being (B,) int64. `correct(x0, timestep)` may change the predicted
    clean sample before the scheduler uses it (constraints, damping). `eta` is DDIM's η; `generator` must be
    given where the sampler draws noise (η > 0, ddpm) if the result is to be repeated.
    The last step's `sample` is the result. Runs without gradients.
    """
    from diffusers import DDIMScheduler  # already loaded: the scheduler is one of its objects

    x, total = noise, len(scheduler.timesteps)
    options = {"eta": eta} if isinstance(scheduler, DDIMScheduler) else {}
    for i, timestep in enumerate(scheduler.timesteps):
        with torch.no_grad():
            predicted = predict(x, timestep.expand(x.shape[0]))
        if correct is not None:
            predicted = correct(predicted, int(timestep))
        with torch.no_grad():
            x = scheduler.step(predicted, timestep, x, generator=generator, **options).prev_sample
        yield SamplingStep(i + 1, total, int(timestep), x, predicted)
