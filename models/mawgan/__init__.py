"""PredictiveMA-WGAN (Chopin, thesis, chapter 2): network and losses, on the sphere of :mod:`.srvf`."""

from .losses import (
    MAWGANLossWeights,
    bone_loss,
    critic_loss,
    gradient_penalty,
    gram_distance,
    position_loss,
    reconstruction_loss,
    skeleton_loss,
    speed_loss,
)
from .network import Critic, MAWGANConfig, PredictiveMAWGAN, to_curves, to_positions, without_flicker

__all__ = [
    "Critic",
    "MAWGANConfig",
    "MAWGANLossWeights",
    "PredictiveMAWGAN",
    "bone_loss",
    "critic_loss",
    "gradient_penalty",
    "gram_distance",
    "position_loss",
    "reconstruction_loss",
    "skeleton_loss",
    "speed_loss",
    "to_curves",
    "to_positions",
    "without_flicker",
]
