"""Turns results into pictures; knows no network."""

from .plotly_figure import figure, write_figure

__all__ = ["figure", "write_figure"]
