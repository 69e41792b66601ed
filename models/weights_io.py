"""Weights folders: one reader and one writer for every network.

A folder holds ``config.json`` (the network's sizes, its files and their SHA-256), float16 ``model*.safetensors``
shards, and for some networks files of their own. ``config.json`` is written last, so a folder that was not written
whole does not load.
"""

from __future__ import annotations

import hashlib
import json
import mmap
import weakref
from collections.abc import Mapping
from dataclasses import asdict, fields
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor, nn
from torch.overrides import TorchFunctionMode

from models.errors import WeightsError
from models.motion_tokens import TokenLayout

Network = TypeVar("Network", bound=nn.Module)
SHARD_BYTES = 15_000_000
"""Largest size of one shard in bytes: hosts of repositories reject or warn about larger files."""


def common(values: Any, sizes: type) -> dict[str, Any]:
    """The fields of a dataclass of sizes that other settings have, too, by name."""
    return {field.name: getattr(values, field.name) for field in fields(sizes) if hasattr(values, field.name)}


class WeightsFolder:
    """A model's folder, every file checked against the SHA-256 that its ``config.json`` names.

    Raises WeightsError if a file is missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            self.meta = json.loads((folder / "config.json").read_text())
            self.files: dict[str, str] = dict(self.meta["files"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise WeightsError(
                f"The model's weights are missing or damaged ({folder.name}/config.json): restore the folder "
                "from the project."
            ) from error

    @cached_property
    def digest(self) -> str:
        """One SHA-256 for all files, by which a manifest names the weights."""
        return hashlib.sha256(json.dumps(self.files, sort_keys=True).encode()).hexdigest()

    def read(self, name: str) -> bytes:
        """The bytes of one file."""
        try:
            data = (self.folder / name).read_bytes()
        except OSError as error:
            raise WeightsError(
                f"The weights file {self.folder.name}/{name} is missing: restore it from the project."
            ) from error
        if hashlib.sha256(data).hexdigest() != self.files.get(name):
            raise WeightsError(
                f"The weights file {self.folder.name}/{name} has been changed (its SHA-256 differs): restore it "
                "from the project."
            )
        return data

    def tensors(self, name: str) -> dict[str, Tensor]:
        """The tensors of one file, by name, as they are stored."""
        try:
            return load(self.read(name))
        except SafetensorError as error:
            raise WeightsError(f"{self.folder.name}/{name} is not a safetensors file: restore it.") from error

    def state_dict(self) -> dict[str, Tensor]:
        """The tensors of all shards in float32, by name."""
        shards = [self.tensors(name) for name in self.files if name.startswith("model")]
        return {name: tensor.float() for shard in shards for name, tensor in shard.items()}


class Uninitialised(TorchFunctionMode):
    """Within it, new layers draw no random weights: the weights that are loaded replace them."""

    def __torch_function__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        kwargs = kwargs or {}
        if getattr(func, "__module__", None) == "torch.nn.init":
            return args[0] if args else kwargs["tensor"]
        return func(*args, **kwargs)


def _size(value: Any) -> Any:
    """A value of ``config.json`` as the dataclass of sizes holds it: lists, and those in them, as tuples."""
    if isinstance(value, list):
        return tuple(map(_size, value))
    return TokenLayout(**value) if isinstance(value, dict) else value


def load_network(folder: Path, network: type[Network]) -> tuple[Network, WeightsFolder]:
    """The network of a weights folder in float32 and eval mode, and the folder.

    Args:
        folder: written by :func:`save_network`.
        network: is made of its sizes, of the dataclass ``network.sizes``.

    Raises:
        WeightsError: if a file is missing, altered or of other sizes.
    """
    source, sizes = WeightsFolder(folder), cast(Any, network).sizes
    known = [field.name for field in fields(sizes)]
    try:
        stored = source.meta["model"]  # of which older folders say more
        with Uninitialised():
            model = network(sizes(**{name: _size(stored[name]) for name in known if name in stored}))
        model.load_state_dict(source.state_dict(), assign=True)  # every tensor, or it raises
    except (RuntimeError, TypeError, KeyError) as error:
        raise WeightsError(f"The weights in {folder.name} do not fit their config: restore them.") from error
    return model.eval().requires_grad_(False), source


def save_network(
    folder: Path,
    model: nn.Module,
    *,
    extra: Mapping[str, bytes] | None = None,
    shard_bytes: int = SHARD_BYTES,
    **meta: Any,
) -> None:
    """Writes a weights folder: float16 shards, other files, then ``config.json``.

    Args:
        folder: made if it is missing; older shards in it are removed.
        model: has its sizes as the dataclass ``model.config``.
        extra: name → content of further files.
        shard_bytes: largest size of one shard.
        meta: more entries for ``config.json``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("model*.safetensors"):
        old.unlink()
    shards: list[dict[str, Tensor]] = [{}]
    size = 0
    for name, tensor in model.state_dict().items():
        tensor = tensor.detach().cpu().half().contiguous()
        if size + tensor.nbytes > shard_bytes and shards[-1]:
            shards.append({})
            size = 0
        shards[-1][name] = tensor
        size += tensor.nbytes
    if len(shards) == 1:
        contents = {"model.safetensors": save(shards[0])}
    else:
        contents = {f"model-{i + 1}-of-{len(shards)}.safetensors": save(s) for i, s in enumerate(shards)}
    contents |= extra or {}
    for name, data in contents.items():
        (folder / name).write_bytes(data)
    files = {name: hashlib.sha256(data).hexdigest() for name, data in contents.items()}
    config = {"model": asdict(model.config), "files": files} | meta  # type: ignore[call-overload]
    (folder / "config.json").write_text(json.dumps(config, indent=1) + "\n")


# ---- files mapped into memory --------------------------------------------------------------------
# Instead of being read. Their pages are those of the system's disk cache. A process at rest lets them go, and the next
# run finds them in the cache again: a few milliseconds for the text encoder's 40 MB. Mapped memory must never be
# written.


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
