"""Speed of films of bodies at 1280 × 720 and 30 frames a second."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parents[2] / "static" / "examples" / "shake-hands.npz"
REAL_TIME = 1.0


def measure_film() -> dict[str, float]:
    """Seconds that a second of film takes, ``film_seconds``, and those of processor time, children included.

    Nothing where no encoder is installed.
    """
    from motion.formats import read
    from webdemo.view import film
    from webdemo.view.stage import Pane

    if not film.can_write(".mp4"):
        return {}
    motion = read(EXAMPLE)
    with tempfile.TemporaryDirectory(prefix="pas-de-deux-benchmark-") as folder:
        before, began = os.times(), time.perf_counter()
        film.write_film([Pane(motion)], Path(folder) / "film.mp4")
        seconds, after = time.perf_counter() - began, os.times()
    spent = sum(after[:4]) - sum(before[:4])
    return {
        "film_seconds": seconds / motion.seconds,
        "film_seconds_goal": REAL_TIME,
        "film_processor_seconds": spent / motion.seconds,
    }
