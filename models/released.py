"""Reading the checkpoints that the papers' authors released, without running what is in them."""

from __future__ import annotations

import pickle
from pathlib import Path

import torch
from torch import Tensor

from models.errors import WeightsError


def read_lightning(path: str | Path, *, prefix: str, network: str) -> dict[str, Tensor]:
    """The tensors of a PyTorch Lightning file whose names start with `prefix`, without the prefix.

    Position tables (``….pe``) are left out: they are computed, not learned. The file is opened with
    ``weights_only=True``, so no code in it runs. Raises WeightsError if the file cannot be read so or
    holds no such tensor.
    """
    path = Path(path)
    try:
        checkpoint = torch.load(path, map_location="cpu", weights_only=True, mmap=True)
    except FileNotFoundError:
        raise WeightsError(f"There is no file {path}: name the released {network} checkpoint.") from None
    except (pickle.UnpicklingError, RuntimeError, EOFError, OSError, ValueError) as error:
        raise WeightsError(
            f"{path.name} cannot be read as plain tensors, so it was not opened: use the released {network} "
            "checkpoint."
        ) from error
    state = checkpoint.get("state_dict", checkpoint) if isinstance(checkpoint, dict) else {}
    found = {
        name.removeprefix(prefix): tensor
        for name, tensor in state.items()
        if isinstance(tensor, Tensor) and name.startswith(prefix) and not name.endswith(".pe")
    }
    if not found:
        raise WeightsError(f"{path.name} holds no {prefix}* tensors: use the released {network} checkpoint.")
    return found
