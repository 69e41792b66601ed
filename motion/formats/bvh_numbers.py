"""The numbers of a BVH file's MOTION part, block after block, so that they are never held at once."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .bvh_hierarchy import Joint
from .files import MAX_NUMBERS, check_duration

Array = NDArray[np.floating]

_PIECE = 2**20
_LARGEST = 1e7
_BLANK = re.compile(rb"\s*+")
_HEAD = re.compile(
    rb"Frames:[ \t]*+(\S{1,99}+)[ \t]*+\r?\n\s*+Frame[ \t]++Time:[ \t]*+(\S{1,99}+)[ \t]*+(?:\r?\n|$)", re.IGNORECASE
)


@dataclass(frozen=True)
class Motion:
    """Position of a file's numbers, and their header.

    Attributes:
        data: the file, in an encoding that writes numbers as ASCII does.
        start: of the numbers.
        frames: of ``width`` numbers each.
        fps: frames a second.
    """

    data: bytes
    start: int
    frames: int
    width: int
    fps: float
    joints: list[Joint]
    label: str

    def blocks(self) -> Iterator[Array]:
        """Blocks (n, width) of all frames in their order, each of about a megabyte of the file.

        Raises:
            InputError: if a number is missing, wrong or not usable.
        """
        short = (
            f"{self.label} is cut short: it says {self.frames} frames of {self.width} numbers but holds {{}} "
            "whole frames: export it again."
        )
        if self.frames * self.width > (len(self.data) - self.start + 1) // 2:  # a digit and a space each
            raise InputError(short.format("fewer"))
        start, done = self.start, 0
        rest: NDArray[np.floating] = np.empty(0)
        while done < self.frames and start < len(self.data):
            stop = _piece_end(self.data, start)
            try:
                found = _numbers(self.data[start:stop], self.width)
            except ValueError:
                raise InputError(self._bad_word(start, stop, done * self.width + len(rest))) from None
            found = np.concatenate([rest, found]) if len(rest) else found
            whole = min(len(found) // self.width, self.frames - done)
            block, rest = found[: whole * self.width].reshape(whole, self.width), found[whole * self.width :]
            if not np.abs(block).max(initial=0) <= _LARGEST:
                frame, column = np.argwhere(~(np.abs(block) <= _LARGEST))[0]
                joint = _joint_of_column(self.joints, column)
                raise InputError(
                    f"{self.label}: joint {joint} has no usable number in frame {done + frame + 1}: remove that frame."
                )
            start, done = stop, done + whole
            if whole:
                yield block
        if done < self.frames:
            raise InputError(short.format(done))

    def _bad_word(self, start: int, stop: int, count: int) -> str:
        """The first word of a piece that is no number, with its line; ``count`` numbers came before it."""
        number = self.data.count(b"\n", 0, start)
        for line in self.data[start:stop].split(b"\n"):
            number += 1
            for word in line.split():
                try:
                    float(word)
                except ValueError:
                    joint = _joint_of_column(self.joints, count % self.width)
                    shown = word[:20].decode("latin-1")
                    return f"{self.label}, line {number}: {shown!r} ({joint}) is not a number: export it again."
                count += 1
        return f"{self.label}, line {number}: something here is not a number: export it again."


def find_motion(data: bytes, start: int, joints: list[Joint], label: str, file_fps: float | None = None) -> Motion:
    """The MOTION part whose head is at ``start``; a given rate stands for the file's, whatever that says.

    Raises:
        InputError: if the head is missing or says what cannot be.
    """
    blank = _BLANK.match(data, start)
    assert blank is not None  # nothing is blank, too
    head = _HEAD.match(data, blank.end())
    if not head:
        raise InputError(f"{label}: after MOTION there must be the lines 'Frames: N' and 'Frame Time: SECONDS'.")
    count, seconds = (words[:20].decode("latin-1") for words in head.groups())
    try:
        frames, frame_time = int(count), float(seconds.replace(",", "."))
    except ValueError:
        raise InputError(f"{label}: Frames {count!r} or Frame Time {seconds!r} is not a number.") from None
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    if file_fps is None and not 1e-4 < frame_time <= 1.0:
        raise InputError(
            f"{label}: a Frame Time of {frame_time:g} s is not possible, 0.0333 is usual: give its true rate."
        )
    fps = file_fps or _frame_rate(frame_time)
    check_duration(frames, fps, label)
    width = sum(len(joint.channels) for joint in joints)
    if width == 0:
        raise InputError(f"{label}: no joint has CHANNELS, so nothing moves: export it with its animation.")
    if frames * width > MAX_NUMBERS:
        raise InputError(f"{label} holds {frames * width:,} numbers, too many: lower its frame rate.")
    return Motion(data, head.end(), frames, width, fps, joints, label)


def _frame_rate(frame_time: float) -> float:
    """Frames a second; files round the frame time, so a rate within 0.05 % of a whole one is that one."""
    rate = 1.0 / frame_time
    return float(round(rate)) if abs(rate - round(rate)) < 5e-4 * rate else round(rate, 4)


def _numbers(piece: bytes, width: int) -> Array:
    """(N,) the numbers of a piece; raises ValueError if something is none.

    A line a frame, as nearly all programs write it, goes through pandas, which is five times as fast as
    NumPy; whatever else is parsed by NumPy, which knows no lines. Pandas makes a column of every word of the
    first line, so that a long one would cost seconds and hundreds of megabytes.
    """
    import pandas

    if piece.isspace():  # of which NumPy makes a number
        return np.empty(0)
    first_line = re.split(rb"[\r\n]", piece.lstrip(), maxsplit=1)[0]
    if len(first_line.split(None, width)) != width:
        return np.fromstring(piece, dtype=np.float64, sep=" ")
    try:
        table = pandas.read_csv(
            io.BytesIO(piece),
            sep=r"\s+",
            header=None,
            index_col=False,
            dtype=np.float64,
            engine="c",
            na_filter=False,
            quoting=csv.QUOTE_NONE,
        ).to_numpy()
        if table.shape[1] == width and np.isfinite(table).all():
            return table.reshape(-1)
    except (ValueError, OverflowError):  # pandas' own errors are ValueErrors
        pass
    return np.fromstring(piece, dtype=np.float64, sep=" ")


def _piece_end(data: bytes, start: int) -> int:
    """End of a piece of about a megabyte: after a line, or after a word if lines are longer."""
    if start + _PIECE >= len(data):
        return len(data)
    for separator in (b"\n", b" "):
        found = data.rfind(separator, start, start + _PIECE)
        if found >= 0:
            return found + 1
    return start + _PIECE


def _joint_of_column(joints: list[Joint], column: int) -> str:
    for joint in joints:
        if column < len(joint.channels):
            return joint.name
        column -= len(joint.channels)
    return joints[-1].name
