"""The engine on Ray Serve, two replicas on one machine: the same motion, none lost when one is killed."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

if find_spec("ray") is None:
    pytest.skip("Ray is not installed: pip install -r requirements-ray.txt", allow_module_level=True)

from motion import InputError
from webdemo.inference import Engine
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result
from webdemo.server.cluster.ray_engine import RayEngine
from webdemo.server.queue.queue import FairQueue
from webdemo.server.queue.shared_engine import SharedEngine
from webdemo.server.queue.turns import QueueLimits

pytestmark = [pytest.mark.slow, pytest.mark.ray]
WANTED = GenerateRequest(prompt="Two people shake hands.", seconds=1.0, steps=6, seed=5)
LONG = replace(WANTED, steps=400, damping=0.0, cleanup=False)
"""Takes seconds, so that something can happen meanwhile."""
TERMS: list[int] = []
"""Every SIGTERM that this process was sent."""


@pytest.fixture(scope="module")
def replicas(weights: Path) -> Iterator[RayEngine]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_worker_niceness", "0")  # the rest of the machine may be busy
        engine = RayEngine(replicas=(2, 2), batch=4, weights=weights)
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
    manifests = [{**result.manifest, "runs_in_pass": 0} for result in (one, other)]
    assert manifests[0] == manifests[1]
    for duet, wanted in zip(one.duets, other.duets, strict=True):
        np.testing.assert_allclose(duet.positions, wanted.positions, atol=2e-4)


def wait_for(condition: Any) -> None:
    until = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def test_sigterm_is_left_to_the_server(replicas: RayEngine) -> None:
    """Ray's own handler would abort the process three seconds later, amid the tests that follow."""
    os.kill(os.getpid(), signal.SIGTERM)
    wait_for(lambda: TERMS)


def test_the_same_request_gives_the_same_motion(replicas: RayEngine, weights: Path) -> None:
    events = list(replicas.run(WANTED))
    assert_same(result_of(events), result_of(list(Engine(weights).run(WANTED))))
    steps = [event.step for event in events[:-1] if event.stage == "sample"]
    assert steps == [1, 2, 3, 4, 5, 6]
    with ThreadPoolExecutor(1) as pool:  # Playwright leaves an event loop in this one
        card = pool.submit(replicas.info).result()
    assert replicas.ready and card["summary"] == "a tiny untrained model"


def test_many_at_once_are_not_swapped(replicas: RayEngine, weights: Path) -> None:
    alone = Engine(weights)
    wanted = [replace(WANTED, seed=i, steps=4 + i % 2, samples=1 + i % 3) for i in range(8)]
    queue = FairQueue(replicas, QueueLimits(workers=replicas.parallel, running=8, waiting=8))
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda i: list(queue.run(f"session {i}", wanted[i])), range(8)))
    for request, events in zip(wanted, found, strict=True):
        assert_same(result_of(events), result_of(list(alone.run(request))))


def test_what_shares_a_pass_in_a_replica() -> None:
    from webdemo.server.cluster.ray_replica import groups

    a, longer, other = WANTED, replace(WANTED, seconds=2.0), replace(WANTED, sampler="dpm++")
    many = replace(WANTED, samples=3)
    assert groups(SharedEngine(), [a, longer, a, other, many, a, many], 5) == [[0, 2, 4], [1], [3], [5, 6]]


def test_errors_are_sentences(replicas: RayEngine) -> None:
    with pytest.raises(InputError, match="There is no model 'nosuch'"):
        list(replicas.run(replace(WANTED, model="nosuch")))


def test_a_cancelled_run_ends_and_leaves_its_place(replicas: RayEngine) -> None:
    token = CancelToken()
    with pytest.raises(Cancelled):
        for event in replicas.run(LONG, cancel=token):
            if event.stage == "sample":
                token.cancel()
    assert not replicas.at_work
    for _ in range(2 * replicas.batch):  # as many as all replicas take at a time
        run = replicas.run(LONG)
        assert any(event.stage == "sample" for event in run)
        run.close()
    began = time.monotonic()
    result_of(list(replicas.run(WANTED)))
    assert time.monotonic() - began < 20


def test_a_replica_that_is_killed_loses_no_request(replicas: RayEngine, weights: Path) -> None:
    events: dict[int, list[Any]] = {0: [], 1: [], 2: []}
    wanted = [replace(LONG, seed=seed) for seed in events]

    def run(i: int) -> None:
        for event in replicas.run(wanted[i]):
            events[i].append(event)

    threads = [threading.Thread(target=run, args=(i,), daemon=True) for i in events]
    for thread in threads:
        thread.start()
    wait_for(lambda: all(any(e.stage == "sample" and e.step > 5 for e in list(es)) for es in events.values()))
    killed = next(iter(replicas.at_work))
    os.kill(killed, signal.SIGKILL)
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
    assert killed not in replicas.at_work


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_it_listens_on_loopback_alone(replicas: RayEngine) -> None:
    ours = descendants(os.getpid())
    assert len(ours) > 3
    open_to_all = [(port, pid) for pid in ours for port in listening(pid) if not port.startswith("127.0.0.1:")]
    assert not open_to_all


def descendants(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        if parent == pid:
            found += [int(folder.name), *descendants(int(folder.name))]
    return found


def listening(pid: int) -> list[str]:
    """ "address:port" of every TCP socket on which a process waits for connections."""
    sockets = set()
    for link in Path(f"/proc/{pid}/fd").glob("*"):
        try:
            sockets.add(os.readlink(link))
        except OSError:
            continue
    found = []
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and f"socket:[{fields[9]}]" in sockets:
                address, _, port = fields[1].partition(":")
                mapped = address[-8:] if address[:-8] in ("", "0000000000000000FFFF0000") else ""
                plain = ".".join(str(part) for part in reversed(bytes.fromhex(mapped))) if mapped else address
                found.append(f"{plain}:{int(port, 16)}")
    return found
