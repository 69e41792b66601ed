"""Accounts, sign-ins and settings."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
import stat
import time
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import update
from starlette.responses import Response

from motion import InputError
from webdemo.cli import main
from webdemo.inference.requests import GenerateRequest
from webdemo.server.accounts import users as accounts
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.users import SignIns, Throttle, TooManyTries, Users
from webdemo.server.accounts.visitors import set_cookie
from webdemo.server.settings import Settings, read_settings
from webdemo.server.store.database import Database, SignIn
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Search


class Clock:
    """A time that a test sets."""

    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def users(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Users:
    monkeypatch.setattr(accounts, "COST", 2**4)  # the real cost is there to be slow
    users = Users(tmp_path / "users")
    users.add("ada", "correct horse")
    return users


def test_passwords_are_kept_as_salted_hashes(users: Users) -> None:
    users.add("eve", "correct horse")
    text = users.path.read_text()
    lines = dict(re.split("#[0-9a-f]{8}:", line) for line in text.splitlines() if not line.startswith("#"))
    assert "correct horse" not in text and lines["ada"] != lines["eve"]
    assert stat.S_IMODE(users.path.stat().st_mode) == 0o600
    assert users.knows("ada", "correct horse") and not users.knows("ada", "wrong horse")
    assert not users.knows("nobody", "nobody") and not users.knows("", "")


def test_passwords_outlive_a_change_of_what_a_try_costs(users: Users, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accounts, "COST", 2**5)
    users.add("eve", "battery staple")
    for reader in (users, Users(users.path)):
        assert reader.knows("ada", "correct horse") and reader.knows("eve", "battery staple")


def test_lines_without_a_cost_are_read_and_impossible_costs_refused(users: Users) -> None:
    salt, digest = b"salt", hashlib.scrypt(b"correct horse", salt=b"salt", n=2**14, r=8, p=1, dklen=32)
    line = ":".join(base64.b64encode(part).decode() for part in (salt, digest))
    users.path.write_text(f"ada:{line}\n")
    assert users.knows("ada", "correct horse") and not users.knows("ada", "wrong horse")
    users.path.write_text(f"ada:{2**40}:{line}\n")
    with pytest.raises(InputError, match="damaged"):
        users.knows("ada", "correct horse")


def test_changes_are_seen_by_who_reads(users: Users) -> None:
    reader = Users(users.path)
    assert reader.names == ["ada"]
    assert not users.add("ada", "another password")
    assert reader.knows("ada", "another password") and not reader.knows("ada", "correct horse")
    users.remove("ada")
    assert not reader.knows("ada", "another password")


@pytest.mark.parametrize("name", ["", "a:b", "a\nroot:x", "../x", "Ada", "a" * 41, "é"])
def test_names_that_would_break_the_file(users: Users, name: str) -> None:
    with pytest.raises(InputError, match="is not a valid account name"):
        users.add(name, "long enough")
    assert users.names == ["ada"]


def test_what_cannot_be_is_a_sentence(users: Users, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="8 to 256 characters"):
        users.add("eve", "short")
    with pytest.raises(InputError, match="no account"):
        users.remove("eve")
    users.path.write_text("ada\n")
    with pytest.raises(InputError, match="it is damaged"):
        _ = users.names
    with pytest.raises(InputError, match="cannot be read"):
        _ = Users(tmp_path / "none").names


@pytest.fixture
def sign_ins(users: Users, tmp_path: Path) -> SignIns:
    return SignIns(Database(tmp_path / "s.db"), users, 1.0)


def test_sign_ins_end(sign_ins: SignIns) -> None:
    token = sign_ins.begin("ada", "correct horse", "1.2.3.4")
    assert token and sign_ins.person(token) == "ada"
    assert sign_ins.person("x" * 43) is None and sign_ins.person("") is None
    with sign_ins.database.session() as session:
        assert token not in str([vars(row) for row in session.query(SignIn)])  # only its hash
    with sign_ins.database.session.begin() as session:
        session.execute(update(SignIn).values(until=time.time() - 1))
    assert sign_ins.person(token) is None
    token = sign_ins.begin("ada", "correct horse", "1.2.3.4")
    assert token
    sign_ins.end(token)
    assert sign_ins.person(token) is None


def test_a_removed_person_is_signed_out(sign_ins: SignIns) -> None:
    token = sign_ins.begin("ada", "correct horse", "1.2.3.4")
    sign_ins.users.remove("ada")
    assert token and sign_ins.person(token) is None


@pytest.fixture
def clock(sign_ins: SignIns) -> Clock:
    clock = Clock()
    sign_ins._throttle = Throttle(clock)
    return clock


def refused_for(sign_ins: SignIns, password: str, address: str, known: str = "") -> int:
    """The seconds that a sign-in as ada has to wait; 0 if the password is looked at."""
    try:
        sign_ins.begin("ada", password, address, known)
    except TooManyTries as error:
        return int(str(error).split()[-2])
    return 0


def test_guesses_from_an_address_are_slowed_down(sign_ins: SignIns, clock: Clock) -> None:
    for _ in range(accounts.TRIES):
        assert not refused_for(sign_ins, "wrong horse", "6.6.6.6")
    wait = refused_for(sign_ins, "correct horse", "6.6.6.6")
    assert 0 < wait <= 60
    assert sign_ins.begin("ada", "correct horse", "1.2.3.4"), "its owner is not locked out"
    clock.now += wait
    assert sign_ins.begin("ada", "correct horse", "6.6.6.6"), "after a while the next try is looked at"


def test_right_passwords_cost_no_tries(sign_ins: SignIns, clock: Clock) -> None:
    for _ in range(3 * accounts.TRIES):
        assert sign_ins.begin("ada", "correct horse", "1.2.3.4")


def test_a_name_is_slowed_down_for_all_addresses_together(sign_ins: SignIns, clock: Clock) -> None:
    known = sign_ins.known_browser("ada")
    guesses = [refused_for(sign_ins, "wrong horse", f"6.6.6.{i}") for i in range(accounts.NAME_TRIES + 20)]
    assert guesses.count(0) == accounts.NAME_TRIES
    assert 0 < refused_for(sign_ins, "correct horse", "1.2.3.4") <= 10
    assert sign_ins.begin("ada", "correct horse", "1.2.3.4", known), "where she has signed in before, she still can"
    clock.now += 10
    assert sign_ins.begin("ada", "correct horse", "1.2.3.4"), "elsewhere she waits for seconds"
    sign_ins.users.add("eve", "password of eve")
    assert sign_ins.begin("eve", "password of eve", "1.2.3.4"), "others are not slowed down"


def test_a_browser_is_known_for_its_own_name_and_password(sign_ins: SignIns, clock: Clock) -> None:
    known = sign_ins.known_browser("ada")
    sign_ins.users.add("eve", "password of eve")
    browser = known.partition(".")[0]
    assert sign_ins._browser("ada", known) == browser
    for name, forged in (
        ("eve", known),
        ("ada", f"{browser}."),
        ("ada", f".{known.partition('.')[2]}"),
        ("ada", known[:-1]),
        ("nobody", f"{browser}."),
        ("ada", "é.é"),
        ("ada", ""),
    ):
        assert not sign_ins._browser(name, forged), forged
    for _ in range(accounts.TRIES):
        assert not refused_for(sign_ins, "wrong horse", "1.2.3.4", known)
    assert refused_for(sign_ins, "wrong horse", "1.2.3.4", known), "it may not guess without end either"
    sign_ins.users.add("ada", "another password")
    assert not sign_ins._browser("ada", known)


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
        ({"host": "0.0.0.0", "users": "users"}, True),
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
    file = str(tmp_path / "users")
    assert main(["user", "add", "ada", "--users", file]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["added"] == "ada"
    assert Users(Path(file)).knows("ada", "correct horse")


def test_settings_from_a_shell(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("PASDEDEUX_METRICS_TOKEN", "s3cret")
    assert main(["serve", "--port", "8123", "--print-settings"]) == 0
    said = capsys.readouterr().out
    assert "port = 8123  # port to listen on" in said and "s3cret" not in said
    assert main(["serve", "--host", "0.0.0.0"]) == 2
    assert "there are no accounts" in capsys.readouterr().err


def test_nobody_inherits_from_an_earlier_account_of_the_same_name(
    users: Users, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither by the shell, which removes what was theirs, nor where a line was deleted by hand."""
    database = Database(tmp_path / "history.db")
    admin = Administration(database, users, Settings(data=tmp_path))
    first, owner = users.key("ada"), f"user {users.key('ada')}"
    admin.set_role("ada", admin=True)
    history = Notebook(database, tmp_path / "motions")
    run = history.begin(owner, GenerateRequest(prompt="They bow."), "They bow.")
    assert not users.add("ada", "another password") and users.key("ada") == first, "the same person"
    users.remove("ada")
    users.add("ada", "battery staple")
    assert users.key("ada") != first and not history.search(f"user {users.key('ada')}", Search()).total
    assert admin.people.of(admin.key("ada")).role == "" and history.search(owner, Search()).entries[0].id == run
    admin.set_role("ada", admin=True)
    mine = f"user {users.key('ada')}"
    history.begin(mine, GenerateRequest(prompt="They hug."), "They hug.")
    monkeypatch.setenv("PASDEDEUX_USERS", str(users.path))
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path))
    assert main(["admin", "delete", "ada"]) == 0
    assert not history.search(mine, Search()).total and not Users(users.path).names
    assert admin.people.of(mine.removeprefix("user ")).role == ""
    database.close()
