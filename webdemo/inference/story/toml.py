"""Stories as TOML text: read with errors that name the line and the key, and written to be read again.

::

    seed = 1

    [[beat]]
    words = "Two people walk up to each other and shake hands."

    [[beat]]
    a = "walks away"
    b = "stands and waves goodbye"
    seconds = 5

    [[beat]]
    acts = [{ act = "hug", agents = ["a", "b"] }]    # as `read` prints them, in place of words

    [[path]]
    person = "a"
    points = [[8.5, 0, 0], [13, -3, -2]]    # seconds, x, z, and a heading in degrees if it matters
"""

from __future__ import annotations

import difflib
import json
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from motion import Duet, InputError
from motion.formats import read
from webdemo.inference.actor import ROLES
from webdemo.inference.methods import method
from webdemo.inference.requests import SamplingRequest

from .beats import MOST_BEATS, Beat
from .request import SceneRequest, beat_of, path_of
from .scripting import split_sentence
from .toml_outline import Lines, check_outline
from .wishes import MOST_POINTS, MOST_POSES, FloorPath, Pose

MOST_CHARACTERS = 150_000
"""Of a story in TOML; the longest there is, with all its paths and poses written in full, has fewer."""
_LOOKS_LIKE_TOML = re.compile(r"^[ \t]*+(?:\[\[?[ \t]*\w++[ \t]*\]|\w++[ \t]*=)", re.MULTILINE)
_NUMBER, _TEXT = (int, float), (str,)
_TOP: dict[str, tuple[type, ...]] = {
    "seed": (int,), "samples": (int,), "guidance": _NUMBER, "steps": (int,), "damping": _NUMBER, "sampler": _TEXT,
    "model": _TEXT, "cleanup": (bool,), "tries": (int,), "loop": (bool,),
    "planned": (bool,), "beat": (list,), "path": (list,), "pose": (list,),
}  # fmt: skip
_BEAT: dict[str, tuple[type, ...]] = {
    "words": _TEXT,
    "a": _TEXT,
    "b": _TEXT,
    "seconds": _NUMBER,
    "seed": (int,),
    "acts": (list,),
}
_PATH: dict[str, tuple[type, ...]] = {"person": _TEXT, "points": (list,)}
_POSE: dict[str, tuple[type, ...]] = {
    "person": _TEXT, "seconds": _NUMBER, "file": _TEXT, "frame": (int,), "of": _TEXT, "positions": (list,),
}  # fmt: skip
_TABLES = {"beat": (_BEAT, MOST_BEATS), "path": (_PATH, len(ROLES)), "pose": (_POSE, MOST_POSES)}
"""The keys of each table, and how many of it a story may have."""
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
    check_outline(text, sum(most for _, most in _TABLES.values()))
    try:
        found = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"The story is no valid TOML: {_sentence(error)}") from None
    except RecursionError:
        raise InputError("The story is no valid TOML: its lists are nested too deeply.") from None
    lines = Lines(text)
    _check_keys(found, _TOP, lines, "", 0, "a story")
    for table, (known, most) in _TABLES.items():
        entries = found.get(table, ())
        if len(entries) > most:
            raise InputError(f"The story has {len(entries)} {table}s: keep to {most} or fewer.")
        for i, entry in enumerate(entries):
            if not isinstance(entry, Mapping):
                raise InputError(f"{lines.where('', 0, table)}{table} must be written as [[{table}]].")
            _check_keys(entry, known, lines, table, i, f"a {table}")
    plain = {f.name: found[f.name] for f in fields(SamplingRequest) if f.name in found}
    return plain | {
        "beats": tuple(_beat(entry, i, lines) for i, entry in enumerate(found.get("beat", ()))),
        "paths": tuple(_path(entry, i, lines) for i, entry in enumerate(found.get("path", ()))),
        "poses": tuple(_pose(entry, i, lines, folder) for i, entry in enumerate(found.get("pose", ()))),
        "loop": found.get("loop", False),
        "planned": found.get("planned", SceneRequest.planned),
    }


def read_words(text: str, go_on: Callable[[], None] = lambda: None) -> dict[str, Any]:
    """The fields that a text sets: a story in TOML, or plain sentences, which are split into beats.

    ``go_on`` is called before each sentence; what it raises ends the reading.

    Raises:
        InputError: as :func:`read_story`.
    """
    if _LOOKS_LIKE_TOML.search(text[:MOST_CHARACTERS]):
        return read_story(text)
    return {"beats": split_sentence(text, go_on)}


def write_story(request: SceneRequest) -> str:
    """A story as TOML text that :func:`read_story` reads as the same fields; a given motion is not part of it."""
    out = [f"seed = {request.seed}"]
    for f in fields(SamplingRequest):
        value = getattr(request, f.name)
        default = method(request.model, "scene").steps if f.name == "steps" else f.default
        if f.name != "seed" and value != default:
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
    if beat.acts:
        out += ["acts = [", *(f"  {_inline(act)}," for act in beat.to_dict()["acts"]), "]"]
    return out


def _inline(value: Any) -> str:
    """A value as TOML on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_inline(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    return _quoted(value) if isinstance(value, str) else json.dumps(value)


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


def _check_keys(
    found: Mapping[str, Any],
    known: Mapping[str, tuple[type, ...]],
    lines: Lines,
    table: str,
    index: int,
    what: str,
) -> None:
    for key, value in found.items():
        if key not in known:
            where = lines.where(table, index, key)
            near = difflib.get_close_matches(key[:40], known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it takes {', '.join(known)}."
            raise InputError(f"{where}there is no key {key!r:.40} in {what}; {hint}" if where else
                             f"There is no key {key!r:.40} in {what}; {hint}")  # fmt: skip
        kinds = known[key]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            wanted = _KINDS[kinds[-1]]
            raise InputError(f"{lines.where(table, index, key)}{key} must be {wanted}, not {value!r:.40}.")


def _beat(entry: Mapping[str, Any], index: int, lines: Lines) -> Beat:
    try:
        return beat_of(entry)
    except InputError as error:
        raise InputError(f"{lines.where('beat', index, 'acts')}{error}") from None


def _path(entry: Mapping[str, Any], index: int, lines: Lines) -> FloorPath:
    points = entry.get("points", [])
    where = lines.where("path", index, "points") or "A path: "
    if len(points) > MOST_POINTS:
        raise InputError(f"{where}there are {len(points)} points: keep to {MOST_POINTS} or fewer.")
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


def _pose(entry: Mapping[str, Any], index: int, lines: Lines, folder: Path | None) -> Pose:
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
