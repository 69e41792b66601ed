"""Reading within limits, NumPy's arrays too, and writing so that a half-written file is never taken for a whole one.

Sizes are checked before anything is unpacked, and nothing is unpickled.
"""

from __future__ import annotations

import codecs
import contextlib
import errno
import io
import json
import lzma
import math
import os
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.skeleton import SMPL22

Array = NDArray[Any]

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
        raise InputError(f"{label} is not {kind}: it holds binary data, or text that is not UTF-8.")
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
            f"{kind} needs a rest pose and SMPL's 22 joints, not {motion.skeleton.name}'s: see motion.retarget.to_smpl."
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
        os.umask(mask := os.umask(0))
        os.chmod(temporary, 0o666 & ~mask)
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


def safe_cell(value: Any) -> Any:
    """The value; text that a spreadsheet would compute begins with an apostrophe."""
    formula = isinstance(value, str) and value.lstrip()[:1] in ("=", "+", "-", "@")
    return f"'{value}" if formula else value


# ---- NumPy arrays out of hostile files -------------------------------------------------------------------------------
MAX_UNPACKED = 128 * 2**20
_MOST_TEXTS = 1000
_MOST_MEMBERS = 200
_MAX_HEADER = 4096
_PICKLED = (
    "{} holds pickled Python objects, which could run code and are never opened: save its numbers alone, of MDM's "
    'results with `numpy.save("motion.npy", results["motion"][0].transpose(2, 0, 1))`.'
)
ZIP_ERRORS = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    lzma.LZMAError,
    EOFError,
    NotImplementedError,
    RuntimeError,
    OSError,
    ValueError,
    OverflowError,
    IndexError,
    KeyError,
)
"""Errors that :mod:`zipfile` raises over damaged files, from wrong sums to sizes below zero."""


def load_members(data: bytes, label: str, keys: Collection[str]) -> dict[str, Array]:
    """The arrays of a .npz that are called one of ``keys``.

    Raises:
        InputError: if the file is damaged, or would unpack to more than :data:`MAX_UNPACKED` bytes or
            :data:`~motion.formats.files.MAX_NUMBERS` numbers.
    """
    arrays: dict[str, Array] = {}
    if data.count(b"PK\x01\x02") > _MOST_MEMBERS:
        raise InputError(f"{label} holds more than {_MOST_MEMBERS} parts: save its arrays alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {m.filename.removesuffix(".npy"): m for m in archive.infolist()}
            wanted = [members[key] for key in keys if key in members]
            if any(m.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) for m in wanted):
                raise InputError(f"{label} is not packed the way NumPy does it: save it with numpy.savez.")
            total = sum(member.file_size for member in wanted)
            if total > MAX_UNPACKED:
                raise InputError(f"{label} would unpack to {total / 2**20:.0f} MB, more than is allowed: cut it.")
            for member in wanted:
                key = member.filename.removesuffix(".npy")
                with archive.open(member) as stream:  # gives no more than the declared size
                    left = MAX_NUMBERS - sum(array.size for array in arrays.values())
                    arrays[key] = load_array(stream, member.file_size, f"{label}, {key}", most=left)
    except InputError:
        raise
    except ZIP_ERRORS as error:
        raise InputError(f"{label} is not a whole .npz file, or it is damaged: save it again.") from error
    return arrays


def load_array(stream: IO[bytes], size: int, label: str, *, most: int = MAX_NUMBERS) -> Array:
    """One .npy of so many numbers at most, whose header is checked against the bytes that are there before anything is
    made. What is a byte each in the file may take eight as it is read."""
    try:
        version = np.lib.format.read_magic(stream)
        reader = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
        shape, _, dtype = reader[version](stream, max_header_size=_MAX_HEADER)
    except Exception:  # the header is parsed as Python literals, which can fail in any way
        raise InputError(f"{label} is not a NumPy array file: save it with numpy.save or numpy.savez.") from None
    if dtype.hasobject:
        raise InputError(_PICKLED.format(label))
    count = 1
    for length in shape:
        count *= int(length)
    if count * dtype.itemsize != size - stream.tell():
        raise InputError(f"{label} is damaged: its header says {shape}, its data has another size.")
    if count > most:
        raise InputError(f"{label} holds {count:,} numbers, more than the {most:,} that are left: cut the motion.")
    if dtype.kind in "USV" and (count > _MOST_TEXTS or count * dtype.itemsize > 4 * MAX_JSON):
        raise InputError(f"{label} holds too much text: save the motion's own arrays alone.")
    stream.seek(0)
    return np.lib.format.read_array(stream, allow_pickle=False, max_header_size=_MAX_HEADER)


def numbers(array: Array, label: str) -> Array:
    """The array as float32; raises InputError for anything but finite numbers of at most 10,000."""
    if array.dtype.kind not in "fiu":
        raise InputError(f"{label} holds {array.dtype} where numbers are needed: save float32 metres.")
    with np.errstate(all="ignore"):
        values = array.astype(np.float32, copy=False)
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError(f"{label} holds NaN or infinite numbers: remove or repair those frames.")
    if max(-low, high) > 1e4:
        raise InputError(f"{label} holds positions more than 10 km away: save them in metres.")
    return values


def frame_rate(stored: Array | None, given: float | None, label: str, *, usual: float = 30.0) -> float:
    """Frames a second that are given, or else those that a file stores, or else the ``usual`` ones.

    Raises:
        InputError: if what is stored is no rate.
    """
    if given or stored is None:
        return given or usual
    try:
        rate = float(np.asarray(stored).reshape(()))
    except (TypeError, ValueError):
        raise InputError(f"{label}: its frame rate is not one number: save fps as a number.") from None
    return check_rate(rate, label)


def check_rate(rate: float, label: str) -> float:
    """The rate; raises InputError where it is none of 1 to 1,000 frames a second."""
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a frame rate of {rate:g} is not possible: save it with its frames a second.")
    return rate


def no_rate(label: str, assumed: float) -> str:
    """The note on a file without a frame rate."""
    return (
        f"{label} does not give its frame rate: {assumed:g} frames a second are assumed. Give the true rate if it "
        "differs."
    )
