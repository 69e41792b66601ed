"""One process that serves the application, and ends well."""

from __future__ import annotations

import asyncio
import logging
import resource
import socket
import struct
import sys
from collections import Counter
from typing import Any, cast
from urllib.parse import quote

import uvicorn
from starlette.concurrency import run_in_threadpool
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware
from uvicorn.protocols.http.h11_impl import H11Protocol

from motion import InputError
from webdemo.server.accounts.proxy import PeerNoted
from webdemo.server.cluster.instance_lock import InstanceLock
from webdemo.server.http.networks import network_of
from webdemo.server.store.scratch import Scratch

from .app import Lab, create_app
from .logs import keep_last_errors, set_up_logs
from .memory import share_heaps
from .settings import Settings
from .watchdog import tell_systemd

log = logging.getLogger(__name__)

SWITCH_SECONDS = 0.001
"""After which a thread that computes lets another go on, a fifth of Python's own: the page answers sooner."""
FILES = 512
"""Open files beside the connections: the database, motions, libraries."""
CLOSING_SECONDS = 3
"""Seconds allowed for open connections once all runs have ended."""


def bounded_protocol(settings: Settings) -> type[H11Protocol]:
    """HTTP that closes connections which are too many, whose head does not come, or whose answers are not read.

    Each counts for the address that it comes from. One of a trusted proxy's counts for the address whose request it
    carries, as soon as there is one.
    """
    counts: Counter[str] = Counter()
    trusted = cast(Any, ProxyHeadersMiddleware)(None, trusted_hosts=settings.proxies).trusted_hosts

    class Bounded(H11Protocol):
        address: str | None = None
        waiting: asyncio.TimerHandle | None = None
        looking: asyncio.TimerHandle | None = None
        moved = 0.0

        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            if len(self.connections) > settings.connections:
                self._send_away()
            elif self._counts_for(self.client[0] if self.client else ""):
                self._expect_head()
                self._look()

        def connection_lost(self, exc: Exception | None) -> None:
            super().connection_lost(exc)
            self._stop_expecting()
            if self.looking is not None:
                self.looking.cancel()
            self._count(None)

        def _count(self, address: str | None) -> None:
            if self.address is not None:
                counts[self.address] -= 1
                if not counts[self.address]:
                    del counts[self.address]
            self.address = address
            if address is not None:
                counts[address] += 1

        def _counts_for(self, host: str) -> bool:
            """Counts for an address from now on, or closes where that has too many; returns whether it goes on."""
            address = network_of(host)
            if address != self.address:
                self._count(None)
                if counts[address] >= settings.address_connections:
                    self._send_away()
                    return False
                self._count(address)
            return True

        def _send_away(self) -> None:
            self.connections.discard(self)  # it takes no place of those who are let in
            self.transport.close()

        def _look(self) -> None:
            """Ends the connection where an answer has waited to be read for too long."""
            now = self.loop.time()
            if not self.transport.get_write_buffer_size():
                self.moved = now
            elif now - self.moved > settings.answer_seconds:
                now_and_nothing_more = struct.pack("ii", 1, 0)  # the system would go on sending what it holds
                wire = self.transport.get_extra_info("socket")
                wire.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, now_and_nothing_more)
                self.transport.abort()
                return
            self.looking = self.loop.call_later(settings.answer_seconds / 4, self._look)

        def resume_writing(self) -> None:
            super().resume_writing()
            self.moved = self.loop.time()

        def data_received(self, data: bytes) -> None:
            before = self.cycle
            super().data_received(data)
            if self.cycle is not before:
                self._stop_expecting()
                if self.client and self.client[0] in trusted:
                    named = b", ".join(value for name, value in self.headers if name == b"x-forwarded-for")
                    host = trusted.get_trusted_client_address(named.decode("latin-1"))[0]
                    self._counts_for(host or self.client[0])
            elif self._between and self.waiting is None:  # the head of a further request has begun
                self._expect_head()

        @property
        def _between(self) -> bool:
            return self.cycle is None or self.cycle.response_complete

        def _expect_head(self) -> None:
            self.waiting = self.loop.call_later(settings.header_seconds, self._head_is_late)

        def _stop_expecting(self) -> None:
            if self.waiting is not None:
                self.waiting.cancel()
                self.waiting = None

        def _head_is_late(self) -> None:
            self.waiting = None
            if self._between:
                self.transport.close()

    return Bounded


class Server(uvicorn.Server):
    """A uvicorn that waits for the runs before it closes the connections which carry them, and tells systemd."""

    def __init__(self, config: uvicorn.Config, lab: Lab) -> None:
        super().__init__(config)
        self.lab = lab

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begins to serve."""
        await super().startup(sockets)
        if self.started:
            tell_systemd("READY=1")

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Lets running work end, then stops the server."""
        tell_systemd("STOPPING=1")
        if not self.force_exit:
            await run_in_threadpool(self.lab.stop)
        await super().shutdown(sockets)


def make_server(settings: Settings, *, scratch: bool = False, **parts: Any) -> Server:
    """The server for the settings; ``parts`` go to :func:`create_app`.

    With ``scratch`` all files of this process, Gradio's as well, lie in the data folder.
    """
    node = InstanceLock(settings.data, settings.node)
    keep_last_errors()
    if scratch:
        parts["scratch"] = Scratch(
            settings.data / "scratch" / quote(node.name, safe=""), settings.scratch_megabytes * 2**20
        )
        parts["scratch"].take_uploads()
    app = create_app(settings, node=node, **parts)
    forwarded: Any = ProxyHeadersMiddleware
    config = uvicorn.Config(
        PeerNoted(forwarded(app, trusted_hosts=settings.proxies)),
        host=settings.host,
        port=settings.port,
        http=bounded_protocol(settings),
        ws="none",
        proxy_headers=False,
        access_log=False,
        log_config=None,
        server_header=False,
        timeout_graceful_shutdown=CLOSING_SECONDS,
        timeout_keep_alive=30,
        loop="asyncio",
        h11_max_incomplete_event_size=32 * 1024,
        backlog=512,
    )
    return Server(config, app.state.lab)


def serve(settings: Settings) -> None:
    """Serves until SIGTERM or Ctrl+C.

    Raises:
        InputError: if the settings do not fit or the address is taken.
    """
    settings.check()
    with socket.socket(socket.AF_INET6 if ":" in settings.host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((settings.host, settings.port))
        except OSError as error:
            raise InputError(
                f"The page cannot be served on {settings.host}:{settings.port} ({error.strerror or error}): "
                "set PASDEDEUX_PORT to a free port."
            ) from None
    set_up_logs(settings.log_level, content=settings.log_content)
    settings = with_room_for_files(settings)
    sys.setswitchinterval(SWITCH_SECONDS)
    share_heaps()
    server = make_server(settings, scratch=True)
    print(f"Pas de Deux is on {settings.url}", flush=True)
    server.run()


def with_room_for_files(settings: Settings) -> Settings:
    """The settings with no more connections than the system lets this process have beside its files.

    A process that may open nothing more can neither take a connection nor read its history.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = settings.connections + FILES
    if soft != resource.RLIM_INFINITY and soft < wanted:
        soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    if soft == resource.RLIM_INFINITY or soft >= wanted:
        return settings
    room = max(soft - FILES, soft // 2)
    log.warning("The system allows %d open files: %d connections are taken.", soft, room)
    return settings.model_copy(update={"connections": room})
