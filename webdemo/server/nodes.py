"""A name for every page process that shares a data folder, and which of them no longer live.

A process holds a lock on a file of its name; the system frees it however the process ends.
"""

from __future__ import annotations

import fcntl
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from webdemo.motion import InputError

MOST = 64
"""Processes of one name."""


class Node:
    """A name that no other process on this data folder has.

    Args:
        folder: the data folder.
        wanted: the name; where another process has it, "-2" and so on is added.

    Raises:
        InputError: where the folder cannot be written.
    """

    def __init__(self, folder: Path, wanted: str) -> None:
        self._folder = folder / "nodes"
        try:
            self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            for i in range(MOST):
                self.name = wanted if i == 0 else f"{wanted}-{i + 1}"
                self._lock = self._locked(self.name)
                if self._lock is not None:
                    return
        except OSError as error:
            raise InputError(
                f"The folder {folder} cannot be written ({error.strerror}): "
                "choose another with PASDEDEUX_DATA."
            ) from None
        raise InputError(f"{MOST} processes called {wanted} use {folder} already: stop some of them.")

    def dead(self, names: Iterable[str]) -> list[str]:
        """Those of the names that a process on this folder had, and none has now; this one's among them."""
        found = []
        for name in names:
            if name == self.name:
                found.append(name)
            elif self._path(name).exists() and (lock := self._locked(name)) is not None:
                lock.close()
                found.append(name)
        return found

    def close(self) -> None:
        """Lets another process have the name."""
        if self._lock is not None:
            self._lock.close()

    def _path(self, name: str) -> Path:
        return self._folder / f"{name.encode().hex()[:200]}.lock"

    def _locked(self, name: str) -> IO[bytes] | None:
        """The name's file, locked, or None where another process has it."""
        file = open(self._path(name), "ab")  # noqa: SIM115  # held as long as the lock is
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
        return file
