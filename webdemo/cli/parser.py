"""The parser of the shell's commands: one line for each mistake, and options that several commands share."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any, NoReturn

from motion import Clip, Duet, InputError
from motion.formats.recording import AXES, ORDERS, ImportChoices
from webdemo.inference.method import Task
from webdemo.inference.methods import AUTOMATIC, method, methods
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest


class Parser(argparse.ArgumentParser):
    """Reports a mistake in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        """Raises :class:`InputError` with argparse's message as a sentence."""
        raise InputError(f"{message[:1].upper()}{message[1:]}: see `{self.prog} --help`.")


def names_of(task: Task) -> str:
    """The names of the methods of a task, for a help text."""
    names = [each.name for each in methods(task)]
    return " or ".join([AUTOMATIC, *names] if task == "react" else names)


def add_reading(parser: argparse.ArgumentParser, of: str) -> None:
    """The options that say what is known of a motion file; ``of`` is the argument that names it."""
    parser.add_argument(
        "--animation",
        metavar="NAME",
        help=f"of a .glb with several, the animation of {of} to read: name or number, from 1; the first by default",
    )
    parser.add_argument(
        "--file-fps",
        type=float,
        metavar="FPS",
        help="true frames a second of a file that gives none, such "
        "as InterHuman's .npy (30 by default) or Inter-X' .npz (120), or gives a wrong one",
    )
    parser.add_argument(
        "--file-up", metavar="AXIS", help=f"what points up in the file, where that is not found: {', '.join(AXES)}"
    )
    parser.add_argument(
        "--file-order", metavar="ORDER", help=f"order of joints without names: {', '.join(ORDERS)}; found by default"
    )


def reading_choices(options: argparse.Namespace) -> ImportChoices:
    """Facts that the options of :func:`add_reading` give of a file."""
    return ImportChoices(options.file_up, options.file_fps, options.file_order, options.animation)


def with_notes(written: dict[str, Any], motion: Clip | Duet) -> dict[str, Any]:
    """A report with notes on how a file was read, also on stderr: which of several animations was taken, and so on."""
    if notes := list(dict.fromkeys(note for person in motion.people for note in person.notes)):
        print("\n".join(notes), file=sys.stderr)
        written["notes"] = [*notes, *written.get("notes", ())]
    return written


def add_sampling(parser: argparse.ArgumentParser, task: Task) -> None:
    """The options of a request that denoises a motion, and where its result goes.

    Those of a scene have no defaults here: what is not given is the story's own.
    """
    asked: Any = {"generate": GenerateRequest, "react": ReactRequest}.get(task)

    def add(option: str, kind: type, words: str, **more: Any) -> None:
        default = getattr(asked, option, None)
        own = "" if default is not None else "; the story's own if not given" if asked is None else "; the model's own"
        parser.add_argument(f"--{option}", type=kind, default=default, help=f"{words}{own}", **more)

    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh, .glb …")
    add("seed", int, "seed of what is drawn")
    add("samples", int, "how many motions to generate")
    parser.add_argument("--guidance", type=float, help=f"guidance scale s; the {'model' if asked else 'story'}'s own")
    add("steps", int, "denoising steps")
    add("damping", float, "damping threshold, 0 to 1")
    add("sampler", str, "ddim or dpm++")
    add("model", str, names_of(task))
    if asked is not None:
        parser.add_argument("--no-cleanup", action="store_true", help="keep bones and feet as the network outputs them")
    if task == "react":
        return
    tries = "try up to N seeds (1 to 4) until the motion shows all that is said, and keep the best"
    add("tries", int, tries, metavar="N")
    parser.add_argument(
        "--no-plan",
        action="store_true",
        help="do not read from the words where people go and whether they stand by, sit down or jump",
    )
    held = "share of the steps in which the network is held to the plan's poses; 0 shows them as a draft"
    add("strictness", float, held, metavar="SHARE")


def sampling_fields(options: argparse.Namespace) -> dict[str, Any]:
    """The fields of a request, from the options of :func:`add_sampling`."""
    names = ("seed", "samples", "guidance", "steps", "damping", "sampler", "model")
    fields = {name: getattr(options, name) for name in names} | {"cleanup": not options.no_cleanup}
    if options.guidance is None:
        fields["guidance"] = method(options.model).defaults.get("guidance", SamplingRequest.guidance)
    return fields
