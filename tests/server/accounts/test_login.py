"""Signing in, and what is whose."""

from __future__ import annotations

import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from motion import InputError
from tests.server.clients import (
    CALL,
    FIELDS,
    HTML,
    events_of,
    find_fn,
    lab_of,
    no_room,
    served_on_loopback,
    sign_in,
    wait_for,
)
from tests.server.lab import add_accounts
from webdemo.server.accounts import accounts
from webdemo.server.store.database import Share, SignIn
from webdemo.ui.history import Entry, Search


def test_a_stranger_is_asked_to_sign_in(shared: TestClient) -> None:
    shared.cookies.clear()
    asked = shared.get("/?run=abc", headers={"accept": "text/html"})
    assert asked.status_code == 303 and asked.headers["location"] == "/login?next=%2F%3Frun%3Dabc"
    assert shared.get("/healthz").status_code in (200, 503)
    assert "Sign in" in shared.get("/login").text


def test_signing_in_from_the_page(shared: TestClient) -> None:
    html = {"accept": "text/html"}
    wrong = shared.post("/login", data={"username": "ada", "password": "no"}, headers=html)
    assert wrong.status_code == 401 and "password is wrong" in wrong.text
    for wanted, place in (
        ("/?run=x", "/?run=x"),
        ("https://evil.example/", "/"),
        ("//evil.example", "/"),
        ("/\\evil.example", "/"),
        ("/x\r\nSet-Cookie: a=b", "/"),
    ):
        fields = {"username": "ada", "password": "password of ada", "next": wanted}
        answer = shared.post("/login", data=fields, headers=html)
        assert (answer.status_code, answer.headers["location"]) == (303, place)
    quoted = shared.get("/login", params={"next": '/"><script>alert(1)</script>'}).text
    assert "<script>alert" not in quoted


def test_sessions_end(shared: TestClient) -> None:
    ada = sign_in(shared, "ada")
    assert shared.get("/config", headers=ada).status_code == 200
    shared.post("/logout", headers=ada)
    assert shared.get("/config", headers=ada).status_code == 401
    late = sign_in(shared, "ada")
    with lab_of(shared).database.session.begin() as session:
        session.execute(update(SignIn).values(until=time.time() - 1))
    assert shared.get("/config", headers=late).status_code == 401


def test_a_full_disk_at_sign_in_is_a_sentence(shared: TestClient) -> None:
    """Sessions that exist go on; the next person can sign in when there is room again."""
    before = sign_in(shared, "ada")
    fields = {"username": "eve", "password": "password of eve"}
    with no_room(lab_of(shared).database):
        answers = [shared.post("/login", data=fields, headers=HTML) for _ in range(60)]
        full = [answer for answer in answers if answer.status_code != 303]
        assert full and {answer.status_code for answer in full} == {507}
        assert "disk" in full[0].text and "Traceback" not in full[0].text and "sqlite" not in full[0].text.lower()
        assert shared.get("/config", headers=before).status_code == 200
    shared.cookies.clear()
    assert shared.get("/config", headers=sign_in(shared, "eve")).status_code == 200


def test_a_browser_is_remembered_that_somebody_signed_in_with(shared: TestClient) -> None:
    """So that guesses of others do not slow its owner down there."""
    given = {"username": "Ada ", "password": "password of ada"}
    signed_in = shared.post("/login", data=given)
    known = signed_in.cookies["pasdedeux_known"]
    shared.cookies.clear()
    accounts = lab_of(shared).accounts
    assert accounts._browser("ada", known)
    attributes = next(c for c in signed_in.headers.get_list("set-cookie") if c.startswith("pasdedeux_known="))
    assert "HttpOnly" in attributes
    for _ in range(60):
        accounts._throttle._names.take("ada")
    assert shared.post("/login", data=given).status_code == 429
    assert shared.post("/login", data=given, headers={"cookie": f"pasdedeux_known={known}"}).json() == {"success": True}
    accounts._throttle._names.take("ada", -60)
    shared.cookies.clear()


def test_a_refused_try_waits_for_no_place(shared: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """And one address takes no more places than its share, so that others' passwords are checked soon."""
    people, checked = lab_of(shared).accounts, threading.Event()
    monkeypatch.setattr(people, "_throttle", accounts.Throttle())
    monkeypatch.setattr(accounts, "_fits", lambda *_: checked.wait(60))
    most = int(lab_of(shared).quotas.sign_ins.person)

    def status(name: str) -> int:
        return shared.post("/login", data={"username": name, "password": "?"}).status_code

    with ThreadPoolExecutor(most) as pool:
        waiting = [pool.submit(status, f"stranger {i}") for i in range(most - 1)]
        wait_for(lambda: len(people._throttle._names._left) >= most - 1)
        for _ in range(accounts.TRIES):
            people.admit("eve", "127.0.0.1")
        assert pool.submit(status, "eve").result(timeout=20) == 429
        waiting.append(pool.submit(status, "one more"))
        wait_for(lambda: "one more" in people._throttle._names._left)
        assert status("one too many") == 429 and "one too many" not in people._throttle._names._left
        checked.set()
        assert {answer.result() for answer in waiting} == {401}


def newest(client: TestClient, owner: str) -> Entry:
    return lab_of(client).history.search(owner, Search()).entries[0]


def test_a_run_of_another_is_not_opened_by_its_id(shared: TestClient) -> None:
    ada = sign_in(shared, "ada")
    assert "event: complete" in events_of(shared, "generate", FIELDS, ada)
    history, entry = lab_of(shared).history, newest(shared, "user ada")
    for key, owner in ((entry.id, "user eve"), (entry.id, ""), (entry.id[:-1], "user ada")):
        with pytest.raises(InputError, match="There is no such run"):
            history.open(key, owner)
    # Its event is hers as well: nobody else may read what it ends with.
    event = shared.post(f"{CALL}/generate", json={"data": FIELDS}, headers=ada).json()["event_id"]
    assert shared.get(f"{CALL}/generate/{event}").status_code == 401
    assert shared.get("/config", headers={"cookie": "pasdedeux_session=user ada"}).status_code == 401
    assert "event: complete" in shared.get(f"{CALL}/generate/{event}", headers=ada).text  # else it ends in a later test


def page_at(client: TestClient, key: str, headers: dict[str, str]) -> str:
    """What the page does first at ``/?run=KEY``: all that it is given then."""
    session = f"page{time.monotonic_ns()}"
    fn = find_fn(client, headers, "open_address")
    body = {"data": [key], "fn_index": fn, "session_hash": session}
    assert client.post("/gradio_api/queue/join", json=body, headers=headers).status_code == 200
    lines = client.get(f"/gradio_api/queue/data?session_hash={session}", headers=headers).text.splitlines()
    events = [json.loads(line.removeprefix("data: ")) for line in lines if line.startswith("data: ")]
    (done,) = [event for event in events if event["msg"] == "process_completed"]
    assert done["success"]
    return json.dumps(done["output"]["data"])


def test_an_address_opens_no_run_of_another(shared: TestClient) -> None:
    """To a stranger a run, one that never was and a link that ended or was revoked are the same."""
    ada, eve = sign_in(shared, "ada"), sign_in(shared, "eve")
    assert "event: complete" in events_of(shared, "generate", ["SECRET", *FIELDS[1:]], ada)
    history, entry = lab_of(shared).history, newest(shared, "user ada")
    assert "SECRET" in page_at(shared, entry.id, ada)
    key, _ = history.link(entry.id, "user ada")
    assert "SECRET" in page_at(shared, key, eve)
    history.revoke(entry.id, "user ada")
    late, _ = history.link(entry.id, "user ada")
    with history.database.session.begin() as session:
        session.execute(update(Share).where(Share.key == late).values(until=time.time() - 1))
    keys = [entry.id, "n" * len(entry.id), key, late, "../" + entry.id, entry.id + "' OR '1'='1"]
    answers = {page_at(shared, each, eve) for each in keys}
    assert len(answers) == 1
    (answer,) = answers
    assert "There is no such run, or its link has expired" in answer and "SECRET" not in answer
    shared.post("/logout", headers=eve)
    signed_out = shared.get(f"/?run={entry.id}", headers={**eve, **HTML})
    assert signed_out.status_code == 303 and "SECRET" not in signed_out.text


def test_behind_a_proxy_that_speaks_tls(tmp_path: Path) -> None:
    """Cookies are then for TLS alone, and a link has the page's own address."""
    add_accounts(tmp_path / "data", "ada")
    given = {"accounts": True, "hosts": ["lab.example", "127.0.0.1"], "proxies": ["127.0.0.2"]}
    with served_on_loopback(tmp_path, root_path="/motion", **given) as (host, port):
        for address, secure in (("127.0.0.2", True), ("127.0.0.3", False)):
            transport = httpx.HTTPTransport(local_address=address)
            with httpx.Client(base_url=f"http://{host}:{port}", transport=transport) as proxy:
                answer = proxy.post(
                    "/login",
                    data={"username": "ada", "password": "password of ada"},
                    headers={
                        "host": "lab.example",
                        "x-forwarded-proto": "https",
                        "x-forwarded-for": "203.0.113.9",
                        "origin": "https://lab.example",
                    },
                )
                assert answer.json() == {"success": True}
                assert ("; Secure" in answer.headers["set-cookie"]) == secure
                signed = {
                    "cookie": answer.headers["set-cookie"].split(";")[0],
                    "host": "lab.example",
                    "x-forwarded-proto": "https",
                }
                root = proxy.get("/config", headers=signed).json()["root"]
                assert root == f"http{'s' if secure else ''}://lab.example/motion"
