"""Sentence → plan: words are read here once, and nowhere else."""

from .read import read

__all__ = ["read"]
