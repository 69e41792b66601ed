"""The diffusion that every network here trains and samples with: noise schedules, samplers, the one loop and guidance.

Sources: the cosine noise level is Nichol & Dhariwal, "Improved Denoising Diffusion Probabilistic
Models", section 3.2, eq. 17; the samplers are DDIM (Song et al. 2021) and DPM-Solver++ multistep
(Lu et al. 2022) as `diffusers` implements them. Whole motions and streams alike run through :func:`sample_steps`.

Words: ``betas`` (T,) are the noise variances, ``alphas_cumprod`` (T,) is ᾱ, ``x0`` is a clean sample,
``xt`` a noised one, ``t`` a timestep in 0 … T−1. The networks predict x0 unless they say otherwise
(BiGraphDiff predicts the noise).
"""

from __future__ import annotations

import importlib
import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, Protocol

import numpy as np
import torch
from torch import Tensor, nn

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


# ---- Sampling --------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class SamplingStep:
    """Result of one step of `sample_steps`: `step` of `total` done, and x_{t−1}."""

    step: int
    total: int
    sample: Tensor


def sample_steps(
    predict: Callable[[Tensor, Tensor], Tensor],
    noise: Tensor,
    scheduler: Scheduler,
    *,
    generator: torch.Generator | None = None,
    correct: Callable[[Tensor, int], Tensor] | None = None,
) -> Iterator[SamplingStep]:
    """Denoise `noise` (B, …) a step at a time, so that the caller can report progress or stop between.

    `predict(xt, t)` is the network, t being (B,) int64. `correct(x0, timestep)` may change the predicted
    clean sample before the scheduler uses it (constraints, damping). `generator` must be given where the sampler
    draws noise (ddpm) if the result is to be repeated.
    The last step's `sample` is the result. Runs without gradients.
    """
    x, total = noise, len(scheduler.timesteps)
    for i, timestep in enumerate(scheduler.timesteps):
        with torch.no_grad():
            predicted = predict(x, timestep.expand(x.shape[0]))
        if correct is not None:
            predicted = correct(predicted, int(timestep))
        with torch.no_grad():
            x = scheduler.step(predicted, timestep, x, generator=generator).prev_sample
        yield SamplingStep(i + 1, total, x)


def denoise(predict: Callable[[Tensor, Tensor], Tensor], noise: Tensor, scheduler: Scheduler, **options: Any) -> Tensor:
    """The end of :func:`sample_steps`, with its arguments: `noise` (B, …) denoised."""
    sample = noise
    for step in sample_steps(predict, noise, scheduler, **options):
        sample = step.sample
    return sample


def sample_noise(seed: int, samples: int, shape: tuple[int, ...]) -> Tensor:
    """(samples, *shape) noise; a sample's noise depends only on the seed and its index."""
    rows = []
    for sample in range(samples):
        state = int(np.random.SeedSequence([seed, sample]).generate_state(1, np.uint64)[0])
        rows.append(torch.randn(shape, generator=torch.Generator().manual_seed(state)))
    return torch.stack(rows)


# ---- classifier-free guidance (Ho & Salimans 2022), as every network here uses it ----------------


DRAFTED = 0.5
"""Share of the guidance beyond 1 that acts on drafted numbers: all of it would exaggerate what the draft says."""


def guide(conditional: Tensor, unconditional: Tensor, scale: float) -> Tensor:
    """scale · D(x, cond) + (1 − scale) · D(x, nothing), from both predictions."""
    return scale * conditional + (1 - scale) * unconditional


def classifier_free(
    predict: Callable[..., Tensor],
    *inputs: Tensor | None,
    cond: Tensor,
    scale: float,
    nothing: Tensor | None = None,
    drafted: Tensor | None = None,
) -> Tensor:
    """:func:`guide` on both predictions of a network, made in one batch.

    A half without weight, as the unconditional one at scale 1, is not run.

    Args:
        predict: D, called with all of `inputs` and then the condition.
        inputs: (B, …) tensors that both halves see, or None.
        cond: (B, …).
        scale: s of the papers.
        nothing: (B, …) what stands for no condition; zeros by default.
        drafted: true at the numbers on which guidance acts by :data:`DRAFTED`; none by default.

    Returns:
        (B, …) as `predict` gives.
    """
    nothing = torch.zeros_like(cond) if nothing is None else nothing
    if scale == 1 or (scale == 0 and drafted is None):
        return predict(*inputs, cond if scale else nothing)
    twice = (None if value is None else torch.cat([value, value]) for value in inputs)
    conditional, unconditional = predict(*twice, torch.cat([cond, nothing])).chunk(2)
    guided = guide(conditional, unconditional, scale)
    return guided if drafted is None else torch.where(drafted, torch.lerp(conditional, guided, DRAFTED), guided)


class TwoPersonDenoiser(nn.Module, ABC):
    """A denoiser of two people that its condition guides, and that OpenVINO can run (:mod:`models.compiled`).

    The inputs of its ``forward`` are x (B, T, 2F), t (B,), cond (B, C) and mask (B, T, 2), nonzero where a person's
    token is real.
    """

    @property
    @abstractmethod
    def widths(self) -> tuple[int, int]:
        """2F and C."""

    @property
    def varying(self) -> dict[str, tuple[int, ...]]:
        """For each input of ``forward``, in order: the axes whose sizes differ between calls."""
        return {"x": (0, 1), "t": (0,), "cond": (0,), "mask": (0, 1)}

    def filled(self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None) -> tuple[Tensor, ...]:
        """The arguments of ``forward`` in the order of ``varying``; without a mask, all tokens are real."""
        real = torch.ones(*x.shape[:2], 2, dtype=torch.bool) if mask is None else mask != 0
        return x, t, cond, real

    def example(self) -> tuple[Tensor, ...]:
        """All arguments of ``forward``, for a batch of two."""
        features, width = self.widths
        draw = torch.Generator().manual_seed(0)
        x, cond = torch.randn(2, 12, features, generator=draw), torch.randn(2, width, generator=draw)
        mask = torch.ones(2, 12, 2, dtype=torch.bool)
        mask[1, 9:] = False
        return x, torch.tensor([999, 500]), cond, mask

    def guided(self, x: Tensor, t: Tensor, cond: Tensor, *, scale: float = 3.5) -> Tensor:
        """:func:`classifier_free` on the condition; shapes are as in ``forward``."""
        return classifier_free(self, x, t, cond=cond, scale=scale)
