"""Shared parts of the training commands: options and exit codes."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Collection
from dataclasses import fields
from pathlib import Path
from typing import TypeVar

from safetensors import SafetensorError

from motion import InputError

Settings = TypeVar("Settings")


def add_run_options(
    parser: argparse.ArgumentParser, settings: type, *, leave_out: Collection[str] = ()
) -> None:
    """Options that every training takes: its folder, its minutes and each of its settings by name.

    Args:
        parser: gets ``--out``, ``--minutes`` and a flag a setting, where it is true or false with ``--no-…``.
        settings: a dataclass whose fields have defaults of the type that the flag takes.
        leave_out: fields without a flag.
    """
    parser.add_argument("--out", type=Path, required=True, help="folder of the checkpoint and the log")
    parser.add_argument(
        "--minutes", type=float, default=1e9, help="stop after this long; start again to go on"
    )
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
