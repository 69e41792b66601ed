"""Public pages of a real process: open to strangers, the player framed by other sites, and nothing more."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.server.attacks.target import Target
from tests.server.clients import FIELDS

HOSTILE = '"@body@</script><script>alert(1)</script>'


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    with Target(tmp_path_factory.mktemp("public"), accounts=True) as target:
        yield target


@pytest.fixture(scope="module")
def key(lab: Target) -> str:
    """A public page of a run of ada's."""
    assert "complete" in lab.call("ada", "generate", [HOSTILE, *FIELDS[1:]])
    return lab.publish(*lab.rows("SELECT owner, id FROM runs")[0])


def test_a_page_is_shown_to_a_stranger(lab: Target, key: str) -> None:
    page = lab.ask("stranger", "GET", f"/share/{key}")
    assert page.status_code == 200 and page.headers["cache-control"] == "no-store"
    assert HOSTILE not in page.text and "@body@&lt;/script&gt;" in page.text
    assert "set-cookie" not in page.headers
    assert (page.text.count("<script"), page.text.count("</script")) == (2, 2), "the motion, the module"
    payload = page.text.split('id="motion">')[1].split("</script>")[0]
    assert json.loads(payload)["samples"][0]["frames"] == 30
    assert f"{lab.url}/embed/{key}" in page.text


def test_only_the_player_alone_may_be_framed(lab: Target, key: str) -> None:
    for path, frames in (
        (f"/embed/{key}", "frame-ancestors *"),
        (f"/share/{key}", "frame-ancestors 'self'"),
        ("/login", "frame-ancestors 'self'"),
        (f"/shown/../embed/{key}/../../login", "frame-ancestors 'self'"),
    ):
        policy = lab.ask("stranger", "GET", path).headers["content-security-policy"]
        assert policy.endswith(frames), path
    policy = lab.ask("stranger", "GET", f"/embed/{key}").headers["content-security-policy"]
    assert "script-src 'self' 'unsafe-eval' blob:;" in policy and "form-action 'none'" in policy


def test_the_files_of_public_pages_are_open_and_nothing_beside_them(lab: Target) -> None:
    main = lab.ask("stranger", "GET", "/shown/player/main.js")
    assert main.status_code == 200 and "max-age" in main.headers["cache-control"]
    assert lab.ask("stranger", "GET", "/shown/bodies/man.json").status_code == 200
    assert lab.ask("stranger", "GET", "/shown/share/page.html").status_code == 404
    assert lab.ask("stranger", "GET", "/gradio_api/file=static/player/main.js").status_code == 401


def test_somebody_who_asks_for_pages_too_often_waits(tmp_path: Path) -> None:
    with Target(tmp_path, accounts=True, rate=100) as lab:
        asked = [lab.ask("stranger", "GET", f"/share/{'0' * 32}").status_code for _ in range(25)]
    assert asked[:15] == [404] * 15 and asked[-1] == 429
