"""Reactions without a method: the nearest recorded one, a plain Transformer, and a conditional VAE.

What a paper's network must beat. All know the same recorded pairs of the training lists, the actor's whole motion
and the reactor's first pose, as InterFormer does.

Shapes: T frames, J = 22 joints, positions in metres in the actor's first frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from models.layers import sinusoids
from webdemo.inference.pipelines.nearest import Bank

Array = NDArray[np.floating]
Baseline = Callable[[Array], Array]
"""(2, T, 22, 3) people → (T, 22, 3) person b; of person b only the first pose is looked at."""

MOST = 150
"""Frames of a training pair that the networks learn from."""
LATENT = 16
"""Width of what the conditional VAE draws."""
DIVERGENCE = 1e-3
"""Weight of the Kullback–Leibler divergence beside distances in metres."""


def nearest(train: Sequence[Array]) -> Baseline:
    """The reactor of the training pair whose actor and whose reactor's first pose lie nearest.

    Actors are compared at 16 moments over their length. The reactor found is stretched to the length of the actor, and
    put where the given first pose stands: every joint is moved by as much as it moved from its own first pose.

    Args:
        train: pairs (2, T, 22, 3).
    """
    bank = Bank(train)

    def react(people: Array) -> Array:
        found = int(bank.answers(people[0], people[1, 0])[0])
        return bank.reactor(found, people.shape[1], people[1, 0])

    return react


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

    def forward(
        self, actor: Tensor, pose: Tensor, padding: Tensor | None = None, *, latent: Tensor | None = None
    ) -> Tensor:
        """(B, T, 66) reactor from actor (B, T, 66) and the reactor's first pose (B, 66).

        ``padding`` (B, T) is True where an actor has ended; ``latent`` (B, width) is added to every frame.
        """
        given = self.pose(pose) if latent is None else self.pose(pose) + latent
        rows = self.input(actor) + given[:, None]
        rows = rows + sinusoids(rows.shape[1], rows.shape[2], device=rows.device)
        return pose[:, None] + self.output(self.layers(rows, src_key_padding_mask=padding))


class ConditionalVAE(nn.Module):
    """A conditional variational autoencoder of Transformers, after ACTOR (Petrovich et al. 2021).

    Two learned tokens before the frames of actor and reactor become mean and log variance of the latent; the decoder is
    a :class:`PlainTransformer` that sees the latent beside the actor and the first pose.
    """

    def __init__(self, width: int = 96, layers: int = 2, latent: int = LATENT) -> None:
        super().__init__()
        self.input = nn.Linear(132, width)
        self.tokens = nn.Parameter(torch.randn(2, width))
        layer = nn.TransformerEncoderLayer(
            width, 4, 2 * width, dropout=0.1, activation="gelu", batch_first=True, norm_first=True
        )
        self.layers = nn.TransformerEncoder(layer, layers, enable_nested_tensor=False)
        self.moments = nn.Linear(width, latent)
        self.decoder, self.shown = PlainTransformer(width, layers), nn.Linear(latent, width)
        nn.init.normal_(self.shown.weight, std=0.02)  # so that the actor is learned first

    def encode(self, actor: Tensor, reactor: Tensor, padding: Tensor) -> tuple[Tensor, Tensor]:
        """Mean and log variance (B, latent) of actors and reactors (B, T, 66); ``padding`` as in the decoder."""
        rows = self.input(torch.cat([actor, reactor], dim=-1))
        rows = rows + sinusoids(rows.shape[1], rows.shape[2], device=rows.device)
        rows = torch.cat([self.tokens.expand(len(rows), -1, -1), rows], dim=1)
        seen = self.moments(self.layers(rows, src_key_padding_mask=nn.functional.pad(padding, (2, 0)))[:, :2])
        return seen[:, 0], seen[:, 1]


def _losses(made: Tensor, reactor: Tensor, real: Tensor) -> Tensor:
    """Distances of the joints, and of their steps, of reactors (B, T, 66)."""
    apart = _distance(made, reactor)[real].mean()
    moved = _distance(made.diff(dim=1), reactor.diff(dim=1))[real[:, 1:]].mean()
    return apart + 5 * moved


def _learned(
    network: nn.Module, loss: Callable[[Tensor, Tensor, Tensor], Tensor], train: Sequence[Array], seed: int, *,
    steps: int, batch: int,
) -> None:  # fmt: skip
    """Trains a network on pairs (2, T, 22, 3) with Adam; ``loss`` takes actor, reactor and the real frames."""
    rng = np.random.default_rng(seed)
    optimizer = torch.optim.AdamW(network.parameters(), lr=1e-3, weight_decay=1e-2)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 1e-3, total_steps=steps)
    for _ in range(steps):
        optimizer.zero_grad()
        loss(*_batch([train[row] for row in rng.integers(len(train), size=batch)], rng)).backward()
        nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        schedule.step()
    network.eval().requires_grad_(False)


def _answer(network: PlainTransformer, people: Array, latent: Tensor | None = None) -> Array:
    """The reactor (T, 22, 3), in the given first pose at first."""
    actor, pose = (torch.from_numpy(part.reshape(-1, 66)).float() for part in (people[0], people[1, :1]))
    made = network(actor[None], pose, latent=latent)[0].numpy().reshape(-1, 22, 3)
    return np.concatenate([people[1, :1], made[1:]])


def plain_transformer(train: Sequence[Array], *, seed: int, steps: int = 400, batch: int = 16) -> Baseline:
    """A :class:`PlainTransformer` that has learned pairs (2, T, 22, 3): joint distances and steps, Adam."""
    torch.manual_seed(seed)
    network = PlainTransformer()

    def loss(actor: Tensor, reactor: Tensor, real: Tensor) -> Tensor:
        return _losses(network(actor, reactor[:, 0], ~real), reactor, real)

    _learned(network, loss, train, seed, steps=steps, batch=batch)
    return partial(_answer, network)


def conditional_vae(train: Sequence[Array], *, seed: int, steps: int = 400, batch: int = 16) -> Baseline:
    """A :class:`ConditionalVAE` that has learned pairs (2, T, 22, 3); each answer draws a latent of the seed."""
    torch.manual_seed(seed)
    network = ConditionalVAE()

    def loss(actor: Tensor, reactor: Tensor, real: Tensor) -> Tensor:
        mean, spread = network.encode(actor, reactor, ~real)
        latent = mean + (0.5 * spread).exp() * torch.randn_like(mean)
        made = network.decoder(actor, reactor[:, 0], ~real, latent=network.shown(latent))
        divergence = 0.5 * (mean.square() + spread.exp() - 1 - spread).sum(-1).mean()
        return _losses(made, reactor, real) + DIVERGENCE * divergence

    _learned(network, loss, train, seed, steps=steps, batch=batch)
    generator = torch.Generator().manual_seed(seed)

    def react(people: Array) -> Array:
        return _answer(network.decoder, people, network.shown(torch.randn(1, LATENT, generator=generator)))

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
