"""Many people with live partners: ``python -m webdemo benchmark --live --people 20 --minutes 0.5``.

Each person is a recorded clip that plays over and over, sent as a page would send it: the poses since the last message
as soon as its answer has come, fifteen messages a second at the most.
"""

from __future__ import annotations

import asyncio
import base64
import statistics
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from motion import FPS, InputError
from webdemo.inference.requests.actor import read_actor
from webdemo.server.accounts.visitors import VISITOR_COOKIE, new_token

from .served import ROOT, errors_logged, ready, serving

CLIP = ROOT / "static" / "examples" / "wave.npz"
BETWEEN = 1 / 15
"""Seconds between two messages of a person."""
MOST_POSES = 15
"""Poses in a message; a page that is further behind leaves some out."""


@dataclass
class Person:
    """Measurements of one person's stream.

    Attributes:
        refused: the sentence with which the server refused them.
        delays: seconds from a message to its answer.
        frames: that were answered.
        left_out: poses that were too late to be sent.
        seconds: of the stream.
    """

    refused: str = ""
    delays: list[float] = field(default_factory=list)
    frames: int = 0
    left_out: int = 0
    seconds: float = 0.0


def run_live(*, people: int, minutes: float, partner: str = "agent") -> dict[str, Any]:
    """Measures live streams of a server on loopback that allows as many as there are people.

    Fewer are let in where the machine is too slow for all.

    Raises:
        InputError: where the numbers do not fit, or the server does not come up.
    """
    if not 1 <= people <= 100 or not 0 < minutes <= 10:
        raise InputError("Live streams are measured for 1 to 100 people and up to 10 minutes.")
    with tempfile.TemporaryDirectory(prefix="pas-de-deux-live-") as folder:
        with serving(Path(folder), live=people) as (url, server):
            figures = asyncio.run(_measure(url, server, people, 60 * minutes, partner))
        figures["log_lines_of_errors"] = errors_logged(Path(folder))
    for name, value in figures.items():
        print(f"{name:32} {round(value, 3) if isinstance(value, float) else value}")
    return figures


async def _measure(url: str, server: Any, people: int, seconds: float, partner: str) -> dict[str, Any]:
    poses = np.rint(1000 * read_actor(CLIP, person="a")[0].positions).astype("<i2")
    limits = httpx.Limits(max_connections=None)
    async with httpx.AsyncClient(base_url=url, timeout=60, limits=limits) as client:
        await ready(client, server)
        await _person(client, poses, 2.0, partner)  # loads the networks
        found = await asyncio.gather(*(_person(client, poses, seconds, partner) for _ in range(people)))
        over = await asyncio.gather(*(_person(client, poses, 2.0, partner) for _ in range(people + 1)))
    delays = sorted(delay for person in found for delay in person.delays)
    return {
        "people": people,
        "refused": sum(bool(person.refused) for person in found),
        "refused_of_one_more": sorted({person.refused for person in over if person.refused}),
        "frames_a_second_least": min(person.frames / person.seconds for person in found if person.seconds),
        "left_out_share": sum(p.left_out for p in found) / max(1, sum(p.frames + p.left_out for p in found)),
        "delay_median_ms": 1000 * statistics.median(delays),
        "delay_95th_ms": 1000 * delays[int(0.95 * len(delays))],
        "delay_longest_ms": 1000 * delays[-1],
    }


async def stream(client: httpx.AsyncClient, seconds: float, partner: str = "agent") -> Person:
    """One person who is live for so many seconds."""
    poses = np.rint(1000 * read_actor(CLIP, person="a")[0].positions).astype("<i2")
    return await _person(client, poses, seconds, partner)


async def _person(client: httpx.AsyncClient, poses: np.ndarray, seconds: float, partner: str) -> Person:
    """A person who is live for so many seconds."""
    cookies = {"cookie": f"{VISITOR_COOKIE}={new_token()}"}
    person = Person()
    opened = await client.post("live", json={"partner": partner}, headers=cookies)
    if opened.status_code != 200:
        person.refused = opened.json()["detail"]
        return person
    address = f"live/{opened.json()['id']}"
    began, sent = time.monotonic(), 0
    while (now := time.monotonic() - began) < seconds:
        due = int(now * FPS) + 1
        person.left_out += max(0, due - sent - MOST_POSES)
        sent = max(sent, due - MOST_POSES)
        frames = np.arange(sent, due)
        if len(frames):
            data = base64.b64encode(poses[frames % len(poses)].tobytes()).decode()
            asked = time.monotonic()
            answer = await client.post(address, json={"times": (frames / FPS).tolist(), "poses": data}, headers=cookies)
            person.delays.append(time.monotonic() - asked)
            if answer.status_code != 200:
                raise InputError(f"A live stream broke off: {answer.text}")
            person.frames += answer.json()["frames"]["shape"][1]
            sent = due
        await asyncio.sleep(max(0.0, BETWEEN - (time.monotonic() - began - now)))
    person.seconds = time.monotonic() - began
    await client.delete(address, headers=cookies)
    return person
