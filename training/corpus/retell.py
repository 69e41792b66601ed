"""``python -m training.corpus.retell --corpus DIR``: writes the captions of composed beats anew.

Motion takes long to build and stays; the scenes of beats get other sentences, as the present words have them.
Scenes of the other families keep theirs.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from motion.formats.files import replacing
from training.core.shell import exit_code

from .beats.play import Beat
from .words import Narrator
from .words.narrator import ALONE, JOINT, ONE_BEAT


def retold(scene: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """The row of the index with new captions, where it has beats that tell enough."""
    rows = scene.get("beats") or []
    if not rows:
        return scene
    beats = [Beat.of_row(row) for row in rows]
    narrator = Narrator(rng, beats, scene["split"])
    captions = narrator.together(JOINT)
    if len(captions) < 3:
        return scene
    alone = [narrator.alone(person, ALONE) for person in (0, 1)]
    retold_rows = [{**row, "captions": narrator.beat(k, ONE_BEAT)} for k, row in enumerate(rows)]
    return {**scene, "captions": captions, "alone": alone, "beats": retold_rows}


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Write new captions for the scenes of beats in a corpus.")
    parser.add_argument("--corpus", type=Path, required=True, help="what `python -m training.corpus` wrote")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    path = options.corpus / "index.json"
    scenes = json.loads(path.read_text())
    rng = np.random.default_rng(options.seed)
    scenes = [retold(scene, rng) for scene in scenes]
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(scenes))
    count = len({caption for scene in scenes for caption in scene["captions"]})
    print(f"{len(scenes)} scenes, {count} different captions")


if __name__ == "__main__":
    raise SystemExit(main())
