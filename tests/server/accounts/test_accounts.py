"""Accounts, sign-ins and settings."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import update
from starlette.responses import Response

from motion import InputError
from tests.server.clients import Clock
from tests.server.lab import stub_module
from webdemo.cli import main
from webdemo.inference.requests import GenerateRequest
from webdemo.server.accounts import accounts
from webdemo.server.accounts.accounts import Accounts, Throttle
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.visitors import set_cookie
from webdemo.server.http.routes import Refused
from webdemo.server.lab import Lab
from webdemo.server.settings import Settings, read_settings
from webdemo.server.store.database import Database, SignIn
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.storage import Storage
from webdemo.ui.history import Search


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    database = Database(tmp_path / "history.db")
    yield database
    database.close()


@pytest.fixture
def people(database: Database, monkeypatch: pytest.MonkeyPatch) -> Accounts:
    monkeypatch.setattr(accounts, "COST", 2**4)  # the real cost is there to be slow
    people = Accounts(database, 1.0)
    people.add("ada", "correct horse")
    return people


def signed_in(people: Accounts, name: str, password: str, address: str, known: str = "") -> str | None:
    return people.begin(people.admit(name, address, known), password)


def test_passwords_are_kept_as_salted_hashes(people: Accounts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accounts, "COST", 2**5)  # of a later version
    people.add("eve", "correct horse")
    (ada, eve) = (people.of(name) for name in ("ada", "eve"))
    assert ada and eve and "correct horse" not in ada.password and ada.password[-64:] != eve.password[-64:]
    assert signed_in(people, "ada", "correct horse", "1.2.3.4") and signed_in(people, "eve", "correct horse", "1.2.3.4")
    people.arrive("mary")  # by a proxy, without a password
    for name, password in (("ada", "wrong horse"), ("nobody", "nobody"), ("mary", ""), ("mary", "nobody"), ("", "")):
        assert signed_in(people, name, password, "1.2.3.4") is None


@pytest.mark.parametrize("name", ["", "a:b", "a\nroot:x", "../x", "Ada", "a" * 41, "é"])
def test_what_cannot_be_is_a_sentence(people: Accounts, name: str) -> None:
    with pytest.raises(InputError, match="is not a valid account name"):
        people.add(name, "long enough")
    with pytest.raises(InputError, match="8 to 256 characters"):
        people.add("eve", "short")
    assert people.of(name) is None and people.of("eve") is None


def test_people_end(people: Accounts, database: Database) -> None:
    token = signed_in(people, "ada", "correct horse", "1.2.3.4")
    found = people.person(token or "")
    assert token and found and found.name == "ada"
    assert people.person("x" * 43) is None and people.person("") is None
    with database.session() as session:
        assert token not in str([vars(row) for row in session.query(SignIn)])  # only its hash
    with database.session.begin() as session:
        session.execute(update(SignIn).values(until=time.time() - 1))
    assert people.person(token) is None
    for end in (people.end, lambda _: people.add("ada", "correct horse")):
        token = signed_in(people, "ada", "correct horse", "1.2.3.4")
        assert token and people.person(token)
        end(token)
        assert people.person(token) is None


@pytest.fixture
def clock(people: Accounts) -> Clock:
    clock = Clock()
    people._throttle = Throttle(clock)
    return clock


def refused_for(people: Accounts, password: str, address: str, known: str = "") -> int:
    """The seconds that a sign-in as ada has to wait; 0 if the password is looked at."""
    try:
        signed_in(people, "ada", password, address, known)
    except Refused as error:
        return int(str(error).split()[-2])
    return 0


def test_guesses_from_an_address_are_slowed_down(people: Accounts, clock: Clock) -> None:
    for _ in range(accounts.TRIES):
        assert not refused_for(people, "wrong horse", "6.6.6.6")
    wait = refused_for(people, "correct horse", "6.6.6.6")
    assert 0 < wait <= 60
    assert signed_in(people, "ada", "correct horse", "1.2.3.4"), "its owner is not locked out"
    clock.now += wait
    assert signed_in(people, "ada", "correct horse", "6.6.6.6"), "after a while the next try is looked at"


def test_right_passwords_cost_no_tries(people: Accounts, clock: Clock) -> None:
    for _ in range(3 * accounts.TRIES):
        assert signed_in(people, "ada", "correct horse", "1.2.3.4")


def test_a_name_is_slowed_down_for_all_addresses_together(people: Accounts, clock: Clock) -> None:
    known = people.known_browser("ada")
    guesses = [refused_for(people, "wrong horse", f"6.6.6.{i}") for i in range(accounts.NAME_TRIES + 20)]
    assert guesses.count(0) == accounts.NAME_TRIES <= 100
    assert 0 < refused_for(people, "correct horse", "1.2.3.4") <= 10
    assert signed_in(people, "ada", "correct horse", "1.2.3.4", known), "where she has signed in before, she still can"
    clock.now += 10
    assert signed_in(people, "ada", "correct horse", "1.2.3.4"), "elsewhere she waits for seconds"
    people.add("eve", "password of eve")
    assert signed_in(people, "eve", "password of eve", "1.2.3.4"), "others are not slowed down"


def test_a_browser_is_known_for_its_own_name_and_password(people: Accounts, clock: Clock) -> None:
    known = people.known_browser("ada")
    people.add("eve", "password of eve")
    browser = known.partition(".")[0]
    assert people._browser("ada", known) == browser
    for name, forged in (
        ("eve", known),
        ("ada", f"{browser}."),
        ("ada", f".{known.partition('.')[2]}"),
        ("ada", known[:-1]),
        ("nobody", f"{browser}."),
        ("ada", "é.é"),
        ("ada", ""),
    ):
        assert not people._browser(name, forged), forged
    for _ in range(accounts.TRIES):
        assert not refused_for(people, "wrong horse", "1.2.3.4", known)
    assert refused_for(people, "wrong horse", "1.2.3.4", known), "it may not guess without end either"
    people.add("ada", "another password")
    assert not people._browser("ada", known)


# ---- settings ------------------------------------------------------------------------------------


def test_the_environment_goes_before_the_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "p.toml"
    file.write_text('port = 8001\nwaiting = 9\nproxies = ["10.0.0.1"]\n')
    monkeypatch.setenv("PASDEDEUX_SETTINGS", str(file))
    monkeypatch.setenv("PASDEDEUX_PORT", "8002")
    settings = read_settings()
    assert (settings.port, settings.waiting, settings.proxies) == (8002, 9, ["10.0.0.1"])
    assert read_settings(port=8003).port == 8003


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("prot = 1", "There is no setting 'prot'"),
        ("port = 'x'", "The setting port (PASDEDEUX_PORT) cannot be 'x'"),
        ("port = 70000", "The setting port"),
        ("root_path = '/a/../b?'", "The setting root_path"),
        ("port = ", "cannot be read"),
    ],
)
def test_a_wrong_file_is_a_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, text: str, sentence: str) -> None:
    file = tmp_path / "p.toml"
    file.write_text(text)
    monkeypatch.setenv("PASDEDEUX_SETTINGS", str(file))
    with pytest.raises(InputError) as caught:
        read_settings()
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("fields", "allowed"),
    [
        ({"host": "127.0.0.1"}, True),
        ({"host": "::1"}, True),
        ({"host": "0.0.0.0"}, False),
        ({"host": "192.0.2.7"}, False),
        ({"host": "0.0.0.0", "open": True}, True),
        ({"host": "0.0.0.0", "accounts": True}, True),
    ],
)
def test_it_is_never_open_unsaid(fields: dict[str, Any], allowed: bool) -> None:
    settings = Settings(**fields)
    if allowed:
        settings.check()
    else:
        with pytest.raises(InputError, match="there are no accounts"):
            settings.check()


def test_a_space_is_open_and_behind_its_own_proxy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPACE_ID", "lab/pas-de-deux")
    settings = Settings()
    settings.check()
    assert (settings.host, settings.open) == ("0.0.0.0", True) and "*" not in settings.proxies
    response = Response()
    set_cookie(response, "a", "b", seconds=1, root="", secure=False)
    assert "SameSite=none; Secure" in response.headers["set-cookie"]


def test_secrets_are_not_printed() -> None:
    shown = Settings(metrics_token="s3cret").shown()
    assert "s3cret" not in str(shown)


# ---- from a shell --------------------------------------------------------------------------------


def test_accounts_from_a_shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("correct horse\n"))
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path))
    assert main(["user", "add", "ada"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["added"] == "ada"
    database = Database(tmp_path / "history.db")
    assert signed_in(Accounts(database), "ada", "correct horse", "1.2.3.4")
    database.close()


def test_settings_from_a_shell(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("PASDEDEUX_METRICS_TOKEN", "s3cret")
    assert main(["serve", "--port", "8123", "--print-settings"]) == 0
    said = capsys.readouterr().out
    assert "port = 8123  # port to listen on" in said and "s3cret" not in said
    assert main(["serve", "--host", "0.0.0.0"]) == 2
    assert "there are no accounts" in capsys.readouterr().err


def test_nobody_inherits_from_an_earlier_account_of_the_same_name(
    people: Accounts, database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where something of theirs is written down after they were deleted."""
    first = people.arrive("ada")
    Administration(database, tmp_path).set_role("ada", admin=True)
    history = Notebook(Storage(database, tmp_path / "motions"))
    history.begin(first.owner, GenerateRequest(prompt="They bow.").to_dict(), "They bow.")
    assert not people.add("ada", "another password") and people.arrive("ada").key == first.key, "the same person"
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path))
    assert main(["admin", "delete", "ada"]) == 0 and people.empty
    assert not history.search(first.owner, Search()).total
    history.begin(first.owner, GenerateRequest(prompt="They hug.").to_dict(), "They hug.")
    people.add("ada", "battery staple")
    assert people.arrive("ada").role == "" and not history.search(people.arrive("ada").owner, Search()).total


def test_a_server_that_nobody_could_sign_in_to_does_not_start(database: Database, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="There are no accounts yet"):
        Lab(Settings(data=tmp_path, accounts=True), stub_module().StubEngine())
