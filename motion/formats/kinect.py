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

import numpy as np

from motion.clip import Clip
from motion.errors import InputError
from motion.skeleton import NTU25, SBU15
from motion.smoothing import filled
from motion.vectors import Array

from .files import MAX_FRAMES, MAX_SECONDS, check_duration, text_bytes
from .recording import ImportChoices, Recording

Track = dict[int, Array]
"""(25, 3) joints of a body by frame."""

SKELETON_FPS = 30.0
SBU_FPS = 15.0
_MAX_BODIES = 6
"""As many as a Kinect v2 tracks."""
_LONGEST_LINE = 4000
_MOST_LINES = 4_000_000
_MOST_IDENTITIES = 200
_FARTHEST = 100.0  # metres
_NEAR = 2.0
"""Metres between the places where a body is lost and where it is found again, at most."""
_MENTIONED = 0.25
"""Seconds; a body that is not seen for longer is mentioned."""


def read_kinect(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """The people of either kind of Kinect text, those seen longest first, in metres; the contents show which kind.

    Frames in which a body or a joint is not seen are interpolated; a body that is lost and found again under another
    number is one. Notes say so. The rate is 30 frames a second for ``.skeleton`` and 15 for SBU's text, which do not
    give it.

    Raises:
        InputError: one sentence with the line where the file is wrong.
    """
    text = text_bytes(data, label, "Kinect text").decode("latin-1")
    del data
    first = next((line for _, line in _lines(text, label)), "")
    if "," in first:
        fps, skeleton = choices.fps or SBU_FPS, SBU15
        people: list[tuple[Array, tuple[str, ...]]] = [(its, ()) for its in _read_sbu(text, label, fps)]
    elif re.fullmatch(r"\s*\d{1,9}\s*", first):
        fps, skeleton = choices.fps or SKELETON_FPS, NTU25
        people = _read_skeleton(text, label, fps)
    else:
        raise InputError(
            f"{label} is not Kinect text: it begins neither with a count of frames (.skeleton) nor with SBU's "
            "numbers between commas."
        )
    if any(np.abs(positions).max() > _FARTHEST for positions, _ in people):
        raise InputError(f"{label} holds joints more than {_FARTHEST:g} m away: is it of another kind?")
    return Recording(tuple(Clip(its, fps, skeleton, name=label, notes=notes) for its, notes in people))


def _lines(text: str, label: str) -> Iterator[tuple[int, str]]:
    """(number from 1, line) of the lines that hold something, cut out one at a time."""
    start, number = 0, 0
    while start < len(text):
        number += 1
        stop = text.find("\n", start)
        stop = len(text) if stop < 0 else stop
        if stop - start > _LONGEST_LINE:
            raise InputError(f"{label}, line {number} is too long for a Kinect's text: is it of another kind?")
        if number > _MOST_LINES:
            raise InputError(f"{label} has more than {_MOST_LINES:,} lines: cut the motion.")
        line = text[start:stop]
        start = stop + 1
        if line and not line.isspace():
            yield number, line


# ---- SBU ---------------------------------------------------------------------------------------------


def _read_sbu(text: str, label: str, fps: float) -> list[Array]:
    most = min(text.count("\n"), MAX_FRAMES, int(MAX_SECONDS * fps))
    rows = np.empty((most + 1, 90), dtype=np.float32)
    frames = 0
    for number, line in _lines(text, label):
        check_duration(frames + 1, fps, label)
        words = line.split(",")
        if len(words) not in (90, 91):
            raise InputError(f"{label}, line {number}: {len(words)} numbers where a frame's number and 90 are needed.")
        rows[frames] = _numbers(words[-90:], f"{label}, line {number}")
        if not np.isfinite(rows[frames]).all():
            raise InputError(f"{label}, line {number} holds NaN or an infinite number: remove that frame.")
        frames += 1
    x, y, z = rows[:frames].reshape(-1, 2, 15, 3).transpose(3, 1, 0, 2)
    metres = np.stack([(1280 - 2560 * x) / 1000, (960 - 1920 * y) / 1000, 10 * z / 7.8125], axis=-1)
    # A body that is not tracked is all zeros in the file.
    return [person for person, seen in zip(metres, (x != 0).any((1, 2)), strict=True) if seen] or [metres[0]]


def _numbers(words: list[str], where: str) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        raise InputError(f"{where}: something is not a number: export it again.") from None


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
        following = next(self.lines, None)
        if following is None:
            raise InputError(f"{self.label} is cut short at line {self.number}: export it again.")
        self.number, line = following
        return line.split(None, most)

    def joints(self) -> Array:
        """(25, 3) float32: the first three numbers of as many lines, NaN for those that are not finite."""
        rows = []
        for _ in range(25):
            words = self.words(3)[:3]
            if len(words) < 3:
                raise InputError(f"{self.where}: a joint needs x, y and z.")
            rows.append(_numbers(words, self.where))
        places = np.array(rows, dtype=np.float32)
        return np.where(np.isfinite(places), places, np.float32("nan"))

    def count(self, what: str, largest: int) -> int:
        """A line that holds one whole number."""
        words = self.words()
        if len(words) != 1 or not re.fullmatch(r"\d{1,9}", words[0]) or int(words[0]) > largest:
            raise InputError(
                f"{self.where}: the number of {what} must stand here, from 0 to {largest}, "
                f"not {' '.join(words)[:30]!r}."
            )
        return int(words[0])


def _read_skeleton(text: str, label: str, fps: float) -> list[tuple[Array, tuple[str, ...]]]:
    """(T, 25, 3) and notes of every body that is seen at least half as long as the longest, which comes first."""
    reader = _Lines(text, label)
    frames = reader.count("frames", 999_999_999)
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    check_duration(frames, fps, label)
    bodies: dict[str, Track] = defaultdict(dict)
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
    longest = sorted(_joined(list(bodies.values())), key=len, reverse=True)
    # A second body that is seen for a moment is a chair or a ghost.
    kept = [body for body in longest[:_MAX_BODIES] if len(body) >= 0.5 * len(longest[0])]
    left_out = [len(body) / fps for body in longest[len(kept) :] if len(body) / fps > _MENTIONED]
    more = (f"{label}: a body seen for only {left_out[0]:.1f} s was left out.",) if left_out else ()
    people = []
    for letter, body in zip("ABCDEF", kept, strict=False):
        positions = np.full((frames, 25, 3), np.nan, dtype=np.float32)
        positions[list(body)] = list(body.values())
        people.append((filled(positions, label), (*_gap(body, frames, fps, f"{label}: person {letter}"), *more)))
    return people


def _joined(tracks: list[Track]) -> list[Track]:
    """The tracks of bodies; those that follow one another at one place are one, which was lost and found again."""
    people: list[Track] = []
    for track in sorted(tracks, key=min):
        before = [one for one in people if max(one) < min(track)]
        away = [float(np.linalg.norm(one[max(one)][0] - track[min(track)][0])) for one in before]
        if before and min(away) < _NEAR:
            before[int(np.argmin(away))].update(track)
        else:
            people.append(dict(track))
    return people


def _gap(body: Track, frames: int, fps: float, who: str) -> tuple[str, ...]:
    """A sentence on the longest time for which a body is not seen, if it is long enough to be noticed."""
    seen = np.array([-1, *sorted(body), frames])
    longest = int(np.argmax(np.diff(seen)))
    begin, end = int(seen[longest]) + 1, int(seen[longest + 1])
    if (end - begin) / fps < _MENTIONED:
        return ()
    there = "held still" if begin == 0 or end == frames else "interpolated"
    return (f"{who} is not seen from {begin / fps:.1f} to {end / fps:.1f} s and is {there} there.",)
