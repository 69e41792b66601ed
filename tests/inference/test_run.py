"""What goes through a run: the time of its stages, and its end before the end."""

import threading

import pytest

from motion import InputError
from webdemo.inference import run
from webdemo.inference.run import Cancelled, CancelToken, StageTimer


def test_laps_of_a_stage_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([10.0, 11.0, 11.5, 13.5, 14.0])
    monkeypatch.setattr(run, "time", type("Clock", (), {"perf_counter": staticmethod(lambda: next(times))}))
    clock = StageTimer()
    for stage in ("text", "sample", "sample"):
        clock.lap(stage)
    assert clock.stages == {"text": 1.0, "sample": 2.5}
    event = clock.progress("sample", 3, 50)
    assert (event.stage, event.step, event.total, event.elapsed) == ("sample", 3, 50, 4.0)


def test_another_thread_cancels() -> None:
    token = CancelToken()
    token.raise_if_cancelled()
    other = threading.Thread(target=token.cancel)
    other.start()
    other.join()
    assert token.cancelled
    with pytest.raises(Cancelled):
        token.raise_if_cancelled()


@pytest.mark.parametrize(("seconds", "said"), [(600, "10 minutes"), (90, "90 seconds"), (60, "60 seconds")])
def test_a_run_ends_when_its_time_is_over(monkeypatch: pytest.MonkeyPatch, seconds: float, said: str) -> None:
    now = 1000.0
    monkeypatch.setattr(run, "monotonic", lambda: now)
    token = CancelToken(seconds)
    now += 10_000  # in line
    token.raise_if_cancelled()
    token.start()
    now += seconds
    token.raise_if_cancelled()
    now += 0.1
    with pytest.raises(InputError, match=f"longer than the {said} that this lab allows"):
        token.raise_if_cancelled()
    assert not token.cancelled
