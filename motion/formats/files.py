"""Reading within limits, and writing so that a half-written file is never taken for a whole one."""

from __future__ import annotations

import codecs
import contextlib
import errno
import json
import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.skeleton import SMPL22

MAX_BYTES = 50 * 2**20
MAX_SECONDS = 600.0
MAX_FRAMES = 72_000
"""Ten minutes at 120 frames a second."""
MAX_NUMBERS = 20_000_000
"""Numbers of a motion, 80 MB: more than 60 joints in so many frames."""

MAX_JSON = 4 * 2**20
MAX_PARTS = 100_000
"""Lists and objects of a description in JSON: a .glb with forty animations of sixty joints has 80,000."""


def read_bytes(
    source: str | Path | bytes, name: str | None = None, *, remedy: str = "cut the motion or lower its frame rate"
) -> tuple[bytes, str]:
    """A file's bytes and what to call it in messages.

    Args:
        source: a path, or the bytes themselves.
        name: what to call it in messages; its own name by default.
        remedy: what makes a file smaller.

    Raises:
        InputError: if it cannot be read or is larger than 50 MB.
    """
    if isinstance(source, bytes):
        data, label = source, name or "The file"
        size = len(data)
    else:
        path = Path(source)
        label = name or path.name
        try:
            size = path.stat().st_size
            data = path.read_bytes() if size <= MAX_BYTES else b""
        except OSError as error:
            raise InputError(f"{label} cannot be read ({error.strerror}): check the path.") from None
    if size > MAX_BYTES:
        raise InputError(f"{label} has {size / 2**20:.0f} MB, more than the {MAX_BYTES // 2**20} MB allowed: {remedy}.")
    if not data:
        raise InputError(f"{label} is empty: export it again.")
    return data, label


def text_bytes(data: bytes, label: str, kind: str) -> bytes:
    """Text without a mark of its encoding, whose lines end in LF or CR LF; what is ASCII in it is ASCII.

    Raises:
        InputError: for binary data, UTF-16 too, which is no file of this ``kind`` ("a BVH file").
    """
    if b"\0" in data:
        raise InputError(f"{label} is not {kind}: it holds binary data. Save it as UTF-8 if it is text.")
    return (data if b"\n" in data else data.replace(b"\r", b"\n")).removeprefix(codecs.BOM_UTF8)


def read_json(text: str | bytes) -> Any:
    """The contents of JSON that came with a file.

    While it is read nothing else is done in the process, and a list takes twenty times as long as a number.

    Raises:
        ValueError: what is wrong with it, as what follows its name in a sentence.
    """
    if len(text) > MAX_JSON:
        raise ValueError(f"has more than {MAX_JSON // 2**20} MB")
    try:
        text = text.decode("utf-8") if isinstance(text, bytes) else text
        if text.count("[") + text.count("{") > MAX_PARTS:
            raise ValueError
        return json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError(f"is not JSON text of at most {MAX_PARTS:,} parts") from None


def check_duration(frames: int, fps: float, label: str) -> None:
    """Raises InputError for motions longer than ten minutes, or of more frames than :data:`MAX_FRAMES`."""
    if fps > 0 and frames / fps > MAX_SECONDS:
        raise InputError(
            f"{label} lasts {math.ceil(frames / fps)} s, more than the {MAX_SECONDS:.0f} s allowed: cut it "
            "or give its true rate."
        )
    if frames > MAX_FRAMES:
        raise InputError(f"{label} has {frames:,} frames, more than the {MAX_FRAMES:,} allowed: lower its frame rate.")


def check_smpl(motion: Clip | Duet, kind: str) -> None:
    """Raises InputError for people who are not on SMPL22, whose T-pose is known; ``kind`` is what needs it."""
    if motion.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"{kind} needs a rest pose and SMPL's 22 joints, not {motion.skeleton.name}'s: retarget the motion."
        )


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields an empty temporary file beside ``path`` that takes its place if the block ends well.

    Raises:
        InputError: if the disk is full or the folder cannot be written; ``path`` is then as before.
    """
    temporary: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent)
        temporary = Path(name)
        os.close(descriptor)
        yield temporary
        # mkstemp makes private files; a finished one is as readable as any other.
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise InputError(
                f"{path} could not be written because the disk is full: free some space and try again."
            ) from None
        raise InputError(
            f"{path} could not be written ({error.strerror or error}): choose another folder or name."
        ) from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Writes a whole file in UTF-8, or none; raises InputError as :func:`replacing` does."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_files(contents: Mapping[Path, bytes]) -> list[Path]:
    """Writes all files or none: each to a temporary one beside it first, then all take their places.

    Raises:
        InputError: if the disk is full or a folder cannot be written; earlier files are as before.
    """
    with contextlib.ExitStack() as waiting:
        for path, data in contents.items():
            waiting.enter_context(replacing(path)).write_bytes(data)
    return list(contents)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def safe_cell(value: Any) -> Any:
    """The value; text that a spreadsheet would compute begins with an apostrophe."""
    formula = isinstance(value, str) and value.lstrip()[:1] in ("=", "+", "-", "@")
    return f"'{value}" if formula else value
