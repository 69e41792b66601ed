"""Every route of the application: each has an attack, none is open to strangers unsaid, none hands out another's."""

from __future__ import annotations

import re
from collections.abc import Callable

from starlette.routing import compile_path

from .backend import Backend
from .known import KNOWN
from .target import SECRETS, Target
from .victim import Victim

OPEN = {
    "GET /healthz",
    "GET /metrics",
    "GET /login",
    "POST /login",
    "POST /login/",
    "GET /logout",
    "POST /logout",
    "GET /share/{key}",
    "GET /embed/{key}",
    "GET /shown/{name:path}",
}
"""Routes that need no sign-in: /metrics has its own rule, and a public page's key is a secret."""
THINGS = {
    "key": ("{study_key}", "{stream}", "{run}", "x"),
    "path": ("{upload}", "../canary.txt", "x"),
    "size": ("7", "x"),
    "session_hash": ("{session}", "x"),
    "event_id": ("{call}", "{session}", "x"),
    "api_name": ("generate", "x"),
    "path_or_url": ("{upload}", "{canary}", "{here}/healthz"),
    "url_path": ("{here}/healthz",),
    "run": ("{run}",),
    "component_id": ("1",),
    "segment_id": ("x",),
    "ext": ("ts",),
    "id": ("1",),
    "name": ("{upload}", "{canary}", "share/page.html"),
    "environment": ("client",),
    "type": ("component",),
    "number": ("0",),
    "pressed": ("1",),
    "file_name": ("index.js",),
}
"""What stands for each parameter of a path."""


def test_every_route_has_an_attack(backend: Backend) -> None:
    """One that is new has none: add it to known.py."""
    without = [
        route
        for route in sorted(backend.routes)
        for method, path in [route.split(" ", 1)]
        if not any(
            method == attack.method and compile_path(path)[0].match(re.split(r"\?", attack.path)[0]) for attack in KNOWN
        )
    ]
    assert not without


def test_strangers_sign_in_first(backend: Backend, closed: Target) -> None:
    assert len(backend.routes) > 70 and backend.routes >= OPEN
    for route in sorted(backend.routes - OPEN):
        method, path = route.split(" ", 1)
        answer = closed.ask("stranger", method, re.sub(r"{\w+(:path)?}", "x", path))
        assert answer.status_code in (401, 404), (route, answer.text)
        assert answer.status_code == 401 or method == "HEAD" or "nothing here" in answer.text, route  # closed to all


def test_none_hands_out_what_is_another_s(
    backend: Backend, target: Target, victims: Callable[[Target], Victim]
) -> None:
    ada = victims(target)
    target.sign_in_anew("eve")
    for route in sorted(backend.routes):
        method, path = route.split(" ", 1)
        if path in ("/logout", "/login", "/login/") or "queue/data" in path or "heartbeat" in path:
            continue  # streams that last; with ada's session they are among the known attacks
        for turn in range(max((len(THINGS[name]) for name in _names(path)), default=1)):
            filled = path
            for name in _names(path):
                filled = re.sub(rf"{{{name}(:path)?}}", THINGS[name][turn % len(THINGS[name])], filled)
            stream = ada.live() if filled == "/live/{stream}" else ""
            answer = target.ask("eve", method, ada.fill(filled), headers={"origin": target.url})
            said = answer.text
            assert answer.status_code < 500, (route, filled, said)
            assert "HIERARCHY" not in said and "SECRET" not in said, (route, filled, said)
            assert not [secret for secret in SECRETS if secret in said.lower()], (route, filled)
            if stream:
                assert answer.status_code == 404, (route, said)
                assert target.ask("ada", "POST", f"/live/{stream}", content=b"{}").status_code == 200
    ada.check(backend.number)


def _names(path: str) -> list[str]:
    return re.findall(r"{(\w+)(?::path)?}", path)
