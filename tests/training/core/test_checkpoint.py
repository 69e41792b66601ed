"""Checkpoints: what is written comes back, and what is damaged or of another run is refused."""

import json
from pathlib import Path

import pytest
import torch
from torch import nn

from motion import InputError
from training.core import checkpoint


def parts(seed: int) -> checkpoint.Parts:
    """A network and its optimiser after one step."""
    torch.manual_seed(seed)
    network = nn.Linear(3, 2)
    optimizer = torch.optim.AdamW(network.parameters())
    network(torch.ones(1, 3)).sum().backward()
    optimizer.step()
    return {"model": network, "optimizer": optimizer}


def test_network_and_optimiser_come_back(tmp_path: Path) -> None:
    path, settings = tmp_path / "last.safetensors", json.dumps({"batch": 4})
    saved, other = parts(0), parts(1)
    checkpoint.save(path, saved, 7, settings)
    assert checkpoint.restore(path, other, settings) == 7
    assert torch.equal(other["model"].state_dict()["weight"], saved["model"].state_dict()["weight"])
    for name in ("exp_avg", "exp_avg_sq", "step"):
        states = [part["optimizer"].state_dict()["state"][0][name] for part in (saved, other)]
        assert torch.equal(*states)


def test_a_part_of_other_sizes_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "last.safetensors"
    checkpoint.save(path, parts(0), 1, "{}")
    with pytest.raises(InputError, match="other sizes"):
        checkpoint.restore_part(path, "model", nn.Linear(4, 2))
    with pytest.raises(InputError, match="give a folder of weights"):
        checkpoint.restore_part(tmp_path / "nowhere", "model", nn.Linear(3, 2))
