"""The engine tests' tiny weights, for the server as well; and servers that many tests share, since a page
takes seconds to build."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient

from tests.inference.conftest import weights
from webdemo.server.accounts import accounts
from webdemo.server.http import exchange, health

from .clients import client_of, served_on_loopback, settings_for
from .lab import add_accounts

__all__ = ["weights"]
OFTEN = 100_000
"""Requests a minute: nothing that these servers are asked is too often."""


@pytest.fixture(scope="package", autouse=True)
def patient() -> Iterator[None]:
    """Tests wait neither for the next look at the server's health nor for a refusal."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(health, "EVERY", 0.1)
        patch.setattr(exchange, "BACK_OFF", 0.0)
        yield


@pytest.fixture(scope="package")
def local(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server for its own machine, without accounts."""
    folder = tmp_path_factory.mktemp("local")
    with client_of(settings_for(folder, metrics_token="", rate=OFTEN, events=1000)) as client:
        yield client


@pytest.fixture(scope="package")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server with the accounts of ada and eve."""
    folder = tmp_path_factory.mktemp("shared")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(accounts, "COST", 2**4)
        add_accounts(folder / "data", "ada", "eve")
        settings = settings_for(folder, accounts=True, host="0.0.0.0", hosts=["127.0.0.1"], rate=OFTEN, events=1000)
        with client_of(settings) as client:
            yield client


@pytest.fixture(scope="package")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    """Where a server listens that waits a second for heads and bodies, and bounds connections."""
    folder = tmp_path_factory.mktemp("served")
    with served_on_loopback(
        folder, header_seconds=1, body_seconds=1, answer_seconds=3, connections=60, address_connections=25
    ) as address:
        yield address
