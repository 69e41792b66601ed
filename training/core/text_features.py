"""Frozen MiniLM features of captions: computed once and kept beside the prepared scenes, or in each step on a GPU."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor

from models.text import MiniLM, TokenFeatures
from training.core.checkpoint import write_tensors
from training.core.loop import mixed_precision


class CaptionFeatures:
    """Per-token features of a fixed list of captions, float16, stored end to end.

    Args:
        captions: unique sentences.
        cache: a folder; features of the same captions are read from it, and written to it otherwise.
    """

    def __init__(self, captions: Sequence[str], cache: Path) -> None:
        self.index = {caption: row for row, caption in enumerate(captions)}
        key = hashlib.sha256("\n".join(captions).encode()).hexdigest()[:16]
        path = cache / f"captions_{key}.safetensors"
        try:
            stored = load_file(path)
        except (OSError, SafetensorError):
            stored = _kept(captions)
            write_tensors(path, stored)
        self.features, self.lengths = stored["features"], stored["lengths"]
        self.starts = torch.cat([torch.zeros(1, dtype=torch.long), self.lengths.cumsum(0)])

    def batch(self, captions: Sequence[str]) -> tuple[Tensor, Tensor]:
        """(B, L, 384) float32 features and (B, L) mask, true where a token is real."""
        rows = torch.tensor([self.index[caption] for caption in captions])
        lengths = self.lengths[rows]
        longest = -8 * (-int(lengths.max()) // 8)  # few shapes: kernels are made for each
        place = torch.arange(longest)[None]
        mask = place < lengths[:, None]
        where = (self.starts[rows][:, None] + place).clamp_max(len(self.features) - 1)
        return self.features[where].float() * mask[..., None], mask

    def features_of(self, text: Tensor, mask: Tensor) -> Tensor:
        """The features of a batch, which are what :meth:`batch` gave."""
        return text


class CaptionTokens:
    """Captions as MiniLM's token ids, whose features are computed in each step.

    A GPU does so in a few milliseconds, and features of a million captions need not be kept.

    Args:
        device: where the encoder runs.
    """

    def __init__(self, device: str) -> None:
        self.device, self.encoder = device, MiniLM().to(device)

    def batch(self, captions: Sequence[str]) -> tuple[Tensor, Tensor]:
        """(B, L) ids and (B, L) mask, true where a token is real, on the CPU."""
        ids, mask = self.encoder.tokens(captions)
        spare = -ids.shape[1] % 8
        return F.pad(ids, (0, spare)), F.pad(mask, (0, spare))

    @torch.no_grad()
    def features_of(self, text: Tensor, mask: Tensor) -> Tensor:
        """(B, L, 384) float32 features of ids and mask (B, L)."""
        with mixed_precision(self.device):
            return self.encoder.encode(text, mask).float() * mask[..., None]


@torch.no_grad()
def encoded(captions: Sequence[str]) -> Iterator[tuple[list[int], TokenFeatures]]:
    """Places of captions of alike length, and their features by MiniLM, until all have had their turn."""
    encoder = MiniLM()
    order = sorted(range(len(captions)), key=lambda place: len(captions[place]))
    for start in range(0, len(order), 128):
        places = order[start : start + 128]
        with mixed_precision("cpu"):
            features = encoder([captions[place] for place in places])
        yield places, TokenFeatures(features.features.float(), features.mask)


def _kept(captions: Sequence[str]) -> dict[str, Tensor]:
    """Features of captions end to end, in float16, and how many tokens each has."""
    features: list[Tensor] = [torch.empty(0)] * len(captions)
    for places, tokens in encoded(captions):
        for place, one, mask in zip(places, tokens.features, tokens.mask, strict=True):
            features[place] = one[mask].half()
    return {"features": torch.cat(features), "lengths": torch.tensor([len(one) for one in features])}
