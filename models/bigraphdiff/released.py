"""The authors' BiGraphDiff: network, text side and CLIP's ViT-B/32 tower, all in one released file.

A sample is (B, T, 150): 25 joints of a Kinect v2 of each person, x, y, z joint after joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor

from models.errors import WeightsError
from models.released import read_tensors, with_prefix
from models.text.clip import ClipTokenizer, ClipTower, tower_from_released
from models.weights_io import Uninitialised
from motion.skeleton import NTU25

from .network import NETWORK, BiGraphDiff, from_released

CLIP = "clip."
JOINTS = NTU25.num_joints
HEAD_WIDTH = 64
"""Channels of a head in the released network."""


class ReleasedBiGraphDiff:
    """Everything in the released file.

    Args:
        network: ε_θ with its text side.
        tower: CLIP's frozen text tower.
        tokenizer: of the tower.
    """

    def __init__(self, network: BiGraphDiff, tower: ClipTower, tokenizer: ClipTokenizer) -> None:
        self.network, self.tower, self.tokenizer = network, tower, tokenizer

    @torch.no_grad()
    def condition(self, prompts: Sequence[str]) -> tuple[Tensor, Tensor]:
        """Features of the tokens (B, 77, C) and of the whole sentences (B, C)."""
        tokens = self.tokenizer(prompts)
        assert self.network.text_side is not None  # load_released refuses a file without one
        features: tuple[Tensor, Tensor] = self.network.text_side(self.tower.token_features(tokens), tokens.argmax(-1))
        return features


def load_released(checkpoint: Path, vocabulary: Path) -> ReleasedBiGraphDiff:
    """The network of the authors' file.

    Args:
        checkpoint: the file.
        vocabulary: as :class:`~models.text.clip.ClipTokenizer` takes it.

    Raises:
        WeightsError: if the file is missing, damaged, another network's, or lacks its text side.
        VocabularyError: if the vocabulary is not CLIP's.
    """
    tensors = read_tensors(checkpoint, network=NETWORK, mark="joint_embed_1.")
    frozen = with_prefix(tensors, CLIP)
    if not frozen:
        raise WeightsError(f"{checkpoint.name} holds no {CLIP}* tensors, CLIP's tower: use the released file.")
    latent_dim = len(tensors.get("joint_embed_1.weight", ()))
    with Uninitialised():
        network = from_released(tensors, num_heads=max(1, latent_dim // HEAD_WIDTH)).requires_grad_(False)
        tower = tower_from_released(frozen)
    if network.text_side is None:
        raise WeightsError(f"{checkpoint.name} holds no text_pre_proj: use the released {NETWORK} checkpoint.")
    if network.config.input_features != 3 * JOINTS:
        raise WeightsError(
            f"{checkpoint.name} was trained on {network.config.input_features} numbers a person and frame, and "
            f"{JOINTS} joints have {3 * JOINTS}: use the checkpoint for NTU RGB+D."
        )
    return ReleasedBiGraphDiff(network, tower, ClipTokenizer(vocabulary, tower))
