"""Weights folders: what is written is read, in shards too, and nothing altered or unfinished is loaded."""

import json
from dataclasses import dataclass
from pathlib import Path

import pytest
import torch
from torch import nn

from models.errors import WeightsError
from models.weights_io import WeightsFolder, load_network, save_network


@dataclass(frozen=True)
class Sizes:
    width: int = 8


class Small(nn.Module):
    sizes = Sizes

    def __init__(self, config: Sizes) -> None:
        super().__init__()
        self.config = config
        self.first, self.second = nn.Linear(config.width, 4), nn.Linear(4, config.width)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    torch.manual_seed(0)
    save_network(tmp_path / "small", Small(Sizes()), extra={"words.txt": b"hello"}, title="A small one")
    return tmp_path / "small"


@pytest.mark.parametrize("shard_bytes", [15_000_000, 80])
def test_a_network_comes_back(tmp_path: Path, shard_bytes: int) -> None:
    torch.manual_seed(0)
    network = Small(Sizes())
    save_network(tmp_path / "small", network, shard_bytes=shard_bytes)
    assert len(list((tmp_path / "small").glob("model*.safetensors"))) == (1 if shard_bytes > 1000 else 2)
    loaded, _ = load_network(tmp_path / "small", Small)
    assert not loaded.training and not any(p.requires_grad for p in loaded.parameters())
    for name, tensor in network.state_dict().items():
        torch.testing.assert_close(loaded.state_dict()[name], tensor.half().float(), atol=0, rtol=0)


def test_other_files_and_entries_come_along(folder: Path) -> None:
    source = WeightsFolder(folder)
    assert source.read("words.txt") == b"hello" and source.meta["title"] == "A small one"


@pytest.mark.parametrize("name", ["model.safetensors", "words.txt"])
def test_a_changed_file_is_refused(folder: Path, name: str) -> None:
    data = bytearray((folder / name).read_bytes())
    data[-1] ^= 1
    (folder / name).write_bytes(data)
    with pytest.raises(WeightsError, match="has been changed"):
        WeightsFolder(folder).read(name)


def test_a_folder_that_was_not_written_whole_is_refused(folder: Path) -> None:
    (folder / "config.json").unlink()
    with pytest.raises(WeightsError, match=r"config\.json"):
        load_network(folder, Small)


def test_weights_of_other_sizes_are_refused(folder: Path) -> None:
    meta = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(json.dumps(meta | {"model": {"width": 9}}))
    with pytest.raises(WeightsError, match="do not fit"):
        load_network(folder, Small)
