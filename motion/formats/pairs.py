"""Two people in two files: a .zip that holds one file of each, or a file beside the other.

InterHuman keeps ``person1/12.npy`` and ``person2/12.npy``, Inter-X ``P1.npz`` and ``P2.npz``, BVH exporters
``NAME_a.bvh`` and ``NAME_b.bvh``. The order of the names says who comes first.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from motion.errors import InputError

from .arrays import ZIP_ERRORS
from .files import MAX_BYTES, read_bytes

Source = tuple[str | Path | bytes, str | None]
"""A file or its bytes, and what to call it."""

MAX_PARTS = 200
_TEXTS = (".txt",)
"""Beside motions these are captions, although Kinect's text ends so too."""


def in_zip(source: str | Path | bytes, suffixes: Sequence[str], *, name: str | None = None) -> list[Source]:
    """The one or two motion files of an archive.

    Args:
        source: a path, or the archive's bytes.
        suffixes: of files that hold motion.
        name: its name in messages.

    Raises:
        InputError: for a damaged or large archive, or one without motion or with more than two files of it.
    """
    data, label = read_bytes(source, name)
    if data.count(b"PK\x01\x02") > MAX_PARTS:
        raise InputError(f"{label} holds more than {MAX_PARTS} parts: pack the two people's files alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = {info.filename: info for info in archive.infolist() if not info.is_dir()}
            chosen = _chosen(list(parts), [suffix for suffix in suffixes if suffix != ".zip"], label)
            if sum(parts[part].file_size for part in chosen) > MAX_BYTES:
                raise InputError(f"{label} would unpack to more than {MAX_BYTES // 2**20} MB: cut the motion.")
            found: list[Source] = []
            for part in chosen:
                with archive.open(parts[part]) as stream:  # gives no more than the size that was checked
                    found.append((stream.read(MAX_BYTES + 1), _shown(part)))
            return found
    except InputError:
        raise
    except ZIP_ERRORS as error:
        raise InputError(f"{label} is not a whole .zip file, or it is damaged: pack it again.") from error


def partner_file(path: Path) -> Path | None:
    """The second person's file beside the first's, by the names that data sets use; None if there is none."""
    if path.stem.endswith("_a"):
        other = path.with_stem(path.stem[:-2] + "_b")
    elif path.name.lower().endswith("_a.smpl.npz"):
        other = path.with_name(path.name[: -len("_a.smpl.npz")] + "_b.smpl.npz")
    elif path.parent.name == "person1":
        other = path.parent.with_name("person2") / path.name
    elif path.stem == "P1":
        other = path.with_stem("P2")
    else:
        return None
    return other if other.is_file() else None


def _chosen(names: Sequence[str], suffixes: Sequence[str], label: str) -> list[str]:
    """The names of the motion files, in order."""
    motions = sorted(
        name
        for name in names
        if PurePosixPath(name).suffix.lower() in suffixes
        and not any(part.startswith((".", "__")) for part in PurePosixPath(name).parts)
    )
    if len(motions) > 2 or any(not name.lower().endswith(_TEXTS) for name in motions):
        motions = [name for name in motions if not name.lower().endswith(_TEXTS)]
    if not 1 <= len(motions) <= 2:
        raise InputError(
            f"{label} holds {len(motions) or 'no'} motion files: put the two people of one take into it, such as "
            "P1.npz and P2.npz."
        )
    return motions


def _shown(part: str) -> str:
    """A part's name in messages: printable, its last two steps."""
    steps = PurePosixPath(part).parts[-2:]
    return "".join(letter if letter.isprintable() else "?" for letter in "/".join(steps))[-80:]
