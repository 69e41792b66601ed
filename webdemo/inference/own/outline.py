"""The names and shapes of a checkpoint's tensors, read without their numbers and remembered between starts."""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import suppress
from pathlib import Path

from motion.formats.files import write_text

Outline = dict[str, tuple[int, ...]]
"""Tensor name → shape."""


def outline_of(path: Path, network: str) -> Outline:
    """The outline of a checkpoint; the first look at a file imports torch, later ones read a small cache.

    Raises:
        WeightsError: if the file cannot be read as plain tensors, see :func:`models.released.read_tensors`.
    """
    known = _remembered(path)
    if known is not None:
        return known
    from models.released import read_tensors

    outline = {name: tuple(tensor.shape) for name, tensor in read_tensors(path, network=network).items()}
    with suppress(OSError):  # a folder that cannot be written costs the next start a second
        file = _cache(path)
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, json.dumps(outline))
    return outline


def _remembered(path: Path) -> Outline | None:
    try:
        found = json.loads(_cache(path).read_text())
        return {str(name): tuple(int(size) for size in shape) for name, shape in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _cache(path: Path) -> Path:
    """The cache's file for this state of a checkpoint."""
    stat = path.stat()
    text = f"{path.resolve()} {stat.st_size} {stat.st_mtime_ns}"
    base = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    return base / "pas-de-deux" / "outlines" / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
