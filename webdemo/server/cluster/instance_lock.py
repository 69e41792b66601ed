"""A unique name for each page process on a data folder, and a check which processes have ended.

A process holds a lock on a file with its name. The operating system releases the lock however the process ends.
The package ``filelock`` falls back to the mere existence of a file where locks are missing, and a killed process
would leave that file behind.
"""

from __future__ import annotations

import fcntl
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from motion import InputError

MOST = 64
"""Most processes with one base name."""


class InstanceLock:
    """Holds a name that no other process on this data folder has.

    Args:
        folder: the data folder.
        wanted: the preferred name; "-2" and so on is added if another process has it.

    Raises:
        InputError: if the folder cannot be written.
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
                f"The folder {folder} cannot be written ({error.strerror}): choose another with PASDEDEUX_DATA."
            ) from None
        raise InputError(f"{MOST} processes called {wanted} use {folder} already: stop some of them.")

    def dead(self, names: Iterable[str]) -> list[str]:
        """Those names whose process has ended; includes this process's own name, which only an earlier process can
        have used."""
        found = []
        for name in names:
            if name == self.name:
                found.append(name)
            elif self._path(name).exists() and (lock := self._locked(name)) is not None:
                lock.close()
                found.append(name)
        return found

    def close(self) -> None:
        """Releases the name."""
        if self._lock is not None:
            self._lock.close()

    def _path(self, name: str) -> Path:
        return self._folder / f"{name.encode().hex()[:200]}.lock"

    def _locked(self, name: str) -> IO[bytes] | None:
        """The name's file, locked, or None if another process has it."""
        file = open(self._path(name), "ab")  # noqa: SIM115  # held as long as the lock is
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
        return file
