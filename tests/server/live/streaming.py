"""Live streams of the stub engine, and messages to them."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np

from motion import SMPL22
from tests.server.clients import Clock
from tests.server.lab import stub_module
from webdemo.server.accounts.quotas import Quota
from webdemo.server.live.streams import Streams

STUB = stub_module()


def streams(most: int = 3, address: int = 2) -> Streams:
    quota = Quota("live streams", 1, address, most)
    some: Any = Streams(STUB.StubEngine(), quota)
    some.clock = Clock()
    return some


def poses(times: list[float], metres: float = 0.0) -> bytes:
    """A message with a person who stands in the rest pose, higher by so many metres a second."""
    rest = SMPL22.rest_positions() + np.array([0, 1.0, 0])
    positions = np.stack([rest + np.array([0, metres * time, 0]) for time in times])
    data = base64.b64encode(np.rint(1000 * positions).astype("<i2").tobytes()).decode()
    return json.dumps({"times": times, "poses": data}).encode()
