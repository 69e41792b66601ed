"""The command ``render``: films, contact sheets and figures of any motion file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from motion import Clip, Duet, InputError
from motion.formats.recording import ImportChoices

from .parser import add_reading, reading_choices, with_notes


def add_render(commands: Any) -> None:
    """Adds ``render`` to the shell's commands."""
    parser = commands.add_parser("render", help="draw a film, a contact sheet or a figure of any motion file")
    parser.add_argument("file", type=Path, help="motion file: .npz, .bvh, .glb …")
    parser.add_argument("second", type=Path, nargs="?", help="the other person, if each has a file")
    add_reading(parser, "the file")
    parser.add_argument(
        "--out",
        type=Path,
        help="film: .mp4, .webm or .gif; contact sheet: .png or .pdf; plotly figure: .html; "
        "a .png beside the file by default",
    )
    parser.add_argument("--beside", type=Path, action="append", default=[], help="film: a motion to show beside it")
    parser.add_argument("--look", default="bodies", help="bodies, skeletons or both")
    parser.add_argument("--theme", default="light", help="light or dark")
    parser.add_argument("--view", default="threequarter", help="threequarter, front, side, top, a or b")
    parser.add_argument("--title", help="title in the picture; the file's name by default")
    parser.add_argument("--fps", type=float, default=30.0, help="film: frames a second")
    parser.add_argument("--size", default="1280x720", help="film: width and height in pixels")
    parser.add_argument("--still-camera", action="store_true", help="film: the camera does not follow the people")
    parser.add_argument(
        "--frames", default="8", help="contact sheet: how many moments, 1 to 24, or which, as in 0,30,75"
    )
    parser.add_argument("--width", type=int, default=1600, help="contact sheet: pixels")
    parser.set_defaults(job=render)


def render(options: argparse.Namespace) -> dict[str, Any]:
    """Draws a motion file; two people with a file each may be given as two files or by the first."""
    from webdemo.view import film, plotly_figure, sheet
    from webdemo.view.stage import Pane, Style

    motion = _motion(options.file, options.second, reading_choices(options))
    out = options.out or options.file.with_suffix(".png")
    title = options.file.stem if options.title is None else options.title
    suffix = out.suffix.lower()
    style = Style(look=options.look, names=suffix in film.SUFFIXES, theme=options.theme)
    if suffix in film.SUFFIXES:
        beside = [_motion(path, None) for path in options.beside]
        names = [options.file.stem, *(path.stem for path in options.beside)] if beside else [""]
        film.write_film(
            [Pane(shown, name) for shown, name in zip([motion, *beside], names, strict=True)],
            out,
            fps=options.fps,
            size=_size(options.size),
            style=style,
            view=options.view,
            follow=not options.still_camera,
            title=title,
        )
    elif suffix in sheet.SUFFIXES:
        sheet.write_sheet(
            motion,
            out,
            frames=_moments(options.frames),
            width=options.width,
            title=title,
            style=style,
            view=options.view,
        )
    elif suffix == plotly_figure.SUFFIX:
        fps = min(options.fps, plotly_figure.FPS)
        plotly_figure.write_figure(motion, out, title=title, theme=options.theme, fps=fps)
    else:
        raise InputError(
            f"{out.name} cannot be rendered: give --out a name that ends in .mp4, .webm, .gif, .png, .pdf or .html."
        )
    written = {"files": [str(out)], "frames": motion.num_frames, "fps": motion.fps, "seconds": motion.seconds}
    return with_notes(written, motion)


def _motion(file: Path, second: Path | None, choices: ImportChoices | None = None) -> Clip | Duet:
    """The motion of a file, or of a pair of files of which the second may be left to be found."""
    from motion.formats import read, read_pair
    from motion.formats.registry import partner_file

    second = second or partner_file(file)
    if second is not None and choices is not None and choices.animation is not None:
        raise InputError("--animation chooses within one file: leave it out, or the second file.")
    return read(file, choices=choices) if second is None else read_pair(file, second, choices=choices)


def _size(words: str) -> tuple[int, int]:
    """Width and height of ``"1280x720"``."""
    parts = words.lower().split("x")
    if len(parts) != 2 or not all(part.isdecimal() for part in parts):
        raise InputError(f"--size is width x height, such as 1280x720, not {words!r:.30}.")
    return int(parts[0]), int(parts[1])


def _moments(words: str) -> int | list[int]:
    """Reads ``--frames``: a number of frames, or a list of them."""
    parts = words.split(",")
    if not all(part.strip().isdecimal() for part in parts):
        raise InputError(f"--frames is a number or frames with commas, such as 0,30,75, not {words!r:.30}.")
    return int(parts[0]) if len(parts) == 1 else [int(part) for part in parts]
