"""InterFormer against the released network's numbers."""

from __future__ import annotations

import pytest
import torch

from models.errors import WeightsError
from models.interformer.network import InterFormer, InterFormerConfig, Positions, from_released, joint_distances
from tests.models.reference_arrays import Reference, assert_equal


@pytest.fixture(scope="module")
def ref() -> Reference:
    return Reference("interformer_small")


@pytest.fixture(scope="module")
def network(ref: Reference) -> InterFormer:
    return from_released(ref.weights(), num_heads=3).requires_grad_(False)


def test_generation_equals_the_reference(ref, network):
    found = network.generate(ref["source"], ref["source_mask"], ref["first_frame"], 15)
    assert_equal(found, ref["autoregressive"])


def test_padding_of_the_actor_changes_nothing(ref, network):
    source, mask, first = ref["source"], ref["source_mask"], ref["first_frame"]
    changed = source.clone()
    changed[1, 15] = 7.0  # beyond the last frame that is made, and masked
    assert torch.equal(*(network.generate(each, mask, first, 15) for each in (source, changed)))


def test_tables_and_positions_equal_the_reference(ref):
    assert_equal(joint_distances(ref["source"][:, :15], ref["target_input"]), ref["distances"], 1e-6)
    assert_equal(Positions(16).pe, ref.weights()["encoder.pe.pe"], 1e-5)


def test_sizes_are_read_off_the_shapes(network):
    assert network.config == InterFormerConfig(num_layers=2, max_length=16)


def test_other_weights_are_refused(ref):
    with pytest.raises(WeightsError, match="not InterFormer weights"):
        from_released({"a": torch.zeros(1)})
    weights = ref.weights()
    del weights["decoder.layers.1.norm_3.bias"]
    with pytest.raises(WeightsError, match=r"norm_3\.bias is missing"):
        from_released(weights)
