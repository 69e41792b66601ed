"""Temporary files: people's uploads, and files for download."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Collection
from pathlib import Path

from motion import InputError

KEPT_SECONDS = 7200.0
"""Seconds after which a file is removed; the history keeps what is needed to make it again."""
IN_USE_SECONDS = 60.0
"""Files younger than this are kept in any case, since they may be in use."""


class Scratch:
    """A folder of one process, emptied at its start of what a killed process left.

    Args:
        folder: is emptied and made.
        most_bytes: size of all its files above which the oldest go.

    Raises:
        InputError: if the folder cannot be made.
    """

    def __init__(self, folder: Path, most_bytes: float) -> None:
        self.folder, self.most_bytes = folder, most_bytes
        shutil.rmtree(folder, ignore_errors=True)
        try:
            self.uploads.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"The folder {folder} cannot be made ({error.strerror}): choose another with PASDEDEUX_DATA."
            ) from None

    @property
    def uploads(self) -> Path:
        """Folders of Gradio's uploads and of files for download."""
        return self.folder / "uploads"

    def take_uploads(self) -> None:
        """Makes Gradio keep its files here; call it before a page is built."""
        os.environ["GRADIO_TEMP_DIR"] = str(self.uploads)

    def clean(self, keep: Collection[str] = ()) -> int:
        """Removes files that are too old, then the oldest while the total is too large; returns their number.

        Args:
            keep: paths that stay.
        """
        now, gone, total = time.time(), 0, 0
        found: list[tuple[float, int, str]] = []
        for parent, _, names in os.walk(self.folder):
            for name in names:
                path = os.path.join(parent, name)
                try:
                    status = os.stat(path)
                except OSError:  # gone meanwhile
                    continue
                found.append((status.st_mtime, status.st_size, path))
                total += status.st_size
        for made, size, path in sorted(found):
            old = now - made > KEPT_SECONDS
            if path in keep or now - made < IN_USE_SECONDS or not (old or total > self.most_bytes):
                continue
            try:
                os.remove(path)
            except OSError:
                continue
            gone, total = gone + 1, total - size
        self._drop_empty_folders(now)
        return gone

    def _drop_empty_folders(self, now: float) -> None:
        for parent, _, _ in os.walk(self.folder, topdown=False):
            if Path(parent) in (self.folder, self.uploads):
                continue
            try:
                if now - os.stat(parent).st_mtime > IN_USE_SECONDS:
                    os.rmdir(parent)
            except OSError:  # it is not empty
                continue
