"""The turns of live streams: who is computed for next, and what happens to late messages."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from webdemo.server.http.routes import Refused
from webdemo.server.live.stream import MOST_FRAMES
from webdemo.ui.visitor import Visitor

from .streaming import STUB, poses, streams

FLOOD = 200
"""Messages that one stream sends at once."""


class Noted(STUB.Mirror):
    """A partner whose frames are written down, and wait until they may be computed."""

    done: list[str]
    gate: threading.Event

    def __init__(self, name: str, done: list[str], gate: threading.Event) -> None:
        super().__init__()
        self.name, self.done, self.gate = name, done, gate

    def step(self, pose: np.ndarray) -> np.ndarray:
        assert self.gate.wait(20)
        self.done.append(self.name)
        return super().step(pose)


class Live:
    """Streams of people called by letters, whose frames are in ``done``."""

    def __init__(self, people: str) -> None:
        self.streams, self.done, self.gate = streams(), [], threading.Event()
        self.keys: dict[str, str] = {}
        for name in people:
            self.streams.engine.partner = lambda _, seed=0, name=name: Noted(name, self.done, self.gate)
            self.keys[name] = self.streams.open(Visitor(name, name), "agent").id

    def sends(self, name: str, *times: float) -> asyncio.Task[dict[str, Any]]:
        return asyncio.create_task(self.streams.answer(self.keys[name], Visitor(name, name), poses(list(times))))


def test_streams_take_turns_frame_by_frame() -> None:
    live = Live("ab")

    async def both() -> None:
        answers = [live.sends("a", 0.0, 0.5), live.sends("b", 0.0, 0.1)]
        live.gate.set()
        await asyncio.gather(*answers)

    asyncio.run(both())
    assert live.done[:6] == ["a", "b", "a", "b", "a", "b"] and live.done.count("a") == 16


def test_a_newer_message_replaces_those_that_wait() -> None:
    live = Live("ab")

    async def flood() -> list[Any]:
        sent = [live.sends("a", i / 10) for i in range(FLOOD)]
        await asyncio.sleep(0)
        sent.append(live.sends("b", 0.0))
        live.gate.set()
        return await asyncio.gather(*sent, return_exceptions=True)

    first, *others, last, late = asyncio.run(flood())
    assert first["frames"] and last["frames"] and late["frames"]
    assert len(others) == FLOOD - 2 and all(isinstance(other, Refused) for other in others)


def test_an_error_ends_its_own_message_alone() -> None:
    live = Live("ab")
    live.gate.set()

    async def broken() -> tuple[Any, Any, Any]:
        both = await asyncio.gather(
            live.streams.answer(live.keys["a"], Visitor("a", "a"), b"[1]"), live.sends("b", 0.0), return_exceptions=True
        )
        return *both, await live.sends("a", 0.0)

    bad, good, after = asyncio.run(broken())
    assert isinstance(bad, InputError) and good["frames"] and after["frames"]


def test_how_long_a_frame_takes_is_known() -> None:
    live = Live("a")

    async def wait() -> None:
        answer = live.sends("a", 0.0)
        while not live.streams._began:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.05)
        live.streams.clock.now += 50  # type: ignore[attr-defined]
        assert live.streams.stuck == 50
        live.gate.set()
        await answer

    assert live.streams.stuck == 0
    asyncio.run(wait())
    assert live.streams.stuck == 0


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    """A server whose partners take 10 ms a frame, as the shipped ones do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("STUB_PARTNER", "0.01")
        with Target(tmp_path_factory.mktemp("live"), accounts=True, live=4) as target:
            yield target


def test_a_flooded_stream_costs_no_other_its_turns(target: Target) -> None:
    """While one stream sends 200 long messages at once, another one gets at least as many frames."""
    long = poses([0.9 * i for i in range(32)])  # of which MOST_FRAMES are computed
    cookies = {who: dict(target.client(who).cookies) for who in ("ada", "eve")}

    async def flood() -> tuple[list[int], int, int]:
        async with (
            httpx.AsyncClient(base_url=target.url, cookies=cookies["eve"], timeout=300) as eve,
            httpx.AsyncClient(base_url=target.url, cookies=cookies["ada"], timeout=300) as ada,
        ):
            hers, his = [(await one.post("/live", json={"partner": "agent"})).json()["id"] for one in (ada, eve)]
            sent = [asyncio.create_task(eve.post(f"/live/{his}", content=long)) for _ in range(FLOOD)]
            while not any(task.done() for task in sent):  # the first is answered: the others have come
                await asyncio.sleep(0.01)
            frames = 0
            for i in range(60):
                answer = await ada.post(f"/live/{hers}", content=poses([i / 10, i / 10 + 1 / 30]))
                assert answer.status_code == 200, answer.text
                frames += answer.json()["frames"]["shape"][1]
            others = (await eve.delete(f"/live/{his}")).json()["frames"]
            assert (await ada.delete(f"/live/{hers}")).status_code == 200
            return [answer.status_code for answer in await asyncio.gather(*sent)], frames, others

    statuses, frames, others = asyncio.run(flood())
    assert frames >= 150
    # One message was answered before, and while ada's next one is on its way the flood alone is computed.
    assert others <= frames + 3 * MOST_FRAMES, "the flood had more turns than its share"
    assert set(statuses) <= {200, 409} and statuses.count(409) > FLOOD / 2
