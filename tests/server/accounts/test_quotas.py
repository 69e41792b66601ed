"""What a person may use: at a time, and by the minute; and by what part of an address limits count."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from tests.server.clients import HERE, Clock, settings_for
from tests.server.lab import stub_module
from webdemo.server.accounts import quotas
from webdemo.server.accounts.quotas import OverQuota, Quota, Quotas, RateLimit, network_of
from webdemo.server.app import create_app
from webdemo.server.http.routes import Refused


@pytest.mark.parametrize(
    ("person", "address", "whose"),
    [("ada", "", "person"), ("new", "near", "address"), ("new", "far", "everybody"), ("new", "", "everybody")],
)
def test_each_share_is_counted(person: str, address: str, whose: str) -> None:
    quota = Quota("runs waiting", person=2, address=3, everybody=8)
    held = [("ada", ""), ("ada", ""), ("a", "near"), ("b", "near"), ("c", "near")]
    held += [] if whose == "address" else [(name, "") for name in "def"]
    with pytest.raises(OverQuota, match="runs waiting") as refused:
        quota.check(person, address, held)
    assert refused.value.whose == whose
    quota.check("new", "far", held[:4])


def test_whoever_takes_all_they_can_leaves_some_to_others() -> None:
    """Three addresses filled the queue of events with what each of them may have, and nobody else was let in."""
    quota, held = Quota("tasks", person=16, address=128, everybody=320), list[tuple[str, str]]()
    for i in range(3 * 320):
        with suppress(OverQuota):
            quota.check(f"visitor {i}", f"192.0.2.{i % 3}", held)
            held.append((f"visitor {i}", f"192.0.2.{i % 3}"))
    assert len(held) == 3 * 80
    quota.check("new", "192.0.2.9", held)


def test_quotas_are_those_of_the_settings(tmp_path: Path) -> None:
    found = Quotas(settings_for(tmp_path, open=True, events=10, waiting=3, address_people=2, live=6))
    assert (found.events.person, found.events.address) == (10, 20) and found.events.everybody > 20
    assert (found.waiting.person, found.waiting.address, found.waiting.everybody) == (3, 6, 64)
    assert (found.live.person, found.live.address, found.live.everybody) == (1, 3, 6)
    assert found.room.person < found.room.everybody


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_as_many_as_a_minute_come_at_once_and_then_at_the_rate(clock: Clock) -> None:
    limit = RateLimit(60, clock)
    for _ in range(60):
        limit.take("a")
    with pytest.raises(Refused) as refused:
        limit.take("a")
    assert refused.value.status == 429
    limit.take("b")  # others have their own
    clock.now += 2.0
    limit.take("a")
    limit.take("a")
    with pytest.raises(Refused):
        limit.take("a")


def test_a_full_bucket_is_enough_for_any_one_request(clock: Clock) -> None:
    limit = RateLimit(10, clock)
    limit.take("a", 500)
    with pytest.raises(Refused):
        limit.take("a")
    clock.now += 61.0
    limit.take("a", 500)


def test_people_who_were_idle_longest_are_forgotten(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quotas, "_MOST", 2)
    limit = RateLimit(1, clock)
    for person in "abc":
        limit.take(person)
    limit.take("a")  # was forgotten, so it begins anew
    with pytest.raises(Refused):
        limit.take("c")


@pytest.mark.parametrize(
    ("address", "network"),
    [
        ("203.0.113.9", "203.0.113.9"),
        ("2001:db8:1:2:ffff:ffff:ffff:ffff", "2001:db8:1:2::/64"),
        ("2001:db8:1:3::1", "2001:db8:1:3::/64"),
        ("::ffff:203.0.113.9", "203.0.113.9"),
        ("::1", "::1"),
        ("127.0.0.1", "127.0.0.1"),
        ("testclient", "testclient"),
    ],
)
def test_a_subscriber_is_one_network(address: str, network: str) -> None:
    assert network_of(address) == network


def test_all_addresses_of_a_subscriber_share_one_rate(tmp_path: Path) -> None:
    """On an open server nobody gets more requests by a new cookie and a new address in their own network for each."""
    settings = settings_for(tmp_path, open=True, rate=10, address_people=2)
    app = create_app(settings, engine=stub_module().StubEngine())
    statuses = []
    with TestClient(app):
        for i in range(30):
            one = TestClient(app, base_url=HERE, client=(f"2001:db8:1:2::{i + 1:x}", 5))
            cookie = {"cookie": f"pasdedeux_visitor={i:032}"}
            statuses.append(one.post("/gradio_api/reset", json={"event_id": "x"}, headers=cookie).status_code)
        other = TestClient(app, base_url=HERE, client=("2001:db8:1:3::1", 5))
        assert other.post("/gradio_api/reset", json={"event_id": "x"}).status_code != 429
    assert 10 <= statuses.count(429) <= 20
