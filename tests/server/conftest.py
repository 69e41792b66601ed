"""The engine tests' tiny weights, for the server as well."""

from ..inference.conftest import weights

__all__ = ["weights"]
