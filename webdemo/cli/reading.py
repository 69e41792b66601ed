"""The command ``read``: a sentence → its plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from acts import read
from acts.reading.director import directed


def add_read(commands: Any) -> None:
    """Adds ``read`` to the shell's commands."""
    parser = commands.add_parser("read", help="print what is understood of a sentence, as a plan")
    parser.add_argument("sentence", help="English text, at most 2,000 characters")
    parser.add_argument(
        "--acts", type=Path, nargs="*", default=[], metavar="FOLDER", help="folders of acts beside the lexicon"
    )
    parser.set_defaults(job=lambda options: {"plan": _plan(options)})


def _plan(options: argparse.Namespace) -> dict[str, Any]:
    if options.acts:
        plan = read(options.sentence, tuple(folder.resolve() for folder in options.acts))
    else:
        plan = directed(options.sentence)
    return plan.model_dump(mode="json")
