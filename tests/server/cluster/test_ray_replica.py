"""The stream of a replica, without Ray: all events in order, errors that travel, its end when the reader leaves."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from motion import InputError
from webdemo.inference.run import CancelToken, Progress
from webdemo.server.cluster.ray_replica import ModelReplica, ReplicaError

STEPS = [Progress(stage="sample", step=i, total=3) for i in range(3)]


class Engine:
    """Takes three steps and ends in an error, or goes on until it is cancelled."""

    def __init__(self) -> None:
        self.ended = threading.Event()

    def run(self, end: Exception | None, cancel: CancelToken) -> Iterator[Progress]:
        yield from STEPS
        if end is not None:
            raise end
        while not cancel.cancelled:
            time.sleep(0.01)
        self.ended.set()


@pytest.fixture
def replica() -> ModelReplica:
    made = ModelReplica.__new__(ModelReplica)
    made._engine = Engine()  # type: ignore[assignment]  # what runs is enough
    return made


@pytest.mark.parametrize(("end", "kind"), [(InputError("no"), InputError), (RuntimeError("x"), ReplicaError)])
def test_events_come_in_order_and_an_error_last(replica: ModelReplica, end: Exception, kind: type) -> None:
    async def read() -> list[Any]:
        return [event async for events in replica.run(end) for event in events]

    *steps, last = asyncio.run(read())
    assert steps == STEPS and type(last) is kind


def test_a_reader_who_leaves_ends_the_run(replica: ModelReplica) -> None:
    async def leave() -> None:
        async def read() -> None:
            async for _ in replica.run(None):
                pass

        reading = asyncio.create_task(read())
        await asyncio.sleep(0.1)
        reading.cancel()
        await asyncio.wait([reading])

    asyncio.run(leave())
    assert replica._engine.ended.wait(20)  # type: ignore[attr-defined]
