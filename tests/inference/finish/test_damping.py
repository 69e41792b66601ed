"""The regularisers of sampling, on control points of two people who stand still."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import torch

from models.diffusion import top_timesteps
from models.intergen.compact import CompactConfig, CompactInterGen, Touch
from models.motion_tokens import encode, pack
from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig
from motion import SMPL22, Duet
from motion.metrics.quality import penetration
from motion.skeleton import FEET
from tests.inference.people import waver
from webdemo.inference.finish import damping
from webdemo.inference.finish.damping import Beside, Damping, shares
from webdemo.inference.requests import GenerateRequest, ReactRequest

HANDS = (("right_wrist", "right_wrist"),)


@pytest.fixture(scope="module")
def model() -> CompactInterGen:
    return CompactInterGen(CompactConfig(latent_dim=32, ff_size=32, num_layers=1, num_heads=2, cond_dim=16))


def standing(model: CompactInterGen, apart: float) -> torch.Tensor:
    """Two people who hold a right hand out, with ``apart`` metres between the wrists."""
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    wrist = SMPL22.index("right_wrist")
    a = rest.copy()
    a[wrist] = a[SMPL22.index("right_shoulder")] + [0, -0.1, 0.45]
    b = a * [-1, 1, -1]
    b += a[wrist] - b[wrist] + [0, 0, apart]
    positions = torch.tensor(np.stack([a, b]), dtype=torch.float32)[:, None].expand(2, 61, 22, 3)
    return pack(encode(positions, torch.ones(2, 61, 4), model.layout)[None], model.layout)


def people(model: CompactInterGen, apart: float = 1.0) -> torch.Tensor:
    """(2, 61, 22, 3) two who stand still, arms down, ``apart`` metres from each other, face to face."""
    rest = torch.tensor(SMPL22.rest_positions(), dtype=torch.float32) + torch.tensor([0, 0.98, 0])
    for side in ("left", "right"):
        chain = [SMPL22.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist")]
        for parent, child in pairwise(chain):
            length = SMPL22.bone_lengths[child]
            rest[child] = rest[parent] - torch.tensor([0.0, float(length), 0.0])
    rest = rest - rest[0] * torch.tensor([1.0, 0, 1.0])
    other = rest * torch.tensor([-1.0, 1, -1]) + torch.tensor([0.0, 0, apart])
    return torch.stack([rest, other])[:, None].repeat(1, 61, 1, 1)


def settled(space: damping.Space, x: torch.Tensor, touches: Sequence[Touch] = ()) -> torch.Tensor:
    """What the whole correction, made three times, leaves of a sample of 61 frames."""
    whole = Damping(space, 1.0, frames=61, timesteps=[0], touches=touches)
    return whole(whole(whole(x, 0), 0), 0)


def damped(model: CompactInterGen, positions: torch.Tensor, *, standing: float = 0.0) -> torch.Tensor:
    """What the shipped weights of the damping make of two people (2, 61, 22, 3), in metres.

    standing: predicted contact of all feet.
    """
    x = pack(encode(positions, torch.full((2, 61, 4), standing), model.layout)[None], model.layout)
    return model.positions(settled(model, x))[0][0, :, :61]


def test_bones_get_the_length_they_should_have(model):
    before = people(model)
    wrist, elbow = SMPL22.index("left_wrist"), SMPL22.index("left_elbow")
    before[0, :, wrist, 1] -= 0.1

    def length(positions: torch.Tensor) -> float:
        return float((positions[0, :, wrist] - positions[0, :, elbow]).norm(dim=-1).mean())

    assert abs(length(damped(model, before)) - SMPL22.bone_lengths[wrist]) < 0.02


def test_feet_that_stand_stop_sliding(model):
    before = people(model) + 0.01 * torch.arange(61)[:, None, None] * torch.tensor([1.0, 0, 0])

    def slide(positions: torch.Tensor) -> float:
        """Metres that a foot moves in a frame."""
        return float(positions[:, :, list(FEET)].diff(dim=1).norm(dim=-1).mean())

    assert slide(before) == pytest.approx(0.01)
    assert slide(damped(model, before, standing=1.0)) < 0.007
    assert slide(damped(model, before, standing=0.0)) > 0.0095  # a foot in the air may move


def test_feet_that_stand_in_one_of_two_frames_may_move_between_them(model):
    sliding = (people(model) + 0.01 * torch.arange(61)[:, None, None])[None]
    sometimes = (torch.arange(61) % 2.0)[:, None].expand(1, 2, 61, 4)
    free, half = (float(damping.energy(sliding, contacts)) for contacts in (0 * sometimes, sometimes))
    assert half == free < float(damping.energy(sliding, torch.ones(1, 2, 61, 4)))


def test_feet_come_out_of_the_floor(model):
    before = people(model)
    before[..., 1] -= before[0, 0, list(FEET), 1].max() + 0.04
    lowest = damped(model, before)[:, :, list(FEET), 1]
    assert float(before[:, :, list(FEET), 1].max()) < -0.03
    assert float(lowest.mean()) > -0.02


def test_hands_that_nearly_meet_do(model):
    before = people(model)
    shoulder, elbow, wrist = (SMPL22.index(f"right_{name}") for name in ("shoulder", "elbow", "wrist"))
    for person, forward in zip(before, (1.0, -1.0), strict=True):  # both hold their right arm out
        for parent, child in ((shoulder, elbow), (elbow, wrist)):
            reach = torch.tensor([0.0, 0.0, forward * float(SMPL22.bone_lengths[child])])
            person[:, child] = person[:, parent] + reach
    before[1] += before[0, 0, wrist] - before[1, 0, wrist] + torch.tensor([0.0, 0, 0.15])

    def nearest(positions: torch.Tensor) -> float:
        return float((positions[0, :, wrist] - positions[1, :, wrist]).norm(dim=-1).min())

    assert nearest(before) == pytest.approx(0.15)
    assert nearest(damped(model, before)) < 0.11


def test_bodies_that_overlap_part(model):
    before = people(model, apart=0.1)

    def depth(positions: torch.Tensor) -> float:
        return float(penetration(Duet.from_positions(positions.numpy(), fps=30.0)).mean())

    assert depth(damped(model, before)) < 0.3 * depth(before)


def rotation_y(angle: float) -> torch.Tensor:
    cos, sin = np.cos(angle), np.sin(angle)
    return torch.tensor([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]], dtype=torch.float32)


def gap(model: CompactInterGen, x: torch.Tensor) -> float:
    a, b = model.positions(x)[0][0, :, :61, SMPL22.index("right_wrist")]
    return float((a - b).norm(dim=-1).min())


def test_an_asked_touch_brings_the_hands_together(model):
    apart = 0.4
    x = standing(model, apart)
    assert gap(model, x) == pytest.approx(apart, abs=0.02)
    met = settled(model, x, [HANDS])
    assert gap(model, met) < 0.12


def test_it_says_how_far_the_last_step_moved_the_joints(model):
    x = standing(model, 0.15)
    damping = Damping(model, 0.7, frames=61, timesteps=[500, 100])
    damping(x, 500)
    assert damping.moved is None, "only the last timestep is what is seen"
    after = damping(x, 100)
    apart = model.positions(after)[0] - model.positions(x)[0]
    assert damping.moved.tolist() == pytest.approx([float(apart[:, :, :61].norm(dim=-1).mean())])
    assert 0.0001 < float(damping.moved) < 0.1


def test_without_damping_nothing_is_corrected(model):
    x = standing(model, 0.4)
    asked = {"frames": 61, "timesteps": [999, 501, 0], "touches": [HANDS]}
    assert all(Damping(model, 0.0, **asked)(x, t) is x for t in (999, 501, 0))
    assert Damping(model, 0.6, **asked)(x, 999) is not x
    assert Damping(model, 0.5, **asked)(x, 999) is x


@pytest.mark.parametrize("steps", [50, 1000])
def test_with_many_steps_the_threshold_is_that_of_the_paper(steps):
    """Eq. 15: all where t ≤ t̄·T, nothing above, and a share at the one step that reaches below it."""
    timesteps = top_timesteps(steps).tolist()
    found = shares(0.7, timesteps)
    assert all(found[t] == 1 for t in timesteps[:-1] if t <= 700)
    assert [t for t in timesteps if t > 700 and found[t]] in ([], [min(t for t in timesteps if t > 700)])


def test_beside_a_given_actor_the_reactor_alone_moves(model):
    """ReGenNet's space holds one person, who brings their hand to where the actor holds out theirs."""
    reactor = CompactReGenNet(CompactReGenNetConfig(latent_dim=32, ff_size=32, num_layers=1, num_heads=2, cond_dim=16))
    reactor.std.fill_(0.5)
    actor, other = model.positions(standing(model, 0.4))[0][0, :, :61]
    space = Beside(reactor, actor)
    x = (encode(other, torch.ones(61, 4), reactor.layout)[None] - reactor.mean) / reactor.std
    before, contacts = space.positions(x)
    assert before.shape == (1, 2, 61, 22, 3) and contacts.shape == (1, 2, 61, 4)
    met = settled(space, x, [HANDS])
    after = space.positions(met)[0]
    wrist = SMPL22.index("right_wrist")
    gaps = [(p[0, 0, :, wrist] - p[0, 1, :, wrist]).norm(dim=-1).min() for p in (before, after)]
    assert gaps[0] == pytest.approx(0.4, abs=0.02) and gaps[1] < 0.12
    torch.testing.assert_close(after[:, 0], actor[None], rtol=0, atol=0)


@pytest.mark.parametrize("apart", [0.2, 1.7])
def test_the_pairs_that_touch_are_all_that_overlap(apart):
    """The sum over all pairs of spheres at all moments, and its gradient, from those alone that touch."""
    dice = torch.Generator().manual_seed(3)
    rest = torch.tensor(SMPL22.rest_positions(), dtype=torch.float32) + torch.tensor([4.0, 1.0, -3.0])
    positions = rest + 0.15 * torch.randn(3, 2, 9, 22, 3, generator=dice)
    positions[:, 1] += torch.tensor([apart, 0.0, 0.0])
    positions[2, 1] += 5  # far away
    answers = []
    for energy in (all_pairs, damping._overlap):
        leaf = positions.clone().requires_grad_(True)
        total = energy(leaf)
        answers.append((total.detach(), *torch.autograd.grad(total.sum(), leaf)))
    for dense, sparse in zip(*answers, strict=True):
        torch.testing.assert_close(sparse, dense, atol=1e-5, rtol=1e-4)
    assert (float(answers[0][0][0]) > 0) == (apart < 1) and float(answers[0][0][2]) == 0


def all_pairs(positions: torch.Tensor) -> torch.Tensor:
    ends, radii = damping._ENDS, damping._RADII
    a, b = ((positions[..., ends[:, 0], :] + positions[..., ends[:, 1], :]) / 2).unbind(1)
    gap = torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist")
    return (radii[:, None] + radii - gap).clamp_min(0).square().sum((1, 2, 3))


def request(model: str, steps: int, threshold: float) -> GenerateRequest | ReactRequest:
    """Two motions of a second, made by a network alone."""
    asked: dict[str, Any] = {"model": model, "samples": 2, "steps": steps, "damping": threshold}
    if model == "regennet":
        return ReactRequest(actor=waver().cut(0, 31), mode="offline", cleanup=False, **asked)
    words = "One person walks up to the other and pats them on the shoulder."
    return GenerateRequest(prompt=words, seconds=1.0, cleanup=False, split=False, planned=False, **asked)


@pytest.mark.parametrize("steps", [1, 20])
@pytest.mark.parametrize("model", ["intergen", "regennet"])
def test_the_threshold_sets_how_much_is_corrected_at_any_number_of_steps(shipped, model, steps):
    """Every larger t̄ takes the shipped networks' motions farther from those of the plain sampler."""

    def made(threshold: float) -> np.ndarray:
        *_, result = shipped.run(request(model, steps, threshold))
        return np.stack([duet.positions[-1] for duet in result.duets])

    plain = made(0.0)
    apart = [float(np.linalg.norm(made(t) - plain, axis=-1).mean()) for t in (0.05, 0.4, 0.7)]
    assert apart[0] > 1e-3
    assert all(after > 1.01 * before for before, after in pairwise(apart))


def test_only_who_turns_is_moved_by_facing_and_not_who_is_faced(model):
    one, other = (person[None].clone().requires_grad_(True) for person in people(model))
    turned = one @ rotation_y(0.2).T
    damping._turned_away(turned, other).sum().backward()
    assert one.grad is not None and one.grad.abs().max() > 0 and other.grad is None
