"""A .zip file as if sent by an enemy: all its sizes are checked before anything is unpacked."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from types import TracebackType
from typing import Any

from motion import InputError
from motion.formats.arrays import ZIP_ERRORS

LARGEST = 1000 * 2**20
"""Bytes of all files together when unpacked."""
SLACK, MOST_TIMES = 32 * 2**20, 20
"""A file may unpack to so many bytes, and so many times its own size besides. Motions are packed already, and of what
else is in a workspace little is packed better."""
LARGEST_READ = 2**20
"""Bytes of the list of files, which :mod:`zipfile` reads at once, and of a piece of a file."""
LARGEST_JSON = 50 * 2**20
MOST_OBJECTS, MOST_VALUES = 500_000, 5_000_000
"""Lists and objects, and values, in a JSON text; each weighs far more once it is read."""
WRONG = "This is no workspace of Pas de Deux, or it was changed by hand ({}): export it again."
DAMAGE = (*ZIP_ERRORS, ArithmeticError, AttributeError, RecursionError, TypeError)
"""Errors that contents may cause which are not as they should be."""


class _InPieces(io.FileIO):
    """A file of which little is read at once, so that no list of millions of files is."""

    def read(self, size: int | None = -1, /) -> bytes:
        """See :meth:`io.RawIOBase.read`; raises BadZipFile for too much."""
        size = LARGEST_READ if size is None or size < 0 else size
        if size > LARGEST_READ:
            raise zipfile.BadZipFile("too many files")
        return super().read(size)


class Archive:
    """The files in a .zip file; use it in a ``with`` block.

    Args:
        file: the .zip file.
        most_files: how many it may hold.

    Attributes:
        names: of its files.
        size: bytes of all of them when unpacked.

    Raises:
        InputError: if it is none, holds too many files, or they are too large.
    """

    def __init__(self, file: Path, most_files: int) -> None:
        try:
            self._file = _InPieces(file)
            packed = file.stat().st_size
        except OSError:
            raise InputError("The workspace cannot be read: choose the file again.") from None
        try:
            self._zip = zipfile.ZipFile(self._file)
            infos = self._zip.infolist()
            self.names = {info.filename for info in infos}
            self.size = sum(info.file_size for info in infos)
            self._check(infos, packed, most_files)
        except BaseException as error:
            self._file.close()
            if isinstance(error, ZIP_ERRORS) and not isinstance(error, InputError):
                raise InputError(WRONG.format("it cannot be read")) from None
            raise

    def _check(self, infos: list[zipfile.ZipInfo], packed: int, most_files: int) -> None:
        if len(infos) > most_files or self.size > LARGEST:
            raise InputError(
                f"The workspace is too large: it may hold {most_files:,} files and {LARGEST / 2**20:,.0f} MB."
            )
        if self.size > SLACK + MOST_TIMES * packed:
            raise InputError(
                WRONG.format(f"{packed / 2**20:.1f} MB would unpack to {self.size / 2**20:,.0f} MB")
            )
        if any(info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) for info in infos):
            raise InputError(WRONG.format("it is packed in another way"))

    def __enter__(self) -> Archive:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._zip.close()
        self._file.close()

    def content(self, name: str, most: int) -> bytes:
        """The bytes of a file; raises InputError if it is missing, damaged, or larger than ``most`` bytes."""
        pieces, size = [], 0
        try:
            with self._zip.open(name) as source:
                while piece := source.read(LARGEST_READ // 2):
                    pieces.append(piece)
                    size += len(piece)
                    if size > most:
                        raise InputError(f"{name} in the workspace is too large: export it again.")
        except InputError:
            raise
        except KeyError:
            raise InputError(WRONG.format(f"{name} is missing")) from None
        except ZIP_ERRORS:
            raise InputError(WRONG.format(f"{name} is damaged")) from None
        return b"".join(pieces)

    def values(self, name: str) -> Any:
        """The values of a file of JSON; raises InputError for what is none, or has too many values."""
        content = self.content(name, LARGEST_JSON)
        if content.count(b"[") + content.count(b"{") > MOST_OBJECTS or content.count(b",") > MOST_VALUES:
            raise InputError(f"{name} in the workspace has too many values: export fewer runs at once.")
        try:
            found = json.loads(content)
            json.dumps(found, ensure_ascii=False).encode()  # half a character could not be shown
        except (ValueError, RecursionError):
            raise InputError(WRONG.format(f"{name} is damaged")) from None
        return found
