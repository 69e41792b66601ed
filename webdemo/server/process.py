"""Ends a process that is stuck, so that its supervisor (Docker, systemd) starts it again; tells systemd how it is."""

from __future__ import annotations

import asyncio
import ctypes
import faulthandler
import logging
import os
import socket
import sys
from collections.abc import Callable

log = logging.getLogger(__name__)

SILENT_SECONDS = 60.0
"""Time after which a server that answers nothing is ended: two of Docker's looks."""
EVERY = 5.0
"""Seconds between two signs of life."""
STDERR = 2
"""File descriptor, which stays the same whatever takes the place of ``sys.stderr``."""
STUCK = 70
"""Exit code of a process that ended itself since a run was stuck."""


def tell_systemd(state: str) -> None:
    """Sends a state such as ``READY=1`` to systemd where it waits for it (``Type=notify``); see sd_notify(3)."""
    if not (address := os.environ.get("NOTIFY_SOCKET", "")):
        return
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as wire:
            wire.setblocking(False)
            wire.connect(f"\0{address[1:]}" if address.startswith("@") else address)
            wire.sendall(state.encode())
    except OSError as error:  # it ends the process at WatchdogSec
        log.error("systemd could not be told %s: %s", state, error)


async def watch(stuck: Callable[[], str], *, silent_seconds: float = SILENT_SECONDS, every: float = EVERY) -> None:
    """Ends the process if something is stuck, or if this coroutine or a thread gets no turn for too long.

    The second holds even where native code keeps Python's interpreter lock for good, since ``faulthandler`` waits in a
    thread of C. Both write where all threads are to stderr; nothing is tidied up.

    Args:
        stuck: says what is stuck, at once; empty while all goes on.
        silent_seconds: time without a turn.
        every: seconds between two looks.
    """
    try:
        while True:
            if reason := stuck():
                log.critical("The process is stuck and ends itself: %s", reason)
                faulthandler.dump_traceback(STDERR)
                os._exit(STUCK)
            tell_systemd("WATCHDOG=1")
            faulthandler.dump_traceback_later(silent_seconds, exit=True, file=STDERR)
            await asyncio.sleep(every)
    finally:
        faulthandler.cancel_dump_traceback_later()


# ---- memory -----------------------------------------------------------------------------------------


ARENAS = 2
"""Heaps of glibc; each keeps what its threads have freed, and a run has many threads."""
_M_ARENA_MAX = -8


def share_heaps() -> None:
    """Limits the heaps that the C library's threads use; call it before any thread starts."""
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_ARENA_MAX, ARENAS)


def give_back(*, resting: bool = False) -> None:
    """Returns unused memory inside the heaps to the system; takes milliseconds.

    Tensors and files of a run leave gaps, and glibc itself returns memory only from a heap's end.

    Args:
        resting: nothing runs, so that the pages of mapped weights can go as well.
    """
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):
        trim(0)
    if resting and (weights := sys.modules.get("models.weights_io")):  # not before a network is loaded
        weights.let_go()
