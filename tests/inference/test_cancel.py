"""Cancelling a run from another thread."""

import threading

import pytest

from motion import InputError
from webdemo.inference import run
from webdemo.inference.run import Cancelled, CancelToken


def test_nothing_happens_until_a_token_is_set() -> None:
    token = CancelToken()
    token.raise_if_cancelled()
    assert not token.cancelled and not token.is_set()


def test_another_thread_cancels() -> None:
    token = CancelToken()
    other = threading.Thread(target=token.cancel)
    other.start()
    other.join()
    assert token.cancelled and token.is_set()
    token.cancel()  # once more changes nothing
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
    assert not token.is_set()
    now += 0.1
    with pytest.raises(InputError, match=f"longer than the {said} that this lab allows"):
        token.raise_if_cancelled()
    assert token.is_set() and not token.cancelled
    token.cancel()
    with pytest.raises(Cancelled):
        token.raise_if_cancelled()


def test_without_a_limit_a_run_may_take_any_time(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr(run, "monotonic", lambda: now)
    token = CancelToken().start()
    now += 1e9
    token.raise_if_cancelled()
