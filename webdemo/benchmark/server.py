"""A server of its own on loopback, for what is measured through it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx

from motion import InputError

ROOT = Path(__file__).resolve().parents[2]
START_SECONDS = 180.0


@contextlib.contextmanager
def serving(folder: Path, **settings: object) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """``python app.py`` on a free port of 127.0.0.1, with its data and its log in a folder: the address, and it.

    Args:
        folder: an empty one.
        settings: of the server.
    """
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    chosen = {"host": "127.0.0.1", "port": port, "data": folder, "free_megabytes": 0, "log_level": "warning"}
    env = os.environ | {f"PASDEDEUX_{name.upper()}": str(value) for name, value in (chosen | settings).items()}
    with open(folder / "log", "w", encoding="utf-8") as log:
        server = subprocess.Popen([sys.executable, "app.py"], cwd=ROOT, env=env, stdout=subprocess.DEVNULL, stderr=log)
        try:
            yield f"http://127.0.0.1:{port}/", server
        finally:
            server.send_signal(signal.SIGTERM)
            try:
                server.wait(timeout=90)
            except subprocess.TimeoutExpired:
                server.kill()
                server.wait()


def wait_until(url: str, path: str, server: subprocess.Popen[bytes], *, every: float = 0.5) -> None:
    """Waits until an address of a server answers 200.

    Raises:
        InputError: where it does not come up.
    """
    until = time.monotonic() + START_SECONDS
    while time.monotonic() < until:
        if server.poll() is not None:
            raise InputError("The server ended before it was ready: start `python app.py` to see why.")
        with contextlib.suppress(httpx.TransportError):  # it does not listen yet
            if httpx.get(f"{url}{path}", timeout=30).status_code == 200:
                return
        time.sleep(every)
    raise InputError(f"The server was not ready within {START_SECONDS:g} s: see its /healthz.")
