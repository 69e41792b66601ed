"""Signing in by OpenID Connect against a real process and a small provider that runs here."""

from __future__ import annotations

import base64
import hashlib
import json
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey

from tests.server.attacks.target import Target

KEY, OTHER_KEY = (RSAKey.generate_key(2048, parameters={"kid": "one"}) for _ in range(2))


class Provider(ThreadingHTTPServer):
    """Signs everybody in at once, as whom ``claims`` says; ``spoil`` changes the token before it is signed."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.issuer = f"http://127.0.0.1:{self.server_port}"
        self.claims: dict[str, Any] = {}
        self.spoil: dict[str, Any] = {}
        self.key = KEY
        self.asked: dict[str, str] = {}

    def token(self, fields: dict[str, str]) -> dict[str, Any] | None:
        """The answer to a code; None where PKCE's verifier does not fit."""
        digest = hashlib.sha256(fields["code_verifier"].encode()).digest()
        if base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != self.asked["code_challenge"]:
            return None
        now = int(time.time())
        claims = {"iss": self.issuer, "aud": "lab", "sub": "1", "iat": now, "exp": now + 60,
                  "nonce": self.asked["nonce"], **self.claims, **self.spoil}  # fmt: skip
        token = jwt.encode({"alg": "RS256", "kid": "one"}, claims, self.key)
        return {"access_token": "x", "token_type": "Bearer", "id_token": token}


class Handler(BaseHTTPRequestHandler):
    server: Provider

    def do_GET(self) -> None:
        issuer = self.server.issuer
        known = {"issuer": issuer, "authorization_endpoint": f"{issuer}/authorize",
                 "token_endpoint": f"{issuer}/token", "jwks_uri": f"{issuer}/keys"}  # fmt: skip
        self._send(known if "openid-configuration" in self.path else {"keys": [KEY.as_dict(private=False)]})

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["content-length"])).decode()
        self._send(self.server.token({name: values[0] for name, values in parse_qs(body).items()}))

    def _send(self, answer: dict[str, Any] | None) -> None:
        content = json.dumps(answer or {"error": "invalid_grant"}).encode()
        self.send_response(200 if answer else 400)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture(scope="module")
def provider() -> Iterator[Provider]:
    with Provider() as served:
        threading.Thread(target=served.serve_forever, daemon=True).start()
        yield served
        served.shutdown()


@pytest.fixture(scope="module")
def lab(provider: Provider, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    settings = {
        "openid_issuer": provider.issuer, "openid_client": "lab", "openid_secret": "s" * 40,
        "openid_name": "preferred_username", "groups": '["dancers"]',
        "admin_groups": '["staff"]',
    }  # fmt: skip
    with Target(tmp_path_factory.mktemp("openid"), accounts=True, **settings) as target:
        yield target


def begun(lab: Target, provider: Provider, wanted: str = "/") -> tuple[httpx.Client, dict[str, str]]:
    """A browser that was sent to the provider, and what the provider was asked."""
    browser = httpx.Client(base_url=lab.url, timeout=30)
    sent = browser.get("/login/openid", params={"next": wanted})
    assert sent.status_code == 303, sent.text
    asked = {k: v[0] for k, v in parse_qs(urlsplit(sent.headers["location"]).query).items()}
    provider.asked = asked
    return browser, asked


def back(browser: httpx.Client, state: str) -> httpx.Response:
    return browser.get("/login/openid/back", params={"state": state, "code": "c"})


def test_somebody_signs_in_and_comes_to_what_they_wanted(lab: Target, provider: Provider) -> None:
    provider.claims, provider.spoil = {"preferred_username": "Grace", "groups": ["dancers"]}, {}
    assert "/login/openid?next=%2F%3Frun%3Dx" in lab.ask("stranger", "GET", "/login?next=/?run=x").text
    browser, asked = begun(lab, provider, "/?run=x")
    assert (asked["response_type"], asked["code_challenge_method"]) == ("code", "S256")
    assert asked["redirect_uri"] == f"{lab.url}/login/openid/back"
    answer = back(browser, asked["state"])
    assert (answer.status_code, answer.headers.get("location")) == (303, "/?run=x"), answer.text
    assert browser.get("/config").status_code == 200
    assert "Signed in as grace" in browser.get("/account").text
    assert browser.post("/account/sign-out").status_code == 303
    assert browser.get("/config").status_code == 401


@pytest.mark.parametrize(
    ("spoil", "key"),
    [({"nonce": "another"}, KEY), ({"aud": "another"}, KEY), ({"iss": "https://evil.example"}, KEY),
     ({"exp": 1}, KEY), ({}, OTHER_KEY)],
)  # fmt: skip
def test_a_token_that_is_not_good_signs_nobody_in(
    lab: Target, provider: Provider, spoil: dict[str, Any], key: RSAKey
) -> None:
    provider.claims = {"preferred_username": "grace", "groups": ["dancers"]}
    provider.spoil, provider.key = spoil, key
    browser, asked = begun(lab, provider)
    answer = back(browser, asked["state"])
    provider.spoil, provider.key = {}, KEY
    assert answer.status_code == 403 and "pasdedeux_session" not in str(answer.headers)


@pytest.mark.parametrize(
    ("claims", "says"),
    [({"preferred_username": "grace", "groups": ["others"]}, "none of the groups"),
     ({"preferred_username": "grace"}, "none of the groups"),
     ({"groups": ["dancers"]}, "no name"), ({"preferred_username": "../x", "groups": ["dancers"]}, "no name"),
     ({"preferred_username": "ada", "groups": ["dancers"]}, "has your name and a password")],
)  # fmt: skip
def test_a_person_who_may_not_use_the_lab_is_told_why(
    lab: Target, provider: Provider, claims: dict[str, Any], says: str
) -> None:
    provider.claims = claims
    browser, asked = begun(lab, provider)
    answer = back(browser, asked["state"])
    assert answer.status_code == 403 and says in answer.json()["detail"]
    assert browser.get("/config").status_code == 401


def test_a_sign_in_ends_in_the_browser_that_began_it(lab: Target, provider: Provider) -> None:
    provider.claims = {"preferred_username": "grace", "groups": ["dancers"]}
    browser, asked = begun(lab, provider, "https://evil.example/")
    assert back(browser, "another").status_code == 403
    with httpx.Client(base_url=lab.url) as another:
        assert back(another, asked["state"]).status_code == 403
        another.cookies.set("pasdedeux_openid", "x" * 5000)
        assert back(another, asked["state"]).status_code == 403
    provider.asked = asked | {"code_challenge": "of another"}
    assert back(browser, asked["state"]).status_code == 403
    provider.asked = asked
    assert back(browser, asked["state"]).headers["location"] == "/"


def signed_in(lab: Target, provider: Provider, name: str, *groups: str) -> httpx.Client:
    provider.claims = {"preferred_username": name, "groups": ["dancers", *groups]}
    browser, asked = begun(lab, provider)
    browser.headers["origin"] = lab.url
    answer = back(browser, asked["state"])
    assert answer.status_code == 303, answer.text
    return browser


def test_groups_make_administrators_who_see_and_suspend_whoever_signed_in(
    lab: Target, provider: Provider
) -> None:
    mary, lead = signed_in(lab, provider, "mary"), signed_in(lab, provider, "lead", "staff")
    assert mary.get("/admin").status_code == 403
    shown = lead.get("/admin")
    assert shown.status_code == 200 and "<strong>mary</strong>" in shown.text
    assert "<strong>lead</strong> admin" in shown.text and "<strong>ada</strong>" in shown.text
    form = {"act": "room", "name": "mary", "megabytes": "5"}
    assert lead.post("/admin", data=form).status_code == 303
    assert 'value="5"' in lead.get("/admin").text
    assert lead.post("/admin", data={"act": "suspend", "name": "mary"}).status_code == 303
    browser, asked = begun(lab, provider)
    provider.claims = {"preferred_username": "mary", "groups": ["dancers"]}
    answer = back(browser, asked["state"])
    assert answer.status_code == 403 and "suspended" in answer.json()["detail"]
    assert lead.post("/admin", data={"act": "let-in", "name": "mary"}).status_code == 303
    assert signed_in(lab, provider, "mary").get("/config").status_code == 200
    assert lead.post("/admin", data={"act": "delete", "name": "mary", "confirm": "mary"}).status_code == 303
    assert "<strong>mary</strong>" not in lead.get("/admin").text
    assert signed_in(lab, provider, "lead").get("/admin").status_code == 403  # left the group
