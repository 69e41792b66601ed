"""The noise schedule and the samplers, checked on a case whose exact denoiser is known."""

from __future__ import annotations

import pytest
import torch

from models.diffusion import (
    NoiseSchedule,
    SamplerError,
    cosine_betas,
    denoise,
    make_scheduler,
    sample_steps,
    top_timesteps,
)
from tests.models.reference_arrays import Reference


def test_betas_equal_the_reference():
    reference = Reference("intergen_small")["betas"]
    assert abs(torch.from_numpy(cosine_betas()) - reference).max() < 1e-12


def test_q_sample_has_the_variance_it_should():
    schedule = NoiseSchedule()
    t = torch.tensor([0, 500, 999]).repeat_interleave(20000)
    noise = torch.randn(60000, 1, generator=torch.Generator().manual_seed(0))
    noised = schedule.q_sample(torch.full((60000, 1), 2.0), t, noise).view(3, -1)
    alpha_bar = schedule.alphas_cumprod[[0, 500, 999]]
    assert torch.allclose(noised.mean(1), 2 * alpha_bar.sqrt(), atol=0.02)
    assert torch.allclose(noised.var(1), 1 - alpha_bar, atol=0.02)


def gaussian_denoiser(mean: float, std: float):
    """E[x0 | xt] for x0 ~ N(mean, std²): the network that perfect training would give."""
    alphas = NoiseSchedule().alphas_cumprod

    def predict(x, t):
        a = alphas[t].view(-1, 1)
        return mean + (x - a.sqrt() * mean) * a.sqrt() * std**2 / (a * std**2 + 1 - a)

    return predict


@pytest.mark.parametrize("name", ["ddim", "dpm++", "ddpm"])
@pytest.mark.parametrize("steps", [1, 2, 5, 50, 300, 600, 999, 1000])
def test_timesteps_from_the_top_begin_with_pure_noise_and_fall(name, steps):
    timesteps = make_scheduler(name, steps, spacing="top").timesteps
    assert timesteps.tolist() == top_timesteps(steps).tolist()
    assert len(timesteps) == steps and timesteps[0] == 999 and timesteps.min() >= 0
    assert (timesteps.diff() < 0).all()
    if 5 <= steps <= 50:  # denser where it is decided what happens
        assert (timesteps >= 900).sum() >= 0.3 * steps


def test_from_the_top_ddim_is_that_of_diffusers_on_its_own_timesteps():
    """At all 1000 timesteps both spacings are the same sampler."""
    noise = torch.randn(4, 3, generator=torch.Generator().manual_seed(0))
    ends = []
    for spacing in ("leading", "top"):
        scheduler = make_scheduler("ddim", 1000, spacing=spacing)
        *_, last = sample_steps(gaussian_denoiser(1.5, 0.5), noise, scheduler)
        ends.append(last.sample)
    torch.testing.assert_close(*ends, atol=1e-4, rtol=0)


@pytest.mark.parametrize(
    ("name", "steps", "spacing", "tolerance"),
    [
        ("ddim", 50, "leading", 0.03),
        ("ddim", 200, "leading", 0.02),
        ("ddim", 50, "top", 0.03),
        ("dpm++", 20, "leading", 0.02),
        ("dpm++", 50, "top", 0.02),
        ("ddpm", 250, "leading", 0.03),
        ("ddpm", 250, "top", 0.03),
    ],
)
def test_samplers_reach_the_distribution(name, steps, spacing, tolerance):
    noise = torch.randn(20000, 1, generator=torch.Generator().manual_seed(0))
    seen = list(
        sample_steps(
            gaussian_denoiser(1.5, 0.5),
            noise,
            make_scheduler(name, steps, spacing=spacing),
            generator=torch.Generator().manual_seed(1),
        )
    )
    assert [s.step for s in seen] == list(range(1, steps + 1))
    assert seen[0].total == steps
    assert abs(seen[-1].sample.mean() - 1.5) < tolerance
    assert abs(seen[-1].sample.std() - 0.5) < tolerance


def test_the_correction_reaches_the_sample():
    noise = torch.zeros(1, 1)
    predict = gaussian_denoiser(1.5, 0.5)
    moved = denoise(predict, noise, make_scheduler("ddim", 10), correct=lambda x0, t: x0 + 1)
    assert moved > denoise(predict, noise, make_scheduler("ddim", 10)) + 0.9


def test_noise_drawn_while_sampling_follows_the_generator():
    def run(seed):
        return denoise(
            gaussian_denoiser(0, 1),
            torch.ones(2, 1),
            make_scheduler("ddpm", 10),
            generator=torch.Generator().manual_seed(seed),
        )

    assert torch.equal(run(1), run(1))
    assert not torch.equal(run(1), run(2))


@pytest.mark.parametrize(
    ("name", "steps", "words"),
    [
        ("ddim", 0, "between 1 and 1000"),
        ("ddim", 1001, "between 1 and 1000"),
        ("ddim", 600, "do not spread"),
        ("euler", 10, "no sampler named 'euler'"),
    ],
)
def test_what_cannot_be_sampled_is_said(name, steps, words):
    with pytest.raises(SamplerError, match=words):
        make_scheduler(name, steps)
