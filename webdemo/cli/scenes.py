"""The commands ``scene``, a story in a TOML file → motion files, and ``read``, a sentence → its plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from acts import read
from motion import InputError
from motion.formats.recording import ImportChoices
from webdemo.inference.requests.sampling import SETTINGS
from webdemo.inference.story import SceneRequest, read_story, split_sentence
from webdemo.inference.story.request import read_motion

from .generation import check_out, run, write_result
from .parser import add_reading, add_sampling, reading_choices, with_notes


def add_scene(commands: Any) -> None:
    """Adds ``scene`` to the shell's commands."""
    parser = commands.add_parser("scene", help="generate a scene of several beats from a story")
    parser.add_argument("story", type=Path, nargs="?", help="TOML file with the story")
    parser.add_argument("--prompt", help="instead of a file: a sentence, which is split into beats")
    parser.add_argument("--motion", type=Path, help="motion of two people that the story goes on from")
    add_reading(parser, "the motion")
    parser.add_argument(
        "--start", type=float, help="with --motion: second at which the story begins; the end by default"
    )
    parser.add_argument("--end", type=float, help="with --motion: second at which the motion goes on unchanged")
    add_sampling(parser, "scene")
    parser.set_defaults(job=scene)


def scene(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`SceneRequest` and writes its duets."""
    check_out(options.out)
    asked = _story(options)
    given = {name: getattr(options, name, None) for name in (*SETTINGS, "strictness")}
    asked |= {name: value for name, value in given.items() if value is not None}
    if options.no_plan:
        asked["planned"] = False
    choices = reading_choices(options)
    if choices != ImportChoices() and options.motion is None:
        raise InputError("--animation and --file-… say how a motion is read: give --motion as well, or leave them out.")
    motion = read_motion(options.motion, choices) if options.motion is not None else None
    request = SceneRequest(**asked, motion=motion, start=options.start, end=options.end)
    written = write_result(run(request), options.out)
    return written if motion is None else with_notes(written, motion)


def _story(options: argparse.Namespace) -> dict[str, Any]:
    """The fields that the story sets."""
    if (options.story is None) == (options.prompt is None):
        raise InputError("Give a story: a TOML file, or a sentence with --prompt.")
    if options.prompt is not None:
        return {"beats": split_sentence(options.prompt)}
    try:
        text = options.story.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not text in UTF-8"
        raise InputError(f"The story {options.story} cannot be read: {why}.") from None
    return read_story(text, options.story.parent)


# ---- reading -------------------------------------------------------------------------------------


def add_read(commands: Any) -> None:
    """Adds ``read`` to the shell's commands."""
    parser = commands.add_parser("read", help="print what is understood of a sentence, as a plan")
    parser.add_argument("sentence", help="English text, at most 2,000 characters")
    parser.add_argument(
        "--acts", type=Path, nargs="*", default=[], metavar="FOLDER", help="folders of acts beside the lexicon"
    )
    parser.set_defaults(job=lambda options: {"plan": _plan(options)})


def _plan(options: argparse.Namespace) -> dict[str, Any]:
    folders = tuple(folder.resolve() for folder in options.acts)
    return read(options.sentence, folders).model_dump(mode="json")
