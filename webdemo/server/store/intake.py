"""The folder of an import while it goes on, from which a later process knows what a killed one left."""

from __future__ import annotations

import secrets
import shutil
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

IMPORT = ".import-"
"""Beginning of the folder's name; then follow the process and a random word."""
_LIST = "runs"


@contextmanager
def intake(home: Path, node: str) -> Iterator[Path]:
    """Makes a new folder in which a process unpacks a workspace; it is removed with all that is still in it."""
    folder = home / f"{IMPORT}{node.encode().hex()[:160]}-{secrets.token_hex(8)}"
    folder.mkdir(mode=0o700)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def node_of(folder: Path) -> str:
    """The process that made a folder of :func:`intake`."""
    with suppress(ValueError):
        return bytes.fromhex(folder.name.removeprefix(IMPORT).partition("-")[0]).decode("utf-8", "replace")
    return ""


def announce(folder: Path, runs: Collection[str]) -> None:
    """Lists the runs whose files leave the folder before their rows are there."""
    (folder / _LIST).write_text("\n".join(runs), encoding="utf-8")


def listed(folder: Path) -> set[str]:
    """The runs that :func:`announce` listed."""
    try:
        return set((folder / _LIST).read_text(encoding="utf-8").split())
    except OSError:  # none yet, or the import has ended meanwhile
        return set()
