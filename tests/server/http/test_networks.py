"""By what part of an address limits count."""

from __future__ import annotations

from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from tests.server.clients import HERE, settings_for
from tests.server.lab import stub_module
from webdemo.server.app import create_app
from webdemo.server.http.networks import network_of


@pytest.mark.parametrize(
    ("address", "network"),
    [
        ("203.0.113.9", "203.0.113.9"),
        ("2001:db8:1:2::1", "2001:db8:1:2::/64"),
        ("2001:db8:1:2:ffff:ffff:ffff:ffff", "2001:db8:1:2::/64"),
        ("2001:db8:1:3::1", "2001:db8:1:3::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("::ffff:203.0.113.9", "203.0.113.9"),
        ("::1", "::1"),
        ("127.0.0.1", "127.0.0.1"),
        ("testclient", "testclient"),
        ("", ""),
    ],
)
def test_a_subscriber_is_one_network(address: str, network: str) -> None:
    assert network_of(address) == network


def test_all_addresses_of_a_subscriber_share_one_rate(tmp_path: Path) -> None:
    """On an open server nobody gets more requests by a new address in their own network for each."""
    settings = settings_for(tmp_path, open=True, rate=10, address_people=2)
    app = create_app(settings, engine=stub_module().StubEngine())
    statuses = []
    with TestClient(app):
        for i in range(30):
            one = TestClient(app, base_url=HERE, client=(f"2001:db8:1:2::{i + 1:x}", 5))
            statuses.append(one.post("/gradio_api/reset", json={"event_id": "x"}).status_code)
        other = TestClient(app, base_url=HERE, client=("2001:db8:1:3::1", 5))
        assert other.post("/gradio_api/reset", json={"event_id": "x"}).status_code != 429
    assert 10 <= statuses.count(429) <= 20
