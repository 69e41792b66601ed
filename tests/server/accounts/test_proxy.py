"""Signing in by a proxy's header against a real process: the trusted proxy's word counts, and nobody else's."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from webdemo.server.accounts.administration import Administration
from webdemo.server.accounts.visitors import PEER, person_by_proxy, trusted_hosts
from webdemo.server.http.routes import Refused
from webdemo.server.settings import Settings
from webdemo.server.store.database import Database

NAME = "X-Remote-User"
ELSEWHERE = "127.0.0.9"
"""An address of this machine that is no proxy's."""


class Proxied(Target):
    """A lab whose proxy is 127.0.0.1, without accounts of its own."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, accounts=False, host="0.0.0.0", proxies='["127.0.0.1"]', proxy_user=NAME)
        del self.env["PASDEDEUX_OPEN"]


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    with Proxied(tmp_path_factory.mktemp("proxied")) as target:
        yield target


def asked(lab: Target, path: str = "/config", *, source: str = "127.0.0.1", **headers: str) -> httpx.Response:
    given = {name.replace("_", "-"): value for name, value in headers.items()}
    with httpx.Client(transport=httpx.HTTPTransport(local_address=source)) as client:
        return client.get(f"{lab.url}{path}", headers=given, timeout=30)


def test_the_proxy_says_who_somebody_is(lab: Target) -> None:
    answer = asked(lab, X_Remote_User="Ada@Lab.example", X_Forwarded_For="203.0.113.9")
    assert answer.status_code == 200, answer.text
    assert asked(lab).status_code == 401
    assert "through its proxy" in asked(lab).json()["detail"]
    assert asked(lab, "/healthz").status_code == 200


def test_nobody_else_can_say_it(lab: Target) -> None:
    """Neither from another address, nor by the address that a header claims."""
    forged = {"X_Remote_User": "ada"}
    for more in ({}, {"X_Forwarded_For": "127.0.0.1"}):
        answer = asked(lab, source=ELSEWHERE, **forged, **more)
        assert answer.status_code == 403 and "through its proxy" in answer.json()["detail"]
    assert asked(lab, source=ELSEWHERE, X_Forwarded_For="127.0.0.1").status_code == 401


def test_two_names_and_a_strange_one_are_refused(lab: Target) -> None:
    for name in ("../ada", "ada eve", "é", "a" * 81):
        answer = asked(lab, X_Remote_User=name) if name.isascii() else None
        assert answer is None or answer.status_code == 403
    with socket.create_connection(("127.0.0.1", lab.port)) as one:
        one.sendall(
            f"GET /config HTTP/1.1\r\nHost: 127.0.0.1\r\n{NAME}: ada\r\n{NAME}: eve\r\n"
            "Connection: close\r\n\r\n".encode()
        )
        assert b" 403 " in one.recv(4096).split(b"\r\n")[0]


def test_each_has_a_history_of_their_own(lab: Target) -> None:
    given = {"X-Remote-User": "ada", "origin": lab.url}
    body = {"data": ["They bow.", 1, 0, 1, 3, 1, 0, "ddim", "intergen", 1]}
    with httpx.Client(base_url=lab.url, timeout=60) as client:
        event = client.post("/gradio_api/call/generate", json=body, headers=given).json()["event_id"]
        eve = client.get(f"/gradio_api/call/generate/{event}", headers=given | {"X-Remote-User": "eve"})
        assert eve.status_code == 403 and "They bow" not in eve.text
        assert "complete" in client.get(f"/gradio_api/call/generate/{event}", headers=given).text


def test_administrators_see_and_suspend_whoever_came(lab: Target) -> None:
    assert asked(lab, X_Remote_User="mary").status_code == 200
    assert asked(lab, "/admin", X_Remote_User="mary").status_code == 403
    lead = {"X-Remote-User": "lead", "origin": lab.url}
    with httpx.Client(base_url=lab.url, headers=lead, timeout=30) as client:
        assert client.get("/admin").status_code == 403
        Administration(Database(lab.data / "history.db"), lab.data).set_role("lead", admin=True)
        assert "<strong>mary</strong>" in client.get("/admin").text
        assert client.post("/admin", data={"act": "suspend", "name": "mary"}).status_code == 303
        refused = asked(lab, X_Remote_User="mary")
        assert refused.status_code == 403 and "suspended" in refused.json()["detail"]
        assert client.get("/admin").status_code == 200


def test_addresses_and_networks_are_read() -> None:
    assert "10.1.2.3" in trusted_hosts(("10.0.0.0/8",)) and "::1" in trusted_hosts(("::1",))
    assert "10.1.2.3" not in trusted_hosts(("proxy.example", "*", "192.168.0.0/16"))
    assert "" not in trusted_hosts(("0.0.0.0/0",))


def test_without_a_noted_peer_no_header_counts(tmp_path: Path) -> None:
    settings = Settings(data=tmp_path, proxy_user=NAME)
    scope: dict[str, Any] = {"type": "http", "headers": [(b"x-remote-user", b"ada")], "client": ("127.0.0.1", 1)}
    with pytest.raises(Refused, match="through its proxy"):
        person_by_proxy(settings, scope)
    assert person_by_proxy(settings, scope | {"state": {PEER: "127.0.0.1"}}) == "ada"
    assert person_by_proxy(Settings(data=tmp_path), scope | {"state": {PEER: "127.0.0.1"}}) == ""


def test_settings_that_would_let_anybody_be_anybody_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be \\*"):
        Settings(data=tmp_path, proxy_user=NAME, proxies=["*"]).check()
