"""InterFormer against the released network's numbers."""

from __future__ import annotations

import pytest
import torch

from models.errors import WeightsError
from models.interformer.network import (
    InterFormer,
    InterFormerConfig,
    Positions,
    from_released,
    joint_distances,
    target_mask,
)
from tests.models.reference_arrays import Reference, assert_equal


@pytest.fixture(scope="module")
def ref() -> Reference:
    return Reference("interformer_small")


@pytest.fixture(scope="module")
def network(ref: Reference) -> InterFormer:
    return from_released(ref.weights(), num_heads=3).requires_grad_(False)


def inputs(ref: Reference) -> list[torch.Tensor]:
    return [ref[k] for k in ("source", "target_input", "distances", "source_mask", "target_mask")]


def test_forward_equals_the_reference(ref, network):
    assert_equal(network(*inputs(ref)), ref["forward"])


def test_generation_equals_the_reference(ref, network):
    found = network.generate(ref["source"], ref["source_mask"], ref["first_frame"], 15)
    assert_equal(found, ref["autoregressive"])


def test_frame_by_frame_is_the_whole_pass(ref, network):
    source, mask = ref["source"], ref["source_mask"]
    made = network.generate(source, mask, ref["first_frame"], 15)
    table = joint_distances(source[:, :14], made[:, :14])
    again = network(source, made[:, :14].clone(), table, mask, target_mask(14))
    torch.testing.assert_close(again[:, 1:], made[:, 2:], atol=1e-5, rtol=1e-5)


def test_tables_masks_and_positions_equal_the_reference(ref):
    assert_equal(joint_distances(ref["source"][:, :15], ref["target_input"]), ref["distances"], 1e-6)
    assert torch.equal(target_mask(15)[0], ref["target_mask"][0])
    assert_equal(Positions(16).pe, ref.weights()["encoder.pe.pe"], 1e-5)


def test_sizes_are_read_off_the_shapes(network):
    assert network.config == InterFormerConfig(num_layers=2, max_length=16)


def test_no_frame_sees_a_later_one(ref, network):
    source, target, distances, *masks = inputs(ref)
    before = network(source, target, distances, *masks)
    changed, table = target.clone(), distances.clone()
    changed[:, 6:], table[:, 6:] = 3.0, 0.1
    after = network(source, changed, table, *masks)
    assert torch.equal(after[:, :6], before[:, :6])
    assert not torch.equal(after[:, 6:], before[:, 6:])


def test_padding_of_the_actor_changes_nothing_in_time(ref, network):
    source, *others = inputs(ref)
    changed = source.clone()
    changed[1, 15] = 7.0  # beyond the last target frame, and masked
    assert torch.equal(network(changed, *others), network(source, *others))


def test_other_weights_are_refused(ref):
    with pytest.raises(WeightsError, match="not InterFormer weights"):
        from_released({"a": torch.zeros(1)})
    weights = ref.weights()
    del weights["decoder.layers.1.norm_3.bias"]
    with pytest.raises(WeightsError, match=r"norm_3\.bias is missing"):
        from_released(weights)
