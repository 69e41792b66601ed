"""Two people who attack a server: one fills its queue of events, one floods a live stream."""

from __future__ import annotations

import asyncio
import base64
import contextlib
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from webdemo.inference.actor import read_actor
from webdemo.server.accounts.visitors import VISITOR_COOKIE, new_token

from .served import ROOT

ATTACKERS = 2
EVENTS = 200
"""Events that are sent at first, in one go: more than the server once took of everybody."""
TOP_UP = 20
"""Events that are sent every second after that, so that what is done is replaced at once."""
MESSAGES = 40
"""Messages of the live stream that are on their way at once."""
POSES = 32
"""Poses in each, 0.9 s apart: as much to compute as the server takes of a message."""
_HANDS = ROOT / "static" / "examples" / "shake-hands.npz"
_WAVE = ROOT / "static" / "examples" / "wave.npz"


async def attack(url: str) -> dict[str, Any]:
    """Attacks a server until this is cancelled; returns what was sent and what became of it."""
    counts: Counter[str] = Counter()
    limits = httpx.Limits(max_connections=None)
    async with (
        httpx.AsyncClient(base_url=url, timeout=120, limits=limits) as one,
        httpx.AsyncClient(base_url=url, timeout=120, limits=limits) as other,
    ):
        for client in (one, other):
            client.headers["cookie"] = f"{VISITOR_COOKIE}={new_token()}"
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.gather(_fill(one, counts), _flood(other, counts))
    names = ("events_taken", "events_refused", "messages_answered", "messages_replaced", "messages_refused")
    return {f"attack_{name}": counts[name] for name in names}


async def _fill(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Sends contact sheets and generations, of which nobody fetches the results."""
    sent = await client.post("gradio_api/upload", files={"files": (Path(_HANDS).name, _HANDS.read_bytes())})
    file = {"path": sent.json()[0], "meta": {"_type": "gradio.FileData"}}
    sheet = [file, "png", "bodies", "light", "threequarter", False, 24, 640, 360, None, "", 0, 0, False]
    run = ["Two people dance together.", 5, 0, 2, 3, 20, 0.7, "ddim", "intergen", 1]

    async def ask(i: int) -> None:
        endpoint, data = ("generate", run) if i % 4 == 0 else ("render", sheet)
        answer = await client.post(f"gradio_api/call/{endpoint}", json={"data": data})
        if answer.status_code not in (200, 429, 503):  # a call that no server takes attacks nothing
            answer.raise_for_status()
        counts["events_taken" if answer.status_code == 200 else "events_refused"] += 1

    count = EVENTS
    while True:
        await asyncio.gather(*(ask(i) for i in range(count)))
        await asyncio.sleep(1.0)
        count = TOP_UP


async def _flood(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Sends long messages to one stream, many at once, and opens it again where it has ended."""
    poses = np.rint(1000 * read_actor(_WAVE, person="a")[0].positions).astype("<i2")
    data = base64.b64encode(poses[np.arange(POSES) % len(poses)].tobytes()).decode()
    outcomes = {200: "messages_answered", 409: "messages_replaced"}
    while True:
        opened = await client.post("live", json={"partner": "agent"})
        if opened.status_code != 200:
            counts["messages_refused"] += 1
            await asyncio.sleep(1.0)
            continue
        address, second = f"live/{opened.json()['id']}", 0.0
        ended = False
        while not ended:
            waiting = []
            for _ in range(MESSAGES):
                times = [second + 0.9 * i for i in range(POSES)]
                second += 0.9 * POSES
                waiting.append(client.post(address, json={"times": times, "poses": data}))
            for answer in await asyncio.gather(*waiting):
                counts[outcomes.get(answer.status_code, "messages_refused")] += 1
                ended |= answer.status_code in (404, 410)
            await asyncio.sleep(0.2)
