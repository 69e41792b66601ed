"""The compact default: InterGen's network over spline tokens, with its text conditioner and normaliser.

One object holds what is trained, averaged, shipped and sampled together. On disk it is a weights folder (see
:mod:`models.weights_io`) with ``captions.json`` and ``captions.safetensors``: a bank of training captions,
which measures how far a prompt is from the training data.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import Tensor, nn

from models.intergen import InterGenConfig
from models.known import KNOWN_FEATURES
from models.motion_tokens import DuetSpace, TokenLayout
from models.text import TextConditioner, TextConditionerConfig, TokenFeatures
from models.weights_io import WeightsFolder, common, save_network

from .words import WordDenoiser

Touch = tuple[tuple[str, str], ...]
"""Which joints of the two people come together: (joint of a, joint of b), …"""


@dataclass(frozen=True)
class CompactConfig:
    """Sizes of a :class:`CompactInterGen`, and the touches that it reads from a sentence."""

    latent_dim: int = 320
    ff_size: int = 1024
    num_layers: int = 6
    num_heads: int = 5
    cond_dim: int = 256
    text_layers: int = 2
    dropout: float = 0.0
    layout: TokenLayout = field(default_factory=TokenLayout)
    touches: tuple[Touch, ...] = ()


class TouchReader(nn.Module):
    """Says from the condition vector which joints the sentence wants to meet.

    The network's own motion brings hands near each other; what they should do there is in the words. This
    small classifier is fitted after the network, on its frozen condition vectors (:mod:`training.trainers.touch`).
    """

    def __init__(self, cond_dim: int, touches: Sequence[Touch]) -> None:
        super().__init__()
        self.touches: tuple[Touch, ...] = ((), *touches)
        self.net = nn.Sequential(nn.Linear(cond_dim, 128), nn.GELU(), nn.Linear(128, len(self.touches)))

    def forward(self, condition: Tensor) -> Tensor:
        """Condition (B, cond_dim) → logits (B, 1 + touches); the first says that nothing touches."""
        return self.net(condition)


@torch.no_grad()
def read_touches(reader: TouchReader | None, condition: Tensor) -> list[Touch]:
    """The likeliest touch of each condition vector (B, cond_dim), () where none is as likely, or nobody reads them."""
    if reader is None:
        return [()] * len(condition)
    probability = reader(condition).softmax(-1)
    due = 1 - probability[:, 0] >= 0.5
    best = probability[:, 1:].argmax(-1) + 1
    return [reader.touches[int(i)] if d else () for d, i in zip(due, best, strict=True)]


class CompactInterGen(DuetSpace):
    """Denoiser, text conditioner and the normaliser of control points."""

    sizes = CompactConfig
    reads_known = True

    def __init__(self, config: CompactConfig) -> None:
        super().__init__(config.layout)
        self.config = config
        sizes = InterGenConfig(**common(config, InterGenConfig), input_features=config.layout.token_features)
        self.denoiser = WordDenoiser(sizes, KNOWN_FEATURES * config.layout.knots_per_token)
        self.conditioner = TextConditioner(
            TextConditionerConfig(latent_dim=config.cond_dim, num_layers=config.text_layers, dropout=0.05)
        )
        self.touch_reader = TouchReader(config.cond_dim, config.touches) if config.touches else None

    def condition(self, both: TokenFeatures, a: TokenFeatures | None = None, b: TokenFeatures | None = None) -> Tensor:
        """Encodes sentences for both people and for each as the denoiser's condition.

        Args:
            both: of B sentences; one without tokens is missing.
            a, b: of B sentences for each person.

        Returns:
            (B, 3, R, cond_dim), R rows for the longest sentence.
        """
        given = {i: tokens for i, tokens in enumerate((both, a, b)) if tokens is not None}
        longest = 1 + max(tokens.mask.shape[1] for tokens in given.values())
        text = both.features.new_zeros(len(both.mask), 3, longest, self.config.cond_dim)
        for i, tokens in given.items():
            rows = self.conditioner.rows(tokens.features, tokens.mask)
            text[:, i, : rows.shape[1]] = rows * tokens.mask.any(1)[:, None, None]
        return text

    def no_condition(self, batch: int = 1) -> Tensor:
        """The condition of no words."""
        return torch.zeros(batch, 3, 1, self.config.cond_dim)

    def touches(self, condition: Tensor) -> list[Touch]:
        """The joints that should touch, for each condition of :meth:`condition`; () if none should."""
        return read_touches(self.touch_reader, condition[:, 0, 0])  # the vector of the sentence for both people

    def shown(self, known: Tensor | None, draft: Tensor | None = None) -> Tensor | None:
        """What the denoiser sees of what is known and of a draft; None where there is neither.

        Args:
            known, draft: (B, tokens, features) of :meth:`models.known.Known.features`; None where there is nothing.
        """
        seen = known if draft is None else draft
        if seen is None:
            return None
        parts = [torch.zeros_like(seen) if part is None else part for part in (known, draft)]
        return torch.cat([part.view(*part.shape[:2], 2, -1) for part in parts], -1).flatten(2)


@dataclass(frozen=True)
class CaptionBank:
    """Training captions and their unit sentence vectors (N, 384)."""

    captions: tuple[str, ...]
    vectors: Tensor
    far: float

    def nearest(self, vector: Tensor) -> tuple[float, str]:
        """The caption nearest to a unit sentence vector (384,), after its cosine."""
        cosine, index = (self.vectors.float() @ vector.float()).max(dim=0)
        return float(cosine), self.captions[int(index)]


def load_captions(source: WeightsFolder) -> CaptionBank:
    """The bank of training captions in a weights folder.

    Raises:
        WeightsError: if a file is missing or altered.
    """
    vectors = source.tensors("captions.safetensors")["vectors"]
    return CaptionBank(tuple(json.loads(source.read("captions.json"))), vectors, float(source.meta["far"]))


def save_folder(folder: Path, model: CompactInterGen, bank: CaptionBank, **options: Any) -> None:
    """Writes the network and its caption bank; options as in :func:`models.weights_io.save_network`."""
    files = {
        "captions.safetensors": save({"vectors": bank.vectors.half().contiguous()}),
        "captions.json": json.dumps(bank.captions, indent=0).encode(),
    }
    save_network(folder, model, extra=files, far=bank.far, **options)
