"""The engine: it loads networks once and runs requests on them, one at a time or several that share passes."""

from .engine import Engine

__all__ = ["Engine"]
