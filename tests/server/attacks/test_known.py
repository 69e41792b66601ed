"""Every known attack, against a real process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from .known import API, KNOWN, Attack
from .target import CANARY, FIELDS, Target

SECRETS = (CANARY, "root:", "sqlite format 3", "traceback (most recent")
CASES = [
    pytest.param(attack, fixture, id=f"{place}: {attack.name}")
    for fixture, place in (("closed", "closed"), ("anyone", "open"))
    for attack in KNOWN
    if attack.at in (place, "both")
]


@pytest.fixture(scope="package")
def things() -> dict[str, dict[str, str]]:
    """Ada's things at every server, by its address."""
    return {}


def victims_things(target: Target) -> dict[str, str]:
    """What ada has there: made anew for every server, once."""
    upload = target.upload("ada", "hers.bvh", b"HIERARCHY of ada's")
    finished = target.call("ada", "generate", ["SECRET", *FIELDS[1:]])
    (download,) = [word for word in finished.split('"') if word.endswith(".npz") and word[0] == "/"][:1]
    open_call = {"data": ["SECRET", *FIELDS[1:]]}
    made = target.ask("ada", "POST", f"{API}/call/generate", json=open_call).json()["event_id"]
    join = {**open_call, "fn_index": 1, "session_hash": "adas own"}
    target.ask("ada", "POST", f"{API}/queue/join", json=join).raise_for_status()
    (run,) = {entry.name for entry in list((target.data / "motions").iterdir())[:1]}
    return {
        "upload": upload, "download": download, "call": made, "session": "adas own", "run": run,
        "folder_of_ada": str(Path(upload).parents[1]), "canary": str(target.canary),
        "folder": str(target.folder), "data": str(target.data),
    }  # fmt: skip


def filled(value: Any, things: dict[str, str]) -> Any:
    """A value with the victim's things in place of their names."""
    if isinstance(value, str):
        for name, thing in things.items():
            value = value.replace(f"{{{name}}}", thing)
        return value
    if isinstance(value, dict):
        return {key: filled(item, things) for key, item in value.items()}
    return [filled(item, things) for item in value] if isinstance(value, list) else value


@pytest.mark.parametrize(("attack", "at"), CASES)
def test_it_fails(
    attack: Attack, at: str, things: dict[str, dict[str, str]], request: pytest.FixtureRequest
) -> None:
    target: Target = request.getfixturevalue(at)
    if target.url not in things:
        things[target.url] = victims_things(target)
    hers = things[target.url]
    content = attack.content
    if attack.body is not None:
        content = json.dumps(filled(attack.body, hers)).encode()
    kind = {"content-type": "application/json"} if attack.body is not None else {}
    answer = target.ask(
        attack.who, attack.method, filled(attack.path, hers), content=content,
        headers={**kind, **attack.headers},
    )  # fmt: skip
    assert answer.status_code in attack.expected, answer.text[:500]
    said = answer.text.lower()
    assert not [secret for secret in (*SECRETS, *attack.never) if secret.lower() in said]
    assert attack.holds in answer.text
    assert "access-control-allow-origin" not in answer.headers


def test_what_ada_has_is_still_hers(target: Target, things: dict[str, dict[str, str]]) -> None:
    """The attacks above asked for things that are there."""
    hers = things.get(target.url) or victims_things(target)
    assert target.ask("ada", "GET", f"{API}/file={hers['upload']}").text == "HIERARCHY of ada's"
    assert target.ask("ada", "GET", f"{API}/file={hers['download']}").content[:2] == b"PK"
    assert "SECRET" in target.ask("ada", "GET", f"{API}/call/generate/{hers['call']}").text
    assert "SECRET" in target.ask("ada", "GET", f"{API}/queue/data?session_hash={hers['session']}").text
    assert target.healthy() and not target.copies(CANARY)


def test_the_log_holds_no_secret(target: Target) -> None:
    log = target.log()
    assert '"message": "request"' in log
    for secret in ("SECRET", "password of", "pasdedeux_", CANARY, "Traceback"):
        assert secret not in log
