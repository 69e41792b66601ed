"""Settings about acts: folders of a lab's own, and the director.

As with a lab's own models, every process that reads sentences looks here: the page, the shell, Ray's replicas and a
program that imports :mod:`acts`. The environment goes before the settings file, which is ``pasdedeux.toml`` in the
working folder or what ``PASDEDEUX_SETTINGS`` names.
"""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from motion import InputError

PREFIX = "PASDEDEUX_"
SETTINGS_FILE = "pasdedeux.toml"


def acts_folders() -> tuple[Path, ...]:
    """The folders of the setting ``acts``; those of the settings file are relative to its own folder.

    Raises:
        InputError: if the setting is no list of folders, or the settings file cannot be read.
    """
    if text := os.environ.get(f"{PREFIX}ACTS", "").strip():
        return tuple(Path(name).expanduser().resolve() for name in listed(text))
    settings, folder = settings_file()
    names = settings.get("acts", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError('The setting acts must be a list of folders: acts = ["our-acts"].')
    return tuple((folder / Path(name).expanduser()).resolve() for name in names)


def listed(text: str) -> list[str]:
    """The folders of ``PASDEDEUX_ACTS``: separated as in ``PATH``, or a JSON list like other lists of settings.

    Raises:
        InputError: if it looks like JSON and is none.
    """
    if not text.lstrip().startswith("["):
        return [name for name in text.split(os.pathsep) if name.strip()]
    try:
        names = json.loads(text)
    except ValueError:
        names = None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{PREFIX}ACTS must be folders with {os.pathsep!r} between them, or a JSON list.")
    return names


def settings_file() -> tuple[Mapping[str, Any], Path]:
    """Contents of the settings file, and its folder; nothing if there is none.

    Raises:
        InputError: if it cannot be read.
    """
    path = Path(os.environ.get(f"{PREFIX}SETTINGS") or SETTINGS_FILE)
    if not path.is_file():
        return {}, Path.cwd()
    try:
        return tomllib.loads(path.read_text(encoding="utf-8")), path.resolve().parent
    except (OSError, ValueError) as error:
        raise InputError(f"The settings file {path.name} cannot be read: {error}.") from None
