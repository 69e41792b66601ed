"""The rate of each person's requests."""

import pytest

from webdemo.server.http import rate_limit
from webdemo.server.http.rate_limit import RateLimit
from webdemo.server.http.refused import Refused


class Clock:
    """A time that a test sets."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_a_machine_that_has_been_up_for_long_gives_nobody_more(clock: Clock) -> None:
    clock.now = 1e6
    limit = RateLimit(3, clock)
    for _ in range(3):
        limit.take("a")
    with pytest.raises(Refused):
        limit.take("a")


def test_as_many_as_a_minute_come_at_once_and_then_at_the_rate(clock: Clock) -> None:
    limit = RateLimit(60, clock)
    for _ in range(60):
        limit.take("a")
    with pytest.raises(Refused) as refused:
        limit.take("a")
    assert refused.value.status == 429
    limit.take("b")  # others have their own
    clock.now = 2.0
    limit.take("a")
    limit.take("a")
    with pytest.raises(Refused):
        limit.take("a")


def test_a_full_bucket_is_enough_for_any_one_request(clock: Clock) -> None:
    limit = RateLimit(10, clock)
    limit.take("a", weight=500)
    with pytest.raises(Refused):
        limit.take("a")
    clock.now = 61.0
    limit.take("a", weight=500)


def test_people_who_were_idle_longest_are_forgotten(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rate_limit, "_MOST", 2)
    limit = RateLimit(1, clock)
    for person in "abc":
        limit.take(person)
    limit.take("a")  # was forgotten, so it begins anew
    with pytest.raises(Refused):
        limit.take("c")
