"""One person's motion as a file, in the formats that need no second person."""

from __future__ import annotations

from pathlib import Path

from motion import Clip, InputError

from .bvh_writer import bvh_text
from .files import write_files
from .npz import write_npy, write_npz
from .smpl import SUFFIX, smpl_bytes

SUFFIXES = (".npz", ".bvh", ".npy", SUFFIX)


def write_clip(clip: Clip, path: str | Path) -> list[Path]:
    """Writes one person in the format of the path's suffix, as :func:`motion.formats.read` reads them.

    A .npz holds positions (T, J, 3) float32, fps, joint_names and parents; a .npy the positions alone.

    Returns:
        the one path.

    Raises:
        InputError: for a suffix that holds two people only, or where the file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(
            f"{path.name}: one person is written as {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}: choose one."
        )
    if path.name.lower().endswith(SUFFIX):
        return write_files({path: smpl_bytes(clip)})
    if suffix == ".bvh":
        return write_files({path: bvh_text(clip).encode()})
    return write_npy(clip, path) if suffix == ".npy" else write_npz(clip, path)
