"""InterGen (Liang et al. 2024): the paper's denoiser, its :mod:`.losses`, and the shipped :mod:`.compact`."""

from .network import Block, InterGenConfig, InterGenDenoiser, from_released

__all__ = ["Block", "InterGenConfig", "InterGenDenoiser", "from_released"]
