"""Arrays as the bytes of NumPy's files."""

from __future__ import annotations

import io

import numpy as np


def npz(**arrays: np.ndarray) -> bytes:
    """A compressed .npz."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def npy(array: np.ndarray, *, allow_pickle: bool = False) -> bytes:
    """A .npy."""
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=allow_pickle)
    return buffer.getvalue()
