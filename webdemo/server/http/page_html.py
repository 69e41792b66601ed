"""Caches what opens the page, since Gradio would copy and traverse its whole configuration for every visitor; and keeps
the server's state of each open page and API client small."""

from __future__ import annotations

import asyncio
import re
import struct
import zlib
from collections import Counter, deque
from functools import reduce
from typing import Any

from gradio.blocks import Blocks
from gradio.state_holder import SessionState, StateHolder
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from webdemo.server.accounts.visitors import Bindings

PATHS = ("/", "/config")
_ANY = b"any-host.invalid"
"""Stands for the name by which a visitor calls this server; the guard lets no name in that is more than a name."""
_LEVEL = 5
"""Of packing: a third of the time of the highest, which saves two per cent."""
_PIECE = 2**16
"""Bytes that are sent in one go, so that no more of an answer waits to be read by a visitor who reads slowly."""
_GZIP_HEAD, _GZIP_END = bytes.fromhex("1f8b08000000000000ff"), bytes.fromhex("010000ffff")
"""Ten bytes before the blocks of a gzip file (RFC 1952), and a last block that is empty (RFC 1951)."""


class Page:
    """An answer that is packed once, however many names visitors call the server by.

    Args:
        status: of HTTP.
        headers: without its length.
        body: with :data:`_ANY` in place of the name.
    """

    def __init__(self, status: int, headers: list[tuple[bytes, bytes]], body: bytes) -> None:
        self.status, self.headers, self.parts = status, headers, body.split(_ANY)
        packer = zlib.compressobj(_LEVEL, zlib.DEFLATED, -zlib.MAX_WBITS)
        # After a full flush a name may follow, since nothing behind it refers to what is before.
        self.packed = [packer.compress(part) + packer.flush(zlib.Z_FULL_FLUSH) for part in self.parts]

    def pieces(self, host: bytes, *, packed: bool) -> list[bytes]:
        """The body for a name, which is a block that is stored as it is where the body is packed.

        The large pieces are those of all visitors: the page, held for each who does not read it, took 1.1 MB.
        """
        plain = [piece for part in self.parts for piece in (host, part)][1:]
        if not packed:
            return plain
        crc = reduce(lambda before, piece: zlib.crc32(piece, before), plain, 0)
        stored = struct.pack("<BHH", 0, len(host), len(host) ^ 0xFFFF) + host
        blocks = [piece for block in self.packed for piece in (stored, block)][1:]
        return [_GZIP_HEAD, *blocks, _GZIP_END + struct.pack("<II", crc, sum(map(len, plain)))]


class PageCache:
    """An ASGI middleware that answers GET of :data:`PATHS` from memory, compressed; it runs inside the access checks.

    The answers are the same for all visitors and whatever the query, which scripts read: personal content arrives
    through events. So they hold no secret that their compressed size could give away. The application makes each of
    them once, under the name :data:`_ANY`, which gives way to the name by which a visitor calls this server.

    Args:
        app: renders the page.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._made: dict[tuple[str, str], Page] = {}
        self._making = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request for the page; passes every other one on."""
        if scope["type"] != "http" or scope["method"] != "GET" or scope["path"] not in PATHS:
            await self.app(scope, receive, send)
            return
        sent, key = dict(scope["headers"]), (scope["path"], scope["scheme"])
        async with self._making:  # whoever comes meanwhile waits for what is being made
            made = self._made.get(key) or await self._make(scope, receive)
            if made.status == 200:
                self._made[key] = made
        packed = b"gzip" in sent.get(b"accept-encoding", b"")
        pieces, waiting = made.pieces(sent.get(b"host", b""), packed=packed), b""
        headers = [*made.headers, (b"vary", b"Accept-Encoding"), (b"content-length", b"%d" % sum(map(len, pieces)))]
        headers += [(b"content-encoding", b"gzip")] if packed else []
        await send({"type": "http.response.start", "status": made.status, "headers": headers})
        for piece in pieces:
            for start in range(0, len(piece), _PIECE):
                waiting += piece[start : start + _PIECE]
                if len(waiting) >= _PIECE:
                    await send({"type": "http.response.body", "body": waiting, "more_body": True})
                    waiting = b""
        await send({"type": "http.response.body", "body": waiting})

    async def _make(self, scope: Scope, receive: Receive) -> Page:
        """The application's own answer."""
        made: list[Message] = []

        async def keep(message: Message) -> None:
            made.append(message)

        dropped = (b"accept-encoding", b"cookie", b"host")
        heard = [pair for pair in scope["headers"] if pair[0] not in dropped]
        await self.app({**scope, "headers": [*heard, (b"host", _ANY)], "query_string": b""}, receive, keep)
        body = b"".join(message.get("body", b"") for message in made)
        start = next(message for message in made if message["type"] == "http.response.start")
        kept = [pair for pair in start["headers"] if pair[0] not in (b"content-length", b"vary")]
        return Page(start["status"], kept, body)


# ---- the state of open pages ---------------------------------------------------------------------


CALLS = 64
"""States kept of single API calls. No client returns to one, and they must not displace those of pages."""
_CALL = re.compile(r"\A[0-9a-f]{32}\Z")
"""Gradio's session name of a call outside any session."""


class _Undescribed:
    """Blocks that report no components, so none gets described."""

    def __init__(self, blocks: Blocks) -> None:
        self._all, self.blocks = blocks, ()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._all, name)


class LeanState(SessionState):
    """Gradio's state of a page or client, without the current description of every component.

    Gradio needs that description for links to a page's state, which :class:`webdemo.server.http.guard.Guard` forbids.
    It makes up nearly all of a session's memory and most of the time of its first event.
    """

    def __init__(self, blocks: Blocks) -> None:
        super().__init__(_Undescribed(blocks))  # type: ignore[arg-type]  # it has all attributes that are read

    def _update_config(self, key: int) -> None:
        pass

    def _update_value_in_config(self, key: int, value: Any) -> None:
        pass


class LeanStates(StateHolder):
    """The most recent states: ``capacity`` of all, :data:`CALLS` of them of single calls.

    The address, or the person, that has most of them gives one up first: many new pages take none of others'.

    Args:
        bindings: knows whose each session is.
    """

    def __init__(self, bindings: Bindings) -> None:
        super().__init__()
        self.bindings = bindings
        self._calls: deque[str] = deque()

    def __getitem__(self, session_id: str) -> SessionState:
        with self.lock:
            if session_id not in self.session_data:
                if len(self.session_data) >= self.capacity:
                    homes = {session: self.bindings.home(session) for session in self.session_data}
                    ((most, _),) = Counter(homes.values()).most_common(1)
                    self._drop(next(session for session, home in homes.items() if home == most))
                self.session_data[session_id] = LeanState(self.blocks)
                if _CALL.match(session_id):
                    self._calls.append(session_id)
                    if len(self._calls) > CALLS:
                        self._drop(self._calls.popleft())
        return super().__getitem__(session_id)

    def _drop(self, session: str) -> None:
        self.session_data.pop(session, None)
        self.time_last_used.pop(session, None)
