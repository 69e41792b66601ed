"""Two servers in processes of their own for attackers: one with the accounts of ada and eve, one open."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .target import Target


@pytest.fixture(scope="package")
def closed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    """A server with accounts."""
    with Target(tmp_path_factory.mktemp("closed"), accounts=True) as target:
        yield target


@pytest.fixture(scope="package")
def anyone(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    """A server that is open to everybody."""
    with Target(tmp_path_factory.mktemp("open"), accounts=False) as target:
        yield target


@pytest.fixture(params=["closed", "anyone"])
def target(request: pytest.FixtureRequest) -> Target:
    """Either of the two."""
    return request.getfixturevalue(request.param)
