"""Errors in weights and checkpoints, each one sentence for the user."""

from __future__ import annotations

from motion.errors import InputError


class WeightsError(InputError):
    """A weights file or dict is missing, altered, or belongs to another network."""
