"""A folder a person for what they upload and what is made for them, below the one that Gradio serves.

Gradio serves a file to anybody who knows its path, and names uploads by their content. Here its folder is that
of the person who asks, so that a path is worth nothing to others.
"""

from __future__ import annotations

import os
from contextvars import ContextVar
from pathlib import Path

from gradio.routes import App
from gradio.utils import get_upload_folder

from webdemo.server.accounts.visitors import digest
from webdemo.ui.visitor import visitor

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


def folder_of(person: str) -> Path:
    """The folder of a person's files."""
    return Path(get_upload_folder()) / digest(person)


def visitors_folder() -> str:
    """The folder name of the person whose event this thread handles."""
    return digest(visitor().person)


def owns(person: str, path: str) -> bool:
    """True if a path is below a person's folder, with all links on its way followed."""
    if "\0" in path or not os.path.isabs(path):
        return False
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder_of(person)))
