"""The tables ``[models.NAME]`` of the settings, checked one by one.

They stand in the settings file (``pasdedeux.toml`` in the working folder, or what ``PASDEDEUX_SETTINGS`` names) or,
as JSON, in ``PASDEDEUX_MODELS``, which goes before the file. Every process that makes motion reads them here: the
page, the shell, Ray's replicas and a program that imports :class:`~webdemo.inference.engine.Engine`.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from motion import InputError

SETTINGS_VARIABLE, MODELS_VARIABLE = "PASDEDEUX_SETTINGS", "PASDEDEUX_MODELS"
SETTINGS_FILE = "pasdedeux.toml"
ROLES = ("checkpoint", "mean", "std", "vocabulary")
"""What a file of a released network is."""
KEYS = ("method", "files", "pipeline", "label", "labels", "precision", "schedule")
PRECISIONS = ("auto", "float32", "bfloat16")
_NAME = re.compile(r"[a-z0-9][a-z0-9._-]{0,39}")
_CHECKPOINTS = (".ckpt", ".pt", ".pth", ".tar", ".bin", ".safetensors")
_VOCABULARY = ".txt.gz"


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One table.

    Attributes:
        name: of the model, as in ``[models.NAME]``.
        label: what people call it.
        method: the network of the paper whose released files these are; "" for a Python class.
        files: role (:data:`ROLES`) → path.
        pipeline: ``file.py:Class`` or ``package.module:Class``; "" for released files.
        folder: what paths are relative to.
        labels: names of the action classes of a network that was trained with them, in their order.
        precision: numbers of the matrix products, one of :data:`PRECISIONS`.
        schedule: noise schedule of BiGraphDiff, "linear" or "cosine".
    """

    name: str
    label: str
    method: str = ""
    files: Mapping[str, Path] = field(default_factory=dict)
    pipeline: str = ""
    folder: Path = Path()
    labels: tuple[str, ...] = ()
    precision: str = "auto"
    schedule: str = "linear"

    def file(self, role: str) -> Path:
        """The path of a file that the method needs.

        Raises:
            InputError: if the table does not name it, or it does not exist.
        """
        if role not in self.files:
            raise InputError(f"`files` names no {role} file: add it to [models.{self.name}].")
        path = self.files[role]
        if not path.exists():
            raise InputError(f"There is no file {path.name}: correct `files` of [models.{self.name}].")
        return path

    def digest(self, *roles: str) -> str:
        """One SHA-256 for the files that are named, by which a manifest names the weights.

        A folder counts by its files' names.
        """
        total = hashlib.sha256()
        for path in (self.files[role] for role in roles if role in self.files):
            if path.is_dir():
                total.update("\n".join(sorted(file.name for file in path.iterdir())).encode())
                continue
            with path.open("rb") as file:
                while block := file.read(1 << 22):
                    total.update(block)
        return total.hexdigest()


def read_entries() -> tuple[dict[str, Entry], dict[str, str]]:
    """All tables: those that can be used by name, and one sentence for each of the others."""
    entries, failed = {}, {}
    try:
        tables, folder, where = _tables()
    except InputError as error:
        return {}, {SETTINGS_FILE: str(error)}
    for name, table in tables.items():
        try:
            entries[name] = _entry(name, table, folder)
        except InputError as error:
            failed[name] = f"The model {name} in {where} cannot be used: {error}"
    return entries, failed


def _tables() -> tuple[Mapping[str, Any], Path, str]:
    """The tables by name, the folder that their paths are relative to, and where they stand."""
    if text := os.environ.get(MODELS_VARIABLE):
        try:
            tables = json.loads(text)
        except ValueError as error:
            raise InputError(f"{MODELS_VARIABLE} is not JSON ({error}).") from None
        return _mapping(tables, MODELS_VARIABLE), Path.cwd(), MODELS_VARIABLE
    path = Path(os.environ.get(SETTINGS_VARIABLE) or SETTINGS_FILE)
    if not path.is_file():
        return {}, Path.cwd(), path.name
    try:
        settings = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"The settings file {path.name} cannot be read: {error}.") from None
    return _mapping(settings.get("models", {}), f"[models] in {path.name}"), path.resolve().parent, path.name


def _mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError(f"{what} must hold one table for each model, as [models.NAME].")
    return value


def _entry(name: str, table: Any, folder: Path) -> Entry:
    if not _NAME.fullmatch(name):
        raise InputError("its name must be up to 40 small letters, digits, dots and dashes.")
    table = _mapping(table, f"[models.{name}]")
    for key in table:
        if key not in KEYS:
            raise InputError(f"it has an unknown key {key!r:.40}: use {', '.join(KEYS)}.")
    texts = {key: table.get(key, "") for key in ("method", "pipeline", "label", "precision", "schedule")}
    for key, value in texts.items():
        if not isinstance(value, str) or len(value) > 200:
            raise InputError(f"`{key}` must be a short text, not {value!r:.40}.")
    if bool(texts["method"]) == bool(texts["pipeline"]):
        raise InputError("give it either `method` with `files`, or `pipeline`.")
    precision, schedule = texts["precision"] or "auto", texts["schedule"] or "linear"
    if precision not in PRECISIONS:
        raise InputError(f"`precision` {precision!r} is unknown: choose one of {', '.join(PRECISIONS)}.")
    if schedule not in ("linear", "cosine"):
        raise InputError(f"`schedule` {schedule!r} is unknown: choose linear or cosine.")
    labels = table.get("labels", [])
    if not isinstance(labels, list) or not all(isinstance(label, str) and label.strip() for label in labels):
        raise InputError("`labels` must be a list of the names of the action classes, in their order.")
    return Entry(
        name=name,
        label=texts["label"].strip() or name,
        method=texts["method"],
        files=_files(table.get("files", {}), folder),
        pipeline=texts["pipeline"],
        folder=folder,
        labels=tuple(labels),
        precision=precision,
        schedule=schedule,
    )


def _files(value: Any, folder: Path) -> dict[str, Path]:
    """Role → path, from a table of roles, from a list of files that are known by their names, or from one."""
    if isinstance(value, str):
        value = [value]
    if isinstance(value, list):
        if not all(isinstance(path, str) for path in value):
            raise InputError("`files` must be a list of paths, or a table of roles and paths.")
        roles = [_role(path) for path in value]
        if len(set(roles)) < len(roles):
            raise InputError("`files` has two files of one role: write them as { checkpoint = …, mean = …, std = … }.")
        value = dict(zip(roles, value, strict=True))
    if not isinstance(value, dict) or not all(isinstance(path, str) for path in value.values()):
        raise InputError("`files` must be a list of paths, or a table of roles and paths.")
    for role in value:
        if role not in ROLES:
            raise InputError(f"`files` has an unknown role {role!r:.40}: use {', '.join(ROLES)}.")
    return {role: folder / Path(path).expanduser() for role, path in value.items()}


def _role(path: str) -> str:
    """The part that a file plays, by its name."""
    name = Path(path).name.lower()
    if name.endswith(_CHECKPOINTS):
        return "checkpoint"
    if name.endswith(".npy"):
        return "mean" if "mean" in name else "std"
    if name.endswith(_VOCABULARY):
        return "vocabulary"
    raise InputError(
        f"it is not clear what the file {name:.60} is: write `files` as {{ checkpoint = …, mean = …, std = … }}."
    )
