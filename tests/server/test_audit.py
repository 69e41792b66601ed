"""The audit log: who did what, one line each, rotated, without secrets."""

from __future__ import annotations

import json
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from webdemo.server.audit import audit, audited, fingerprint, set_up_audit

from .attacks.backend import Backend
from .attacks.target import Target
from .clients import FIELDS


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[Path]:
    """A data folder with an audit log whose files are put aside after 2 kB."""
    set_up_audit("file", tmp_path, "one", megabytes=2000 / 2**20, files=3)
    yield tmp_path
    set_up_audit("log", tmp_path, "one", megabytes=1, files=1)


def test_a_line_is_json_and_cannot_begin_another(kept: Path) -> None:
    audit("sign-in", ok=False, person='eve"\n{"act": "admin-delete"}', reason=None, tries=3)
    (line,) = (kept / "audit" / "one.jsonl").read_text().splitlines()
    found = json.loads(line)
    assert found["act"] == "sign-in" and found["ok"] is False and found["tries"] == 3
    assert found["person"].startswith('eve"\n') and "reason" not in found


def test_files_are_put_aside_and_private(kept: Path) -> None:
    for number in range(100):
        audit("import", person="ada", count=number)
    files = sorted(path.name for path in (kept / "audit").iterdir())
    assert files == ["one.jsonl", "one.jsonl.1", "one.jsonl.2", "one.jsonl.3"]
    for path in (kept / "audit").iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o600 and path.stat().st_size <= 2000
    assert [line["count"] for line in audited(kept, 30)] == list(range(99, 69, -1))


def test_it_can_be_switched_off(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    set_up_audit("off", tmp_path, "one", megabytes=1, files=1)
    audit("import", person="ada")
    assert not (tmp_path / "audit").exists() and not caplog.records
    set_up_audit("log", tmp_path, "one", megabytes=1, files=1)
    audit("import", person="ada")
    assert not (tmp_path / "audit").exists() and caplog.records[-1].audit["act"] == "import"  # type: ignore[attr-defined]


def test_a_server_writes_down_what_people_do(tmp_path: Path) -> None:
    """Sign-ins and failures, links, removals: with a name and an address, without what opens anything."""
    backend = Backend(tmp_path / "backend")
    with Target(tmp_path, accounts=True) as lab:
        for name, password in (("ada", "a wrong password"), ("the password of ada", "ada")):
            given = {"username": name, "password": password}
            assert lab.ask("stranger", "POST", "/login", data=given).status_code == 401
        finished = lab.call("ada", "generate", ["SECRET", *FIELDS[1:]])
        assert "complete" in finished
        open_history = backend.number("HistoryTab.open_address")
        lab.event("eve", open_history, ["no-such-link-at-all"])
        lab.ask("ada", "POST", "/logout")

        lines = audited(tmp_path / "data", 100)[::-1]
    seen = [(line["act"], line["ok"], line["person"]) for line in lines]
    assert ("sign-in", False, "ada") in seen and ("sign-in", True, "ada") in seen
    assert ("sign-in", False, "(unknown)") in seen  # the name field held a password
    assert ("link-opened", False, "eve") in seen and seen[-1] == ("sign-out", True, "ada")
    assert {line["address"] for line in lines} == {"127.0.0.1"} and all(line["request"] for line in lines)
    opened: dict[str, Any] = next(line for line in lines if line["act"] == "link-opened")
    assert opened["link"] == fingerprint("no-such-link-at-all")
    text = "".join(path.read_text() for path in (tmp_path / "data" / "audit").iterdir())
    for secret in ("SECRET", "password of", "wrong password", "no-such-link", "pasdedeux_"):
        assert secret not in text
