"""The addresses of live streams.

``POST live`` opens one, ``POST live/ID`` sends poses and is answered with the partner's, ``DELETE live/ID`` ends it.
A message is an ordinary request, so it passes the same checks as all others, and every proxy lets it through.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from motion import FPS, SMPL22, Clip, InputError
from motion.video.landmarks import camera_number
from webdemo.ui.visitor import Visitor, visitor_of
from webdemo.view.payload import player_payload

from .stream import StreamEnded, read_fields
from .streams import StreamRefused, Streams, StreamUnknown
from .turns import Replaced


def live_routes(streams: Streams) -> APIRouter:
    """The routes of a server's live streams."""
    router = APIRouter()

    @router.post("/live")
    async def begin(request: Request) -> Response:
        visitor, body = visitor_of(request), await request.body()
        return await _answered(
            request, lambda: streams.opening(visitor.person, partial(_begin, streams, visitor, body))
        )

    @router.post("/live/{key}")
    async def frames(key: str, request: Request) -> Response:
        body = await request.body()
        return await _answered(request, lambda: streams.answer(key, visitor_of(request), body))

    @router.delete("/live/{key}")
    async def end(key: str, request: Request) -> Response:
        return await _answered(request, lambda: _end(streams, key, visitor_of(request)))

    return router


async def _answered(request: Request, job: Callable[[], dict[str, Any] | Future[dict[str, Any]]]) -> Response:
    """The answer to a message, once it is there; errors are sentences."""
    status, answer = 200, {}
    try:
        found = job()
        answer = await asyncio.wrap_future(found) if isinstance(found, Future) else found
    except StreamRefused as error:
        status, answer = 503, {"detail": str(error)}
    except StreamUnknown as error:
        status, answer = 404, {"detail": str(error)}
    except StreamEnded as error:
        status, answer = 410, {"detail": str(error)}
    except Replaced as error:
        status, answer = 409, {"detail": str(error)}
    except InputError as error:
        status, answer = 422, {"detail": str(error)}
    return JSONResponse(answer, status_code=status, headers={"Cache-Control": "no-store"})


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


def _end(streams: Streams, key: str, visitor: Visitor) -> dict[str, Any]:
    stream = streams.find(key, visitor)
    streams.close(stream)
    return {"frames": stream.counts.frames}
