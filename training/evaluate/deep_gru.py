"""DeepGRU, a classifier of skeleton sequences (Maghoumi & LaViola 2019), small, and the scores read off it.

The thesis (Chopin, section 3.4.2) judges reactions by it: it is trained on the reacting person alone, so the
actor, who is always recorded motion, cannot help. Its deep features give FVD (eq. 3.10) and diversity.

Shapes: B clips, T frames, F numbers a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import torch
import torch.nn.functional as F
from scipy.spatial.distance import pdist
from torch import Tensor, nn
from torch.nn.utils.rnn import pack_padded_sequence, pad_packed_sequence, pad_sequence

from motion.metrics.generation import frechet_distance
from motion.vectors import Array
from training.core import loop


class DeepGRU(nn.Module):
    """Stacked GRUs, attention to the last state, and two layers on top.

    Args:
        features: F.
        classes: how many labels.
        widths: of the stacked GRUs; the paper's are 512, 512, 256, 256, 128, for far more data.
    """

    def __init__(self, features: int, classes: int, widths: Sequence[int] = (96, 64)) -> None:
        super().__init__()
        sizes = [features, *widths]
        self.layers = nn.ModuleList(nn.GRU(n, m, batch_first=True) for n, m in pairwise(sizes))
        last = widths[-1]
        self.attention = nn.Linear(last, last, bias=False)
        self.context = nn.GRU(last, last, batch_first=True)
        self.deep = nn.Sequential(nn.BatchNorm1d(2 * last), nn.Dropout(0.5), nn.Linear(2 * last, last))
        self.top = nn.Sequential(nn.BatchNorm1d(last), nn.ReLU(), nn.Dropout(0.5), nn.Linear(last, classes))

    def features(self, clips: Tensor, lengths: Tensor) -> Tensor:
        """Deep features (B, width) of padded clips (B, T, F) of the given lengths (B,)."""
        packed = pack_padded_sequence(clips, lengths, batch_first=True, enforce_sorted=False)
        for layer in self.layers:
            packed, state = layer(packed)
        h, _ = pad_packed_sequence(packed, batch_first=True)
        real = torch.arange(h.shape[1])[None] < lengths[:, None]
        scores = torch.einsum("btd,bd->bt", h, self.attention(state[-1])).masked_fill(~real, -torch.inf)
        context = torch.einsum("bt,btd->bd", scores.softmax(-1), h)
        _, second = self.context(context[:, None], state)
        return self.deep(torch.cat([context, second[-1]], dim=-1))

    def forward(self, clips: Tensor, lengths: Tensor) -> Tensor:
        """Logits (B, classes)."""
        return self.top(self.features(clips, lengths))


def padded(clips: Sequence[Array]) -> tuple[Tensor, Tensor]:
    """(B, T, F) float32 and lengths (B,) of clips (T_i, F)."""
    tensors = [torch.from_numpy(np.asarray(clip, dtype=np.float32)) for clip in clips]
    return pad_sequence(tensors, batch_first=True), torch.tensor([len(clip) for clip in clips])


def fit(clips: Sequence[Array], labels: Sequence[int], *, seed: int, epochs: int = 80, batch: int = 32) -> DeepGRU:
    """A classifier trained on clips (T_i, F) and their labels; eval mode.

    Every epoch sees the clips cut at random (80 % or more is kept), shifted and scaled a little.
    """
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    counts = np.bincount(labels)
    network = DeepGRU(clips[0].shape[1], len(counts))
    balance = torch.tensor(len(labels) / np.maximum(counts, 1) / len(counts)).float()
    rounds = -(-len(clips) // batch)
    drawn = [rows for _ in range(epochs) for rows in np.array_split(rng.permutation(len(clips)), rounds)]

    def loss(step: int) -> Tensor:
        chosen = [_varied(clips[row], rng) for row in drawn[step]]
        wanted = torch.tensor([labels[row] for row in drawn[step]])
        return F.cross_entropy(network(*padded(chosen)), wanted, weight=balance, label_smoothing=0.05)

    loop.fit(network, loss, len(drawn), rate=2e-3, weight_decay=1e-2)
    return network


def _varied(clip: Array, rng: np.random.Generator) -> Array:
    keep = rng.integers(max(2, int(0.8 * len(clip))), len(clip) + 1)
    start = rng.integers(0, len(clip) - keep + 1)
    return clip[start : start + keep] * rng.uniform(0.95, 1.05) + rng.normal(0, 0.01, clip.shape[1])


def accuracy(network: DeepGRU, clips: Sequence[Array], labels: Sequence[int]) -> float:
    """Share of clips that are taken for what they are."""
    return float((network(*padded(clips)).argmax(-1).numpy() == np.array(labels)).mean())


def spread(features: Array) -> float:
    """Mean distance of all pairs of deep features (N, D)."""
    return float(pdist(features).mean())


def deep_features(network: DeepGRU, clips: Sequence[Array]) -> Array:
    """(N, D) deep features of clips."""
    return network.features(*padded(clips)).double().numpy()


def diversity_score(real: Array, made: Array) -> float:
    """Deviation of the :func:`spread` of features (N, D) from that of recorded motion, in percent (eq. 3.12)."""
    return 100 * abs(spread(real) - spread(made)) / spread(real)


def measured(network: DeepGRU, clips: Sequence[Array], labels: Sequence[int], real: Array) -> dict[str, float]:
    """Accuracy, FVD and diversity of clips beside the deep features of recorded ones."""
    features = deep_features(network, clips)
    return {
        "accuracy": round(accuracy(network, clips, labels), 4),
        "fvd": round(frechet_distance(real, features), 4),
        "diversity": round(diversity_score(real, features), 4),
    }
