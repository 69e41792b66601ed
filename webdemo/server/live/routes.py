"""The addresses of live streams.

``POST live`` opens one, ``POST live/ID`` sends poses and is answered with the partner's, ``DELETE live/ID`` ends it.
A message is an ordinary request, so it passes the same checks as all others, and every proxy lets it through.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from motion import SMPL22, Clip, InputError
from motion.video.packed import camera_number
from webdemo.inference.actor import FPS
from webdemo.ui.visitor import LOCAL, Visitor
from webdemo.view.payload import player_payload

from .messages import read_fields, read_message
from .streams import StreamEnded, StreamRefused, Streams, StreamUnknown


def live_routes(streams: Streams) -> APIRouter:
    """The routes of a server's live streams."""
    router = APIRouter()

    @router.post("/live")
    async def begin(request: Request) -> Response:
        return await _answered(None, partial(_begin, streams, _visitor(request), await request.body()))

    @router.post("/live/{key}")
    async def frames(key: str, request: Request) -> Response:
        return await _answered(
            streams.worker, partial(_frames, streams, key, _visitor(request), await request.body())
        )

    @router.delete("/live/{key}")
    async def end(key: str, request: Request) -> Response:
        return await _answered(None, partial(_end, streams, key, _visitor(request)))

    return router


async def _answered(worker: Executor | None, job: Callable[[], dict[str, Any]]) -> Response:
    """Does a job in a worker's turn, or in a thread of its own; errors are sentences."""
    status, answer = 200, {}
    try:
        answer = await asyncio.get_running_loop().run_in_executor(worker, job)
    except StreamRefused as error:
        status, answer = 503, {"detail": str(error)}
    except StreamUnknown as error:
        status, answer = 404, {"detail": str(error)}
    except StreamEnded as error:
        status, answer = 410, {"detail": str(error)}
    except InputError as error:
        status, answer = 422, {"detail": str(error)}
    return JSONResponse(answer, status_code=status, headers={"Cache-Control": "no-store"})


def _visitor(request: Request) -> Visitor:
    found = request.scope.get("state", {}).get("visitor")
    return found if isinstance(found, Visitor) else LOCAL


def _begin(streams: Streams, visitor: Visitor, body: bytes) -> dict[str, Any]:
    fields = read_fields(body)
    lens, tilt = (camera_number(fields.get(name)) for name in ("lens", "tilt"))
    seed = fields.get("seed", 0)
    if type(seed) is not int or not 0 <= seed < 2**32:
        raise InputError("The seed of a live stream is a whole number from 0 to 4294967295.")
    stream = streams.open(visitor, str(fields.get("partner", "")), seed=seed, lens=lens, tilt=tilt)
    rest = SMPL22.rest_positions()[None]
    empty = player_payload(Clip(rest - [0, rest[..., 1].min(), 0], FPS, SMPL22, name="you"), title="Live")
    return {"id": stream.id, "payload": {**empty, "id": f"stream-{stream.id}"}}


def _frames(streams: Streams, key: str, visitor: Visitor, body: bytes) -> dict[str, Any]:
    return streams.answer(key, visitor, read_message(body))


def _end(streams: Streams, key: str, visitor: Visitor) -> dict[str, Any]:
    stream = streams.find(key, visitor)
    streams.close(stream)
    return {"frames": stream.counts.frames}
