"""Settings about acts: folders of a lab's own, and the director.

As with a lab's own models, every process that reads sentences looks here: the page, the shell, Ray's replicas and a
program that imports :mod:`acts`. The environment goes before the settings file, which is ``pasdedeux.toml`` in the
working folder or what ``PASDEDEUX_SETTINGS`` names.
"""

from __future__ import annotations

import ipaddress
import json
import os
import threading
import time
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError

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


class DirectorSettings(BaseModel):
    """A language model that writes plans, as ``[director]`` of the settings names it.

    Attributes:
        url: of an OpenAI-compatible API, up to ``/v1``.
        model: its name there.
        key: sent as a bearer token; never shown.
        when: "unread" asks only where the lexicon leaves words unread, "always" for every text.
        seconds: limit of one reading, with its repair.
        plain_http: True allows ``http://`` to other machines, which sends texts and key in the clear.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    url: str
    model: str
    key: str = Field("", repr=False)
    when: Literal["unread", "always"] = "unread"
    seconds: float = 10.0
    plain_http: bool = False


def director_settings() -> DirectorSettings | None:
    """The director of ``PASDEDEUX_DIRECTOR_URL``, ``_MODEL``, … or the settings file; None if there is none.

    Raises:
        InputError: one sentence on what is wrong with it, which holds no value of it.
    """
    table = settings_file()[0].get("director", {})
    if not isinstance(table, dict):
        raise InputError("The setting director must be a table: [director] with url and model.")
    given = dict(table)
    for name in DirectorSettings.model_fields:
        if text := os.environ.get(f"{PREFIX}DIRECTOR_{name.upper()}", "").strip():
            given[name] = text
    if not given:
        return None
    try:
        found = DirectorSettings.model_validate(given)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])[:60]
        raise InputError(f"The setting director.{where} cannot be used: {first['msg']}.") from None
    _check_address(found)
    return found


def _check_address(found: DirectorSettings) -> None:
    try:
        parts = urlsplit(found.url)
        host, _ = parts.hostname or "", parts.port
    except ValueError:
        host = ""
    if not host or parts.scheme not in ("http", "https") or parts.username or parts.query or parts.fragment:
        raise InputError("The setting director.url must be http://HOST/v1 or https://HOST/v1, without a name or key.")
    if not found.model or not 0 < found.seconds <= 60 or any(ord(c) < 33 or ord(c) > 126 for c in found.key):
        raise InputError("The setting director needs a model, at most 60 seconds, and a key of plain characters.")
    if parts.scheme == "http" and not is_loopback(host) and not found.plain_http:
        raise InputError(
            "The setting director.url is http:// to another machine: use https://, or allow it with plain_http = true."
        )


def is_loopback(host: str) -> bool:
    """True if an address or name is this machine's loopback."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


# ---- files of a lab's own acts -------------------------------------------------------------------------
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
