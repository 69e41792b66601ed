"""Two servers in processes of their own for attackers: one with the accounts of ada and eve, one open."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from .backend import Backend
from .target import Target
from .victim import Victim


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


@pytest.fixture(scope="package")
def victims() -> Callable[[Target], Victim]:
    """Ada at a server, with what she has there: made once."""
    made: dict[str, Victim] = {}

    def at(target: Target) -> Victim:
        if target.url not in made:
            made[target.url] = Victim(target)
        return made[target.url]

    return at


@pytest.fixture(scope="package")
def backend(tmp_path_factory: pytest.TempPathFactory) -> Backend:
    """The routes and functions of the application that the servers run."""
    return Backend(tmp_path_factory.mktemp("backend"))
