"""Positions as the player's script reads them out of a payload."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np


def unpack_positions(packed: dict[str, Any]) -> np.ndarray:
    """The inverse of ``pack_positions``: (people, T, J, 3) float32 metres."""
    levels = np.frombuffer(base64.b64decode(packed["data"]), dtype="<u2").reshape(packed["shape"])
    return (np.asarray(packed["min"]) + np.asarray(packed["scale"]) * levels).astype(np.float32)
