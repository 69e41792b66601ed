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
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from motion import Duet, InputError
from motion.formats import read
from webdemo.inference.methods import method
from webdemo.inference.requests import SamplingRequest
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import MOST_POINTS, FloorPath, FloorPoint, path_of

from .beats import MOST_BEATS, Beat, beat_of
from .poses import MOST_POSES, Pose
from .request import SceneRequest
from .sentences import split_sentence

MOST_CHARACTERS = 150_000
"""Of a story in TOML; the longest there is, with all its paths and poses written in full, has fewer."""
MOST_DEEP = 8
"""Lists and tables in each other; a story has three."""
MOST_PARTS = 8
"""Parts of a dotted key; a story's keys have one."""
LONGEST_WORD = 100
"""Characters of a number or a bare key."""
_TOKEN = re.compile(
    r'(?P<text>"""(?:[^"\\]|\\.|"(?!""))*+"{3,5}'
    r"|'''(?:[^']|'(?!''))*+'{3,5}"
    r'|"(?:[^"\\\n]|\\[^\n])*+"'
    r"|'[^'\n]*+')"
    r"|(?P<comment>#[^\n]*+)|(?P<space>[ \t\r]++)|(?P<word>[\w+-]++)|(?P<sign>.)",
    re.DOTALL,
)
_HEADER = re.compile(r"^\s*\[\[?\s*\"?([\w-]+)\"?\s*\]\]?")
_KEY = re.compile(r"^\s*(?:\"([^\"]*)\"|'([^']*)'|([\w-]+))\s*[.=]")
_LOOKS_LIKE_TOML = re.compile(r"^[ \t]*+(?:\[\[?[ \t]*\w++[ \t]*\]|\w++[ \t]*=)", re.MULTILINE)
_NUMBER, _TEXT = (int, float), (str,)
_TOP: dict[str, tuple[type, ...]] = {
    "seed": (int,),
    "samples": (int,),
    "guidance": _NUMBER,
    "steps": (int,),
    "damping": _NUMBER,
    "sampler": _TEXT,
    "model": _TEXT,
    "cleanup": (bool,),
    "tries": (int,),
    "loop": (bool,),
    "planned": (bool,),
    "strictness": _NUMBER,
    "beat": (list,),
    "path": (list,),
    "pose": (list,),
}
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
    "person": _TEXT,
    "seconds": _NUMBER,
    "file": _TEXT,
    "frame": (int,),
    "of": _TEXT,
    "positions": (list,),
}
_TABLES = {"beat": (_BEAT, MOST_BEATS), "path": (_PATH, len(ROLES)), "pose": (_POSE, MOST_POSES)}
"""The keys of each table, and how many of it a story may have."""
_KINDS = {str: "text in quotes", int: "a whole number", float: "a number", bool: "true or false", list: "a list"}


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
        "strictness": found.get("strictness", SceneRequest.strictness),
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
    story = tomlkit.document()
    story["seed"] = request.seed
    for f in fields(SamplingRequest):
        value = getattr(request, f.name)
        default = method(request.model, "scene").steps if f.name == "steps" else f.default
        if f.name != "seed" and value != default:
            story[f.name] = value
    if not request.planned:
        story["planned"] = False
    if request.strictness != SceneRequest.strictness:
        story["strictness"] = request.strictness
    if request.loop:
        story["loop"] = True
    tables = {
        "beat": [_beat_table(beat) for beat in request.beats],
        "path": [{"person": path.person, "points": list(map(_point, path.points))} for path in request.paths],
        "pose": [
            {"person": p.person, "seconds": p.seconds, "positions": np.asarray(p.positions).tolist()}
            for p in request.poses
        ],
    }
    return tomlkit.dumps({**story, **{name: listed for name, listed in tables.items() if listed}})


def _point(p: FloorPoint) -> list[float] | dict[str, float]:
    """A point as a row, or with its names where a row would not say what it is."""
    row = {name: value for name in ("seconds", "x", "z", "heading") if (value := getattr(p, name)) is not None}
    if p.seconds is None and p.heading is not None:
        return row
    return [round(value, 4) if p.seconds is not None else value for value in row.values()]


def _beat_table(beat: Beat) -> dict[str, Any]:
    table: dict[str, Any] = {name: value for name in ("words", "a", "b") if (value := getattr(beat, name))}
    if beat.seconds is not None:
        whole = float(beat.seconds).is_integer()
        table["seconds"] = int(beat.seconds) if whole else beat.seconds
    if beat.seed is not None:
        table["seed"] = beat.seed
    if beat.acts:
        acts = table["acts"] = tomlkit.array().multiline(True)
        for act in beat.to_dict()["acts"]:
            row = tomlkit.inline_table()
            row.update(act)
            acts.append(row)
    return table


def _sentence(error: Exception) -> str:
    words = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)|\(at end of document\)", words)
    said = words[: place.start()].strip() if place else words
    where = f"line {place[1]}, column {place[2]}" if place and place[1] else "its end"
    return f"{where}: {said[:1].lower()}{said[1:200]}."


def _check_keys(
    found: Mapping[str, Any], known: Mapping[str, tuple[type, ...]], lines: Lines, table: str, index: int, what: str
) -> None:
    for key, value in found.items():
        if key not in known:
            where = lines.where(table, index, key)
            near = difflib.get_close_matches(key[:40], known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it takes {', '.join(known)}."
            raise InputError(
                f"{where}there is no key {key!r:.40} in {what}; {hint}"
                if where
                else f"There is no key {key!r:.40} in {what}; {hint}"
            )
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
        raise InputError(f"{where}a file is only read from the shell: give the positions of the pose in the story.")
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


# ---- the outline -----------------------------------------------------------------------------------------
def check_outline(text: str, most_tables: int) -> None:
    """Raises InputError for a text with more tables, or keys and lists in each other, than a story can have.

    `tomllib` takes quadratic time for a key of many parts and has no limits, so a stranger's text is looked through
    once, in linear time, before it is parsed.

    Args:
        text: TOML, valid or not.
        most_tables: table headers, as ``[[beat]]``.
    """
    line, tables, depth, dots, begins = 1, 0, 0, 0, True
    for token in _TOKEN.finditer(text):
        kind, found = token.lastgroup, token[0]
        line += found.count("\n") if kind in ("text", "sign") else 0
        if kind == "word" and len(found) > LONGEST_WORD:
            raise InputError(f"Line {line}: {found[:20]!r} … is longer than any key or number: shorten it.")
        if kind == "sign" and found == ".":
            dots += 1
            if dots >= MOST_PARTS:
                raise InputError(f"Line {line}: a key has {dots + 1} parts or more: a story's keys have one.")
        elif kind == "sign":
            dots = 0
        if kind == "sign" and found in "[{":
            tables += found == "[" and begins
            depth += 1
            if tables > most_tables:
                raise InputError(f"The story has more than {most_tables} tables, more than any scene can: shorten it.")
            if depth > MOST_DEEP:
                raise InputError("The story is no valid TOML: its lists are nested too deeply.")
        elif kind == "sign" and found in "]}":
            depth = max(depth - 1, 0)
        if kind not in ("space", "comment"):
            begins = found == "\n" and not depth


class Lines:
    """The lines of a text's keys.

    Args:
        text: valid TOML.
    """

    def __init__(self, text: str) -> None:
        self.text = text

    def where(self, table: str, index: int, key: str) -> str:
        """``"Line 4: "`` for a key of the table's ``index``-th entry; "" if it is not found."""
        line = self._found.get((table, index, key))
        return f"Line {line}: " if line else ""

    @cached_property
    def _found(self) -> dict[tuple[str, int, str], int]:
        """The first line of each (table, index of its entry, key); a table's own name is a key of the text."""
        found: dict[tuple[str, int, str], int] = {}
        current, counts = "", {"": 0}
        for number, line in enumerate(self.text.splitlines(), 1):
            if header := _HEADER.match(line):
                current = header[1]
                counts[current] = counts.get(current, -1) + 1
                found.setdefault(("", 0, current), number)
            elif key := _KEY.match(line):
                found.setdefault((current, counts[current], key[1] or key[2] or key[3] or ""), number)
        return found
