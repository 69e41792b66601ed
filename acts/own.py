"""The files of a lab's own acts: where the settings say they are, looked at again every two seconds.

This is the one place that decides which folders count; :func:`acts.lexicon.lexicon` merges their entries into ours. A
file that is saved while a server runs is read with the next sentence.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from pathlib import Path

from motion import InputError

from .config import acts_folders

LOOK_EVERY = 2.0
"""Seconds after which the folders are looked at again."""


@dataclass(frozen=True)
class OwnFiles:
    """The files of the folders, and what is wrong with the folders.

    Attributes:
        files: (path, time of change in nanoseconds, bytes), in the order in which later ones replace earlier ones.
        problems: a sentence for each folder that cannot be used.
    """

    files: tuple[tuple[Path, int, int], ...] = ()
    problems: tuple[str, ...] = ()


_lock = threading.Lock()
_found = OwnFiles()
_looked_at = float("-inf")


def own_files() -> OwnFiles:
    """The files as they are now, at most :data:`LOOK_EVERY` seconds ago."""
    global _found, _looked_at
    with _lock:
        if time.monotonic() - _looked_at >= LOOK_EVERY:
            _found, _looked_at = _look(), time.monotonic()
        return _found


def look_again() -> OwnFiles:
    """The files as they are now, without waiting."""
    global _looked_at
    with _lock:
        _looked_at = float("-inf")
    return own_files()


def _look() -> OwnFiles:
    try:
        folders = acts_folders()
    except InputError as error:
        return OwnFiles(problems=(str(error),))
    found: list[tuple[Path, int, int]] = []
    problems = []
    for folder in dict.fromkeys(folders):
        try:
            for path in sorted(folder.glob("*.toml")):
                state = path.stat()
                found.append((path, state.st_mtime_ns, state.st_size))
            if not folder.is_dir():
                problems.append(f"There is no folder of acts {folder.name}: correct the setting acts.")
        except OSError as error:
            problems.append(f"The folder of acts {folder.name} cannot be read: {error.strerror}.")
    return OwnFiles(tuple(found), tuple(problems))
