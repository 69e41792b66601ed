"""The default predictor of one person's motion: a residual network over cosine coefficients."""

from .network import MotionMLP, MotionMLPConfig

__all__ = ["MotionMLP", "MotionMLPConfig"]
