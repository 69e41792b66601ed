"""Text encoders: MiniLM with a trained transformer on top, and CLIP's text side in :mod:`.clip`."""

from .minilm import MiniLM, TextConditioner, TextConditionerConfig, TextEncoderError, TokenFeatures

__all__ = ["MiniLM", "TextConditioner", "TextConditionerConfig", "TextEncoderError", "TokenFeatures"]
