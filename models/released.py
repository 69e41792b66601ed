"""The checkpoints that the papers' authors released, read without running what is in them."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor, nn

from models.errors import WeightsError

WRAPPED = ("module.", "model.", "net.")
"""Prefixes that trainers put before all names of a network."""
HARMLESS = (
    "argparse.Namespace",
    "lightning_fabric.utilities.data.AttributeDict",
    "pathlib.PosixPath",
    "pathlib.WindowsPath",
    "pytorch_lightning.callbacks.model_checkpoint.ModelCheckpoint",
    "pytorch_lightning.utilities.parsing.AttributeDict",
    "yacs.config.CfgNode",
)
"""Objects that trainers store beside the tensors. An empty stand-in takes the place of each; none is imported."""
_reading = threading.Lock()
Network = TypeVar("Network", bound=nn.Module)


class Released(dict[str, Tensor]):
    """The released tensors of a network by name: float32 on the CPU, integers stay integers.

    Args:
        weights: tensors or numpy arrays by name.
        network: its name, for messages.
    """

    def __init__(self, weights: Mapping[str, object], network: str) -> None:
        tensors = {name: torch.as_tensor(value) for name, value in weights.items()}
        super().__init__({name: v.float() if v.is_floating_point() else v for name, v in tensors.items()})
        self.network = network

    def shape(self, name: str) -> tuple[int, ...]:
        """The shape of a named tensor; WeightsError if it is absent."""
        if name not in self:
            raise WeightsError(f"These are not {self.network} weights: {name} is missing. Choose another file.")
        return tuple(self[name].shape)

    def layers(self, prefix: str) -> int:
        """Number of layers `prefix`0., `prefix`1., … among the names."""
        return len({name[len(prefix) :].split(".")[0] for name in self if name.startswith(prefix)})

    def loaded(self, module: Network) -> Network:
        """The module with every tensor, none missing, left over or misshapen, in eval mode.

        Raises WeightsError that names the first offender.
        """
        expected = module.state_dict()
        for name, value in expected.items():
            if self.shape(name) != tuple(value.shape):
                raise WeightsError(
                    f"These are not {self.network} weights of one size: {name} is {self.shape(name)}, "
                    f"and {tuple(value.shape)} was expected. Choose another file."
                )
        if unknown := next((name for name in self if name not in expected), None):
            raise WeightsError(f"These are not {self.network} weights: {unknown} is unknown. Choose another file.")
        module.load_state_dict(dict(self))
        return module.eval()


class _StandIn(dict[Any, Any]):
    """Takes the place of one of :data:`HARMLESS`; it keeps nothing of what it is given."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__()

    def __setstate__(self, state: Any) -> None:
        pass


def read_tensors(path: str | Path, *, network: str, mark: str = "") -> dict[str, Tensor]:
    """The tensors of a checkpoint by name; they are mapped from the file and read when they are used.

    A PyTorch file is opened with ``weights_only=True``, so no code in it runs; ``.safetensors`` files hold
    none. Where a trainer put the network into a larger record, the part with the most tensors is taken. Position
    tables (``….pe``) are kept.

    Args:
        path: of the file.
        network: what it should be, for messages.
        mark: the beginning of one of its names: a prefix of :data:`WRAPPED` before that is left out.

    Raises:
        WeightsError: if the file is missing, truncated, holds objects other than tensors, or no tensors.
    """
    path = Path(path)
    if not path.is_file():
        raise WeightsError(f"There is no file {path}: name the released {network} checkpoint.")
    checkpoint = _read_safetensors(path) if path.suffix == ".safetensors" else _read_torch(path, network)
    records = max(_records(checkpoint), key=len, default={})
    if not records:
        raise WeightsError(f"{path.name} holds no tensors: use the released {network} checkpoint.")
    wrapped = (prefix for prefix in WRAPPED if mark and any(name.startswith(prefix + mark) for name in records))
    before = next(wrapped, "")
    return {name.removeprefix(before): value for name, value in records.items() if name.startswith(before)}


def with_prefix(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """The tensors whose names start with a prefix, without it, and without position tables, which are computed."""
    own = {name: tensor for name, tensor in tensors.items() if name.startswith(prefix) and not name.endswith(".pe")}
    return {name.removeprefix(prefix): tensor for name, tensor in own.items()}


def _records(checkpoint: Any) -> Iterator[Mapping[str, Tensor]]:
    """Every dictionary in a checkpoint, to two levels, reduced to its tensors."""
    if not isinstance(checkpoint, dict):
        return
    inner = [value for value in checkpoint.values() if isinstance(value, dict)]
    for record in (checkpoint, *inner):
        yield {str(name): value for name, value in record.items() if isinstance(value, Tensor)}


def _read_safetensors(path: Path) -> dict[str, Tensor]:
    try:
        return load_file(path)
    except (SafetensorError, OSError, ValueError) as error:
        raise WeightsError(f"{path.name} is not a whole safetensors file: copy or download it again.") from error


def _read_torch(path: Path, network: str) -> Any:
    try:
        with _reading:  # the list of stand-ins is the process's own
            before = torch.serialization.get_safe_globals()
            torch.serialization.add_safe_globals([(_StandIn, name) for name in HARMLESS])
            try:
                return torch.load(path, map_location="cpu", weights_only=True, mmap=True)
            finally:
                torch.serialization.clear_safe_globals()
                torch.serialization.add_safe_globals(before)
    except (pickle.UnpicklingError, RuntimeError, EOFError, OSError, ValueError, TypeError) as error:
        raise WeightsError(
            f"{path.name} cannot be read as plain tensors, so it was not opened: it is truncated, or holds code or "
            f"other objects. Use the released {network} checkpoint, or save its state_dict alone."
        ) from error
