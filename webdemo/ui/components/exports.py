"""Files to take home: written to a folder of their own for every run, removed when they are old."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import shutil
import tempfile
import threading
import unicodedata
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from motion import Clip, InputError, formats
from motion.formats import ALONE
from motion.formats.files import safe_cell
from webdemo.inference.run import Result
from webdemo.view.sheet import write_grid_sheet, write_sheet
from webdemo.view.stage import Style

_WRITING = threading.Lock()
"""Writing is work for Python, which does one thing at a time: several at once only hold up the page."""


_SHEET = Style(names=False)
_PLAIN = ("png", "json", "csv")
"""Kinds that are no motion."""

ALL = "all"
"""The key of everything in one archive."""

PURPOSES = {
    "For Blender": ("glb", "bvh", "usda"),
    "Numbers": ("npz", "smpl.npz", "csv", "json"),
    "Pictures and film": ("png",),
    "Everything": (ALL,),
}
"""What files are for, the likeliest first, and their kinds: suffixes without the dot, by which programs call them."""
KINDS = tuple(kind for kinds in PURPOSES.values() for kind in kinds)


@dataclass
class Record:
    """A session's last result.

    Attributes:
        result: what the engine gave.
        prompt: names the files.
        files: what was written of it for download, by kind.
        compared: the results of a grid by the names of their cells; ``result`` is the first of them.
        grid: columns, rows, names and title of the grid that they stand in; empty for none.
    """

    result: Result = field(repr=False)
    prompt: str
    files: Mapping[str, Path] = field(default_factory=dict, repr=False)
    compared: Mapping[str, Result] = field(default_factory=dict, repr=False)
    grid: Mapping[str, Any] = field(default_factory=dict)


class Shelf:
    """A folder with one folder a run.

    Args:
        root: created when first needed.
        owner: names the folder in it for the person whose event is answered; by default there is one for all.
        admit: makes room for a file of so many bytes, or raises InputError; by default there is room.
    """

    def __init__(
        self, root: Path, *, owner: Callable[[], str] | None = None, admit: Callable[[float], None] | None = None
    ) -> None:
        self.root, self.owner, self.admit = root, owner, admit

    def folder(self, size: float = 0.0) -> Path:
        """A new empty folder.

        Args:
            size: bytes that will be written there, as far as that is known.

        Raises:
            InputError: if the person whose event is answered has too little room.
        """
        if self.admit is not None:
            self.admit(size)
        parent = self.root / self.owner() if self.owner else self.root
        parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        return Path(tempfile.mkdtemp(prefix="run-", dir=parent))


def offered(kind: str) -> bool:
    """True if this installation can write a kind of file for every result."""
    return kind in (*_PLAIN, ALL) or formats.can_write(f".{kind}")


def write_record(record: Record, folder: Path) -> dict[str, list[Path]]:
    """:func:`write_files` for all results of a record; names of compared ones begin with their method.

    The cells of a grid have one table of read-outs and one contact sheet.
    """
    if not record.compared:
        return write_files(record.result, folder, prompt=record.prompt)
    files: dict[str, list[Path]] = {}
    for method, result in record.compared.items():
        prompt = f"{method} {record.prompt}"
        written = write_files(result, folder, prompt=prompt, leave_out=("csv", "png"))
        for key, paths in written.items():
            files.setdefault(key, []).extend(paths)
    name = folder / file_name(record.prompt, record.result.manifest)
    with _writing(folder):
        if any(result.readouts for result in record.compared.values()):
            files["csv"] = [_write_table(record.compared, name.with_suffix(".csv"))]
        motions = {cell: result.duets[0] for cell, result in record.compared.items()}
        files["png"] = [write_grid_sheet(motions, name.with_suffix(".png"), title=record.prompt, style=_SHEET)]
    return files


def write_files(result: Result, folder: Path, *, prompt: str, leave_out: tuple[str, ...] = ()) -> dict[str, list[Path]]:
    """Writes a result in every kind that this installation can write, but for those that are left out.

    Returns:
        the files by the key of their kind, in the order of the samples; a BVH pair is two files.

    Raises:
        OSError: where the disk is full or cannot be written; the folder is removed.
    """
    name = file_name(prompt, result.manifest)
    with _writing(folder):
        return {
            kind: _write_kind(kind, result, folder, name, prompt)
            for kind in KINDS
            if offered(kind) and kind not in (*leave_out, ALL) and _holds(kind, result)
        }


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    """Lets one writer work at a time, and removes the folder of one that fails."""
    try:
        with _WRITING:
            yield
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise (without_place(error, folder) if isinstance(error, Exception) else error) from None


def without_place(error: Exception, folder: Path) -> Exception:
    """An error whose sentence does not say where the server keeps its files."""
    if isinstance(error, InputError):
        return InputError(str(error).replace(f"{folder}{os.sep}", ""))
    return error


def _write_kind(kind: str, result: Result, folder: Path, name: str, prompt: str) -> list[Path]:
    if kind == "json":
        path = folder / f"{name}.json"
        path.write_text(json.dumps(result.manifest, indent=2, ensure_ascii=False), encoding="utf-8")
        return [path]
    if kind == "csv":
        return [_write_table({"": result}, folder / f"{name}.csv")]
    several = len(result.duets) > 1
    files: list[Path] = []
    for i, duet in enumerate(result.duets):
        path = folder / (f"{name}-{i + 1}.{kind}" if several else f"{name}.{kind}")
        if kind == "png":
            files.append(write_sheet(duet, path, title=prompt, style=_SHEET))
        else:
            files += map(Path, formats.write(duet, path))
    return files


def _write_table(results: Mapping[str, Result], path: Path) -> Path:
    """The read-outs of results, a row a sample; cells that a spreadsheet would compute begin with an apostrophe."""
    rows = []
    for name, result in results.items():
        request = result.manifest.get("request", {})
        for i, readout in enumerate(result.readouts):
            after = readout.get("after") or {}
            rows.append(
                {"result": name, "sample": i + 1, "model": result.manifest.get("model")}
                | {key: request.get(key) for key in ("prompt", "seed", "guidance", "steps", "damping")}
                | dict(after.get("summary", after))
            )
    heads = list(dict.fromkeys(key for row in rows for key in row)) or ["result"]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, heads)
        writer.writeheader()
        for row in rows:
            writer.writerow({key: safe_cell(value) for key, value in row.items()})
    return path


def _holds(kind: str, result: Result) -> bool:
    """True if files of a kind can hold the people of a result."""
    if kind == "csv" and not result.readouts:
        return False
    one = isinstance(result.duets[0], Clip)
    return not one or kind in _PLAIN or f".{kind}" in ALONE


def for_download(files: Mapping[str, list[Path]], name: str | None = None) -> dict[str, Path]:
    """One file a kind: the file itself, or a .zip of several, called after the first or ``name``; and one of all."""
    name = name or files["json"][0].stem
    files = {**files, ALL: [path for paths in files.values() for path in paths]}
    return {
        key: paths[0] if len(paths) == 1 else _zipped(paths, paths[0].with_name(f"{name}-{key}.zip"))
        for key, paths in files.items()
    }


def _zipped(paths: list[Path], archive: Path) -> Path:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as target:
        for path in paths:
            target.write(path, path.name)
    return archive


def file_name(prompt: str, manifest: Mapping[str, object]) -> str:
    """A short plain name, such as "two-people-shake-hands-seed7-3fa2": the prompt, the seed and four digits of a
    digest of everything that was asked, so that runs that differ have files that differ in name."""
    plain = unicodedata.normalize("NFKD", prompt).encode("ascii", "ignore").decode().lower()
    words = re.findall(r"[a-z0-9]+", plain)
    name = ""
    for word in words:
        if len(name) + len(word) > 40:
            break
        name = f"{name}-{word}" if name else word
    request = manifest.get("request")
    seed = request.get("seed") if isinstance(request, Mapping) else None
    described = {key: manifest.get(key) for key in ("model", "weights_sha256", "request")}
    digest = hashlib.blake2b(json.dumps(described, sort_keys=True, default=str).encode(), digest_size=2).hexdigest()
    return (name or "motion") + (f"-seed{seed}" if isinstance(seed, int) else "") + f"-{digest}"
