"""Films of what the player shows: MP4, WebM and GIF, drawn off screen.

PyAV (FFmpeg's libraries) packs the pictures as H.264 or VP9, Pillow as GIF.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from motion.errors import InputError
from motion.formats.files import replacing

from .camera import Camera, cameras
from .stage import Pane, Stage, Style, in_pixels, write

SUFFIXES = (".mp4", ".webm", ".gif")
SIZES = (64, 3840)
RATES = (1.0, 60.0)
SIZE = (1280, 720)
FPS = 30.0
_GIF_DELAY = 4
"""Hundredths of a second for which a picture of a GIF is shown, at least; they are whole."""
"""GIF counts in hundredths of a second and browsers slow down what is shown for one: 25 is its best rate."""
MOST_GIF = 400_000_000
"""Pixels of a GIF's pictures together, a byte each: all are held until the last."""
_PLANES = "yuv420p"
"""Pixels of the videos, in FFmpeg's words."""
_CODECS = {
    ".mp4": ("libx264", {"preset": "veryfast", "crf": "19", "movflags": "+faststart"}),
    ".webm": ("libvpx-vp9", {"deadline": "realtime", "cpu-used": "8", "crf": "31", "b": "0", "row-mt": "1"}),
}


def can_write(suffix: str) -> bool:
    """True if this installation writes films with this suffix (with its dot)."""
    return suffix.lower() == ".gif" or (suffix.lower() in SUFFIXES and find_spec("av") is not None)


def write_film(
    panes: Sequence[Pane],
    path: str | Path,
    *,
    fps: float = FPS,
    size: tuple[int, int] = SIZE,
    style: Style | None = None,
    view: str = "threequarter",
    follow: bool = True,
    title: str = "",
    yaw: float | None = None,
    elevation: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Writes a film of one motion, or of several on one clock: up to three side by side, more in rows.

    Args:
        panes: what is shown, from left to right and from top to bottom.
        path: ends in .mp4, .webm or .gif; a GIF has at most 25 frames a second.
        fps: frames a second; motion is interpolated to them.
        size: width and height in pixels.
        style: how people are drawn.
        view: one of :data:`~webdemo.view.camera.VIEWS`.
        follow: whether the cameras go with the people.
        title: stands at the lower edge, with the time.
        yaw, elevation: radians, instead of the view's.
        progress: is called with frames done and frames in all.

    Returns:
        the path.

    Raises:
        InputError: for what cannot be shown or written, or where PyAV is missing; no file is left.
    """
    path, style = Path(path), style or Style()
    suffix = path.suffix.lower()
    _check(suffix, fps, size, panes)
    rate = 100 / max(_GIF_DELAY, round(100 / fps)) if suffix == ".gif" else fps
    seconds = max(pane.motion.seconds for pane in panes)
    times = np.arange(max(1, round(seconds * rate))) / rate
    if suffix == ".gif" and len(times) * size[0] * size[1] > MOST_GIF:
        raise InputError(
            f"A GIF of {len(times):,} pictures of {size[0]}x{size[1]} is too large: ask for a smaller one."
        )
    views = cameras(
        [pane.motion for pane in panes],
        size=_cell(size, len(panes)),
        times=times,
        view=view,
        follow=follow,
        yaw=yaw,
        elevation=elevation,
    )
    pictures = _draw(panes, style, size, times, views, title)
    with replacing(path) as temporary:
        counted = _counted(pictures, len(times), progress)
        if suffix == ".gif":
            _write_gif(counted, temporary, rate)
        else:
            _write_video(counted, temporary, suffix, rate, size)
    return path


def _check(suffix: str, fps: float, size: tuple[int, int], panes: Sequence[Pane]) -> None:
    if suffix not in SUFFIXES:
        raise InputError(f"Films end in .mp4, .webm or .gif, not in {suffix or 'nothing'}.")
    if not can_write(suffix):
        raise InputError("MP4 and WebM need the package av: install it with `pip install av`, or write a .gif.")
    if not panes:
        raise InputError("There is no motion to film: give at least one.")
    if not RATES[0] <= fps <= RATES[1]:
        raise InputError(f"{fps:g} frames a second are not possible: give {RATES[0]:g} to {RATES[1]:g}.")
    if not all(SIZES[0] <= side <= SIZES[1] for side in size) or _cell(size, len(panes))[0] < SIZES[0]:
        raise InputError(
            f"A picture of {size[0]}x{size[1]} is not possible: give {SIZES[0]} to {SIZES[1]} pixels each way."
        )
    if any(side % 2 for side in size):
        raise InputError(f"A film's width and height are even: give {size[0] & ~1}x{size[1] & ~1}.")


def _shape(panes: int) -> tuple[int, int]:
    """Columns and rows of a film."""
    columns = panes if panes <= 3 else 2 if panes == 4 else 3
    return columns, -(-panes // columns)


def _cell(size: tuple[int, int], panes: int) -> tuple[int, int]:
    """Width and height of each pane, in pixels."""
    columns, rows = _shape(panes)
    return size[0] // columns, size[1] // rows


def _draw(
    panes: Sequence[Pane],
    style: Style,
    size: tuple[int, int],
    times: NDArray[np.floating],
    views: list[list[Camera]],
    title: str,
) -> Iterator[Image.Image]:
    """The pictures of a film at moments in seconds; ``views`` has a pane's cameras, one a moment."""
    (wide, tall), (columns, rows) = _cell(size, len(panes)), _shape(len(panes))
    stages = [Stage(pane, style, (wide, tall)).pictures(times, ways) for pane, ways in zip(panes, views, strict=True)]
    ink, small = style.colours.ink, max(round(size[1] / 48), 9)
    for seconds, shown in zip(times, zip(*stages, strict=True), strict=True):
        whole = Image.new("RGB", size, in_pixels(style.colours.horizon))
        for number, (pane, picture) in enumerate(zip(panes, shown, strict=True)):
            row, column = divmod(number, columns)
            whole.paste(picture, (wide * column, tall * row))
            write(whole, (wide * (column + 0.5), tall * row + 0.6 * small), pane.caption, ink, small, "mt")
        pen = ImageDraw.Draw(whole)
        for column in range(1, columns):
            pen.line([(wide * column, 0), (wide * column, size[1])], in_pixels(ink))
        for row in range(1, rows):
            pen.line([(0, tall * row), (size[0], tall * row)], in_pixels(ink))
        line = f"{title}  ·  {seconds:.2f} s" if title else f"{seconds:.2f} s"
        write(whole, (small, size[1] - 0.9 * small), line, ink, small, "ls")
        yield whole


def _counted(
    pictures: Iterator[Image.Image], total: int, progress: Callable[[int, int], None] | None
) -> Iterator[Image.Image]:
    for done, picture in enumerate(pictures, start=1):
        yield picture
        if progress is not None:
            progress(done, total)


def _write_video(pictures: Iterator[Image.Image], path: Path, suffix: str, fps: float, size: tuple[int, int]) -> None:
    import av

    codec, options = _CODECS[suffix]
    with av.open(str(path), "w", format=suffix[1:]) as film:
        rate = Fraction(fps).limit_denominator(1001)
        stream = cast(av.VideoStream, film.add_stream(codec, rate=rate, options=options))
        stream.width, stream.height = size
        stream.pix_fmt = _PLANES
        for picture in pictures:
            film.mux(stream.encode(av.VideoFrame.from_image(picture).reformat(format=_PLANES)))
        film.mux(stream.encode(None))


def _write_gif(pictures: Iterator[Image.Image], path: Path, fps: float) -> None:
    first = next(pictures).quantize(256, dither=Image.Dither.NONE)
    others = (picture.quantize(palette=first, dither=Image.Dither.NONE) for picture in pictures)
    first.save(
        path, format="GIF", save_all=True, append_images=others, duration=round(1000 / fps), loop=0, optimize=False
    )
