"""Pages of blind pairs: two motions with bodies above each other, drawn so that nothing tells them apart but motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion import Duet
from motion.transforms import turn
from webdemo.view.camera import cameras
from webdemo.view.stage import Pane, Picture, Stage, Style, paste, words

_COLUMNS, _ROWS = 5, 2
_TILE = (320, 300)
"""Pixels of a moment."""
_TOP = (160, 160)
"""Pixels of a moment from above, all of which stand in one row; these cameras stay where they are."""
_SMALL = 15


def pair_page(title: str, motions: Sequence[Duet]) -> Image.Image:
    """The moments of each motion, numbered from 1, in two rows with bodies and in a row from above.

    Only positions are drawn: things, finger shapes and looks, which not every lab makes, are left out. Each
    motion is turned so that it is seen from the same side of its people.
    """
    style = Style(names=False)
    parts = [_line(title, style)]
    for number, motion in enumerate(motions, start=1):
        parts += [_line(f"{number}", style), _moments(aligned(motion), style)]
    return Image.fromarray(np.concatenate(parts)).convert("RGB")


def aligned(motion: Duet) -> Duet:
    """The bare positions with the first frame's people about the origin and b from a along +Z."""
    positions = motion.positions.astype(np.float64)
    start = positions[:, 0, 0] * np.array([1.0, 0.0, 1.0])
    way = start[1] - start[0]
    placed = turn(positions - start.mean(axis=0), -float(np.arctan2(way[0], way[2])))
    return Duet.from_positions(placed, fps=motion.fps)


def _moments(motion: Duet, style: Style) -> Picture:
    frames = np.linspace(0, motion.num_frames - 1, _COLUMNS * _ROWS)
    times = np.round(frames) / motion.fps
    (views,) = cameras([motion], size=_TILE, times=times, around=0.0)
    pictures = [_edged(picture) for picture in Stage(Pane(motion), style, _TILE).pictures(times, views)]
    for picture, seconds in zip(pictures, times, strict=True):
        paste(picture, words(f"{seconds:.2f} s", style.colours.ink, 12), 5, 4)
    rows = [np.concatenate(pictures[i * _COLUMNS : (i + 1) * _COLUMNS], axis=1) for i in range(_ROWS)]
    (above,) = cameras([motion], size=_TOP, times=times, view="top", follow=False)
    small = np.concatenate(
        [_edged(picture) for picture in Stage(Pane(motion), style, _TOP).pictures(times, above)], axis=1
    )
    return np.concatenate([*rows, small])


def _edged(picture: Picture) -> Picture:
    """The picture with a white edge, so that people in neighbouring moments do not seem to meet."""
    picture[:, -2:, :3] = 255
    picture[-2:, :, :3] = 255
    return picture


def _line(text: str, style: Style) -> NDArray[np.uint8]:
    line = np.full((2 * _SMALL, _TILE[0] * _COLUMNS, 4), 255, dtype=np.uint8)
    line[..., :3] = [round(255 * c) for c in style.colours.horizon]
    paste(line, words(text, style.colours.ink, _SMALL), _SMALL // 2, _SMALL // 4)
    return line
