"""Numbers and names as OpenUSD's text has them."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


def identifier(called: str, other: str) -> str:
    """A name as that of a prim: ASCII letters, digits and underscores, no digit first; ``other`` where none is left."""
    name = re.sub(r"\W+", "_", called, flags=re.ASCII).strip("_")[:40] or other
    return f"_{name}" if name[0].isdigit() else name


def tuple_of(values: Any) -> str:
    """Numbers as a tuple."""
    return str(tuple(np.asarray(values).tolist()))


def rows(values: Array) -> str:
    """(N, k) numbers as an array of tuples."""
    return str(list(map(tuple, np.round(values.astype(np.float64), 6).tolist())))


def matrices(values: Array) -> str:
    """(N, 4, 4) as an array of tuples of rows."""
    return str([tuple(map(tuple, each)) for each in np.round(values, 7).tolist()])


def samples(values: Array) -> str:
    """(T, N, k) as an array of tuples for each frame."""
    frames = "".join(f"{frame}: {rows(each)},\n" for frame, each in enumerate(values))
    return f"{{\n{frames}}}"
