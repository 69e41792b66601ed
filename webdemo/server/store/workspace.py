"""One file that holds the runs of a history: written from ours, and read as if by an enemy.

A .zip with ``workspace.json`` (what was asked and written of each run, how its tab was set and the numbers of the runs
that stand beside it), ``NUMBER/1.npz …`` (its motions) and ``NUMBER/original`` (the file that it was made from). What
is read back is checked and made anew: motions go through the reader and the writer of uploads, and settings keep plain
values of the expected kinds. Original files are copied and not read. No name in the file becomes a path.
"""

from __future__ import annotations

import errno
import json
import math
import os
import secrets
import time
import zipfile
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from motion import Clip, Duet, InputError, formats
from webdemo.inference.plans import kept_plan
from webdemo.inference.story import SceneRequest
from webdemo.view.thumbnail import thumbnail

from .archive import DAMAGE, WRONG, Archive
from .kept_settings import groups, plain_controls
from .originals import LARGEST_ORIGINAL, ORIGINAL, bytes_of, kept_original
from .storage import ROW_BYTES

FORMAT = "pas-de-deux-workspace-1"
MOST_RUNS = 1000
MOST_SAMPLES = 16
MOST_FILES = MOST_RUNS * (MOST_SAMPLES + 2)
LARGEST_FILE = 50 * 2**20
"""Bytes of one motion inside when unpacked."""
LARGEST_STORY = 100_000
"""Characters of a scene's request."""
_KINDS = ("generate", "scene", "react", "predict")
_CURVES = ("error", "speed", "true_speed")


@dataclass(frozen=True)
class Packed:
    """A run on its way into a file.

    Attributes:
        row: columns of its row.
        note: columns of its note.
        folder: its motions; called after its id.
        kept: settings of its tab, and ids of the runs beside it.
    """

    row: Mapping[str, Any]
    note: Mapping[str, Any]
    folder: Path
    kept: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Taken:
    """A run out of a file.

    Attributes:
        row: columns of its row.
        note: columns of its note.
        folder: its files wait here.
        motion: the first of its samples.
    """

    row: dict[str, Any]
    note: dict[str, Any]
    folder: Path
    motion: Duet | Clip


def pack(runs: Sequence[Packed], file: Path) -> None:
    """Writes runs into a file; raises InputError if their files are gone."""
    stored = []
    numbers = {run.folder.name: number for number, run in enumerate(runs)}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, run in enumerate(runs):
            motions = sorted(run.folder.glob("*.npz"))
            if not motions:
                raise InputError(f"The files of “{run.row['title'][:60]}” are gone: remove that run first.")
            for path in motions:
                archive.write(path, f"{number}/{path.name}")
            readouts = json.loads((run.folder / "readouts.json").read_text(encoding="utf-8"))
            beside = [numbers[other] for other in run.kept.get("compared", ()) if other in numbers]
            kept = {"controls": run.kept.get("controls", {}), "compared": beside}
            if original := kept_original(run.kept.get("file"), run.folder):
                archive.write(original.path, f"{number}/{ORIGINAL}")
                kept["file"] = original.name
            stored.append({**run.row, "note": dict(run.note), "readouts": readouts, "kept": kept})
        archive.writestr("workspace.json", json.dumps({"format": FORMAT, "runs": stored}))


def unpack(file: Path, folder: Path, room: float) -> Generator[tuple[int, int], None, list[Taken]]:
    """Reads the runs of a file; their files lie in folders in ``folder`` that are called after their new ids.

    Args:
        file: the workspace.
        folder: empty; whoever made it removes what is in it if this fails or is not finished.
        room: bytes that may be written.

    Yields:
        how many runs have been read, and of how many.

    Raises:
        InputError: if anything is not as :func:`pack` writes it, or there is too little room.
    """
    taken: list[Taken] = []
    written = 0
    try:
        with Archive(file, MOST_FILES) as archive:
            stored_runs = _stored_runs(archive)
            _check_room(archive.size, room)
            for number, stored in enumerate(stored_runs):
                taken.append(_taken(archive, number, stored, folder))
                written += taken[-1].row["size"]
                _check_room(written, room)
                yield number + 1, len(stored_runs)
            _put_beside(stored_runs, taken)
    except InputError as error:
        raise InputError(str(error).replace(f"{folder}{os.sep}", "")) from None
    except DAMAGE as error:
        if getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT):
            raise InputError("The server's disk is full: tell the person who runs it.") from None
        raise InputError(WRONG.format("it cannot be read")) from None
    return taken


def _check_room(size: float, room: float) -> None:
    if size > room:
        raise InputError(
            f"This workspace takes {size / 2**20:,.1f} MB, and {max(room, 0.0) / 2**20:,.1f} MB of your room are free: "
            "remove runs of yours first, or import fewer at once."
        )


def _put_beside(stored: Sequence[Mapping[str, Any]], taken: Sequence[Taken]) -> None:
    """Gives runs their tab's settings again, and makes those beside them their parts."""
    kept = [run["kept"] if isinstance(run.get("kept"), dict) else {} for run in stored]
    beside = groups([each.get("compared") for each in kept], [run.motion for run in taken])
    for number, run in enumerate(taken):
        others = [taken[other] for other in beside.get(number, ())]
        record: dict[str, Any] = {
            "controls": plain_controls(kept[number].get("controls")),
            "compared": [o.row["id"] for o in others],
        }
        if original := kept_original(kept[number].get("file"), run.folder):
            record["file"] = original.name
        if "grid" in record["controls"] and not others:  # its other cells were removed before
            del record["controls"]["grid"]
        run.note["kept"] = json.dumps(record)
        for other in others:
            other.note["part_of"] = run.row["id"]


def _stored_runs(archive: Archive) -> list[dict[str, Any]]:
    stored = archive.values("workspace.json")
    if (
        not isinstance(stored, dict)
        or stored.get("format") != FORMAT
        or not isinstance(stored.get("runs"), list)
    ):
        raise InputError(WRONG.format("its list of runs is missing"))
    if len(stored["runs"]) > MOST_RUNS:
        raise InputError(f"The workspace holds {len(stored['runs']):,} runs: import {MOST_RUNS:,} at most.")
    return [run if isinstance(run, dict) else {} for run in stored["runs"]]


def _taken(archive: Archive, number: int, stored: Mapping[str, Any], home: Path) -> Taken:
    run = secrets.token_urlsafe(18)
    folder = home / run
    folder.mkdir(mode=0o700)
    motions = _motions(archive, number, folder)
    readouts = [
        _readout(each, motion) for each, motion in zip(stored.get("readouts") or [], motions, strict=False)
    ]
    (folder / "readouts.json").write_text(json.dumps(readouts), encoding="utf-8")
    kind = stored.get("kind")
    if kind not in _KINDS:
        raise InputError(WRONG.format(f"run {number + 1} is of no known kind"))
    request = {**_plain(stored.get("request")), "kind": kind}
    if kind == "scene":
        request = _scene(stored.get("request"), motions[0])
    now = time.time()
    row = {
        "id": run, "kind": kind, "title": _text(stored.get("title"), 500) or "Imported",
        "created": max(0.0, min(_number(stored.get("created"), now), now)),
        "favourite": False, "request": json.dumps(request),
        "outcome": json.dumps(_outcome(stored.get("outcome"), request, motions[0], folder)),
    }  # fmt: skip
    row["size"] = ROW_BYTES + bytes_of(folder) + len(row["request"]) + len(row["outcome"])
    return Taken(row, _note(stored.get("note"), motions[0]), folder, motions[0])


def _motions(archive: Archive, number: int, folder: Path) -> list[Duet | Clip]:
    names = archive.names
    motions = []
    for sample in range(1, MOST_SAMPLES + 1):
        name = f"{number}/{sample}.npz"
        if name not in names:
            break
        motions.append(_motion(archive, name, folder / f"{sample}.npz"))
    if not motions:
        raise InputError(WRONG.format(f"run {number + 1} has no motion"))
    for name in ("truth.npz", *(f"given-{i}.npz" for i in range(1, 7))):
        if f"{number}/{name}" in names:
            _motion(archive, f"{number}/{name}", folder / name)
    if f"{number}/{ORIGINAL}" in names:
        (folder / ORIGINAL).write_bytes(archive.content(f"{number}/{ORIGINAL}", LARGEST_ORIGINAL))
    return motions


def _motion(archive: Archive, name: str, path: Path) -> Duet | Clip:
    """Reads a motion as an upload is read, and writes it anew."""
    path.write_bytes(archive.content(name, LARGEST_FILE))
    try:
        motion = formats.read(path)
    finally:
        path.unlink()
    formats.write(motion, path)
    return motion


# ---- plain values ----------------------------------------------------------------------------------


def _text(value: Any, most: int) -> str:
    return value[:most].replace("\0", "") if isinstance(value, str) else ""


def _number(value: Any, otherwise: float) -> float:
    fits = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if fits else otherwise


def _plain(value: Any) -> dict[str, Any]:
    """The scalars of a dictionary, and dictionaries of scalars in it."""
    if not isinstance(value, dict):
        return {}
    found: dict[str, Any] = {}
    for name, each in list(value.items())[:60]:
        if isinstance(each, dict):
            found[str(name)[:60]] = {str(k)[:60]: v for k, v in list(each.items())[:20] if _is_scalar(v)}
        elif _is_scalar(each):
            found[str(name)[:60]] = each
    return found


def _scene(stored: Any, motion: Duet | Clip) -> dict[str, Any]:
    """The request of a scene, if one can be made of it."""
    if (
        not isinstance(stored, dict)
        or not isinstance(motion, Duet)
        or len(json.dumps(stored)) > LARGEST_STORY
    ):
        raise InputError(WRONG.format("a scene has no story"))
    return SceneRequest.from_dict(stored, motion if "motion" in stored else None).to_dict()


def _is_scalar(value: Any) -> bool:
    if isinstance(value, str):
        return len(value) <= 1000
    return value is None or isinstance(value, bool) or _number(value, math.nan) == value


def _outcome(stored: Any, request: Mapping[str, Any], motion: Duet | Clip, folder: Path) -> dict[str, Any]:
    stored = stored if isinstance(stored, dict) else {}
    notes = stored.get("notes")
    outcome: dict[str, Any] = {
        "manifest": {**_plain(stored.get("manifest")), "request": dict(request)},
        "timings": {k: v for k, v in _plain(stored.get("timings")).items() if _number(v, math.nan) == v},
        "notes": [_text(note, 1000) for note in notes[:20]] if isinstance(notes, list) else [],
    }
    manifest = stored.get("manifest")
    if isinstance(manifest, dict) and (plan := kept_plan(manifest)) is not None:
        outcome["manifest"]["plan"] = plan.to_dict()
    kept = stored.get("prediction")
    if isinstance(kept, dict):
        past = kept.get("past_frames")
        if type(past) is not int or not 0 < past < motion.num_frames:
            raise InputError(WRONG.format("a prediction begins nowhere"))
        curves = {name: _numbers(kept.get(name), motion.num_frames) for name in _CURVES}
        outcome["prediction"] = {"past_frames": past, **curves}
    elif (folder / "truth.npz").exists():
        (folder / "truth.npz").unlink()
    return outcome


def _numbers(values: Any, most: int) -> list[float]:
    values = values[:most] if isinstance(values, list) else []
    return [_number(value, 0.0) for value in values]


def _readout(stored: Any, motion: Duet | Clip) -> dict[str, Any]:
    """Measures, curves and contacts of a sample, as far as they are of the expected kinds."""
    stored = stored if isinstance(stored, dict) else {}
    found: dict[str, Any] = {}
    for side in ("before", "after"):
        values = stored.get(side)
        if isinstance(values, dict):
            plain = values.get("summary", values)
            numbers = plain.items() if isinstance(plain, dict) else ()
            found[side] = {str(k)[:60]: float(v) for k, v in numbers if _number(v, math.nan) == v}
    curves = stored.get("curves")
    if isinstance(curves, dict):
        found["curves"] = {str(k)[:60]: _numbers(v, motion.num_frames) for k, v in list(curves.items())[:10]}
    if isinstance(stored.get("contacts"), list):
        found["contacts"] = [
            {"start": each["start"], "stop": each["stop"], "kind": _text(each.get("kind"), 20),
             "label": _text(each.get("label"), 100)}
            for each in stored["contacts"][:1000]
            if isinstance(each, dict) and type(each.get("start")) is int and type(each.get("stop")) is int
            and 0 <= each["start"] <= each["stop"] <= motion.num_frames
        ]  # fmt: skip
    return found


def _note(stored: Any, motion: Duet | Clip) -> dict[str, Any]:
    stored = stored if isinstance(stored, dict) else {}
    frame = stored.get("frame")
    tags = _text(stored.get("tags"), 300).split()
    return {
        "title": _text(stored.get("title"), 200), "text": _text(stored.get("text"), 4000),
        "tags": f" {' '.join(tags)} " if tags else "",
        "frame": frame if type(frame) is int and 0 <= frame < motion.num_frames else None,
        "thumbnail": thumbnail(motion),
    }  # fmt: skip
