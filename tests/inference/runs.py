"""What an engine gives for a request."""

from __future__ import annotations

from typing import Any

import numpy as np

from motion import Duet
from webdemo.inference import CancelToken, Engine, Result


def run(engine: Engine, request: Any, cancel: CancelToken | None = None) -> Result:
    *_, result = engine.run(request, cancel=cancel)
    assert isinstance(result, Result)
    return result


def positions(result: Result, sample: int = 0) -> np.ndarray:
    duet = result.duets[sample]
    assert isinstance(duet, Duet)
    return duet.positions
