"""Folders of a lab: this user's alone, held by one process, and whole or not there."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from motion import InputError


def make_folder(folder: Path) -> Path:
    """Makes a folder that only this user may read, where there is none; raises InputError if that cannot be."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"The folder {folder} cannot be made ({error.strerror}): choose another with PASDEDEUX_DATA."
        ) from None
    return folder


def hold(file: Path, sentence: str) -> IO[bytes]:
    """Locks a file until it is closed or this process ends; raises InputError where another process has it."""
    opened = open(file, "ab")  # noqa: SIM115  # held as long as the lock is
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        opened.close()
        raise InputError(sentence) from None
    return opened


@contextmanager
def whole(folder: Path) -> Iterator[Path]:
    """A folder that takes its name when all is written in it, and is removed where that fails."""
    half = folder.with_name(f".{folder.name}")
    shutil.rmtree(half, ignore_errors=True)
    try:
        half.mkdir(mode=0o700)
        yield half
        os.replace(half, folder)
    finally:
        shutil.rmtree(half, ignore_errors=True)
