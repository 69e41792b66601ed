"""A motion as a figure for a paper: moments side by side on the ground, each as the player shows it, as PNG or PDF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.formats.files import replacing
from motion.vectors import Array

from .camera import Camera, cameras
from .stage import Pane, Stage, Style, in_pixels, write

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
    chosen = [int(frame) for frame in frames]
    if not MOMENTS[0] <= len(chosen) <= MOMENTS[1]:
        raise InputError(f"A contact sheet has {MOMENTS[0]} to {MOMENTS[1]} moments, not {len(chosen)}.")
    if any(not 0 <= frame <= last for frame in chosen):
        raise InputError(f"The motion has frames 0 to {last}: choose among them.")
    return chosen


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
    times = np.array(chosen_frames(motion, frames)) / motion.fps
    columns = min(len(times), _COLUMNS)
    tile = (width // columns, round(width / columns * _TALL))
    (views,) = cameras([motion], size=tile, times=times, view=view, around=0.0)
    parts = [slice(first, first + columns) for first in range(0, len(times), columns)]
    rows = [_row(Stage(Pane(motion), style, tile), times[part], views[part], columns) for part in parts]
    _save(rows, path, style, title)
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
    rows = [
        _row(Stage(Pane(motion), style, tile), times, views, _IN_ROW, name)
        for (name, motion), views in zip(motions.items(), ways, strict=True)
    ]
    _save(rows, path, style, title)
    return path


def _row(stage: Stage, times: Array, views: Sequence[Camera], columns: int, name: str = "") -> Image.Image:
    """Pictures beside each other at moments in seconds, room for ``columns`` of them, the times below, a name above."""
    (wide, tall), small = stage.size, max(stage.size[0] // 16, 9)
    top = 2 * small if name else 0
    row, ink = _blank(wide * columns, top + tall + 2 * small, stage.style), stage.style.colours.ink
    write(row, (small // 2, 1.4 * small), name, ink, small, "ls")
    for column, (seconds, picture) in enumerate(zip(times, stage.pictures(times, views), strict=True)):
        row.paste(picture, (wide * column, top))
        write(row, (wide * column + small // 2, top + tall + 1.4 * small), f"{seconds:.2f} s", ink, small, "ls")
    return row


def _blank(width: int, height: int, style: Style) -> Image.Image:
    return Image.new("RGB", (width, height), in_pixels(style.colours.horizon))


def _save(rows: list[Image.Image], path: Path, style: Style, title: str) -> None:
    """Writes rows of one width under each other, a title above, as the path's suffix says."""
    small = max(rows[0].width // 100, 9)
    at = 2 * small if title else 0
    whole = _blank(rows[0].width, at + sum(row.height for row in rows), style)
    write(whole, (small // 2, 1.4 * small), title, style.colours.ink, small, "ls")
    for row in rows:
        whole.paste(row, (0, at))
        at += row.height
    with replacing(path) as temporary:
        whole.save(temporary, format=path.suffix[1:].upper(), resolution=_DPI, quality=95)
