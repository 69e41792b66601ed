"""A network in one file: ``model.safetensors`` in float16 and ``config.json`` with its SHA-256."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from torch import nn

from models.compact import WeightsFolder
from models.errors import WeightsError

Network = TypeVar("Network", bound=nn.Module)


def load_network(
    folder: Path, network: Callable[[Any], Network], config: Callable[..., Any]
) -> tuple[Network, WeightsFolder]:
    """The network of a weights folder in float32, eval mode, and the folder.

    Args:
        network: makes the untrained network of a config.
        config: the dataclass of its sizes.

    Raises:
        WeightsError: where a file is missing, altered or of other sizes.
    """
    source = WeightsFolder(folder)
    try:
        model = network(config(**source.meta["model"]))
        weights = source.tensors("model.safetensors")
        model.load_state_dict({name: tensor.float() for name, tensor in weights.items()})
    except (RuntimeError, TypeError, KeyError) as error:
        raise WeightsError(f"The weights in {folder.name} do not fit their config: restore them.") from error
    return model.eval().requires_grad_(False), source


def save_network(folder: Path, model: nn.Module, **meta: Any) -> None:
    """Writes ``model.safetensors``, then ``config.json`` with the sizes (``model.config``) and ``meta``."""
    from safetensors.torch import save

    folder.mkdir(parents=True, exist_ok=True)
    data = save({name: v.detach().cpu().half().contiguous() for name, v in model.state_dict().items()})
    (folder / "model.safetensors").write_bytes(data)
    files = {"model.safetensors": hashlib.sha256(data).hexdigest()}
    config = {"model": asdict(model.config), "files": files} | meta
    (folder / "config.json").write_text(json.dumps(config, indent=1) + "\n")
