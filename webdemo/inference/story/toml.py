"""Stories as TOML text: read with errors that name the line and the key, and written to be read again.

::

    seed = 1

    [[beat]]
    words = "Two people walk up to each other and shake hands."

    [[beat]]
    a = "walks away"
    b = "stands and waves goodbye"
    seconds = 5

    [[path]]
    person = "a"
    points = [[8.5, 0, 0], [13, -3, -2]]    # seconds, x, z, and a heading in degrees if it matters
"""

from __future__ import annotations

import difflib
import json
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from motion import Duet, InputError
from motion.formats import read
from webdemo.inference.requests import SamplingRequest

from .beats import Beat
from .request import SceneRequest, beat_of, path_of
from .splitting import split_sentence
from .wishes import FloorPath, Pose

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MOST_CHARACTERS = 200_000
"""Of a story; one of 60 beats with drawn paths has a tenth of that."""
_LOOKS_LIKE_TOML = re.compile(r"^\s*(?:\[\[?\s*\w+\s*\]|\w+\s*=)", re.MULTILINE)
_NUMBER, _TEXT = (int, float), (str,)
_TOP: dict[str, tuple[type, ...]] = {
    "seed": (int,), "samples": (int,), "guidance": _NUMBER, "steps": (int,), "damping": _NUMBER, "sampler": _TEXT,
    "model": _TEXT, "cleanup": (bool,), "loop": (bool,),
    "planned": (bool,), "beat": (list,), "path": (list,), "pose": (list,),
}  # fmt: skip
_BEAT: dict[str, tuple[type, ...]] = {
    "words": _TEXT,
    "a": _TEXT,
    "b": _TEXT,
    "seconds": _NUMBER,
    "seed": (int,),
}
_PATH: dict[str, tuple[type, ...]] = {"person": _TEXT, "points": (list,)}
_POSE: dict[str, tuple[type, ...]] = {
    "person": _TEXT, "seconds": _NUMBER, "file": _TEXT, "frame": (int,), "of": _TEXT, "positions": (list,),
}  # fmt: skip
_TABLES = {"beat": _BEAT, "path": _PATH, "pose": _POSE}
_KINDS = {
    str: "text in quotes",
    int: "a whole number",
    float: "a number",
    bool: "true or false",
    list: "a list",
}


def read_story(text: str, folder: Path | None = None) -> dict[str, Any]:
    """The fields of a :class:`SceneRequest` that a story sets.

    Args:
        text: TOML.
        folder: where the files of poses are; without it a pose gives its positions in the story itself.

    Raises:
        InputError: one sentence with the line and the key of what is wrong.
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"The story has {len(text):,} characters: shorten it to {MOST_CHARACTERS:,}.")
    try:
        found = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"The story is no valid TOML: {_sentence(error)}") from None
    except RecursionError:
        raise InputError("The story is no valid TOML: its lists are nested too deeply.") from None
    lines = _Lines(text)
    _check_keys(found, _TOP, lines, "", 0, "a story")
    for table, known in _TABLES.items():
        for i, entry in enumerate(found.get(table, ())):
            if not isinstance(entry, Mapping):
                raise InputError(f"{lines.where('', 0, table)}{table} must be written as [[{table}]].")
            _check_keys(entry, known, lines, table, i, f"a {table}")
    plain = {f.name: found[f.name] for f in fields(SamplingRequest) if f.name in found}
    return plain | {
        "beats": tuple(beat_of(entry) for entry in found.get("beat", ())),
        "paths": tuple(_path(entry, i, lines) for i, entry in enumerate(found.get("path", ()))),
        "poses": tuple(_pose(entry, i, lines, folder) for i, entry in enumerate(found.get("pose", ()))),
        "loop": found.get("loop", False),
        "planned": found.get("planned", SceneRequest.planned),
    }


def read_words(text: str) -> dict[str, Any]:
    """The fields that a text sets: a story in TOML, or plain sentences, which are split into beats.

    Raises:
        InputError: as :func:`read_story`.
    """
    if _LOOKS_LIKE_TOML.search(text):
        return read_story(text)
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"The story has {len(text):,} characters: shorten it to {MOST_CHARACTERS:,}.")
    return {"beats": split_sentence(text)}


def write_story(request: SceneRequest) -> str:
    """A story as TOML text that :func:`read_story` reads as the same fields; a given motion is not part of it."""
    out = [f"seed = {request.seed}"]
    for f in fields(SamplingRequest):
        value = getattr(request, f.name)
        if f.name != "seed" and value != f.default:
            out.append(f"{f.name} = {json.dumps(value)}")
    if not request.planned:
        out.append("planned = false")
    if request.loop:
        out.append("loop = true")
    for beat in request.beats:
        out += ["", *_beat_lines(beat)]
    for path in request.paths:
        out += ["", "[[path]]", f'person = "{path.person}"', _points(path)]
    for pose in request.poses:
        positions = json.dumps(np.asarray(pose.positions).tolist())
        out += [
            "",
            "[[pose]]",
            f'person = "{pose.person}"',
            f"seconds = {pose.seconds!r}",
            f"positions = {positions}",
        ]
    return "\n".join(out) + "\n"


def _beat_lines(beat: Beat) -> list[str]:
    out = ["[[beat]]"]
    for name in ("words", "a", "b"):
        if value := getattr(beat, name):
            out.append(f"{name} = {_quoted(value)}")
    if beat.seconds is not None:
        out.append(f"seconds = {beat.seconds:g}")
    if beat.seed is not None:
        out.append(f"seed = {beat.seed}")
    return out


def _points(path: FloorPath) -> str:
    rows = []
    for p in path.points:
        row = {"seconds": p.seconds, "x": p.x, "z": p.z, "heading": p.heading}
        if p.seconds is None:
            given = (f"{k} = {v!r}" for k, v in row.items() if v is not None)
            rows.append("{ " + ", ".join(given) + " }" if p.heading is not None else f"[{p.x!r}, {p.z!r}]")
        else:
            rows.append("[" + ", ".join(f"{round(v, 4)!r}" for v in row.values() if v is not None) + "]")
    return f"points = [{', '.join(rows)}]"


def _quoted(text: str) -> str:
    """A basic string of TOML, whose escapes are those of JSON; it takes no control characters as they are."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _sentence(error: Exception) -> str:
    words = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)|\(at end of document\)", words)
    said = words[: place.start()].strip() if place else words
    where = f"line {place[1]}, column {place[2]}" if place and place[1] else "its end"
    return f"{where}: {said[:1].lower()}{said[1:200]}."


@dataclass(frozen=True)
class _Lines:
    """Finds the line of a key in the text."""

    text: str

    def where(self, table: str, index: int, key: str) -> str:
        """``"Line 4: "`` for a key of the table's ``index``-th entry; "" if it is not found."""
        current, counts = "", {"": 0}
        for number, line in enumerate(self.text.splitlines(), 1):
            header = re.match(r"\s*\[\[?\s*\"?([\w-]+)\"?\s*\]\]?", line)
            if header:
                current = header[1]
                counts[current] = counts.get(current, -1) + 1
            found = header is not None and not table and current == key
            inside = current == table and counts[current] == index
            if found or (inside and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*[.=]", line)):
                return f"Line {number}: "
        return ""


def _check_keys(
    found: Mapping[str, Any],
    known: Mapping[str, tuple[type, ...]],
    lines: _Lines,
    table: str,
    index: int,
    what: str,
) -> None:
    for key, value in found.items():
        where = lines.where(table, index, key)
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it takes {', '.join(known)}."
            raise InputError(f"{where}there is no key {key!r:.40} in {what}; {hint}" if where else
                             f"There is no key {key!r:.40} in {what}; {hint}")  # fmt: skip
        kinds = known[key]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            wanted = _KINDS[kinds[-1]]
            raise InputError(f"{where}{key} must be {wanted}, not {value!r:.40}.")


def _path(entry: Mapping[str, Any], index: int, lines: _Lines) -> FloorPath:
    points = entry.get("points", [])
    where = lines.where("path", index, "points") or "A path: "
    keys = {"seconds", "x", "z", "heading"}
    for number, point in enumerate(points, 1):
        values = list(point.values()) if isinstance(point, Mapping) else point
        listed = isinstance(point, list) and 2 <= len(point) <= 4
        shaped = {"x", "z"} <= set(point) <= keys if isinstance(point, Mapping) else listed
        if not shaped or not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values):
            raise InputError(
                f"{where}point {number} of points must be [x, z], [seconds, x, z] or "
                "[seconds, x, z, heading], all numbers."
            )
    return path_of({"person": entry.get("person", ""), "points": points})


def _pose(entry: Mapping[str, Any], index: int, lines: _Lines, folder: Path | None) -> Pose:
    person, seconds = entry.get("person", ""), entry.get("seconds", 0.0)
    if "positions" in entry:
        where = lines.where("pose", index, "positions") or "A pose: "
        try:
            positions = np.asarray(entry["positions"], dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(f"{where}positions must be 22 lists of three numbers.") from None
        return Pose(person, seconds, positions)
    where = lines.where("pose", index, "file") or "A pose: "
    if "file" not in entry:
        raise InputError(f"{where}it needs a file and a frame, or positions.")
    if folder is None:
        raise InputError(
            f"{where}a file is only read from the shell: give the positions of the pose in the story."
        )
    motion = read(folder / entry["file"])
    people = motion.people if isinstance(motion, Duet) else (motion,)
    of = entry.get("of", person if len(people) > 1 else "a")
    if of not in ("a", "b")[: len(people)]:
        raise InputError(f"{where}{entry['file']} has no person {of!r:.20}.")
    clip, frame = people["ab".index(of)], entry.get("frame", 0)
    if not 0 <= frame < clip.num_frames:
        raise InputError(
            f"{lines.where('pose', index, 'frame') or where}{entry['file']} has frames 0 to "
            f"{clip.num_frames - 1}, not {frame}."
        )
    if clip.positions.shape[1] != 22:
        raise InputError(f"{where}the pose must be of SMPL's 22 joints: bring the file onto them first.")
    return Pose(person, seconds, np.asarray(clip.positions[frame], dtype=np.float64))
