"""A motion as a figure for a paper: moments side by side on the ground, each as the player shows it, as PNG or PDF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.formats.files import replacing

from .camera import Camera, cameras
from .stage import Pane, Stage, Style, paste, words

Array = NDArray[np.floating]

SUFFIXES = (".png", ".pdf")
MOMENTS = (1, 24)
WIDTHS = (200, 8000)
WIDTH = 1600
_COLUMNS, _IN_ROW = 8, 6
_DPI = 300.0
"""Pixels an inch of a PDF."""
_TALL = 1.15
"""Height of a picture over its width."""


def chosen_frames(motion: Clip | Duet, frames: int | Sequence[int]) -> list[int]:
    """Evenly spaced frames including both ends, or the named ones in the given order.

    Raises:
        InputError: for no frames, more than 24, or one that the motion has not.
    """
    last = motion.num_frames - 1
    if isinstance(frames, int):
        if not MOMENTS[0] <= frames <= MOMENTS[1]:
            raise InputError(f"A contact sheet has {MOMENTS[0]} to {MOMENTS[1]} moments, not {frames}.")
        return np.unique(np.linspace(0, last, frames).round().astype(int)).tolist()
    found = [int(frame) for frame in frames]
    if not MOMENTS[0] <= len(found) <= MOMENTS[1]:
        raise InputError(f"A contact sheet has {MOMENTS[0]} to {MOMENTS[1]} moments, not {len(found)}.")
    if any(not 0 <= frame <= last for frame in found):
        raise InputError(f"The motion has frames 0 to {last}: choose among them.")
    return found


def write_sheet(
    motion: Clip | Duet,
    path: str | Path,
    *,
    frames: int | Sequence[int] = 8,
    width: int = WIDTH,
    title: str = "",
    style: Style | None = None,
    view: str = "threequarter",
) -> Path:
    """Writes moments of a motion, up to eight in a row, each with its time.

    Args:
        motion: one person or two.
        path: ends in .png or .pdf.
        frames: how many, evenly spaced, or which.
        width: of the whole in pixels.
        title: stands above.
        style: how people are drawn.
        view: one of :data:`~webdemo.view.camera.VIEWS`.

    Returns:
        the path.

    Raises:
        InputError: for what cannot be shown or written; no file is left.
    """
    path, style = Path(path), style or Style(names=False)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"Contact sheets end in .png or .pdf, not in {suffix or 'nothing'}.")
    if not WIDTHS[0] <= width <= WIDTHS[1]:
        raise InputError(f"A width of {width} is not possible: give {WIDTHS[0]} to {WIDTHS[1]}.")
    moments = chosen_frames(motion, frames)
    columns = min(len(moments), _COLUMNS)
    tile = (width // columns, round(width / columns * _TALL))
    times = np.arange(motion.num_frames) / motion.fps
    (views,) = cameras([motion], size=tile, times=times[moments], view=view, around=0.0)
    with replacing(path) as temporary:
        _sheet(motion, style, moments, views, tile, title).save(
            temporary, format=suffix[1:].upper(), resolution=_DPI, quality=95
        )
    return path


def write_grid_sheet(
    motions: Mapping[str, Clip | Duet], path: str | Path, *, title: str = "", style: Style | None = None
) -> Path:
    """Writes a row of moments for each of several motions, at the same times and from one side, as .png.

    They are evenly spaced over the longest motion; a shorter one rests in its last frame.

    Args:
        motions: by the name that stands over each row.
        path: ends in .png.
        title: stands above.
        style: how people are drawn.

    Raises:
        InputError: for no motions, or what cannot be written; no file is left.
    """
    path, style = Path(path), style or Style(names=False)
    if not motions or path.suffix.lower() != ".png":
        raise InputError("A sheet of several motions ends in .png and holds one motion or more.")
    tile = (WIDTH // _IN_ROW, round(WIDTH / _IN_ROW * _TALL))
    times = np.linspace(0.0, max((m.num_frames - 1) / m.fps for m in motions.values()), _IN_ROW)
    ways = cameras(list(motions.values()), size=tile, times=times, follow=False)
    rows = [_row(motion, name, style, times, own) for (name, motion), own in zip(motions.items(), ways, strict=True)]
    small = _text_size(tile)
    head = np.full((2 * small if title else 0, rows[0].shape[1], 4), 255, dtype=np.uint8)
    head[..., :3] = [round(255 * c) for c in style.colours.horizon]
    sheet = np.concatenate([head, *rows])
    if title:
        paste(sheet, words(title, style.colours.ink, small), small // 2, small // 4)
    with replacing(path) as temporary:
        Image.fromarray(sheet).convert("RGB").save(temporary, format="PNG")
    return path


def _row(motion: Clip | Duet, name: str, style: Style, times: Array, views: Sequence[Camera]) -> NDArray[np.uint8]:
    """Pictures of a motion beside each other, its name above and the times below."""
    tile, ink = views[0].size, style.colours.ink
    small = _text_size(tile)
    row = np.full((tile[1] + 4 * small, tile[0] * len(times), 4), 255, dtype=np.uint8)
    row[..., :3] = [round(255 * c) for c in style.colours.horizon]
    paste(row, words(name, ink, small), small // 2, small // 4)
    for place, picture in enumerate(Stage(Pane(motion), style, tile).pictures(times, views)):
        left = place * tile[0]
        row[2 * small : 2 * small + tile[1], left : left + tile[0]] = picture
        paste(row, words(f"{times[place]:.2f} s", ink, small), left + small // 2, tile[1] + 2 * small + small // 4)
    return row


def _places(count: int, tile: tuple[int, int], head: int) -> list[tuple[int, int]]:
    """The upper left corner of each picture; under each row is a line for the times."""
    foot = _text_size(tile) * 2
    return [(tile[0] * (i % _COLUMNS), head + (tile[1] + foot) * (i // _COLUMNS)) for i in range(count)]


def _text_size(tile: tuple[int, int]) -> int:
    return max(tile[0] // 16, 9)


def _whole(count: int, tile: tuple[int, int], head: int) -> tuple[int, int]:
    rows = -(-count // _COLUMNS)
    return tile[0] * min(count, _COLUMNS), head + rows * (tile[1] + _text_size(tile) * 2)


def _sheet(
    motion: Clip | Duet, style: Style, moments: list[int], views: list[Camera], tile: tuple[int, int], title: str
) -> Image.Image:
    small, ink = _text_size(tile), style.colours.ink
    head = 2 * small if title else 0
    width, height = _whole(len(moments), tile, head)
    sheet = np.full((height, width, 4), 255, dtype=np.uint8)
    sheet[..., :3] = [round(255 * c) for c in style.colours.horizon]
    pictures = Stage(Pane(motion), style, tile).pictures(np.array(moments) / motion.fps, views)
    for frame, (x, y), picture in zip(moments, _places(len(moments), tile, head), pictures, strict=True):
        sheet[y : y + tile[1], x : x + tile[0]] = picture
        paste(sheet, words(f"{frame / motion.fps:.2f} s", ink, small), x + small // 2, y + tile[1] + small // 4)
    if title:
        paste(sheet, words(title, ink, small), small // 2, small // 4)
    return Image.fromarray(sheet).convert("RGB")
