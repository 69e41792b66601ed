"""The way of an operator through docs/hosting.md, from an empty folder: each step by the command that the page gives,
against servers in processes of their own. Sign-in by a proxy has tests in ``accounts``."""

from __future__ import annotations

import json
import shutil
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from .attacks.target import Target
from .clients import FIELDS

PASSWORD = "a password of ada's"
DONE = "SELECT owner, id FROM runs WHERE state = 'done'"


class Way(Target):
    """A server whose settings are in a file, as the page shows it, and whose accounts are made by commands."""

    def __init__(self, folder: Path, name: str = "data") -> None:
        super().__init__(folder, accounts=False, stub_pause=0.1)
        self.data = folder / name
        self.settings = folder / f"{name}.toml"
        self.settings.write_text(
            f"accounts = true\ndata = {json.dumps(str(self.data))}\nkeep_days = 60\n"
            f'host = "0.0.0.0"\nhosts = ["127.0.0.1"]\n'
            "free_megabytes = 0\ngrace_seconds = 1\n"
        )
        self.env = {"PASDEDEUX_SETTINGS": str(self.settings)}

    @contextmanager
    def browser(self, name: str, password: str) -> Any:
        """A browser that has signed in."""
        with httpx.Client(base_url=self.url, timeout=60, headers={"origin": self.url}) as client:
            given = {"username": name, "password": password}
            assert client.post("/login", data=given).json() == {"success": True}
            yield client


def generate(browser: httpx.Client, steps: int = 1) -> str:
    asked = browser.post("/gradio_api/call/generate", json={"data": [*FIELDS[:5], steps, *FIELDS[6:]]}).json()
    return browser.get(f"/gradio_api/call/generate/{asked['event_id']}").text


def test_from_an_empty_folder_to_a_backup_that_serves_again(tmp_path: Path) -> None:
    lab = Way(tmp_path)
    assert lab.shell("user", "add", "ada", given=f"{PASSWORD}\n")["added"] == "ada"
    assert lab.shell("user", "add", "temp", given=f"{PASSWORD}\n")["added"] == "temp"
    assert lab.shell("admin", "delete", "temp")["name"] == "temp"
    with lab, lab.browser("ada", PASSWORD) as ada:
        lab.shell("admin", "make-admin", "ada")
        lab.shell("user", "add", "guest", given=f"{PASSWORD}\n")
        with lab.browser("guest", PASSWORD) as guest:
            assert "complete" in generate(guest) and "complete" in generate(guest)
            page = ada.get("/admin").text
        assert "<strong>guest</strong>" in page
        runs = lab.rows(DONE)
        key = lab.publish(*runs[0])
        assert lab.ask("stranger", "GET", f"/share/{key}").status_code == 200
        acts = [(line["act"], line["person"]) for line in lab.audited()]
        assert ("sign-in", "ada") in acts and "page-opened" in dict(acts)
        assert PASSWORD not in lab.log() and key not in lab.log()
        backup = lab.shell("backup", str(tmp_path / "backups"), "--keep", "7")["backup"]

    again = Way(tmp_path, "again")
    shutil.copytree(backup, again.data)
    with again, again.browser("guest", PASSWORD) as guest:
        assert "complete" in generate(guest)
        assert again.ask("stranger", "GET", f"/share/{key}").status_code == 200
    assert len(again.rows(DONE)) == len(runs) + 1
