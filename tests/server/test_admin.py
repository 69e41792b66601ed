"""Administrators, against a real server: their page and the shell."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from .attacks.target import Target
from .clients import FIELDS


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    """A server whose steps take a while, of which eve is an administrator."""
    with Target(tmp_path_factory.mktemp("admin"), accounts=True, stub_pause=0.2) as target:
        target.shell("admin", "make-admin", "eve")
        yield target


def act(lab: Target, who: str = "eve", **form: str) -> Any:
    return lab.ask(who, "POST", "/admin", data=form, headers={"origin": lab.url})


def test_only_administrators_and_only_their_own_page(lab: Target) -> None:
    assert lab.ask("ada", "GET", "/admin").status_code == 403
    assert act(lab, "ada", act="suspend", name="eve").status_code == 403
    shown = lab.ask("eve", "GET", "/admin")
    assert shown.status_code == 200 and "<script" not in shown.text and "ada" in shown.text
    for headers in ({}, {"origin": "https://evil.example"}):
        refused = lab.ask("eve", "POST", "/admin", data={"act": "suspend", "name": "ada"}, headers=headers)
        assert refused.status_code == 403
    assert act(lab, act="burn", name="ada").status_code == 422


def test_suspended_and_signed_out_everywhere(lab: Target) -> None:
    assert "event: complete" in lab.call("ada", "generate", FIELDS)
    lab.shell("admin", "suspend", "ada")
    given = {"username": "ada", "password": "password of ada"}
    refused = lab.ask("stranger", "POST", "/login", data=given)
    assert refused.status_code == 403 and "suspended" in refused.text
    assert lab.ask("ada", "GET", "/config").status_code == 401
    assert act(lab, act="let-in", name="ada").status_code == 303
    assert lab.ask("stranger", "POST", "/login", data=given).status_code == 200


def test_a_deleted_account_leaves_nothing(lab: Target) -> None:
    assert any((lab.data / "motions").iterdir())
    lab.shell("admin", "delete", "ada")
    assert not any((lab.data / "motions").iterdir())
    assert [row["name"] for row in lab.shell("admin", "list")["people"]] == ["eve"]
