"""ReGenNet against the released networks' numbers, and what *online* promises."""

from __future__ import annotations

import pytest
import torch

from models.diffusion import make_scheduler, sample_steps
from models.errors import WeightsError
from models.regennet.network import ReactionStream, ReGenNet, ReGenNetConfig, StreamError, from_released
from tests.models.reference_arrays import Reference, assert_equal

KINDS = ("regennet_online", "regennet_offline", "regennet_online_action")


def load(name: str) -> tuple[Reference, ReGenNet]:
    ref = Reference(name)
    return ref, from_released(ref.weights(), num_heads=4).requires_grad_(False)


@pytest.mark.parametrize("name", KINDS)
def test_forward_equals_the_reference(name):
    ref, network = load(name)
    action = ref.arrays.get("action")
    assert_equal(network(ref["x"], ref["t"], ref["actor"], action), ref["forward"])


def test_unconditional_equals_the_reference():
    ref, network = load("regennet_online_action")
    inputs = ref["x"], ref["t"], ref["actor"]
    expected = ref["forward_unconditional"]
    assert_equal(network(*inputs, ref["action"], unconditional=True), expected)
    assert_equal(network(*inputs), expected)
    mixed = network(*inputs, ref["action"], torch.tensor([True, False]))
    assert_equal(mixed, torch.stack([expected[0], ref["forward"][1]]))


def test_guidance_mixes_both_in_one_batch():
    ref, network = load("regennet_online_action")
    inputs = ref["x"], ref["t"], ref["actor"], ref["action"]
    assert_equal(network.guided(*inputs, scale=2.5), 2.5 * ref["forward"] - 1.5 * ref["forward_unconditional"], 5e-4)
    assert torch.equal(network.guided(*inputs, scale=1), network(*inputs))


def test_sizes_are_read_off_the_shapes():
    config = ReGenNetConfig(latent_dim=64, ff_size=96, num_layers=2, num_heads=4)
    assert load("regennet_online")[1].config == config
    assert load("regennet_offline")[1].config == ReGenNetConfig(**{**vars(config), "online": False})
    assert load("regennet_online_action")[1].config == ReGenNetConfig(**{**vars(config), "num_actions": 26})


@pytest.mark.parametrize("name", KINDS)
def test_the_future_changes_no_past_frame_by_a_bit_when_online(name):
    ref, network = load(name)
    action = ref.arrays.get("action")
    actor, x = ref["actor"].clone(), ref["x"].clone()
    actor[..., 10:] = 50
    x[..., 10:] = -50
    before = network(ref["x"], ref["t"], ref["actor"], action)
    after = network(x, ref["t"], actor, action)
    assert torch.equal(after[..., :10], before[..., :10]) == network.config.online
    assert not torch.equal(after[..., 10:], before[..., 10:])


@pytest.mark.parametrize("name", ["regennet_online", "regennet_online_action"])
def test_the_stream_gives_the_frames_of_the_whole_motion(name):
    ref, network = load(name)
    noise, actor, action = ref["x"], ref["actor"], ref.arrays.get("action")
    *_, whole = sample_steps(lambda x, t: network(x, t, actor, action), noise, make_scheduler("ddim", 5))
    stream = ReactionStream(network, steps=5, batch=2, action=action, max_frames=18)
    frames = [stream.step(actor[..., i], noise=noise[..., i]) for i in range(18)]
    assert_equal(torch.stack(frames, dim=-1), whole.sample)
    assert stream.length == 18
    with pytest.raises(StreamError, match="18 frames"):
        stream.step(actor[..., 0], noise=noise[..., 0])


def test_an_offline_network_cannot_stream():
    _, network = load("regennet_offline")
    with pytest.raises(StreamError, match="choose online weights"):
        ReactionStream(network, steps=1, batch=1, action=None, max_frames=1)


def test_other_weights_are_refused():
    with pytest.raises(WeightsError, match="not ReGenNet weights"):
        from_released({"a": torch.zeros(1)}, num_heads=4)
