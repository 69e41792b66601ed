"""What an InterGen is shipped with: a bank of training captions, by which the demo detects that a prompt is far from
all of them, and weights averaged with those that its training began with."""

from __future__ import annotations

import torch

from models.intergen.compact import CaptionBank, CompactInterGen
from motion import InputError
from training.core.text_features import encoded
from training.prepare import Scenes

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
    vectors = torch.empty(len(captions), 384)
    for places, tokens in encoded(captions):
        vectors[places] = tokens.pooled().float()
    return vectors


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
