"""Invitations: a link that makes one account once, against a real process and alone."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from tests.server.lab import ROOT
from webdemo.server.accounts import invitations as module
from webdemo.server.accounts.invitations import PATH, Invitations
from webdemo.server.accounts.users import Users
from webdemo.server.audit import audited
from webdemo.server.store.database import Database

PASSWORD = "a long password"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    with Target(tmp_path_factory.mktemp("invitations"), accounts=True) as target:
        yield target


def shell(lab: Target, *words: str) -> dict[str, object]:
    env = {**os.environ, **lab.env, "PASDEDEUX_DATA": str(lab.data)}
    command = [sys.executable, "-m", "webdemo", "admin", *words]
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_a_guest_makes_an_account_by_a_link_of_the_shell(lab: Target) -> None:
    path = str(shell(lab, "invite", "guest", "--megabytes", "20", "--days", "2")["path"])
    with httpx.Client(base_url=lab.url, timeout=30, headers={"origin": lab.url}) as guest:
        assert guest.get("/config").status_code == 401
        shown = guest.get(path)
        assert shown.status_code == 200 and "<strong>guest</strong>" in shown.text
        assert "no-store" in shown.headers["cache-control"]
        for new, again, says in (("short", "short", "8 to 256"), (PASSWORD, "another one", "differ")):
            refused = guest.post(path, data={"new": new, "again": again})
            assert refused.status_code == 422 and says in refused.text
        made = guest.post(path, data={"new": PASSWORD, "again": PASSWORD})
        assert (made.status_code, made.headers["location"]) == (303, "/")
        assert guest.get("/config").status_code == 200
        assert "Signed in as guest" in guest.get("/account").text
        for answer in (guest.get(path), guest.post(path, data={"new": PASSWORD, "again": PASSWORD})):
            assert answer.status_code == 404 and "has been used" in answer.text
    people = shell(lab, "list")["people"]
    assert isinstance(people, list)
    assert [row["room"] for row in people if row["name"] == "guest"] == [20.0]
    acts = {line["act"]: line for line in audited(lab.data, 100)}
    assert acts["invitation-accepted"]["person"] == acts["admin-invite"]["target"] == "guest"
    assert path.removeprefix(PATH) not in str(acts)


def test_the_page_of_administrators_shows_a_link_once(lab: Target) -> None:
    shell(lab, "make-admin", "eve")
    form = {"act": "invite", "name": "Mary", "megabytes": ""}
    shown = lab.ask("eve", "POST", "/admin", data=form, headers={"origin": lab.url})
    (link,) = re.findall(rf"{lab.url}/login/invited/[\w-]+", shown.text)
    assert shown.status_code == 200 and link not in lab.ask("eve", "GET", "/admin").text
    assert httpx.get(link).status_code == 200
    refused = lab.ask("eve", "POST", "/admin", data={**form, "name": "ada"}, headers={"origin": lab.url})
    assert refused.status_code == 422 and "ada already" in refused.text
    refused = lab.ask("ada", "POST", "/admin", data=form, headers={"origin": lab.url})
    assert refused.status_code == 403


def test_a_link_ends_with_time_with_another_and_with_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    database, users = Database(f"sqlite:///{tmp_path / 'history.db'}"), Users(tmp_path / "users")
    invitations = Invitations(database, users)
    first = invitations.invite("mary").removeprefix(PATH)
    second = invitations.invite("mary").removeprefix(PATH)
    assert (invitations.name_of(first), invitations.name_of(second)) == (None, "mary")
    other = invitations.invite("zoe", days=1).removeprefix(PATH)
    with monkeypatch.context() as later:
        now = module.time.time()
        later.setattr(module.time, "time", lambda: now + 86_401)
        assert (invitations.name_of(other), invitations.accept(other, PASSWORD)) == (None, None)
    users.add("zoe", PASSWORD)
    with pytest.raises(InputError, match="zoe already"):
        invitations.accept(other, "another password")
    assert users.knows("zoe", PASSWORD)
    assert (invitations.accept(second, PASSWORD), invitations.accept(second, PASSWORD)) == ("mary", None)
    for name, options in (("../x", {}), ("x", {"megabytes": 0.0}), ("x", {"days": 0.0}), ("mary", {})):
        with pytest.raises(InputError):
            invitations.invite(name, **options)
    database.close()
