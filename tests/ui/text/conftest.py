"""A visitor whose page is German, for tests of what the server says."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from gradio.context import LocalContext


@pytest.fixture
def german() -> Iterator[None]:
    """Answers an event of a page with ``?lang=de`` while the test runs."""
    request = SimpleNamespace(query_params={"lang": "de"}, headers={}, scope={})
    token = LocalContext.request.set(SimpleNamespace(request=request))
    yield
    LocalContext.request.reset(token)
