"""Turns results into pictures; knows no network."""

from .payload import Curve, Payload, distance_curves, player_payload, sample_payload
from .plotly_figure import figure, write_figure

__all__ = ["Curve", "Payload", "distance_curves", "figure", "player_payload", "sample_payload", "write_figure"]
