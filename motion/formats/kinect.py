"""Kinect recordings as text: NTU RGB+D's ``.skeleton`` (25 joints), SBU's ``skeleton_pos.txt`` (15 joints).

``.skeleton`` (Shahroudy et al. 2016) holds a count of frames; for every frame a count of bodies; for every
body a line that begins with its id, a count of joints, and a line a joint that begins with x, y, z in metres
of the camera's frame. SBU's text (Yun et al. 2012) holds a line a frame: its number, then 15 joints of each
of two people as x, y, z between 0 and 1, separated by commas.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip
from motion.errors import InputError
from motion.skeleton import NTU25, SBU15, Skeleton

from .crowd import Motion, gathered
from .files import MAX_FRAMES, check_duration, decode_text, read_bytes

Array = NDArray[np.floating]

SKELETON_FPS = 30.0
SBU_FPS = 15.0
_MAX_BODIES = 6
"""As many as a Kinect v2 tracks."""
_LONGEST_LINE = 4000
_MOST_LINES = 4_000_000
_MOST_IDENTITIES = 200
_FARTHEST = 100.0  # metres


def read_kinect(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    """Reads either kind of Kinect text; the contents show which.

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: frames a second; 30 for ``.skeleton`` and 15 for SBU's text by default, as the files have none.
        everyone: return all people instead of the two seen longest.

    Returns:
        the person, or the two who are seen longest (or everybody, the longest first), in metres and Y up;
        frames in which one of them is not seen are interpolated.

    Raises:
        InputError: one sentence with the line where the file is wrong.
    """
    data, label = read_bytes(source, name)
    text = decode_text(data, label, "Kinect text")
    del data
    first = next((line for _, line in _lines(text, label)), "")
    if "," in first:
        positions = _read_sbu(text, label, fps or SBU_FPS)
        return _motion(positions, fps or SBU_FPS, SBU15, label, everyone)
    if re.fullmatch(r"\s*\d{1,9}\s*", first):
        positions = _read_skeleton(text, label, fps or SKELETON_FPS)
        return _motion(positions if everyone else positions[:2], fps or SKELETON_FPS, NTU25, label, everyone)
    raise InputError(
        f"{label} is not Kinect text: it begins neither with a count of frames (.skeleton) nor with SBU's "
        "numbers between commas."
    )


def _lines(text: str, label: str) -> Iterator[tuple[int, str]]:
    """(number from 1, line) of the lines that hold something, cut out one at a time."""
    ending = "\n" if "\n" in text else "\r"
    start, number = 0, 0
    while start < len(text):
        number += 1
        stop = text.find(ending, start)
        stop = len(text) if stop < 0 else stop
        if stop - start > _LONGEST_LINE:
            raise InputError(
                f"{label}, line {number} is too long for a Kinect's text: is it of another kind?"
            )
        if number > _MOST_LINES:
            raise InputError(f"{label} has more than {_MOST_LINES:,} lines: cut the motion.")
        line = text[start:stop]
        start = stop + 1
        if line and not line.isspace():
            yield number, line


def _motion(people: list[Array], fps: float, skeleton: Skeleton, label: str, everyone: bool) -> Motion:
    if any(np.abs(person).max() > _FARTHEST for person in people):
        raise InputError(f"{label} holds joints more than {_FARTHEST:g} m away: is it of another kind?")
    try:
        clips = tuple(Clip(person, fps, skeleton, name=label) for person in people)
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
    return gathered(clips, label, everyone=everyone)


# ---- SBU ---------------------------------------------------------------------------------------------


def _read_sbu(text: str, label: str, fps: float) -> list[Array]:
    rows = np.empty((min(text.count("\n" if "\n" in text else "\r"), MAX_FRAMES) + 1, 90), dtype=np.float32)
    frames = 0
    for number, line in _lines(text, label):
        check_duration(frames + 1, fps, label)
        words = line.split(",")
        if len(words) not in (90, 91):
            raise InputError(
                f"{label}, line {number}: {len(words)} numbers where a frame's number and 90 are needed."
            )
        rows[frames] = _numbers(words[-90:], f"{label}, line {number}")
        frames += 1
    x, y, z = rows[:frames].reshape(-1, 2, 15, 3).transpose(3, 1, 0, 2)
    metres = np.stack([(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125], axis=-1)
    # A body that is not tracked is all zeros in the file.
    return [person for person, seen in zip(metres, (x != 0).any((1, 2)), strict=True) if seen] or [metres[0]]


def _numbers(words: list[str], where: str) -> Array:
    try:
        values = np.array([float(word) for word in words])
    except ValueError:
        wrong = next(word for word in words if not _is_number(word))
        raise InputError(f"{where}: {wrong.strip()[:20]!r} is not a number: export it again.") from None
    if not np.isfinite(values).all():
        raise InputError(f"{where} holds NaN or an infinite number: remove that frame.")
    return values


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


# ---- NTU RGB+D ---------------------------------------------------------------------------------------


class _Lines:
    """The lines of a file one after the other, with their numbers for messages."""

    def __init__(self, text: str, label: str) -> None:
        self.lines, self.label, self.number = _lines(text, label), label, 0

    @property
    def where(self) -> str:
        return f"{self.label}, line {self.number}"

    def words(self, most: int = -1) -> list[str]:
        """The next line's words, of which the first ``most`` are wanted; raises InputError at the end."""
        found = next(self.lines, None)
        if found is None:
            raise InputError(f"{self.label} is cut short at line {self.number}: export it again.")
        self.number, line = found
        return line.split(None, most)

    def joints(self) -> Array:
        """(25, 3) float32: the first three numbers of as many lines."""
        rows: list[tuple[int, list[str]]] = []
        try:
            for _ in range(25):
                words = self.words(3)[:3]
                if len(words) < 3:
                    raise InputError(f"{self.where}: a joint needs x, y and z.")
                rows.append((self.number, words))
            places = np.array([[float(x), float(y), float(z)] for _, (x, y, z) in rows])
            if not np.isfinite(places).all():
                raise ValueError
            return places.astype(np.float32)
        except ValueError:  # includes InputError; report the first error in the file
            for number, words in rows:
                _numbers(words, f"{self.label}, line {number}")
            raise

    def count(self, what: str, largest: int) -> int:
        """A line that holds one whole number."""
        words = self.words()
        if len(words) != 1 or not re.fullmatch(r"\d{1,9}", words[0]) or int(words[0]) > largest:
            raise InputError(
                f"{self.where}: the number of {what} must stand here, from 0 to {largest}, "
                f"not {' '.join(words)[:30]!r}."
            )
        return int(words[0])


def _read_skeleton(text: str, label: str, fps: float) -> list[Array]:
    """(T, 25, 3) of every body that is seen at least half as long as the longest, which comes first."""
    reader = _Lines(text, label)
    frames = reader.count("frames", 999_999_999)
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    check_duration(frames, fps, label)
    bodies: dict[str, dict[int, Array]] = defaultdict(dict)
    for frame in range(frames):
        for _ in range(reader.count("bodies", _MAX_BODIES)):
            identity = (reader.words() or [""])[0]
            if reader.count("joints", 25) != 25:
                raise InputError(f"{reader.where}: a body of {label} must have 25 joints.")
            joints = reader.joints()
            if identity not in bodies and len(bodies) >= _MOST_IDENTITIES:
                raise InputError(f"{reader.where}: more than {_MOST_IDENTITIES} bodies come and go: cut it.")
            bodies[identity][frame] = joints
    if not bodies:
        raise InputError(f"{label} holds no body in any of its frames: record it again.")
    longest = sorted(bodies.values(), key=len, reverse=True)[:_MAX_BODIES]
    # A second body that is seen for a moment is a chair or a ghost.
    kept = [body for body in longest if len(body) >= 0.5 * len(longest[0])]
    return [_filled(body, frames) for body in kept]


def _filled(body: dict[int, Array], frames: int) -> Array:
    """(frames, 25, 3) with frames that lack the body interpolated, and held at the ends."""
    seen = np.array(sorted(body))
    known = np.stack([body[frame] for frame in seen]).reshape(len(seen), -1)
    columns = [np.interp(np.arange(frames), seen, column) for column in known.T]
    return np.stack(columns, axis=1).reshape(frames, 25, 3)
