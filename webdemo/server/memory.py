"""Memory that a server at rest gives back: what a run has freed, and files that the system can read again."""

from __future__ import annotations

import ctypes
import gc
import sys

ARENAS = 2
"""Heaps of glibc; each keeps what its threads have freed, and a run has many threads."""
_M_ARENA_MAX = -8


def share_heaps() -> None:
    """Limits the heaps that the C library's threads use; call it before any thread starts."""
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_ARENA_MAX, ARENAS)


def put_off_collection() -> None:
    """Keeps Python from looking for garbage while a server starts: it would walk through all modules again and again,
    a fifth of the start."""
    gc.disable()


def collect_again() -> None:
    """Ends :func:`put_off_collection`; what is there by now, modules above all, is left out from then on."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def give_back(*, resting: bool = False) -> None:
    """Returns unused memory inside the heaps to the system; takes milliseconds.

    Tensors and files of a run leave gaps, and glibc itself returns memory only from a heap's end.

    Args:
        resting: nothing runs, so that the pages of mapped weights can go as well.
    """
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):
        trim(0)
    if resting and (mapped := sys.modules.get("models.mapped")):  # not before a network is loaded
        mapped.let_go()
