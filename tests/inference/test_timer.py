"""The duration of a run and its stages."""

import pytest

from webdemo.inference import run
from webdemo.inference.run import StageTimer


def test_laps_of_a_stage_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([10.0, 11.0, 11.5, 13.5, 14.0])
    monkeypatch.setattr(run, "time", type("Clock", (), {"perf_counter": staticmethod(lambda: next(times))}))
    clock = StageTimer.start()
    for stage in ("text", "sample", "sample"):
        clock.lap(stage)
    assert clock.stages == {"text": 1.0, "sample": 2.5}
    event = clock.progress("sample", 3, 50)
    assert (event.stage, event.step, event.total, event.elapsed) == ("sample", 3, 50, 4.0)
