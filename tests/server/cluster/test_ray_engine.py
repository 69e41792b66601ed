"""The engine on Ray Serve, two replicas on one machine: the same motion, none lost when one is killed."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

if find_spec("ray") is None:
    pytest.skip("Ray is not installed: pip install -r requirements-ray.txt", allow_module_level=True)

from tests.server.clients import wait_for
from webdemo.inference import Engine
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Progress, Result
from webdemo.server.cluster.ray_engine import RayEngine

pytestmark = [pytest.mark.slow, pytest.mark.ray]
WANTED = GenerateRequest(prompt="Two people shake hands.", seconds=1.0, steps=6, seed=5, split=False, planned=False)
LONG = replace(WANTED, steps=400, damping=0.0, cleanup=False)
"""Takes seconds, so that something can happen meanwhile."""
TERMS: list[int] = []
"""Every SIGTERM that this process was sent."""


@pytest.fixture(scope="module")
def replicas(weights: Path) -> Iterator[RayEngine]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_worker_niceness", "0")  # the rest of the machine may be busy
        engine = RayEngine(replicas=(2, 2), weights=weights)
        assert not engine.ready
        before = signal.signal(signal.SIGTERM, lambda number, frame: TERMS.append(number))
        starter = threading.Thread(target=engine.warm_up)  # as a server does: its end must not end Ray's
        starter.start()
        starter.join()
        yield engine
        engine.close()
        signal.signal(signal.SIGTERM, before)


def result_of(events: Sequence[Any]) -> Result:
    assert isinstance(events[-1], Result)
    return events[-1]


def assert_same(one: Result, other: Result) -> None:
    assert one.manifest == other.manifest
    for duet, wanted in zip(one.duets, other.duets, strict=True):
        np.testing.assert_allclose(duet.positions, wanted.positions, atol=2e-4)


def own_replicas() -> list[int]:
    """The ids of the replicas' processes, which descend from this one."""
    above: dict[int, int] = {}
    found: list[int] = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it ended meanwhile
            pid = int(process.name)
            above[pid] = int((process / "stat").read_text().rpartition(") ")[2].split()[1])
            if b"ServeReplica" in (process / "cmdline").read_bytes():
                found.append(pid)

    def descends(pid: int) -> bool:
        return pid == os.getpid() or (pid in above and descends(above[pid]))

    return [pid for pid in found if descends(pid)]


def test_sigterm_is_left_to_the_server(replicas: RayEngine) -> None:
    """Ray's own handler would abort the process three seconds later, amid the tests that follow."""
    os.kill(os.getpid(), signal.SIGTERM)
    wait_for(lambda: TERMS)


def test_the_same_request_gives_the_same_motion(replicas: RayEngine, weights: Path) -> None:
    events = list(replicas.run(WANTED))
    assert_same(result_of(events), result_of(list(Engine(weights).run(WANTED))))
    steps = [event.step for event in events[:-1] if event.stage == "sample"]
    assert steps == [1, 2, 3, 4, 5, 6]
    assert replicas.ready


def test_a_replica_that_is_killed_loses_no_request(replicas: RayEngine, weights: Path) -> None:
    events: dict[int, list[Any]] = {0: [], 1: []}
    wanted = [replace(LONG, seed=seed) for seed in events]

    def run(i: int) -> None:
        for event in replicas.run(wanted[i]):
            events[i].append(event)

    threads = [threading.Thread(target=run, args=(i,), daemon=True) for i in events]
    for thread in threads:
        thread.start()
    wait_for(lambda: all(any(e.stage == "sample" and e.step > 5 for e in list(es)) for es in events.values()))
    os.kill(own_replicas()[0], signal.SIGKILL)
    for thread in threads:
        thread.join(timeout=120)
        assert not thread.is_alive()
    alone = Engine(weights)
    again = 0
    for i, request in enumerate(wanted):
        assert_same(result_of(events[i]), result_of(list(alone.run(request))))
        steps = [e.step for e in events[i] if isinstance(e, Progress) and e.stage == "sample"]
        again += steps != sorted(steps)
    assert again >= 1  # at least one had to begin anew
