"""People who attack a server: they fill its queue of events, flood a live stream, ask for pages and long readings,
leave answers unread, and send the largest files."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import itertools
import multiprocessing
import os
import signal
from collections import Counter
from collections.abc import Callable
from typing import Any, cast

import httpx
import numpy as np

from webdemo.inference.requests.actor import read_actor
from webdemo.server.accounts.visitors import VISITOR_COOKIE, new_token

from .server import ROOT

ATTACKERS = 6
EVENTS = 200
"""Events that are sent at first, in one go: more than the server once took of everybody."""
TOP_UP = 20
"""Events that are sent every second after that, so that what is done is replaced at once."""
MESSAGES = 40
"""Messages of the live stream that are on their way at once."""
POSES = 32
"""Poses in each, 0.9 s apart: as much to compute as the server takes of a message."""
PAGES = 40
"""Connections that ask for the page, each time by another address or in another packing."""
UNREAD = 100
"""Connections whose answers are not read."""
READING_EVERY = 0.25
"""Seconds between two texts of the greatest length."""
LARGE = 2
"""Files at a time, of many markers and as many frames as an upload may have."""
FRAMES = 24_000
"""Of each of them: 48 MB."""
CLIP, WAVE = (ROOT / "static" / "examples" / name for name in ("shake-hands.npz", "wave.npz"))
"""The file that is uploaded, and the clip that plays over and over in a live stream."""


class _Refusing(httpx.AsyncHTTPTransport):
    """Takes a connection that the server cuts, in the middle of a request or of an answer, for a refusal (503)."""

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        try:
            answer = await super().handle_async_request(request)
            await answer.aread()
        except httpx.TransportError:
            return httpx.Response(503)
        return answer


def attack_apart(url: str) -> Callable[[], dict[str, Any]]:
    """Attacks a server from a process of its own, since what is sent would keep those waiting who measure; returns what
    ends that. It gives what was sent and what became of it, or raises EOFError where the attackers failed."""
    context = multiprocessing.get_context("fork")
    counts, theirs = context.Pipe(duplex=False)

    def work() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job has it ignored
        theirs.send(asyncio.run(attack(url)))

    process = context.Process(target=work, daemon=True)
    process.start()
    theirs.close()

    def end() -> dict[str, Any]:
        os.kill(process.pid or 0, signal.SIGINT)  # cancels what asyncio runs
        return counts.recv()

    return end


async def attack(url: str) -> dict[str, Any]:
    """Attacks a server until this is cancelled; returns what was sent and what became of it."""
    counts: Counter[str] = Counter()
    limits = httpx.Limits(max_connections=None)
    async with contextlib.AsyncExitStack() as people:
        going = []
        for way in (_fill, _flood, _ask_for_pages, _ask_for_readings, _read_nothing, _send_large):
            cookie = {"cookie": f"{VISITOR_COOKIE}={new_token()}"}
            client = httpx.AsyncClient(base_url=url, timeout=120, transport=_Refusing(limits=limits), headers=cookie)
            going.append(way(await people.enter_async_context(client), counts))
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.gather(*going)
    return {f"attack_{name}": count for name, count in sorted(counts.items())}


def _count(answer: httpx.Response, what: str, counts: Counter[str]) -> bool:
    """Counts a call and returns whether it was taken; raises for one that no server takes, which attacks nothing."""
    taken = answer.status_code == 200
    if not taken and answer.status_code not in (429, 503):
        answer.raise_for_status()
    counts[f"{what}_{'taken' if taken else 'refused'}"] += 1
    return taken


async def _fill(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Sends contact sheets and generations, of which nobody fetches the results."""
    sent = await client.post("gradio_api/upload", files={"files": (CLIP.name, CLIP.read_bytes())})
    file = {"path": sent.json()[0], "meta": {"_type": "gradio.FileData"}}
    sheet = [file, "png", "bodies", "light", "threequarter", 24, 640, 360, "", 0, "", ""]
    run = ["Two people dance together.", 5, 0, 2, 3, 20, 0.7, "ddim", "intergen", 1]

    async def ask(i: int) -> None:
        endpoint, data = ("generate", run) if i % 4 == 0 else ("render", sheet)
        answer = await client.post(f"gradio_api/call/{endpoint}", json={"data": data})
        _count(answer, "events", counts)

    count = EVENTS
    while True:
        await asyncio.gather(*(ask(i) for i in range(count)))
        await asyncio.sleep(1.0)
        count = TOP_UP


async def _flood(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Sends long messages to one stream, many at once, and opens it again where it has ended."""
    poses = np.rint(1000 * read_actor(WAVE, person="a")[0].positions).astype("<i2")
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
                ended |= answer.status_code == 404 or b'"ended"' in answer.content
            await asyncio.sleep(0.2)


async def _ask_for_pages(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Asks for the page as fast as it comes, never twice the same way."""

    async def one(number: int) -> None:
        for i in itertools.count():
            path, packed = ("", "config", "/")[i % 3], ("gzip", "br", f"gzip;q=0.{i % 9 + 1}")[i // 3 % 3]
            address = f"{client.base_url}{path}?x={number}-{i}"
            answer = await client.get(address, headers={"accept-encoding": packed})
            counts["pages_taken" if answer.status_code == 200 else "pages_refused"] += 1
            if answer.status_code != 200:
                await asyncio.sleep(0.5)

    await asyncio.gather(*(one(number) for number in range(PAGES)))


async def _ask_for_readings(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Has long texts read, of which nobody fetches the plans."""
    for i in itertools.count():
        text = f"The {i}. time, " + "they walk up to each other, hug, dance and walk away again. " * 40
        answer = await client.post("gradio_api/call/read", json={"data": [text[:2000]]})
        _count(answer, "readings", counts)
        await asyncio.sleep(READING_EVERY)


async def _read_nothing(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Asks for much on many connections and reads nothing of it."""
    host, port = client.base_url.host, client.base_url.port
    ask = f"GET /config HTTP/1.1\r\nHost: {host}\r\nAccept-Encoding: identity\r\n\r\n".encode() * 20

    async def one() -> None:
        while True:
            with contextlib.suppress(OSError):
                _, writer = await asyncio.open_connection(host, port, limit=1024)
                writer.write(ask)
                cast(asyncio.Transport, writer.transport).pause_reading()
                counts["unread_connections"] += 1
                await asyncio.sleep(30)
                writer.transport.abort()
            await asyncio.sleep(1)

    await asyncio.gather(*(one() for _ in range(UNREAD)))


async def _send_large(client: httpx.AsyncClient, counts: Counter[str]) -> None:
    """Sends large recordings of markers for reactions, several at once."""
    data = large_trc()

    async def one() -> None:
        while True:
            sent = await client.post("gradio_api/upload", files={"files": ("large.trc", data)})
            if sent.status_code == 200:
                file = {"path": sent.json()[0], "meta": {"_type": "gradio.FileData"}}
                usual = [1, 3, 5, 0.7, "ddim", "intergen", "offline", False, "", 0, "", ""]
                react = [file, "", "", 0, 2, "b", 0, *usual]
                answer = await client.post("gradio_api/call/react", json={"data": react})
                if _count(answer, "files", counts):
                    await client.get(f"gradio_api/call/react/{answer.json()['event_id']}")
            else:
                counts["uploads_refused"] += 1
            await asyncio.sleep(1)

    await asyncio.gather(*(one() for _ in range(LARGE)))


def large_trc() -> bytes:
    """Markers of a still body and 160 points beside it, in :data:`FRAMES` frames."""
    pose = read_actor(WAVE, person="a")[0]
    parts = {"hip": "Hip", "knee": "Knee", "ankle": "Ankle", "shoulder": "Shoulder", "elbow": "Elbow", "wrist": "Wrist"}
    joints = dict(zip(pose.skeleton.joint_names, pose.positions[0], strict=True))
    points = {
        f"{side[0].upper()}{name}": joints[f"{side}_{part}"]
        for side in ("left", "right")
        for part, name in parts.items()
    } | {"Neck": joints["neck"], "Head": joints["head"]}
    names = [*points, *(f"P{i}" for i in range(160))]
    places = [*points.values(), *[np.ones(3)] * 160]
    head = (
        "PathFileType\t4\t(X/Y/Z)\tlarge.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
        f"60\t60\t{FRAMES}\t{len(names)}\tm\nFrame#\tTime\t" + "\t\t\t".join(names) + "\t\t\n\t\t\n"
    )
    row = "1\t0\t" + "\t".join(f"{value:.1f}" for place in places for value in place) + "\n"
    return (head + row * FRAMES).encode()
