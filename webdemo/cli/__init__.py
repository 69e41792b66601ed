"""The same jobs from a shell: ``python -m webdemo COMMAND``.

The commands are generate, react, predict, scene, read, render, score, info, benchmark, serve, user, admin
and backup.
The last line on stdout is one JSON object. An error is one line on stderr that says what is
wrong and what to do, with exit code 2. A cancelled run (Ctrl+C) ends with 130, and one whose reader has gone
with 141. No file is left half-written.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from motion import InputError

from .generation import add_generate, add_predict, add_react
from .parser import Parser
from .rendering import add_render
from .scenes import add_read, add_scene
from .scoring import add_score
from .service import add_admin, add_backup, add_service

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit code."""
    parser = Parser(prog="python -m webdemo", description="Motion of two people, from a shell.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=Parser)
    for add in (
        add_generate,
        add_react,
        add_predict,
        add_scene,
        add_read,
        add_render,
        add_score,
        add_service,
        add_admin,
        add_backup,
    ):
        add(commands)
    began = time.perf_counter()
    try:
        options = parser.parse_args(argv)
        job: Callable[[argparse.Namespace], dict[str, Any]] = options.job
        answer = job(options)
        print(json.dumps(answer | {"wall_seconds": round(time.perf_counter() - began, 3)}), flush=True)
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 2
    except BrokenPipeError:  # the reader of stdout has gone, as `head` does
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except KeyboardInterrupt:
        print("Stopped; nothing was written.", file=sys.stderr)
        return 130
    return 0
