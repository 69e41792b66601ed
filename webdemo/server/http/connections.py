"""Connections: how many there may be, and when one is ended."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import struct
from collections import Counter
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from webdemo.server.accounts.quotas import Quota, network_of
from webdemo.server.accounts.visitors import PEER, trusted_hosts
from webdemo.server.settings import Settings

HEAD_BYTES = 32 * 1024
"""Most bytes of a request's head."""
HEAD_LINES = 100
"""Most lines of a request's head; each takes 10 µs."""
PIECES, PIECE_BYTES = 200, 512
"""Pieces of a body that may be of any size, and the bytes that all further ones must have on average: reading a piece
takes 11 µs, so in pieces of one byte a few megabits a second would keep the server from doing anything else."""


class BoundedPieces(h11.Connection):
    """A connection that fails where a head has too many lines or a body comes in pieces that are too small."""

    pieces = 0.0

    def next_event(self) -> Any:
        """The next event; raises RemoteProtocolError for the line or the piece that is too much."""
        if self.their_state is h11.IDLE:
            head, _, _ = self.trailing_data[0].partition(b"\r\n\r\n")
            if head.count(b"\n") > HEAD_LINES:
                raise h11.RemoteProtocolError("The request has too many headers.")
        event = super().next_event()
        if isinstance(event, h11.Request):
            self.pieces = 0.0
        elif isinstance(event, h11.Data):
            self.pieces += 1 - len(event.data) / PIECE_BYTES
            if self.pieces > PIECES:
                raise h11.RemoteProtocolError("The body comes in pieces that are too small.")
        return event


def bounded_protocol(settings: Settings, quota: Quota) -> type[H11Protocol]:
    """HTTP that closes connections which are too many, whose head does not come, or whose answers are not read.

    Each counts for the address that it comes from. One of a trusted proxy's counts for the address whose request it
    carries, as soon as there is one.

    Args:
        settings: the times, and the trusted proxies.
        quota: of connections.
    """
    counts: Counter[str] = Counter()
    trusted = trusted_hosts(tuple(settings.proxies))
    every = min(settings.header_seconds, settings.answer_seconds) / 4

    class Bounded(H11Protocol):
        address: str | None = None
        looking: asyncio.TimerHandle | None = None
        head_since: float | None = None
        moved = 0.0

        def __init__(self, *config: Any, **more: Any) -> None:
            super().__init__(*config, **more)
            self.conn = BoundedPieces(h11.SERVER, HEAD_BYTES)

        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            self.app_state = {**self.app_state, PEER: self.client[0] if self.client else ""}
            if len(self.connections) > quota.everybody:
                self._send_away()
            elif self._counts_for(self.client[0] if self.client else ""):
                self.head_since = self.loop.time()
                self._look()

        def connection_lost(self, exc: Exception | None) -> None:
            super().connection_lost(exc)
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
                if counts[address] >= min(quota.address, quota.left(len(self.connections))):
                    self._send_away()
                    return False
                self._count(address)
            return True

        def _send_away(self) -> None:
            self.connections.discard(self)  # it takes no place of those who are let in
            self.transport.close()

        def _look(self) -> None:
            """Ends the connection where a head does not come, or an answer has waited to be read for too long."""
            now = self.loop.time()
            if self.head_since is not None and now - self.head_since > settings.header_seconds:
                self.transport.close()
                return
            if not self.transport.get_write_buffer_size():
                self.moved = now
            elif now - self.moved > settings.answer_seconds:
                now_and_nothing_more = struct.pack("ii", 1, 0)  # the system would go on sending what it holds
                wire = self.transport.get_extra_info("socket")
                wire.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, now_and_nothing_more)
                self.transport.abort()
                return
            self.looking = self.loop.call_later(every, self._look)

        def send_400_response(self, msg: str) -> None:
            with contextlib.suppress(h11.LocalProtocolError):  # an answer has begun
                super().send_400_response(msg)
            self.transport.close()

        def resume_writing(self) -> None:
            super().resume_writing()
            self.moved = self.loop.time()

        def data_received(self, data: bytes) -> None:
            before = self.cycle
            super().data_received(data)
            if self.cycle is not before:
                self.head_since = None
                if self.client and self.client[0] in trusted:
                    named = b", ".join(value for name, value in self.headers if name == b"x-forwarded-for")
                    host = trusted.get_trusted_client_address(named.decode("latin-1"))[0]
                    self._counts_for(host or self.client[0])
            elif self.head_since is None and (self.cycle is None or self.cycle.response_complete):
                self.head_since = self.loop.time()  # the head of a further request has begun

    return Bounded
