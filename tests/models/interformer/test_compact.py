"""The trained InterFormer's network: causal, and alive to all it is given."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch

from models.errors import WeightsError
from models.interformer.compact import CompactInterFormer, CompactInterFormerConfig
from models.interformer.network import JOINTS
from models.weights_io import load_network, save_network


@pytest.fixture(scope="module")
def model() -> CompactInterFormer:
    """Random weights in all layers, the two that begin at zero among them."""
    torch.manual_seed(0)
    network = CompactInterFormer(CompactInterFormerConfig(joint_width=4, ff_size=16, window=20))
    for layer in (network.linear, network.out):
        torch.nn.init.normal_(layer.weight, std=0.05)
    network.step_std.uniform_(0.01, 0.03)
    for name in ("actor", "reactor"):
        getattr(network, f"{name}_mean").normal_(std=0.5)
        getattr(network, f"{name}_std").uniform_(0.5, 1.5)
    torch.nn.init.constant_(network.reach, 0.7)
    return network.eval().requires_grad_(False)


@pytest.fixture(scope="module")
def scene() -> tuple[torch.Tensor, ...]:
    """actor, reactor (2, 14, J, 3), noise and mask; the second scene is shorter."""
    g = torch.Generator().manual_seed(1)
    actor, reactor = (torch.randn(2, 14, JOINTS, 3, generator=g) for _ in range(2))
    mask = torch.ones(2, 14, dtype=torch.bool)
    mask[1, 9:] = False
    return actor, reactor, torch.randn(2, 16, generator=g), mask


def test_a_reaction_made_pose_by_pose_is_what_the_network_gives_for_it(model, scene):
    actor, reactor, noise, mask = scene
    made = model.react(actor, reactor[:, 0], noise, mask)
    assert made.shape == actor.shape
    again = model(actor, made[:, :-1], noise, mask)
    torch.testing.assert_close(again, made[:, 1:], atol=1e-5, rtol=1e-5)


def test_no_frame_of_the_reactor_sees_a_later_one(model, scene):
    actor, reactor, noise, mask = scene
    changed = reactor.clone()
    changed[:, 6:] += 1.0
    before, after = (model(actor, past[:, :-1], noise, mask) for past in (reactor, changed))
    torch.testing.assert_close(after[:, :6], before[:, :6], atol=1e-6, rtol=1e-6)
    assert (after[:, 6:] - before[:, 6:]).abs().amin() > 0


def test_the_whole_actor_and_the_noise_are_seen(model, scene):
    actor, reactor, noise, mask = scene
    before = model.react(actor, reactor[:, 0], noise, mask)
    later = actor.clone()
    later[0, 12] += 0.5
    assert (model.react(later, reactor[:, 0], noise, mask) - before)[0, 1].abs().max() > 1e-5
    assert (model.react(actor, reactor[:, 0], -noise, mask) - before)[:, 1].abs().max() > 1e-5


def test_attention_does_not_see_padding(model, scene):
    actor, _, noise, mask = scene
    changed = actor.clone()
    changed[1, 9:] = 5.0
    before, after = (model.encode(people, noise, mask) for people in (actor, changed))
    torch.testing.assert_close(after[1, :9], before[1, :9], atol=1e-6, rtol=1e-6)


def test_before_anything_is_learned_nobody_moves(scene):
    actor, reactor, noise, mask = scene
    network = CompactInterFormer(CompactInterFormerConfig(joint_width=4, ff_size=16, window=20)).eval()
    made = network.react(actor, reactor[:, 0], noise, mask)
    assert torch.equal(made, reactor[:, :1].expand_as(made))


def test_a_folder_holds_the_network_and_says_what_is_wrong_with_it(model, tmp_path: Path):
    save_network(tmp_path, model, trained_steps=3)
    found, source = load_network(tmp_path, CompactInterFormer)
    assert source.meta["trained_steps"] == 3 and found.config == model.config
    for name, value in model.state_dict().items():
        torch.testing.assert_close(found.state_dict()[name], value.half().float())
    config = json.loads((tmp_path / "config.json").read_text())
    config["model"]["joint_width"] = 8
    (tmp_path / "config.json").write_text(json.dumps(config))
    with pytest.raises(WeightsError, match="do not fit"):
        load_network(tmp_path, CompactInterFormer)
