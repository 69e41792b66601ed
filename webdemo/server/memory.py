"""The C library's heaps, which by themselves keep much of what a run has freed."""

from __future__ import annotations

import ctypes

ARENAS = 2
"""Heaps of glibc; each keeps what its threads have freed, and a run has many threads."""
_M_ARENA_MAX = -8


def share_heaps() -> None:
    """Limits the heaps that the C library's threads use; call it before any thread starts."""
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_ARENA_MAX, ARENAS)


def give_back() -> None:
    """Returns unused memory inside the heaps to the system; takes milliseconds.

    Tensors and files of a run leave gaps, and glibc itself returns memory only from a heap's end.
    """
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):
        trim(0)
