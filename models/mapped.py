"""Files of weights that are mapped into memory instead of read.

Their pages are those of the system's disk cache. A process at rest lets them go, and the next run finds them in the
cache again: a few milliseconds for the text encoder's 40 MB. Mapped memory must never be written.
"""

from __future__ import annotations

import json
import mmap
import weakref
from pathlib import Path

import torch
from torch import Tensor

_MAPPED: weakref.WeakSet[mmap.mmap] = weakref.WeakSet()
_TYPES = {"F32": torch.float32, "F16": torch.float16, "I64": torch.int64}


def mapped(path: Path) -> mmap.mmap:
    """A file's bytes.

    Raises:
        OSError: if it cannot be read.
        ValueError: if it is empty.
    """
    with path.open("rb") as file:
        # Torch and OpenVINO want memory that can be written; what is written would be a copy of this process alone.
        made = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_COPY)
    _MAPPED.add(made)
    return made


def mapped_tensors(path: Path) -> dict[str, Tensor]:
    """The tensors of a safetensors file, by name.

    Raises:
        OSError: if it cannot be read.
        ValueError: if it is no such file.
    """
    data = mapped(path)
    start = 8 + int.from_bytes(data[:8], "little")
    described = json.loads(data[8:start])
    described.pop("__metadata__", None)
    tensors = {}
    for name, entry in described.items():
        begin, end = entry["data_offsets"]
        kind = _TYPES[entry["dtype"]]
        flat = torch.frombuffer(data, dtype=kind, offset=start + begin, count=(end - begin) // kind.itemsize)
        tensors[name] = flat.reshape(entry["shape"])
    return tensors


def let_go() -> None:
    """Lets the system take the pages of all mapped files; what is read next comes from its cache or the disk."""
    for data in tuple(_MAPPED):
        if hasattr(data, "madvise"):
            data.madvise(mmap.MADV_DONTNEED)
