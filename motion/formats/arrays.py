"""NumPy arrays out of hostile files: sizes are checked before anything is unpacked, and nothing is unpickled."""

from __future__ import annotations

import io
import lzma
import struct
import zipfile
import zlib
from collections.abc import Collection
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .files import MAX_JSON, MAX_NUMBERS

Array = NDArray[Any]

MAX_UNPACKED = 128 * 2**20
_MOST_TEXTS = 1000
_MOST_MEMBERS = 200
_MAX_HEADER = 4096
_NO_RATE = "{} does not give its frame rate: {:g} frames a second are assumed. Give the true rate if it differs."
_PICKLED = (
    "{} holds pickled Python objects, which could run code and are never opened: where you trust the file, save its "
    'numbers alone, for MDM\'s results with `d = numpy.load("results.npy", allow_pickle=True).item()` and '
    '`numpy.save("motion.npy", d["motion"][0].transpose(2, 0, 1))`.'
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
        found = array.astype(np.float32, copy=False)
    low, high = (float(found.min()), float(found.max())) if found.size else (0.0, 0.0)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError(f"{label} holds NaN or infinite numbers: remove or repair those frames.")
    if max(-low, high) > 1e4:
        raise InputError(f"{label} holds places more than 10 km away: save metres.")
    return found


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
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a frame rate of {rate:g} is not possible: save frames a second.")
    return rate


def no_rate(label: str, assumed: float) -> str:
    """The note on a file without a frame rate."""
    return _NO_RATE.format(label, assumed)


def says_no_rate(note: str) -> bool:
    """True for a note of :func:`no_rate`."""
    return note.endswith(_NO_RATE.rpartition("} ")[2]) and " does not give its frame rate: " in note
