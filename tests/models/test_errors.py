"""Weights that do not fit a network are refused by the name of the first wrong tensor."""

import numpy as np
import pytest
import torch
from torch import nn

from models.errors import WeightsError, as_tensors, count_layers, load_strictly

GOOD = {"weight": torch.ones(2, 3), "bias": torch.zeros(2)}


@pytest.mark.parametrize(
    ("weights", "says"),
    [
        ({"weight": GOOD["weight"]}, "bias is missing"),
        (GOOD | {"extra": torch.zeros(1)}, "extra is unknown"),
        (GOOD | {"bias": torch.zeros(5)}, r"bias is \(5,\), and \(2,\) was expected"),
    ],
)
def test_wrong_weights_are_refused_and_change_nothing(weights: dict[str, torch.Tensor], says: str) -> None:
    layer = nn.Linear(3, 2)
    before = layer.weight.clone()
    with pytest.raises(WeightsError, match=says):
        load_strictly(layer, weights, network="Test")
    assert torch.equal(layer.weight, before) and layer.training


def test_right_weights_are_loaded_in_eval_mode() -> None:
    layer = nn.Linear(3, 2)
    load_strictly(layer, GOOD, network="Test")
    assert torch.equal(layer.weight, GOOD["weight"]) and not layer.training


def test_arrays_become_float32_and_integers_stay() -> None:
    found = as_tensors({"a": np.ones(2, dtype=np.float64), "n": np.arange(3)})
    assert found["a"].dtype == torch.float32 and found["n"].dtype == torch.int64


def test_layers_are_counted_by_their_numbers() -> None:
    names = ("blocks.0.a", "blocks.0.b", "blocks.10.a", "other.3.a")
    assert count_layers(dict.fromkeys(names, torch.zeros(1)), "blocks.") == 2
