"""PredictiveMA-WGAN (Chopin, thesis, chapter 2): the network, on the sphere of :mod:`.srvf`."""

from .network import (
    Critic,
    MAWGANConfig,
    MAWGANLossWeights,
    PredictiveMAWGAN,
    bone_loss,
    critic_loss,
    gradient_penalty,
    gram_distance,
    position_loss,
    reconstruction_loss,
    skeleton_loss,
    speed_loss,
    to_curves,
    to_positions,
    without_flicker,
)

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
