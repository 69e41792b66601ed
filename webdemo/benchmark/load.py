"""Load test: many people send mixed jobs to a server on loopback, and every answer is checked.

In the second half of the time attackers join them (:mod:`.attackers`).
``python -m webdemo benchmark --load --people 20 --minutes 2``.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import random
import statistics
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from motion import FPS, InputError
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.actor import read_actor
from webdemo.server.accounts.visitors import VISITOR_COOKIE, new_token
from webdemo.server.queue.turns import units

from . import PROMPTS
from .attackers import ATTACKERS, CLIP, WAVE, attack_apart
from .server import serving, wait_until

PROBE_EVERY = 1.0
"""Seconds between two looks at how quickly the server answers."""
BETWEEN, MOST_POSES = 1 / 15, 15
"""Seconds between two messages of a live stream, and poses in each."""
_RUNS = ("runs_lost", "runs_swapped", "runs_refused_or_failed")
GOALS: dict[str, tuple[float, float]] = {
    **{f"{when}{figure}": (0, 0) for figure in _RUNS for when in ("", "attacked_")},
    "log_lines_of_errors": (0, 0),
    "longest_wait_over_fair_share": (0, 3),
    "page_worst_seconds": (0, 1),
    "healthz_worst_seconds": (0, 1),
    "memory_last_over_first_quarter": (0, 1.05),
    "attacked_longest_wait_over_fair_share": (0, 3),
    "attacked_healthz_worst_seconds": (0, 1),
    "attacked_live_wait_over_fair_share": (0, 3),
    "attacked_live_frames_over_fair_share": (1 / 3, float("inf")),
}
"""The goals of a server for a lab: the least and the most of each figure."""
REST_SECONDS = 6.0
"""Seconds before memory is read; the server frees the memory of ended runs every few seconds."""
_API = "gradio_api"
SHEET = "render"


@dataclass(frozen=True)
class Job:
    """A request that a simulated person sends.

    Attributes:
        endpoint: name of the endpoint.
        data: its arguments; None stands for an uploaded :data:`CLIP`.
        asked: fields of the request that the result's manifest must hold.
        work: units of work, see :func:`webdemo.server.queue.turns.units`.
    """

    endpoint: str
    data: tuple[Any, ...]
    asked: dict[str, Any]
    work: float


def _generation(dice: random.Random, steps: int) -> Job:
    r = GenerateRequest(
        prompt=dice.choice(PROMPTS),
        seconds=dice.choice((2.0, 4.0, 5.0)),
        seed=dice.randrange(2**32),
        samples=dice.choice((1, 1, 1, 2)),
        steps=dice.choice((max(steps // 2, 1), steps)),
    )
    run = (r.prompt, r.seconds, r.seed, r.samples, r.guidance, r.steps, r.damping, r.sampler, r.model, r.tries)
    return Job("generate", run, json.loads(json.dumps(r.to_dict())), units(r))


def _reaction(dice: random.Random, steps: int) -> Job:
    seed, seconds = dice.randrange(2**32), 2.0
    chosen = (None, "", "a", 0, seconds, "a", seed, 1, 3.0, steps, 0.7, "ddim", "intergen", "offline")
    data = (*chosen, False, "", 0, "", "")
    return Job("react", data, {"kind": "react", "seed": seed, "steps": steps}, seconds * steps + 10)


def _prediction(dice: random.Random, steps: int) -> Job:
    seconds = dice.choice((0.5, 1.0, 1.5))
    data = (None, 1.5, seconds, "motion-mlp", 0, 1, "", 0, "", "")
    return Job("predict", data, {"kind": "predict", "seconds": seconds}, seconds + 10)


def _sheet(dice: random.Random, steps: int) -> Job:
    """A contact sheet, which waits in the queue of events."""
    look = ("png", "bodies", "light", "threequarter", 24, dice.choice((480, 640)), 360)
    return Job(SHEET, (None, *look, "", 0, "", ""), {}, 1.0)


KINDS = (_generation, _generation, _generation, _generation, _reaction, _sheet, _prediction)
"""Jobs are drawn from these, so a kind that stands here twice is twice as frequent; a person's first is fixed."""


@dataclass
class LivePerson:
    """Measurements of one person's live stream.

    Attributes:
        refused: the sentence with which the server refused them.
        delays: seconds from a message to its answer.
        frames: that were answered.
        seconds: of the stream.
    """

    refused: str = ""
    delays: list[float] = field(default_factory=list)
    frames: int = 0
    seconds: float = 0.0


@dataclass
class Tally:
    """Everything that a run of the load test recorded.

    Attributes:
        kinds: (seconds waited, units of work) of each job, by person and endpoint.
        live: the stream of one more person.
        page, healthz: seconds that these took to answer, each time they were asked.
        memory: megabytes that the server held at those times.
        errors: the messages that came instead of a result.
    """

    done: int = 0
    lost: int = 0
    swapped: int = 0
    errors: list[str] = field(default_factory=list)
    page: list[float] = field(default_factory=list)
    healthz: list[float] = field(default_factory=list)
    memory: list[float] = field(default_factory=list)
    kinds: dict[int, dict[str, list[tuple[float, float]]]] = field(default_factory=dict)
    live: LivePerson | None = None

    def add(self, person: int, job: Job, took: float) -> None:
        """Records a job that is done."""
        self.done += 1
        self.kinds.setdefault(person, {}).setdefault(job.endpoint, []).append((took, job.work))

    def figures(self) -> dict[str, Any]:
        """The tally as plain numbers."""
        runs = [
            [wait for endpoint, waits in kinds.items() if endpoint != SHEET for wait in waits]
            for kinds in self.kinds.values()
        ]
        waited = [seconds_a_unit(waits) for waits in runs if waits]
        latencies = [took for kinds in self.kinds.values() for waits in kinds.values() for took, _ in waits]
        quarter = max(len(self.memory) // 4, 1)
        first, last = (statistics.median(part or [0.0]) for part in (self.memory[:quarter], self.memory[-quarter:]))
        return {
            "runs_done": self.done,
            "runs_lost": self.lost,
            "runs_swapped": self.swapped,
            "runs_refused_or_failed": len(self.errors),
            "first_errors": self.errors[:3],
            "people_served": len(self.kinds),
            "longest_wait_over_fair_share": max(waited) / statistics.mean(waited) if waited else None,
            **_spread("latency", latencies),
            **_spread("page", self.page),
            **_spread("healthz", self.healthz),
            "memory_most_mb": max(self.memory, default=0.0),
            "memory_last_over_first_quarter": last / first if first else None,
        }


def _spread(name: str, seconds: Sequence[float]) -> dict[str, float]:
    """The median, the 99th percentile and the worst of some times; nothing where there are none."""
    if not seconds:
        return {}
    figures = {"median": 50, "99th": 99, "worst": 100}
    return {f"{name}_{figure}_seconds": float(np.percentile(seconds, of)) for figure, of in figures.items()}


def seconds_a_unit(waits: Sequence[tuple[float, float]]) -> float:
    """Seconds that somebody waited for a unit of work, over all their (seconds, units)."""
    return sum(took for took, _ in waits) / sum(work for _, work in waits)


def attacked_figures(calm: Tally, attacked: Tally, people: int) -> dict[str, Any]:
    """Figures of what people got while they were attacked, over their fair share.

    An attacker is entitled to as much as anybody else, so a fair share is what a person got before, divided among as
    many people more. A live stream is one of two then. Waiting is weighed by work: a short run waits for the same turn
    as a long one, and alone says little of its owner's share.
    """
    usual: dict[str, list[tuple[float, float]]] = {}
    for kinds in calm.kinds.values():
        for endpoint, waits in kinds.items():
            usual.setdefault(endpoint, []).extend(waits)
    more = (people + ATTACKERS) / people
    ratios = []
    for kinds in attacked.kinds.values():
        known = {endpoint: waits for endpoint, waits in kinds.items() if endpoint in usual}
        waited = sum(took for waits in known.values() for took, _ in waits)
        fair = sum(work * seconds_a_unit(usual[endpoint]) for endpoint, waits in known.items() for _, work in waits)
        if known:
            ratios.append(waited / fair / more)
    figures = {
        f"attacked_{name}": value
        for name, value in attacked.figures().items()
        if name.startswith(("runs_", "first_errors", "people_served", "page_", "healthz_", "memory_most"))
    }
    figures["attacked_waits_over_fair_share"] = sorted(round(ratio, 2) for ratio in ratios)
    figures["attacked_longest_wait_over_fair_share"] = max(ratios, default=None)
    before, after = calm.live, attacked.live
    figures["live_refused"] = [person.refused for person in (before, after) if person and person.refused]
    if before and after and before.delays and after.delays:
        a_frame = [sum(person.delays) / person.frames for person in (before, after)]  # seconds
        frames = [person.frames / person.seconds for person in (before, after)]
        figures |= {
            "live_frames_a_second": frames[0],
            "attacked_live_frames_a_second": frames[1],
            "attacked_live_wait_over_fair_share": a_frame[1] / (2 * a_frame[0]),
            "attacked_live_frames_over_fair_share": 2 * frames[1] / frames[0],
        }
    return figures


def goals_missed(figures: Mapping[str, Any]) -> list[str]:
    """The names of the :data:`GOALS` that the figures miss, or that were not measured."""
    return [
        name for name, (least, most) in GOALS.items() if figures.get(name) is None or not least <= figures[name] <= most
    ]


def run_load(*, people: int, minutes: float, steps: int = 8) -> dict[str, Any]:
    """Starts ``python app.py`` on a free port of 127.0.0.1 and sends it the requests of many people.

    Args:
        people: number of people at once; each sends the next request when the result is there.
        minutes: duration, half of it beside the attackers; runs that are under way at its end are finished.
        steps: the most denoising steps that a job has; jobs differ in prompt, length, samples and steps.

    Raises:
        InputError: where the numbers do not fit, or the server does not come up.
    """
    if not 1 <= people <= 200 or not 0 < minutes <= 60 or not 2 <= steps <= 100:
        raise InputError("A load has 1 to 200 people, up to 60 minutes and 2 to 100 steps.")
    with tempfile.TemporaryDirectory(prefix="pas-de-deux-load-") as folder:
        with serving(Path(folder), queue=max(64, people)) as (url, server):
            wait_until(url, "healthz", server)
            figures = asyncio.run(_load(url, people, minutes, steps))
        log = (Path(folder) / "log").read_text(encoding="utf-8")
    figures["log_lines_of_errors"] = log.count('"level": "error"')
    return figures | {"goals_missed": goals_missed(figures)}


async def _load(url: str, people: int, minutes: float, steps: int) -> dict[str, Any]:
    calm, attacked = Tally(), Tally()
    limits = httpx.Limits(max_connections=None)
    async with httpx.AsyncClient(base_url=url, timeout=httpx.Timeout(60, read=None), limits=limits) as client:
        # The first run of each kind imports and prepares things, so it comes before memory is read.
        await _crowd(client, Tally(), max(people, len(KINDS)), 0.0, steps, "warm-up")
        await asyncio.sleep(REST_SECONDS)
        memory = await _memory(client)
        took = await _crowd(client, calm, people, 30 * minutes, steps, "calm")
        await asyncio.sleep(REST_SECONDS)
        after = await _memory(client)
        end = attack_apart(url)
        await _crowd(client, attacked, people, 30 * minutes, steps, "attacked")
        sent = end()
    return {
        "people": people,
        "seconds": took,
        **calm.figures(),
        "memory_at_rest_before_mb": memory,
        "memory_at_rest_after_mb": after,
        **sent,
        **attacked_figures(calm, attacked, people),
    }


async def _crowd(client: httpx.AsyncClient, tally: Tally, people: int, seconds: float, steps: int, seed: str) -> float:
    """Everybody at once, and one more who is live; returns how long it took."""
    began = time.monotonic()
    probes = [asyncio.create_task(_probe(client, "", tally.page, tally.memory))]
    probes.append(asyncio.create_task(_probe(client, "healthz", tally.healthz)))
    live = asyncio.create_task(_live(client, max(seconds, 2.0)))
    dice = [random.Random(f"{seed} {person}") for person in range(people)]
    await asyncio.gather(*(_person(client, tally, i, dice[i], steps, began + seconds) for i in range(people)))
    took = time.monotonic() - began
    tally.live = await live
    for probe in probes:
        probe.cancel()
    return took


async def _live(client: httpx.AsyncClient, seconds: float) -> LivePerson:
    """A person who is live for so many seconds, and sends the poses since the last answer as soon as it has come."""
    poses = np.rint(1000 * read_actor(WAVE, person="a")[0].positions).astype("<i2")
    cookies = {"cookie": f"{VISITOR_COOKIE}={new_token()}"}
    person = LivePerson()
    opened = await client.post("live", json={"partner": "agent"}, headers=cookies)
    if opened.status_code != 200:
        person.refused = opened.json()["detail"]
        return person
    address = f"live/{opened.json()['id']}"
    began, sent = time.monotonic(), 0
    while (now := time.monotonic() - began) < seconds:
        due = int(now * FPS) + 1
        frames = np.arange(max(sent, due - MOST_POSES), due)
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


async def _probe(client: httpx.AsyncClient, path: str, times: list[float], memory: list[float] | None = None) -> None:
    while True:
        began = time.monotonic()
        with contextlib.suppress(httpx.TransportError):  # a connection that is cut took as long as that
            await client.get(path, headers={"accept": "text/html"})
        times.append(time.monotonic() - began)
        if memory is not None:
            with contextlib.suppress(httpx.TransportError):
                memory.append(await _memory(client))
        await asyncio.sleep(PROBE_EVERY)


async def _memory(client: httpx.AsyncClient) -> float:
    """Megabytes that the server holds by its own figures; 0 if the system does not report them."""
    for line in (await client.get("metrics")).text.splitlines():
        if line.startswith("process_resident_memory_bytes "):
            return float(line.split()[1]) / 2**20
    return 0.0


async def _person(
    client: httpx.AsyncClient, tally: Tally, person: int, dice: random.Random, steps: int, until: float
) -> None:
    """One person, who sends the next request after each result, and at least one."""
    cookies = {"cookie": f"{VISITOR_COOKIE}={new_token()}"}
    job = KINDS[-1 - person % len(KINDS)](dice, steps)
    await asyncio.sleep(dice.random())
    while True:
        began = time.monotonic()
        kind, answer = await _ask(client, cookies, job)
        took = time.monotonic() - began
        if kind == "complete":
            tally.add(person, job, took)
            if job.asked:
                request = answer[0]["manifest"]["request"]
                tally.swapped += any(request.get(name) != value for name, value in job.asked.items())
        elif kind == "error":
            tally.errors.append(f"{job.endpoint}: {answer}"[:200])
            await asyncio.sleep(1)
        else:
            tally.lost += 1
        if time.monotonic() >= until:
            return
        job = dice.choice(KINDS)(dice, steps)


async def _ask(client: httpx.AsyncClient, cookies: dict[str, str], job: Job) -> tuple[str, Any]:
    """("complete", result), ("error", sentence), or ("lost", None) if the answer broke off."""
    call = f"{_API}/call/{job.endpoint}"
    try:
        data = list(job.data)
        if None in data:
            sent = await client.post(f"{_API}/upload", files={"files": (CLIP.name, CLIP.read_bytes())}, headers=cookies)
            if sent.status_code != 200:
                return "error", f"{sent.status_code} {sent.text}"
            data[data.index(None)] = {"path": sent.json()[0], "meta": {"_type": "gradio.FileData"}}
        joined = await client.post(call, json={"data": data}, headers=cookies)
        if joined.status_code != 200:
            return "error", f"{joined.status_code} {joined.text}"
        kind = ""
        async with client.stream("GET", f"{call}/{joined.json()['event_id']}", headers=cookies) as stream:
            async for line in stream.aiter_lines():
                if line.startswith("event: "):
                    kind = line.removeprefix("event: ")
                elif line.startswith("data: ") and kind in ("complete", "error"):
                    return kind, json.loads(line.removeprefix("data: "))
    except httpx.TransportError as error:
        return "error", type(error).__name__
    return "lost", None
