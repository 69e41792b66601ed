"""Checkpoints of a training run as one ``.safetensors`` file, written atomically."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from motion import InputError
from motion.formats.files import replacing

Parts = dict[str, nn.Module | torch.optim.Optimizer]


def _tensors(parts: Parts) -> dict[str, Tensor]:
    tensors: dict[str, Tensor] = {}
    for name, part in parts.items():
        if isinstance(part, nn.Module):
            tensors |= {f"{name}/{key}": value for key, value in part.state_dict().items()}
        else:
            for row, state in part.state_dict()["state"].items():
                tensors |= {f"{name}/{row}/{key}": torch.as_tensor(value) for key, value in state.items()}
    return {key: value.detach().contiguous().cpu().clone() for key, value in tensors.items()}


def write_tensors(path: Path, tensors: dict[str, Tensor], **known: Any) -> None:
    """Writes tensors and what is known of them, as JSON; an interrupted write leaves no file of that name."""
    metadata = {name: value if isinstance(value, str) else json.dumps(value) for name, value in known.items()}
    with replacing(path) as temporary:
        save_file(tensors, temporary, metadata=metadata)


def read_tensors(path: Path, otherwise: str) -> tuple[dict[str, Tensor], dict[str, str]]:
    """Tensors and metadata of a file; raises InputError, which says what to do ``otherwise``, if it is damaged."""
    try:
        with safe_open(path, framework="pt") as file:
            return {key: file.get_tensor(key) for key in file.keys()}, file.metadata() or {}  # noqa: SIM118
    except (OSError, SafetensorError) as error:
        raise InputError(f"{path} is missing or damaged ({error}): {otherwise}") from error


def save(path: Path, parts: Parts, step: int, settings: str) -> None:
    """Writes modules and optimisers with the step number and the run's settings (JSON text)."""
    write_tensors(path, _tensors(parts), step=step, settings=settings)


def _read(path: Path) -> tuple[dict[str, Tensor], dict[str, str]]:
    return read_tensors(path, "delete it to begin anew.")


def _part(tensors: dict[str, Tensor], name: str) -> dict[str, Tensor]:
    """The tensors of one part by their own names."""
    return {key.removeprefix(f"{name}/"): v for key, v in tensors.items() if key.startswith(f"{name}/")}


def metadata(path: Path) -> dict[str, str]:
    """``step`` and ``settings`` (JSON text) of a checkpoint."""
    return _read(path)[1]


def restore_part(path: Path, name: str, module: nn.Module) -> None:
    """Loads one module from a checkpoint of any run; only one of the two may have a reader of touches.

    Raises InputError for a damaged file and for a module of other sizes.
    """
    try:
        tensors, _ = read_tensors(path, "give a folder of weights or a run's last.safetensors.")
        read = module.load_state_dict(_part(tensors, name), strict=False)
        if wrong := [key for key in (*read.missing_keys, *read.unexpected_keys) if not key.startswith("touch_reader.")]:
            raise RuntimeError(wrong)
    except RuntimeError as error:
        raise InputError(f"{path} holds a network of other sizes: give the settings it was trained with.") from error


def restore(path: Path, parts: Parts, settings: str) -> int:
    """Loads what :func:`save` wrote into ``parts`` and returns its step; 0 if there is no checkpoint.

    Raises InputError for a damaged file and for a checkpoint of other settings.
    """
    if not path.exists():
        return 0
    tensors, metadata = _read(path)
    if metadata.get("settings") != settings:
        raise InputError(f"{path} belongs to a run of other settings: give another --out, or the same settings.")
    for name, part in parts.items():
        own = _part(tensors, name)
        if isinstance(part, nn.Module):
            part.load_state_dict(own)
            continue
        states: dict[int, dict[str, Tensor]] = {}
        for key, value in own.items():
            row, field = key.split("/")
            states.setdefault(int(row), {})[field] = value
        part.load_state_dict(part.state_dict() | {"state": states})
    return int(metadata["step"])
