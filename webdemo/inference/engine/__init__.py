"""The engine: it loads networks once and runs requests on them, one after another."""

from .engine import Engine

__all__ = ["Engine"]
