"""Administrators, against a real server: their page and the shell."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from .attacks.target import Target
from .clients import FIELDS
from .lab import ROOT


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    """A server whose steps take a while, of which eve is an administrator."""
    with Target(tmp_path_factory.mktemp("admin"), accounts=True, stub_pause=0.2) as target:
        shell(target, "make-admin", "eve")
        yield target


def shell(lab: Target, *words: str) -> dict[str, Any]:
    env = {**os.environ, **lab.env, "PASDEDEUX_DATA": str(lab.data)}
    done = subprocess.run(
        [sys.executable, "-m", "webdemo", "admin", *words], cwd=ROOT, env=env, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def act(lab: Target, **form: str) -> Any:
    return lab.ask("eve", "POST", "/admin", data=form, headers={"origin": lab.url})


def test_only_administrators_and_only_their_own_page(lab: Target) -> None:
    assert lab.ask("ada", "GET", "/admin").status_code == 403
    assert (
        lab.ask(
            "ada", "POST", "/admin", data={"act": "suspend", "name": "eve"}, headers={"origin": lab.url}
        ).status_code
        == 403
    )
    shown = lab.ask("eve", "GET", "/admin")
    assert shown.status_code == 200 and "<script" not in shown.text and "ada" in shown.text
    for headers in ({}, {"origin": "https://evil.example"}):
        assert (
            lab.ask("eve", "POST", "/admin", data={"act": "suspend", "name": "ada"}, headers=headers).status_code == 403
        )
    assert act(lab, act="burn", name="ada").status_code == 422


def test_suspended_and_signed_out_everywhere(lab: Target) -> None:
    assert "event: complete" in lab.call("ada", "generate", FIELDS)
    shell(lab, "suspend", "ada")
    given = {"username": "ada", "password": "password of ada"}
    refused = lab.ask("stranger", "POST", "/login", data=given)
    assert refused.status_code == 403 and "suspended" in refused.text
    assert lab.ask("ada", "GET", "/config").status_code == 401
    assert act(lab, act="let-in", name="ada").status_code == 303
    assert lab.ask("stranger", "POST", "/login", data=given).status_code == 200


def test_a_deleted_account_leaves_nothing(lab: Target) -> None:
    assert any((lab.data / "motions").iterdir())
    shell(lab, "delete", "ada")
    assert not any((lab.data / "motions").iterdir())
    assert [row["name"] for row in shell(lab, "list")["people"]] == ["eve"]
