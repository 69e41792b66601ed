"""``python -m training.corpus.retell --corpus DIR``: writes the captions of a corpus anew from its labels.

Motion takes long to build and stays; the scenes get other sentences, as the lexicon has them now.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from motion.formats.files import write_text
from training.core.shell import add_options, exit_code

from .cues import Label
from .telling import Teller, texts


def retold(scene: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """The row of the index with new captions, where it has a label that tells enough."""
    if not scene.get("label"):
        return scene
    known = Label.of_row(scene["label"])
    teller = Teller(rng, known, scene["split"], sides="side" in (scene.get("events") or {}))
    captions = texts(teller.scene())
    if len(captions) < 3:
        return scene
    alone = [texts(teller.alone(who)) for who in "ab"]
    beats = [
        {**row, "captions": texts(teller.beat(ids))}
        for row, ids in zip(scene.get("beats") or (), known.beats, strict=False)
    ]
    return {**scene, "captions": captions, "alone": alone, "beats": beats}


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Write new captions for the scenes of a corpus.")
    add_options(parser, "corpus", "seed")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    path = options.corpus / "index.json"
    scenes = json.loads(path.read_text())
    rng = np.random.default_rng(options.seed)
    scenes = [retold(scene, rng) for scene in scenes]
    write_text(path, json.dumps(scenes))
    count = len({caption for scene in scenes for caption in scene["captions"]})
    print(f"{len(scenes)} scenes, {count} different captions")


if __name__ == "__main__":
    raise SystemExit(main())
