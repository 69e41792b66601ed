"""Makes the recordings of people who stand by: ``python -m training.bystanders --data DATA --out acts/recordings``.

Taken are those of ReActIdle in which the feet stay and the body lives: most of its people stand as still as they can.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from acts.staging.poses import RATE
from motion import SMPL22, InputError
from motion.formats.files import replacing
from motion.transforms import canonicalize
from motion.vectors import Array
from training.core.shell import exit_code

from .corpus.sources import FPS, load_sources

STILL = 0.2
"""Metres a second: slower than that in all joints, a body is still."""
MOST_STILL, MOST_STEPS = 0.6, 0.06
"""Shares of the frames in which the body is still, and in which a foot moves, at most."""
PIECE = 180
"""Frames of a piece of a recording."""
_FEET = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


def lively(positions: Array) -> bool:
    """True for a person (T, 22, 3) who moves while their feet stay."""
    speeds = np.linalg.norm(np.diff(positions.astype(float), axis=0), axis=-1) * FPS
    still, steps = (speeds.max(-1) < STILL).mean(), (speeds[:, _FEET].max(-1) > STILL).mean()
    return bool(still < MOST_STILL and steps < MOST_STEPS)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.bystanders", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of the data sets")
    parser.add_argument("--out", type=Path, required=True, help="folder of the recordings")
    options = parser.parse_args(argv)

    def job() -> None:
        kept = {}
        for clip in load_sources(options.data):
            for start in range(0, len(clip.positions) - PIECE + 1, PIECE) if clip.dataset == "reactidle" else ():
                piece = clip.positions[start : start + PIECE]
                if lively(piece):
                    kept[f"{clip.source}_{len(kept)}"] = canonicalize(piece)[:: round(FPS / RATE)]
        if not kept:
            raise InputError(f"{options.data} holds no recording of ReActIdle in which people move: unpack it there.")
        options.out.mkdir(parents=True, exist_ok=True)
        with replacing(options.out / "idle.npz") as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, **{name: np.rint(1000 * poses).astype(np.int16) for name, poses in kept.items()})
        print(f"{len(kept)} recordings, {sum(map(len, kept.values())) / RATE:.0f} s")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
