"""A past of the network's own: what is unrolled, what is learned, and what it aims at."""

import pytest
import torch
from torch import Tensor

from models.diffusion import NoiseSchedule
from models.motion_tokens import FEATURES, NUM_CONTACTS
from models.regennet.compact import LEAD, CompactReGenNet, CompactReGenNetConfig
from training.trainers.regennet_data import FARTHEST, SHORTEST, Plan, make_past, plan, return_share

B, K = 6, 24
STD = torch.ones(FEATURES)


def planned(**given: Tensor) -> Plan:
    fields = {
        "own": torch.ones(B, dtype=torch.bool),
        "begins": torch.zeros(B, dtype=torch.long),
        "ends": torch.full((B,), 3),
        "cut": torch.full((B,), 10),
    }
    return Plan(**(fields | given))


def made(predict, the_plan: Plan, x0: Tensor):
    generator = torch.Generator().manual_seed(5)
    noise = torch.randn(x0.shape, generator=generator)
    recorded = (torch.randn(x0.shape, generator=generator), torch.full((B,), 123))
    past = make_past(predict, the_plan, x0, recorded, NoiseSchedule(), STD, steps=5, noise=noise)
    return past, recorded


def test_a_plan_leaves_rows_to_learn_and_unrolls_one_to_four_steps() -> None:
    rows = torch.tensor([7, 12, 30, 60] * 500)
    drawn = plan(rows, share=0.6, steps=5, rollout=4, generator=torch.Generator().manual_seed(0))
    unrolled = drawn.ends - drawn.begins
    assert set(unrolled.tolist()) == {1, 2, 3, 4} and set(drawn.ends.tolist()) == {1, 2, 3, 4}
    assert (drawn.begins >= 0).all()
    assert not drawn.own[rows == 7].any(), "too short to leave anything to learn"
    assert drawn.own[rows > 7].float().mean() == pytest.approx(0.6, abs=0.05)
    assert (drawn.cut[drawn.own] > LEAD).all()
    assert (drawn.cut + SHORTEST <= rows)[drawn.own].all()
    short = plan(rows, share=1.0, steps=5, rollout=2, generator=torch.Generator().manual_seed(0))
    assert set((short.ends - short.begins).tolist()) == {1, 2}


def test_the_past_is_the_networks_and_what_follows_leads_back_to_the_recorded_motion() -> None:
    generator = torch.Generator().manual_seed(1)
    x0 = torch.randn(B, K, FEATURES, generator=generator)
    off = torch.zeros(FEATURES)
    off[:3] = 0.15  # the whole body stands 0.26 m off
    off[-NUM_CONTACTS:] = 1.0
    past, _ = made(lambda x, t, places: x0[places] + off, planned(), x0)
    assert past.used.all()
    torch.testing.assert_close(past.past, x0 + off)
    torch.testing.assert_close(
        past.wanted[:, 10, :3], x0[:, 10, :3] + 0.15 * return_share(K, torch.tensor([10]))[0, 10]
    )
    assert (past.wanted[:, 10, 0] - x0[:, 10, 0] > 0.1).all(), "begins where the past left off"
    torch.testing.assert_close(past.wanted[:, 16:], x0[:, 16:])
    torch.testing.assert_close(past.wanted[..., -NUM_CONTACTS:], x0[..., -NUM_CONTACTS:])
    assert past.learned[:, 10:].all() and not past.learned[:, :10].any()


def test_the_noised_past_is_that_of_the_sampler() -> None:
    """Row by row, the past carries what DDIM makes of the network's own predictions; the rest does not."""
    x0, guess = torch.zeros(B, K, FEATURES), 0.1
    past, _ = made(lambda x, t, places: torch.full_like(x, guess), planned(), x0)
    schedule = NoiseSchedule()
    t = int(past.t[0])
    assert (past.t == t).all() and t == 639
    noise = torch.randn(x0.shape, generator=torch.Generator().manual_seed(5))
    # From pure noise a predictor that always says the same keeps, at each step, the noise it implies.
    top, spread = schedule.sqrt_alphas_cumprod[999], schedule.sqrt_one_minus_alphas_cumprod[999]
    implied = (spread * noise - top * guess) / spread
    sampled = schedule.sqrt_alphas_cumprod[t] * guess + schedule.sqrt_one_minus_alphas_cumprod[t] * implied
    torch.testing.assert_close(past.x[:, :10], sampled[:, :10], atol=1e-4, rtol=1e-4)
    torch.testing.assert_close(past.x[:, 16:], schedule.q_sample(x0, past.t, noise)[:, 16:])


def test_scenes_not_drawn_and_pasts_too_far_off_keep_the_recorded_one() -> None:
    x0 = torch.zeros(B, K, FEATURES)
    own = torch.tensor([True, False] * 3)
    far = torch.tensor([0, 0, 0, 0, 1, 1.0])
    called = []

    def predict(x: Tensor, t: Tensor, places: Tensor) -> Tensor:
        called.append(places)
        return (2 * FARTHEST * far[places])[:, None, None] * torch.ones_like(x)

    past, (xt, t) = made(predict, planned(own=own), x0)
    assert past.used.tolist() == [True, False, True, False, False, False]
    assert {int(p) for places in called for p in places} == {0, 2, 4}
    for i in (1, 3, 4, 5):
        torch.testing.assert_close(past.x[i], xt[i])
        assert past.t[i] == t[i] and past.learned[i].all()
        torch.testing.assert_close(past.wanted[i], x0[i])


def test_no_row_of_the_past_depends_on_what_the_actor_does_later() -> None:
    torch.manual_seed(0)
    model = CompactReGenNet(
        CompactReGenNetConfig(latent_dim=16, ff_size=16, num_layers=2, num_heads=2, cond_dim=16, text_layers=1)
    )
    actor, other = torch.randn(2, B, K, 132)
    other[:, :10] = actor[:, :10]
    x0, words = 0.01 * torch.randn(B, K, FEATURES), torch.zeros(B, 16)
    pasts = []
    for seen in (actor, other):

        def predict(x: Tensor, t: Tensor, places: Tensor, seen: Tensor = seen) -> Tensor:
            return 0.01 * model(x, t, seen[places], words[places], causal=True)

        pasts.append(made(predict, planned(), x0)[0])
    assert pasts[0].used.all() and pasts[1].used.all()
    torch.testing.assert_close(pasts[0].x[:, :10], pasts[1].x[:, :10])
    assert not torch.allclose(pasts[0].past[:, 10:], pasts[1].past[:, 10:])
