"""BiGraphDiff (Chopin, thesis, chapter 4): the paper's network and the shipped :mod:`.compact`."""

from .network import BiGraphDiff, BiGraphDiffConfig, from_released

__all__ = ["BiGraphDiff", "BiGraphDiffConfig", "from_released"]
