"""Log lines about what people do: who, what and from where, without secrets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from webdemo.server.audit import fingerprint

from .attacks.backend import Backend
from .attacks.target import Target
from .clients import FIELDS


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
        lines = lab.audited()[::-1]
    seen = [(line["act"], line["ok"], line["person"]) for line in lines]
    assert ("sign-in", False, "ada") in seen and ("sign-in", True, "ada") in seen
    assert ("sign-in", False, "(unknown)") in seen  # the name field held a password
    assert ("link-opened", False, "eve") in seen and seen[-1] == ("sign-out", True, "ada")
    assert {line["address"] for line in lines} == {"127.0.0.1"} and all(line["request"] for line in lines)
    opened: dict[str, Any] = next(line for line in lines if line["act"] == "link-opened")
    assert opened["link"] == fingerprint("no-such-link-at-all")
    for secret in ("SECRET", "password of", 'wrong password",', "no-such-link", "pasdedeux_"):
        assert secret not in lab.log()
