"""The turns of live streams: who is computed for next, and what happens to late messages."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator

import httpx
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from webdemo.server.live.stream import MOST_FRAMES
from webdemo.server.live.turns import Replaced, Steps, StepTurns

from .test_streams import poses

FLOOD = 200
"""Messages that one stream sends at once."""


class Gate:
    """Jobs whose steps are written down, and which wait until they may begin."""

    def __init__(self) -> None:
        self.done: list[str] = []
        self.began, self.open = threading.Event(), threading.Event()

    def job(self, name: str, steps: int) -> Steps:
        self.began.set()
        for _ in range(steps):
            assert self.open.wait(20)
            self.done.append(name)
            yield
        return {"name": name}


@pytest.fixture
def turns() -> Iterator[StepTurns]:
    turns = StepTurns("test")
    yield turns
    turns.stop()


def test_owners_take_turns_step_by_step(turns: StepTurns) -> None:
    gate = Gate()
    answers = [turns.submit(name, lambda name=name, n=n: gate.job(name, n)) for name, n in (("a", 30), ("b", 2))]
    gate.open.set()
    assert [answer.result(20)["name"] for answer in answers] == ["a", "b"]
    assert gate.done[:5] == ["a", "b", "a", "b", "a"] and len(gate.done) == 32


def test_a_newer_message_replaces_the_one_that_waits(turns: StepTurns) -> None:
    gate = Gate()
    first = turns.submit("a", lambda: gate.job("a0", 3))
    assert gate.began.wait(20)
    others = [turns.submit("a", lambda i=i: gate.job(f"a{i}", 1)) for i in range(1, FLOOD)]
    late = turns.submit("b", lambda: gate.job("b", 1))
    for other in others[:-1]:
        with pytest.raises(Replaced, match="newer message"):
            other.result(20)
    gate.open.set()
    assert first.result(20) == {"name": "a0"} and others[-1].result(20) == {"name": f"a{FLOOD - 1}"}
    assert late.result(20) == {"name": "b"}
    assert gate.done == ["a0", "b", "a0", "a0", f"a{FLOOD - 1}"]


def test_an_error_ends_its_own_job_alone(turns: StepTurns) -> None:
    def broken() -> Steps:
        yield
        raise RuntimeError("broken")

    gate = Gate()
    gate.open.set()
    bad, good = turns.submit("a", broken), turns.submit("b", lambda: gate.job("b", 2))
    with pytest.raises(RuntimeError, match="broken"):
        bad.result(20)
    assert good.result(20) == {"name": "b"}
    assert turns.submit("a", lambda: gate.job("a", 1)).result(20) == {"name": "a"}
    turns.stop()
    with pytest.raises(InputError, match="stopping"):
        turns.submit("a", lambda: gate.job("a", 1))


def test_how_long_a_step_takes_is_known() -> None:
    now, gate = [100.0], Gate()
    turns = StepTurns("test", clock=lambda: now[0])
    began = threading.Event()

    def job() -> Steps:
        began.set()
        gate.open.wait(20)
        return {}
        yield

    assert turns.stuck == 0
    answer = turns.submit("a", job)
    assert began.wait(20)
    now[0] += 50
    assert turns.stuck == 50
    gate.open.set()
    answer.result(20)
    turns.stop()


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
            while not any(task.done() for task in sent):  # the first was replaced: they have come
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
    assert others <= frames + 2 * MOST_FRAMES, "the flood had more turns than its share"
    assert set(statuses) <= {200, 409, 410} and statuses.count(409) > FLOOD / 2
