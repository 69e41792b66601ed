"""InterFormer (Chopin, thesis, chapter 3): the network, its decoding, and the shipped :mod:`.compact`."""

from .network import (
    JOINTS,
    WIDTH,
    InterFormer,
    InterFormerConfig,
    Positions,
    from_released,
    joint_distances,
    skeleton_mask,
    target_mask,
)

__all__ = [
    "JOINTS",
    "WIDTH",
    "InterFormer",
    "InterFormerConfig",
    "Positions",
    "from_released",
    "joint_distances",
    "skeleton_mask",
    "target_mask",
]
