"""The files that runs were made from, byte for byte, beside their motions.

They are never read here: opened again, they go through the readers of uploads like any other file. On disk all are
called alike, and the name that their owner gave them is kept cleaned in the database.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from webdemo.ui.history import Original, clean_name

ORIGINAL = "original"
"""Name of the file in the folder of its run."""
LARGEST_ORIGINAL = 20 * 2**20
"""Bytes of a file that is kept with a run."""
LARGEST_SHARE = 0.5
"""Share of a person's room for runs and studies up to which it may grow by such files."""


def keep_original(original: Original, folder: Path, room: float) -> str:
    """Copies an uploaded file into the folder of its run.

    Args:
        original: the file.
        folder: of the run.
        room: bytes that it may have.

    Returns:
        the name to keep; "" where the file is gone or too large.
    """
    name = clean_name(original.name)
    half = folder / f".{ORIGINAL}"
    try:
        if not name or original.path.is_symlink() or original.path.stat().st_size > min(room, LARGEST_ORIGINAL):
            return ""
        shutil.copyfile(original.path, half)
        os.replace(half, folder / ORIGINAL)
    except OSError:
        half.unlink(missing_ok=True)
        return ""
    return name


def kept_original(name: object, folder: Path) -> Original | None:
    """The file of a run, where one was kept."""
    plain = clean_name(name) if isinstance(name, str) else ""
    path = folder / ORIGINAL
    return Original(path, plain) if plain and path.is_file() else None


def bytes_of(folder: Path) -> int:
    """Size of all files of a run."""
    return sum(path.stat().st_size for path in folder.iterdir())
