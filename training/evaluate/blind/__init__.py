"""Blind comparison by people, of two models or of a model and recorded duets."""

from .pairs import InPair, choose, lay_out, make, reveal, verdict

__all__ = ["InPair", "choose", "lay_out", "make", "reveal", "verdict"]
