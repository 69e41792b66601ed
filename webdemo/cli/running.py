"""Runs a request from the shell and writes its result."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from motion import InputError
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.predict import PredictRequest
from webdemo.inference.run import Progress, Result
from webdemo.inference.story.request import SceneRequest


def check_out(path: Path) -> None:
    """Raises :class:`InputError` where no motion can be written under this name."""
    from motion.formats import can_write, suffix_of

    if not can_write(suffix_of(path)):
        raise InputError(
            f"{path.name} has a suffix that cannot be written: choose another, such as .npz, .bvh or .glb."
        )


def write_result(result: Result, out: Path) -> dict[str, Any]:
    """Writes the duets of a result and returns what the last line on stdout reports of them."""
    from motion.formats import with_stem, write

    paths: list[Path] = []
    for i, duet in enumerate(result.duets):
        number = f"_{i + 1}" if len(result.duets) > 1 else ""
        paths += write(duet, with_stem(out, number))
    for note in result.notes:
        print(note, file=sys.stderr)
    return {
        "files": [str(path) for path in paths],
        "manifest": result.manifest,
        "readouts": [{k: r[k] for k in ("before", "after", "planned") if k in r} for r in result.readouts],
        "timings": result.timings,
        "notes": list(result.notes),
    }


def run(request: GenerateRequest | ReactRequest | PredictRequest | SceneRequest) -> Result:
    """Runs a request with a step counter on stderr, where that is a terminal."""
    from webdemo.inference.engine import Engine

    show = sys.stderr.isatty()
    for event in Engine().run(request):
        if isinstance(event, Result):
            if show:
                print("\r\033[K", end="", file=sys.stderr)
            return event
        if show and isinstance(event, Progress):
            number = f"try {event.attempt}/{event.attempts}: " if event.attempts > 1 else ""
            line = f"{number}{event.stage} {event.step}/{event.total}"
            print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)
    raise InputError("The run ended without a result: try again.")
