"""Ends a process that is stuck, so that its supervisor (Docker, systemd) starts it again; tells systemd how it is."""

from __future__ import annotations

import asyncio
import contextlib
import faulthandler
import logging
import os
import socket
import threading
from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

log = logging.getLogger(__name__)
T = TypeVar("T")

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


class Apart(Generic[T]):
    """Looks at something in a thread of its own, so that it waits for nothing that other threads wait for.

    Whoever asks while somebody's look goes on gets the same answer, so there is one thread at most.

    Args:
        look: gives the answer.
    """

    def __init__(self, look: Callable[[], T]) -> None:
        self.look = look
        self._going: asyncio.Future[T] | None = None

    async def __call__(self) -> T:
        """The answer."""
        if self._going is None or self._going.done():
            self._going = asyncio.get_running_loop().create_future()
            threading.Thread(target=self._work, args=(self._going,), name="apart", daemon=True).start()
        return await asyncio.shield(self._going)

    def _work(self, going: asyncio.Future[T]) -> None:
        told: Callable[[], None]
        try:
            told = partial(going.set_result, self.look())
        except Exception as error:
            told = partial(going.set_exception, error)
        with contextlib.suppress(RuntimeError):  # the server has ended meanwhile
            going.get_loop().call_soon_threadsafe(told)


async def watch(stuck: Callable[[], str], *, silent_seconds: float = SILENT_SECONDS, every: float = EVERY) -> None:
    """Ends the process if something is stuck, or if this coroutine or a thread gets no turn for too long.

    The second holds even where native code keeps Python's interpreter lock for good, since ``faulthandler`` waits in a
    thread of C. Both write where all threads are to stderr; nothing is tidied up.

    Args:
        stuck: says what is stuck; empty while all goes on.
        silent_seconds: time without a turn.
        every: seconds between two looks.
    """
    look = Apart(stuck)
    try:
        while True:
            if reason := await look():
                log.critical("The process ends itself, since it is stuck: %s", reason)
                faulthandler.dump_traceback(STDERR)
                os._exit(STUCK)
            tell_systemd("WATCHDOG=1")
            faulthandler.dump_traceback_later(silent_seconds, exit=True, file=STDERR)
            await asyncio.sleep(every)
    finally:
        faulthandler.cancel_dump_traceback_later()
