"""A person's own account: another password, and signing out everywhere."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from tests.server.clients import HTML, client_of, settings_for, sign_in
from webdemo.server.accounts import users as accounts
from webdemo.server.accounts.users import Users


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder: Path = tmp_path_factory.mktemp("account")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(accounts, "COST", 2**4)
        for name in ("ada", "eve"):
            Users(folder / "users").add(name, f"password of {name}")
        settings = settings_for(folder, users=folder / "users", host="0.0.0.0", hosts=["127.0.0.1"], rate=10_000)
        with client_of(settings) as client:
            yield client


def change(lab: TestClient, headers: dict[str, str], now: str, new: str, again: str | None = None):
    fields = {"now": now, "new": new, "again": new if again is None else again}
    return lab.post("/account/password", data=fields, headers=headers | HTML)


def test_a_new_password_ends_all_other_sessions(lab: TestClient) -> None:
    here, elsewhere, eve = sign_in(lab, "ada"), sign_in(lab, "ada"), sign_in(lab, "eve")
    for headers in (here, elsewhere, eve):
        assert lab.get("/config", headers=headers).status_code == 200  # which the cache remembers
    assert "Signed in as ada" in lab.get("/account", headers=here).text
    changed = change(lab, here, "password of ada", "another of ada")
    assert changed.status_code == 200 and "signed out everywhere else" in changed.text
    fresh = {"cookie": changed.headers["set-cookie"].split(";")[0]}
    lab.cookies.clear()
    states = [lab.get("/config", headers=headers).status_code for headers in (fresh, here, elsewhere, eve)]
    assert states == [200, 401, 401, 200]
    back = change(lab, fresh, "another of ada", "password of ada")
    assert back.status_code == 200


def test_a_wrong_or_short_password_changes_nothing(lab: TestClient) -> None:
    lab.cookies.clear()
    eve = sign_in(lab, "eve")
    for now, new, again, status, says in (
        ("password of ada", "something else", None, 401, "is another one"),
        ("password of eve", "something else", "something other", 422, "differ"),
        ("password of eve", "short", None, 422, "8 to 256 characters"),
    ):
        answer = change(lab, eve, now, new, again)
        assert (answer.status_code, says in answer.text) == (status, True)
        assert lab.get("/config", headers=eve).status_code == 200
    assert sign_in(lab, "eve")


def test_guesses_of_the_password_slow_down(lab: TestClient) -> None:
    lab.cookies.clear()
    eve = sign_in(lab, "eve")
    tries = [change(lab, eve, f"guess {n}", "something else").status_code for n in range(9)]
    assert tries[-1] == 429 and 401 in tries


def test_signing_out_everywhere_ends_every_session_of_one_person(lab: TestClient) -> None:
    lab.cookies.clear()
    here, elsewhere = sign_in(lab, "ada"), sign_in(lab, "ada")
    assert lab.get("/config", headers=elsewhere).status_code == 200
    assert lab.post("/account/sign-out", headers=here).headers["location"] == "/login"
    lab.cookies.clear()
    assert [lab.get("/config", headers=each).status_code for each in (here, elsewhere)] == [401, 401]


def test_a_stranger_and_another_site_change_nothing(lab: TestClient) -> None:
    lab.cookies.clear()
    assert lab.get("/account").status_code == 401
    assert lab.post("/account/sign-out").status_code == 401
    ada = sign_in(lab, "ada")
    evil = ada | {"origin": "https://evil.example"}
    assert lab.post("/account/sign-out", headers=evil).status_code == 403
    assert change(lab, evil, "password of ada", "something else").status_code == 403
    assert lab.get("/config", headers=ada).status_code == 200
