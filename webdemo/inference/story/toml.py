"""Stories as TOML text, read with errors that name the line and the key.

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
from pathlib import Path
from typing import Any

import numpy as np

from motion import InputError
from motion.formats import read
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import FloorPath, path_of

from .beats import MOST_BEATS, Beat, beat_of
from .poses import MOST_POSES, Pose
from .request import SceneRequest
from .sentences import split_sentence

MOST_CHARACTERS = 150_000
"""Of a story in TOML; the longest there is, with all its paths and poses written in full, has fewer."""
_ASIDE = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+"{3,5}'
    r"|'''(?:[^']|'(?!''))*+'{3,5}"
    r'|"(?:[^"\\\n]|\\[^\n])*+"'
    r"|'[^'\n]*+'|#[^\n]*+",
    re.DOTALL,
)
"""Strings and comments."""
_TOO_LONG = re.compile(r'[\w+-]{101}|(?<![\w"-])[\w"-]++(?:[ \t]*+\.[ \t]*+[\w"-]++){8}')
"""Words longer than any key or number of a story, and keys of more parts."""
_HEADER = re.compile(r"^\s*\[\[?\s*\"?([\w-]+)\"?\s*\]\]?")
_KEY = re.compile(r"^\s*(?:\"([^\"]*)\"|'([^']*)'|([\w-]+))\s*[.=]")
_LOOKS_LIKE_TOML = re.compile(r"^[ \t]*+(?:\[\[?[ \t]*\w++[ \t]*\]|\w++[ \t]*=)", re.MULTILINE)
_NUMBER, _TEXT = (int, float), (str,)
_TYPES: dict[Any, tuple[type, ...]] = {"int": (int,), "float": _NUMBER, "str": _TEXT, "bool": (bool,)}


def _plain(of: type[SceneRequest] | type[Beat]) -> dict[str, tuple[type, ...]]:
    """The fields of a dataclass that are numbers, texts and marks, with what they may be."""
    named = {f.name: str(f.type).removesuffix(" | None") for f in fields(of)}
    return {name: _TYPES[kind] for name, kind in named.items() if kind in _TYPES}


_SETTINGS = {name: kinds for name, kinds in _plain(SceneRequest).items() if name not in ("start", "end")}
_BEAT = _plain(Beat) | {"acts": (list,)}
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
_TOP = _SETTINGS | dict.fromkeys(_TABLES, (list,))
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
    _check_words(text)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"The story is not valid TOML: {_sentence(error)}") from None
    except RecursionError:
        raise InputError("The story is not valid TOML: its lists are nested too deeply.") from None
    lines = Lines(text)
    _check_keys(tables, _TOP, lines, "", 0, "a story")
    for table, (known, most) in _TABLES.items():
        entries = tables.get(table, ())
        if len(entries) > most:
            raise InputError(f"The story has {len(entries)} {table}s: keep to {most} or fewer.")
        for i, entry in enumerate(entries):
            if not isinstance(entry, Mapping):
                raise InputError(f"{lines.where('', 0, table)}{table} must be written as [[{table}]].")
            _check_keys(entry, known, lines, table, i, f"a {table}")
    given = {name: tables[name] for name in _SETTINGS if name in tables}
    return (
        {"loop": SceneRequest.loop, "planned": SceneRequest.planned}
        | given
        | {
            "beats": tuple(_beat(entry, i, lines) for i, entry in enumerate(tables.get("beat", ()))),
            "paths": tuple(_path(entry, i, lines) for i, entry in enumerate(tables.get("path", ()))),
            "poses": tuple(_pose(entry, i, lines, folder) for i, entry in enumerate(tables.get("pose", ()))),
        }
    )


def read_words(text: str, go_on: Callable[[], None] = lambda: None) -> dict[str, Any]:
    """The fields that a text sets: a story in TOML, or plain sentences, which are split into beats.

    ``go_on`` is called before each sentence; what it raises ends the reading.

    Raises:
        InputError: as :func:`read_story`.
    """
    if _LOOKS_LIKE_TOML.search(text[:MOST_CHARACTERS]):
        return read_story(text)
    return {"beats": split_sentence(text, go_on)}


def _sentence(error: Exception) -> str:
    words = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)|\(at end of document\)", words)
    said = words[: place.start()].strip() if place else words
    where = f"line {place[1]}, column {place[2]}" if place and place[1] else "its end"
    return f"{where}: {said[:1].lower()}{said[1:200]}."


def _check_keys(
    row: Mapping[str, Any], known: Mapping[str, tuple[type, ...]], lines: Lines, table: str, index: int, what: str
) -> None:
    for key, value in row.items():
        if key not in known:
            where = lines.where(table, index, key)
            near = difflib.get_close_matches(key[:40], known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it takes {', '.join(known)}."
            raise InputError(f"{where}{'there' if where else 'There'} is no key {key!r:.40} in {what}; {hint}")
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
    where = lines.where("path", index, "points") or "A path: "
    try:
        return path_of(entry)
    except InputError as error:
        raise InputError(f"{where}{error}") from None


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
    people = read(folder / entry["file"]).people
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


def _check_words(text: str) -> None:
    """Raises InputError for a text with a longer word or key than a story can have.

    `tomllib` takes quadratic time and memory for a key of many parts, so a stranger's text is looked through before it
    is parsed.
    """
    outline = _ASIDE.sub(lambda match: '""' + "\n" * match[0].count("\n"), text)
    if match := _TOO_LONG.search(outline):
        line = outline.count("\n", 0, match.start()) + 1
        raise InputError(f"Line {line}: {match[0][:20]!r} … is longer than any key or number of a story: shorten it.")


class Lines(dict[tuple[str, int, str], int]):
    """The first line of each (table, index of its entry, key) of a text; a table's own name is a key of the text.

    Args:
        text: valid TOML.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        current, counts = "", {"": 0}
        for number, line in enumerate(text.splitlines(), 1):
            if header := _HEADER.match(line):
                current = header[1]
                counts[current] = counts.get(current, -1) + 1
                self.setdefault(("", 0, current), number)
            elif key := _KEY.match(line):
                self.setdefault((current, counts[current], key[1] or key[2] or key[3] or ""), number)

    def where(self, table: str, index: int, key: str) -> str:
        """``"Line 4: "`` for a key of the table's ``index``-th entry; "" if it is not found."""
        line = self.get((table, index, key))
        return f"Line {line}: " if line else ""
