"""Tensors of mapped files are those of the file, also after their pages were let go."""

import re
import sys
from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file

from models.weights_io import let_go, mapped_tensors


def resident(path: Path) -> int:
    """Kilobytes of a file that this process has in memory."""
    maps = Path("/proc/self/smaps").read_text()
    parts = re.split(r"^(?=[0-9a-f]+-)", maps, flags=re.MULTILINE)
    return sum(int(re.search(r"Rss:\s+(\d+)", part)[1]) for part in parts if str(path) in part)  # type: ignore[index]


def test_tensors_are_those_of_the_file(tmp_path: Path) -> None:
    stored = {"a": torch.randn(3, 4), "b": torch.arange(5), "c": torch.randn(2, 2).half(), "d": torch.tensor(2.0)}
    save_file(stored, tmp_path / "x.safetensors", metadata={"format": "pt"})
    found = mapped_tensors(tmp_path / "x.safetensors")
    assert found.keys() == stored.keys()
    for name, tensor in stored.items():
        assert found[name].dtype == tensor.dtype and torch.equal(found[name], tensor)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="another system's memory")
def test_pages_are_let_go_and_come_again(tmp_path: Path) -> None:
    path = tmp_path / "large.safetensors"
    stored = torch.randn(1_000_000)
    save_file({"large": stored}, path)
    large = mapped_tensors(path)["large"]
    assert torch.equal(large, stored) and resident(path) > 3000
    let_go()
    assert resident(path) < 100
    assert torch.equal(large, stored)


def test_what_is_no_such_file_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "empty").write_bytes(b"")
    with pytest.raises(ValueError, match="empty"):
        mapped_tensors(tmp_path / "empty")
