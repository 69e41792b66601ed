"""The rate of each person's requests."""

import pytest

from webdemo.server.http import rate_limit
from webdemo.server.http.body_limits import Refused
from webdemo.server.http.rate_limit import RateLimit


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The seconds that the limit's clock shows."""
    now = [0.0]
    monkeypatch.setattr(rate_limit, "time", type("Clock", (), {"monotonic": staticmethod(lambda: now[0])}))
    return now


def test_as_many_as_a_minute_come_at_once_and_then_at_the_rate(clock: list[float]) -> None:
    limit = RateLimit(60)
    for _ in range(60):
        limit.take("a")
    with pytest.raises(Refused) as refused:
        limit.take("a")
    assert refused.value.status == 429
    limit.take("b")  # others have their own
    clock[0] = 2.0
    limit.take("a")
    limit.take("a")
    with pytest.raises(Refused):
        limit.take("a")


def test_a_full_bucket_is_enough_for_any_one_request(clock: list[float]) -> None:
    limit = RateLimit(10)
    limit.take("a", weight=500)
    with pytest.raises(Refused):
        limit.take("a")
    clock[0] = 61.0
    limit.take("a", weight=500)


def test_people_who_were_idle_longest_are_forgotten(
    clock: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rate_limit, "_MOST", 2)
    limit = RateLimit(1)
    for person in "abc":
        limit.take(person)
    limit.take("a")  # was forgotten, so it begins anew
    with pytest.raises(Refused):
        limit.take("c")
