"""Reactions without a method: the nearest recorded one, and a plain Transformer.

What a paper's network must beat. Both know the same recorded pairs of the training lists, the actor's whole motion
and the reactor's first pose, as InterFormer does.

Shapes: T frames, J = 22 joints, positions in metres in the actor's first frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from models.layers import sinusoids

Array = NDArray[np.floating]
Baseline = Callable[[Array], Array]
"""(2, T, 22, 3) people → (T, 22, 3) person b; of person b only the first pose is looked at."""

MOST = 150
"""Frames of a training pair that the Transformer learns from."""


def nearest(train: Sequence[Array]) -> Baseline:
    """The reactor of the training pair whose actor and whose reactor's first pose lie nearest.

    Actors are compared at 16 moments over their length. The reactor found is stretched to the length of the actor, and
    put where the given first pose stands: every joint is moved by as much as it moved from its own first pose.

    Args:
        train: pairs (2, T, 22, 3).
    """
    known = np.stack([_outline(pair) for pair in train])

    def react(people: Array) -> Array:
        apart = np.linalg.norm(known - _outline(people), axis=-1).mean(axis=-1)
        found = train[int(apart.argmin())][1]
        moments = np.linspace(0, len(found) - 1, people.shape[1])
        lower = np.minimum(moments.astype(int), len(found) - 1)
        upper = np.minimum(lower + 1, len(found) - 1)
        share = (moments - lower)[:, None, None]
        stretched = (1 - share) * found[lower] + share * found[upper]
        return people[1, :1] + stretched - stretched[:1]

    return react


def _outline(people: Array) -> Array:
    """(17 · 22, 3): the actor at 16 moments and the reactor's first pose."""
    moments = np.linspace(0, people.shape[1] - 1, 16).round().astype(int)
    return np.concatenate([people[0, moments].reshape(-1, 3), people[1, 0]])


class PlainTransformer(nn.Module):
    """A Transformer encoder over the actor's frames: no graph, no distances, no diffusion, one pass.

    Args:
        width: of the layers.
        layers: how many.
    """

    def __init__(self, width: int = 96, layers: int = 2) -> None:
        super().__init__()
        self.input = nn.Linear(66, width)
        self.pose = nn.Linear(66, width)
        layer = nn.TransformerEncoderLayer(
            width, 4, 2 * width, dropout=0.1, activation="gelu", batch_first=True, norm_first=True
        )
        self.layers = nn.TransformerEncoder(layer, layers, enable_nested_tensor=False)
        self.output = nn.Linear(width, 66)

    def forward(self, actor: Tensor, pose: Tensor, padding: Tensor | None = None) -> Tensor:
        """(B, T, 66) reactor from actor (B, T, 66) and the reactor's first pose (B, 66).

        ``padding`` (B, T) is True where an actor has ended.
        """
        rows = self.input(actor) + self.pose(pose)[:, None]
        rows = rows + sinusoids(rows.shape[1], rows.shape[2], device=rows.device)
        return pose[:, None] + self.output(self.layers(rows, src_key_padding_mask=padding))


def plain_transformer(train: Sequence[Array], *, seed: int, steps: int = 400, batch: int = 16) -> Baseline:
    """A :class:`PlainTransformer` that has learned pairs (2, T, 22, 3): joint distances and steps, Adam."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    network = PlainTransformer()
    optimizer = torch.optim.AdamW(network.parameters(), lr=1e-3, weight_decay=1e-2)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 1e-3, total_steps=steps)
    for _ in range(steps):
        actor, reactor, real = _batch([train[row] for row in rng.integers(len(train), size=batch)], rng)
        made = network(actor, reactor[:, 0], ~real)
        apart = _distance(made, reactor)[real].mean()
        moved = _distance(made.diff(dim=1), reactor.diff(dim=1))[real[:, 1:]].mean()
        optimizer.zero_grad()
        (apart + 5 * moved).backward()
        nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        schedule.step()
    network.eval().requires_grad_(False)

    def react(people: Array) -> Array:
        actor, pose = (torch.from_numpy(part.reshape(-1, 66)).float() for part in (people[0], people[1, :1]))
        made = network(actor[None], pose)[0].numpy().reshape(-1, 22, 3)
        return np.concatenate([people[1, :1], made[1:]])

    return react


def _batch(pairs: Sequence[Array], rng: np.random.Generator) -> tuple[Tensor, Tensor, Tensor]:
    """Actors and reactors (B, T, 66), turned about the vertical by some degrees, and which frames (B, T) are real."""
    longest = max(min(pair.shape[1], MOST) for pair in pairs)
    both = torch.zeros(2, len(pairs), longest, 66)
    real = torch.zeros(len(pairs), longest, dtype=torch.bool)
    for row, pair in enumerate(pairs):
        angle = rng.normal(0, 0.15)
        cos, sin = np.cos(angle), np.sin(angle)
        turned = pair[:, :longest] @ np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
        both[:, row, : turned.shape[1]] = torch.from_numpy(turned.reshape(2, -1, 66)).float()
        real[row, : turned.shape[1]] = True
    return both[0], both[1], real


def _distance(a: Tensor, b: Tensor) -> Tensor:
    """(B, T) mean distance of joints in metres."""
    return (a - b).unflatten(-1, (22, 3)).norm(dim=-1).mean(-1)
