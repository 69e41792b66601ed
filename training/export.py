"""Checkpoint → the folder that is shipped: ``python -m training.export --run DIR --scenes FILE --out DIR``.

Takes the averaged weights, and a bank of training captions which the demo uses to detect that a prompt is far from
all of them.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import torch

from models.intergen.compact import CaptionBank, CompactInterGen, load_folder, save_folder
from motion import InputError
from training.core import checkpoint
from training.core.shell import exit_code
from training.core.text_features import encoded
from training.prepare import Scenes, load
from training.trainers.intergen import new_model
from training.trainers.intergen_data import Data, settings_of
from training.trainers.touch import with_touches

BANK_PER_FAMILY = 25
BANK_PER_ACTS = 3
"""Captions of single beats in the bank, for each pair of acts: scenes of beats are one family, and hold them all."""
FAR_QUANTILE = 0.02


def caption_bank(scenes: Scenes) -> CaptionBank:
    """Captions of every family and of every kind of beat, with their sentence vectors.

    ``far`` is set so that of the test split's captions, whose phrasings were not trained on, 2 % would be
    called far.
    """
    chosen: dict[str, list[str]] = {}
    for row in scenes.split("train"):
        kinds = [(row["family"], row["captions"][:2], BANK_PER_FAMILY)]
        kinds += [("/".join(b["acts"]), b["captions"][:1], BANK_PER_ACTS) for b in row.get("beats") or ()]
        for kind, captions, most in kinds:
            known = chosen.setdefault(kind, [])
            known += [c for c in captions if c not in known and len(known) < most]
    captions = sorted({c for known in chosen.values() for c in known})
    unseen = sorted({c for row in scenes.split("test") for c in row["captions"]})[:2000]
    if not captions or not unseen:
        raise InputError("The scenes hold no training or no test captions: build the corpus with both splits.")
    vectors = encode(captions)
    nearest = (encode(unseen) @ vectors.T).amax(1)
    return CaptionBank(tuple(captions), vectors, round(float(nearest.quantile(FAR_QUANTILE)), 3))


def encode(captions: list[str]) -> torch.Tensor:
    """Unit sentence vectors (N, 384)."""
    found = torch.empty(len(captions), 384)
    for places, tokens in encoded(captions):
        found[places] = tokens.pooled().float()
    return found


@torch.no_grad()
def average(model: CompactInterGen, began: CompactInterGen, share: float) -> None:
    """Moves weights back towards those that a run began with, which forgets less of what these knew.

    Wortsman et al. 2022, "Robust fine-tuning of zero-shot models". New parts keep the run's weights.

    Args:
        model: the run's network; ``share`` of each weight is its own.
        began: the network that the run began with.
    """
    before = began.state_dict()
    for name, value in model.state_dict().items():
        if name in before and value.is_floating_point() and before[name].shape == value.shape:
            value.lerp_(before[name].to(value), 1 - share)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Turn a training run into the folder that is shipped.")
    parser.add_argument("--run", type=Path, required=True, help="--out of the training")
    parser.add_argument("--scenes", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True, help="folder under models/weights")
    parser.add_argument("--card", type=Path, help="JSON with the card's fields")
    parser.add_argument("--init", type=Path, help="the folder that the run began with, to average the weights with")
    parser.add_argument("--share", type=float, default=1.0, help="the run's share in that average, 0 to 1")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    path = options.run / "last.safetensors"
    meta, settings = checkpoint.metadata(path), settings_of(path)
    scenes = load(options.scenes)
    model = new_model(settings, Data(scenes, settings, options.run, "cpu", captions=False))
    checkpoint.restore_part(path, "ema", model)
    if options.init is not None:
        average(model, load_folder(options.init)[0], options.share)
    try:
        card: dict[str, Any] = json.loads(options.card.read_text()) if options.card else {}
    except (OSError, ValueError) as error:
        raise InputError(f"{options.card} is no JSON file: {error}.") from error
    model, reads = with_touches(model, scenes)
    print(f"touches read from test captions: {reads:.1%}")
    save_folder(options.out, model, caption_bank(scenes), card=card, trained_steps=int(meta["step"]))
    print(f"{options.out}: {sum(f.stat().st_size for f in options.out.iterdir()) / 1e6:.1f} MB")


if __name__ == "__main__":
    raise SystemExit(main())
