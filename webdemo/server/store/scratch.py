"""Temporary files: people's uploads, and files for download."""

from __future__ import annotations

import asyncio
import math
import os
import shutil
import time
from collections.abc import Collection, Iterator
from contextvars import ContextVar
from functools import partial
from pathlib import Path
from typing import Any

import gradio.routes
from gradio import processing_utils
from gradio.data_classes import GradioModel, GradioRootModel
from gradio.routes import App
from gradio.utils import LRUCache, get_upload_folder
from gradio_client.utils import is_file_obj_with_meta, traverse
from starlette.concurrency import run_in_threadpool

from motion import InputError
from webdemo.server.accounts.quotas import ADDRESS_SHARE
from webdemo.server.accounts.visitors import digest
from webdemo.ui.visitor import visitor

from .folders import make_folder

KEPT_SECONDS = 7200.0
"""Seconds after which a file is removed; the history keeps what is needed to make it again."""
IN_USE_SECONDS = 60.0
"""Files younger than this are kept in any case, since they may be in use."""
LEAST_BYTES = 2**17
"""What a file weighs at least: each takes blocks of the disk and time at every count, also where it is empty."""
UPLOADS = 256
"""Uploads whose progress is kept."""
_File = tuple[float, int, str]
"""When it was made, its weight in bytes and its path."""


class Scratch:
    """A folder, emptied at the start of what a killed process left.

    Args:
        folder: is emptied and made.
        most_bytes: size of all its files beyond which nobody's share grows any more.

    Raises:
        InputError: if the folder cannot be made.
    """

    def __init__(self, folder: Path, most_bytes: float) -> None:
        self.folder, self.most_bytes = folder, most_bytes
        self._addresses: dict[str, str] = {}
        self._weights: dict[str, float] = {}  # of each person's files, when they last stored one or all were counted
        shutil.rmtree(folder, ignore_errors=True)
        make_folder(self.uploads)

    @property
    def uploads(self) -> Path:
        """Folders of Gradio's uploads and of files for download."""
        return self.folder / "uploads"

    def take_uploads(self) -> None:
        """Makes Gradio keep its files here; call it before a page is built."""
        os.environ["GRADIO_TEMP_DIR"] = str(self.uploads)

    def used(self, person: str) -> int:
        """Bytes that the files in the folder of this name weigh."""
        return sum(size for _, size, _ in _files(self.uploads / person))

    def admit(self, person: str, address: str, size: float, allowed: float) -> None:
        """Makes room for a file of a person, for which their own oldest ones make way.

        Args:
            person: the name of their folder.
            address: that they come from, where they could throw their name away; "" elsewhere.
            size: bytes of the file, as far as they are known.
            allowed: bytes that the person may have.

        Raises:
            InputError: if there is too little room even then.
        """
        own = self.used(person)
        others = {name: weight for name, weight in list(self._weights.items()) if name != person}
        missing = max(own + size - allowed, sum(others.values()) + own + size - self.most_bytes)
        if address:
            self._addresses[person] = address
            near = sum(weight for name, weight in others.items() if self._addresses.get(name) == address)
            missing = max(missing, near + own + size - ADDRESS_SHARE * self.most_bytes)
        if missing > 0 and self._remove_oldest(self.uploads / person, missing)[1] < missing:
            megabytes = math.ceil(10 * size / 2**20) / 10  # never "0 MB"
            raise InputError(
                f"There is no room for {megabytes:,g} MB more beside your uploads and files for download: use a "
                "smaller file, remove runs of the history, or wait until the older ones are gone."
            )
        self._weights[person] = own + size

    def clean(self, keep: Collection[str] = (), allowed: float = math.inf) -> int:
        """Removes files that are too old, then the oldest of each person who has too many; returns their number.

        Args:
            keep: paths that stay.
            allowed: bytes that a person may have.
        """
        now = time.time()
        gone = sum(
            _remove(path)
            for made, _, path in list(_files(self.folder))
            if now - made > KEPT_SECONDS and path not in keep
        )
        for folder in list(self.uploads.iterdir()):
            if (missing := self.used(folder.name) - allowed) > 0:
                gone += self._remove_oldest(folder, missing, keep)[0]
        self._weights = {folder.name: self.used(folder.name) for folder in self.uploads.iterdir()}
        self._addresses = {name: home for name, home in self._addresses.items() if name in self._weights}
        self._drop_empty_folders(now)
        return gone

    @staticmethod
    def _remove_oldest(folder: Path, size: float, keep: Collection[str] = ()) -> tuple[int, int]:
        """Removes files of a folder that are not in use until so much room is made; returns their number and bytes."""
        now, gone, freed = time.time(), 0, 0
        for made, weight, path in sorted(_files(folder)):
            if freed >= size:
                break
            in_use = 0 <= now - made < IN_USE_SECONDS  # or the clock was set back
            if not in_use and path not in keep and _remove(path):
                gone, freed = gone + 1, freed + weight
        return gone, freed

    def _drop_empty_folders(self, now: float) -> None:
        for parent, _, _ in os.walk(self.folder, topdown=False):
            if Path(parent) in (self.folder, self.uploads):
                continue
            try:
                if now - os.stat(parent).st_mtime > IN_USE_SECONDS:
                    os.rmdir(parent)
            except OSError:  # it is not empty
                continue


def _files(folder: Path) -> Iterator[_File]:
    """All files below a folder."""
    for parent, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(parent, name)
            try:
                status = os.stat(path)
            except OSError:  # gone meanwhile
                continue
            yield status.st_mtime, max(status.st_size, LEAST_BYTES), path


def _remove(path: str) -> bool:
    try:
        os.remove(path)
    except OSError:
        return False
    return True


# ---- a folder a person ------------------------------------------------------------------------------


PERSON: ContextVar[str] = ContextVar("person", default="")
"""The person whose request is being handled."""


class PersonalApp(App):
    """Gradio's application with a folder of uploads for every person; :func:`keep_files_apart` makes one."""

    @property
    def uploaded_file_dir(self) -> str:  # type: ignore[override]  # Gradio sets it once, for all
        """Folder of uploads, and of served files."""
        return str(folder_of(PERSON.get()))


def keep_files_apart(app: App) -> None:
    """Makes a mounted Gradio application a :class:`PersonalApp`; it is made deep inside of Gradio."""
    del app.uploaded_file_dir
    app.__class__ = PersonalApp


async def _move_files(data: Any, *where: Any, **options: Any) -> Any:
    files: list[Any] = []
    traverse(data, files.append, is_file_obj_with_meta)
    move = partial(processing_utils.move_files_to_cache, data, *where, **options)
    return await run_in_threadpool(move) if files or isinstance(data, GradioModel | GradioRootModel) else move()


class _Signals(LRUCache[str, asyncio.Event]):
    def __missing__(self, upload: str) -> asyncio.Event:
        self[upload] = made = asyncio.Event()
        return made


def mend_uploads() -> None:
    """Makes Gradio check and copy the files of events in threads, and forget the progress of old uploads.

    It asks the system some hundred times about a file's place and reads all of it. On the event loop, which would wait
    for the interpreter lock after each of these, the files of one result kept every other request waiting for a second.
    What nobody watches to its end, and every upload that was ever asked for, it keeps for good.
    """
    processing_utils.async_move_files_to_cache = _move_files
    statuses: Any = gradio.routes.file_upload_statuses
    statuses._statuses, statuses._signals = LRUCache(UPLOADS), _Signals(UPLOADS)


def folder_of(person: str) -> Path:
    """The folder of a person's files."""
    return Path(get_upload_folder()) / digest(person)


def visitors_folder() -> str:
    """The folder name of the person whose event this thread handles."""
    return digest(visitor().person)


def owns(person: str, path: str) -> bool:
    """True if a path is a file below a person's folder, with all links on its way followed."""
    if "\0" in path or not os.path.isabs(path):
        return False
    real = Path(os.path.realpath(path))
    return real.is_file() and real.is_relative_to(os.path.realpath(folder_of(person)))
