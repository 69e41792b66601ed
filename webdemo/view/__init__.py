"""Turns results into pictures; knows no network."""

from .curves import Curve, distance_curves
from .payload import Payload, player_payload, sample_payload

__all__ = [
    "Curve",
    "Payload",
    "distance_curves",
    "player_payload",
    "sample_payload",
]
