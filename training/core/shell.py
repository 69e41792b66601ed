"""Shared parts of the training commands: options and exit codes."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import torch
from safetensors import SafetensorError

from motion import InputError
from motion.formats.files import write_text

from .loop import Loop

Settings = TypeVar("Settings")


_FOLDER, _NEEDED = {"type": Path}, {"type": Path, "required": True}
OPTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "blocks": (
        "--blocks",
        {"type": int, "nargs": "+", "default": (), "help": "those of the teacher that the network has (all)"},
    ),
    "compile": ("--compile", {"action": "store_true", "help": "compile the network (needs a C++ compiler)"}),
    "corpus": ("--data", _NEEDED | {"help": "folder of the corpus"}),
    "cache": ("--cache", _FOLDER | {"help": "folder of the fitted pairs; --data by default"}),
    "damping": ("--damping", {"type": float, "default": 0.7}),
    "device": ("--device", {"help": "of torch: cuda where there is one, else cpu"}),
    "export": ("--export", _FOLDER | {"help": "folder that the trained network is also written to, as it is shipped"}),
    "guidance": ("--guidance", {"type": float, "default": 4.3}),
    "init": ("--init", _FOLDER | {"help": "begin with a shipped folder, or with another run's last.safetensors"}),
    "out": ("--out", _NEEDED | {"help": "JSON file for all scores"}),
    "pairs": ("--data", _NEEDED | {"help": "folder that holds sbu and k3hi"}),
    "scenes": ("--scenes", _NEEDED | {"help": "file of `python -m training.prepare`"}),
    "seed": ("--seed", {"type": int, "default": 0}),
    "share": (
        "--share",
        {"type": float, "default": 1.0, "help": "the run's share of the exported weights; the rest is of --init (1)"},
    ),
    "steps": ("--steps", {"type": int, "default": 25, "help": "DDIM steps (25)"}),
    "table": ("--table", _FOLDER | {"help": "Markdown file for the table, which is printed too"}),
    "teacher": ("--teacher", _FOLDER | {"help": "a shipped folder to begin with and to learn from"}),
    "threads": ("--threads", {"type": int, "help": "of torch on the CPU (as many as there are cores)"}),
    "weights": ("--weights", _FOLDER | {"help": "folder of all weights"}),
    "words": (
        "--words",
        {
            "type": Path,
            "default": Path("models/weights/intergen"),
            "help": "a shipped InterGen, whose text conditioner is taken over",
        },
    ),
    "workers": ("--workers", {"type": int, "default": 0, "help": "processes that draw batches ahead (0)"}),
}
"""Options that several commands have."""


def add_options(parser: argparse.ArgumentParser, *names: str) -> None:
    """Adds some of :data:`OPTIONS`."""
    for name in names:
        flag, given = OPTIONS[name]
        if name == "weights":
            from webdemo.inference.methods import WEIGHTS

            given = given | {"default": WEIGHTS}
        if name == "device":
            given = given | {"default": "cuda" if torch.cuda.is_available() else "cpu"}
        parser.add_argument(flag, **given)


def add_run_options(parser: argparse.ArgumentParser, settings: type, *, leave_out: Collection[str] = ()) -> None:
    """Options that every training takes: its folder, its minutes and each of its settings by name.

    Args:
        parser: gets ``--out``, ``--minutes`` and a flag a setting, where it is true or false with ``--no-…``.
        settings: a dataclass whose fields have defaults of the type that the flag takes.
        leave_out: fields without a flag.
    """
    parser.add_argument("--out", type=Path, required=True, help="folder of the checkpoint and the log")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after this long; start again to go on")
    for setting in fields(settings):
        if setting.name in leave_out:
            continue
        flag = "--" + setting.name.replace("_", "-")
        if isinstance(setting.default, bool):
            parser.add_argument(flag, action=argparse.BooleanOptionalAction, default=setting.default)
        else:
            parser.add_argument(flag, type=type(setting.default), default=setting.default)


def chosen(options: argparse.Namespace, settings: type[Settings]) -> Settings:
    """The settings that :func:`add_run_options` understood; a field without a flag has its default."""
    names = (field.name for field in fields(settings))  # type: ignore[arg-type] # a dataclass, as documented
    return settings(**{name: getattr(options, name) for name in names if hasattr(options, name)})


def at_least(settings: Any, **least: int) -> None:
    """Raises InputError for a setting that is less, or for a ``latent_dim`` that the heads cannot share."""
    for name, number in least.items():
        if getattr(settings, name) < number:
            raise InputError(f"{name} is {getattr(settings, name)}: give {number} or more.")
    width, heads = getattr(settings, "latent_dim", 0), getattr(settings, "num_heads", 1)
    if width % heads:
        raise InputError(f"latent_dim {width} cannot be shared by {heads} heads: give a multiple.")


def train(
    argv: list[str] | None,
    description: str,
    settings: type[Settings],
    begin: Callable[[argparse.Namespace, Settings], Loop],
    *names: str,
    leave_out: Collection[str] = (),
    lean: Mapping[str, Any] | None = None,
) -> int:
    """The command of a trainer: begins or resumes a run, and exports its network where ``--export`` asks for it.

    Args:
        argv: its words.
        description: the trainer's documentation.
        settings: see :func:`add_run_options`, as for ``leave_out``.
        begin: makes the run from the options and the settings.
        names: of :data:`OPTIONS`.
        lean: settings that ``--lean`` changes.

    Returns:
        the exit code.
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser, *names)
    add_run_options(parser, settings, leave_out=leave_out)
    if lean:
        parser.add_argument("--lean", action="store_true", help="settings that one CPU core trains in an hour")
    options = parser.parse_args(argv)
    if lean and options.lean:  # explicit options still override
        parser.set_defaults(**lean)
        options = parser.parse_args(argv)

    def job() -> None:
        if getattr(options, "threads", None):
            torch.set_num_threads(options.threads)
        run = begin(options, chosen(options, settings))
        run.run_logged(minutes=options.minutes)
        if getattr(options, "export", None):
            run.export(options.export)

    return exit_code(job)


def write_scores(options: argparse.Namespace, scores: Any, shown: str) -> None:
    """Writes scores to ``--out`` and their table to ``--table``, where that is given, and prints the table."""
    write_text(options.out, json.dumps(scores, indent=1, ensure_ascii=False) + "\n")
    if options.table:
        write_text(options.table, shown)
    print(shown)


def exit_code(job: Callable[[], None]) -> int:
    """Runs a job; 0, or 2 after one line on stderr that says what is wrong and what to do."""
    try:
        job()
    except InputError as error:
        message = str(error)
    except (OSError, SafetensorError) as error:  # a full disk, as the tensor writer says it
        message = f"A file could not be written ({error}): free disk space or choose another folder."
    else:
        return 0
    print(" ".join(message.split()), file=sys.stderr)
    return 2
