"""ReGenNet (Xu et al. 2024): the paper's network, and the variant that is shipped in :mod:`.compact`."""

from .network import (
    ROW_WIDTH,
    CausalPass,
    ReGenNet,
    ReGenNetConfig,
    StreamError,
    attend_to_one,
    decoder_layer,
    from_released,
)

__all__ = [
    "ROW_WIDTH",
    "CausalPass",
    "ReGenNet",
    "ReGenNetConfig",
    "StreamError",
    "attend_to_one",
    "decoder_layer",
    "from_released",
]
