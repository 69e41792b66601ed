"""The losses of PredictiveMA-WGAN (Chopin, thesis, sections 2.4 and 2.5)."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn


@dataclass(frozen=True)
class MAWGANLossWeights:
    """β₁ to β₄ of eq. 2.11 and λ of eq. 2.5 (section 2.5.2).

    ``position`` weighs the mean distance of joints in metres. The thesis has no such loss; its eq. 2.9 does not
    see a rotation of the whole pose.
    """

    adversarial: float = 1.0
    reconstruction: float = 1.0
    skeleton: float = 10.0
    bone: float = 10.0
    gradient_penalty: float = 10.0
    position: float = 0.0


def gradient_penalty(critic: nn.Module, real: Tensor, made: Tensor, share: Tensor) -> Tensor:
    """(‖∇D(q̃)‖ − 1)² at q̃ = (1 − a) real + a made, averaged (eq. 2.5).

    Args:
        critic: (B, …) → (B,).
        real, made: (B, …) tangent vectors.
        share: (B,) a, from 0 to 1.
    """
    a = share.view(-1, *[1] * (real.dim() - 1))
    between = ((1 - a) * real + a * made).detach().requires_grad_(True)
    (gradient,) = torch.autograd.grad(critic(between).sum(), between, create_graph=True)
    return ((gradient.flatten(1).square().sum(1) + 1e-12).sqrt() - 1).square().mean()


def critic_loss(critic: nn.Module, real: Tensor, made: Tensor, share: Tensor, *, penalty: float = 10.0) -> Tensor:
    """The critic's loss: the Wasserstein distance of eq. 2.5, negated, and the penalty."""
    distance = critic(real).mean() - critic(made).mean()
    return -distance + penalty * gradient_penalty(critic, real, made, share)


def reconstruction_loss(made: Tensor, real: Tensor) -> Tensor:
    """L1 norm of the difference of tangent vectors (B, N, D) (eq. 2.7), averaged over B.

    The vectors are functions on [0, 1], so the norm is ∫ Σ |·| dt: the sum over coordinates, averaged over the N
    times, as in every inner product of :mod:`models.mawgan.srvf`. A plain sum over all numbers is N times as large.
    """
    return (made - real).abs().sum(-1).mean()


def position_loss(made: Tensor, real: Tensor) -> Tensor:
    """Mean distance of joints (B, T, J, 3) in metres, which is what MPJPE measures."""
    return ((made - real).square().sum(-1) + 1e-10).sqrt().mean()


def gram_distance(p: Tensor, q: Tensor) -> Tensor:
    """Distance of the Gram matrices of poses (eq. 2.8): tr(PPᵀ) + tr(QQᵀ) − 2 Σ σ(QᵀP).

    It is the squared distance of the poses after the best rotation or reflection about the origin.

    Args:
        p, q: (…, J, 3) metres.

    Returns:
        (…) square metres.
    """
    singular = torch.linalg.svdvals(q.transpose(-1, -2) @ p)
    return p.square().sum((-1, -2)) + q.square().sum((-1, -2)) - 2 * singular.sum(-1)


def skeleton_loss(made: Tensor, real: Tensor) -> Tensor:
    """Mean Gram distance of predicted and true poses (B, T, J, 3) (eq. 2.9)."""
    return gram_distance(made, real).mean()


def bone_loss(made: Tensor, real: Tensor, bones: list[tuple[int, int]]) -> Tensor:
    """Mean difference of bone lengths in metres (eq. 2.10).

    Args:
        made, real: (B, T, J, 3) metres.
        bones: (parent, child) places among the joints.
    """
    parents, children = (list(side) for side in zip(*bones, strict=True))
    lengths = [(x[..., children, :] - x[..., parents, :]).norm(dim=-1) for x in (made, real)]
    return (lengths[0] - lengths[1]).abs().mean()
