"""All live streams of a server: who may have one, how many there are, and when one ends.

``POST live`` opens one, ``POST live/ID`` sends poses and is answered with the partner's, ``DELETE live/ID`` ends it.
A message is an ordinary request, so it passes the same checks as all others, and every proxy lets it through.
Once a stream has ended, the answer is ``{"ended": sentence}``, since a page may have sent its last message before that.
"""

from __future__ import annotations

import asyncio
import logging
import secrets
import threading
import time
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any, TypeVar

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import JSONResponse, Response

from motion import FPS, SMPL22, Clip, InputError
from webdemo.inference.engine import Engine
from webdemo.inference.requests.live import check_partner
from webdemo.server.accounts.quotas import Quota
from webdemo.server.http.routes import Refused
from webdemo.ui.visitor import Visitor, visitor_of
from webdemo.view.payload import player_payload

from .stream import LiveStream, StreamEnded, read_fields

log = logging.getLogger(__name__)
Answer = TypeVar("Answer")

IDLE = 20.0
"""Seconds without a message after which a stream is closed."""
LONGEST = 600.0
"""Seconds that a stream may last."""
KEPT = 256
"""Ended streams whose reason is kept for their page."""
OTHER_TAB = "Another live stream of yours has begun, so this one ended: press Start to go on here."
TOO_LONG = f"A live stream lasts {LONGEST / 60:.0f} minutes at most: press Start to go on."
SILENT = f"Nothing came for {IDLE:.0f} seconds, so the live stream was closed: press Start to go on."
REPLACED = "A newer message of this live stream took this one's place: send one after the other."
OFF = "Live streams are switched off on this server: film a video and press React."
STOPPING = "The server is stopping: press Start again in a minute."
UNKNOWN = "The server does not know this live stream any more: press Start to go on."


class Streams:
    """Opens streams, finds them again and closes those that are idle.

    Each person may have one: opening another ends the first. One thread at a time computes, a frame of each stream in
    turn, as several would wait for Python's interpreter lock; a stream's message waits until the one before is
    answered, and a newer one takes its place. Streams are opened beside that, as networks may have to be loaded first.

    Args:
        engine: has the partners.
        quota: of streams.
    """

    def __init__(self, engine: Engine, quota: Quota) -> None:
        self.engine, self.quota, self.clock = engine, quota, time.monotonic
        self._computing, self._opening = asyncio.Lock(), asyncio.Lock()  # whoever waits longest goes first
        self._began: dict[asyncio.Lock, float] = {}
        self._lock = threading.Lock()
        self._open: dict[str, LiveStream] = {}
        self._ended: dict[str, str] = {}
        self._stopping = False

    @property
    def stuck(self) -> float:
        """Seconds for which a frame, or the opening of a stream, has taken."""
        return max((self.clock() - began for began in list(self._began.values())), default=0.0)

    @property
    def count(self) -> int:
        """Number of open streams."""
        return len(self._open)

    def open(self, visitor: Visitor, partner: str, *, seed: int = 0) -> LiveStream:
        """A new stream; the networks may have to be loaded first.

        Raises:
            Refused: if there are none here.
            InputError: if there are too many, or for a partner that is not known.
        """
        check_partner(partner)
        self.sweep()
        with self._lock:
            self._admit(visitor)
        made = self.engine.partner(partner, seed=seed)
        stream = LiveStream(secrets.token_urlsafe(16), visitor.person, visitor.address, made, self.clock)
        with self._lock:
            if self._stopping:
                raise Refused(503, STOPPING, "live")
            self._open[stream.id] = stream
        return stream

    def _admit(self, visitor: Visitor) -> None:
        """Ends the person's other stream; raises InputError if there is no room for a new one."""
        if self._stopping:
            raise Refused(503, STOPPING, "live")
        if not self.quota.everybody:
            raise Refused(503, OFF, "live")
        for stream in [stream for stream in self._open.values() if stream.person == visitor.person]:
            self._end(stream, OTHER_TAB)
        held = [(stream.person, stream.address) for stream in self._open.values()]
        self.quota.check(visitor.person, visitor.address, held)

    def find(self, key: str, visitor: Visitor) -> LiveStream:
        """A person's stream.

        Raises:
            StreamEnded: if it has ended.
            Refused: if there is none of this id, or it is another person's.
        """
        self.sweep()
        with self._lock:
            stream = self._open.get(key)
            if stream is None or stream.person != visitor.person:
                reason = self._ended.get(key)
                raise Refused(404, UNKNOWN, "live") if reason is None else StreamEnded(reason)
        return stream

    async def opened(self, job: Callable[[], Answer]) -> Answer:
        """Calls a function that opens a stream, in a thread, when it is its turn."""
        return await self._in_turn(self._opening, job)

    async def answer(self, key: str, visitor: Visitor, body: bytes) -> dict[str, Any]:
        """The answer of a person's stream to a message.

        Raises:
            StreamEnded: if it has ended.
            Refused: as :meth:`find`, and for a message whose place a newer one has taken.
            InputError: for a message that cannot be read.
        """
        stream = self.find(key, visitor)
        stream.heard = self.clock()
        stream.newest = mine = object()
        async with stream.one:
            if stream.newest is not mine:
                raise Refused(409, REPLACED, "live")
            steps, answer = stream.answer(body), None
            while answer is None:
                answer = await self._in_turn(self._computing, partial(next, steps))
            return answer

    async def _in_turn(self, turns: asyncio.Lock, job: Callable[[], Answer]) -> Answer:
        async with turns:
            self._began[turns] = self.clock()
            try:
                return await run_in_threadpool(job)
            finally:
                del self._began[turns]

    def close(self, stream: LiveStream) -> None:
        """Ends a stream that its person has stopped."""
        with self._lock:
            self._end(stream, UNKNOWN)

    def sweep(self) -> None:
        """Ends streams that are idle or too old."""
        now = self.clock()
        with self._lock:
            for stream in list(self._open.values()):
                if now - stream.heard > IDLE:
                    self._end(stream, SILENT)
                elif now - stream.began > LONGEST:
                    self._end(stream, TOO_LONG)

    def stop(self) -> None:
        """Ends all streams and takes no more."""
        with self._lock:
            self._stopping = True
            for stream in list(self._open.values()):
                self._end(stream, STOPPING)

    def _end(self, stream: LiveStream, reason: str) -> None:
        """The caller holds the lock."""
        stream.ended = reason
        if self._open.pop(stream.id, None) is None:
            return
        self._ended[stream.id] = reason
        while len(self._ended) > KEPT:
            del self._ended[next(iter(self._ended))]
        log.info("live", extra={"frames": stream.frames, "milliseconds": round(stream.milliseconds, 2)})


# ---- the addresses of live streams ---------------------------------------------------------------


def live_routes(streams: Streams) -> APIRouter:
    """The routes of a server's live streams."""
    router = APIRouter()

    @router.post("/live")
    async def begin(request: Request) -> Response:
        body = await request.body()
        return await _answered(streams.opened(partial(_begin, streams, visitor_of(request), body)))

    @router.post("/live/{key}")
    async def frames(key: str, request: Request) -> Response:
        body = await request.body()
        return await _answered(streams.answer(key, visitor_of(request), body))

    @router.delete("/live/{key}")
    async def end(key: str, request: Request) -> Response:
        return await _answered(run_in_threadpool(_end, streams, key, visitor_of(request)))

    return router


async def _answered(job: Awaitable[dict[str, Any]]) -> Response:
    """The answer to a message, once it is there."""
    try:
        answer = await job
    except StreamEnded as error:
        answer = {"ended": str(error)}
    return JSONResponse(answer, headers={"Cache-Control": "no-store"})


def _begin(streams: Streams, visitor: Visitor, body: bytes) -> dict[str, Any]:
    fields = read_fields(body)
    seed = fields.get("seed", 0)
    if type(seed) is not int or not 0 <= seed < 2**32:
        raise InputError("The seed of a live stream is a whole number from 0 to 4294967295.")
    stream = streams.open(visitor, str(fields.get("partner", "")), seed=seed)
    empty = player_payload(Clip(SMPL22.standing()[None], FPS, SMPL22, name="you"), title="Live")
    return {"id": stream.id, "payload": {**empty, "id": f"stream-{stream.id}"}}


def _end(streams: Streams, key: str, visitor: Visitor) -> dict[str, Any]:
    stream = streams.find(key, visitor)
    streams.close(stream)
    return {"frames": stream.frames}
