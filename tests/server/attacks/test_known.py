"""Every known attack, against a real process."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from .backend import Backend
from .known import API, KNOWN, Attack
from .target import CANARY, SECRETS, Target
from .victim import SECRET, Victim

Victims = Callable[[Target], Victim]
CASES = [
    pytest.param(attack, fixture, id=f"{place}: {attack.name}")
    for fixture, place in (("closed", "closed"), ("anyone", "open"))
    for attack in KNOWN
    if attack.at in (place, "both")
]


@pytest.mark.parametrize(("attack", "at"), CASES)
def test_it_fails(attack: Attack, at: str, victims: Victims, request: pytest.FixtureRequest) -> None:
    target: Target = request.getfixturevalue(at)
    fill, content = victims(target).fill, attack.content
    kind = {}
    if attack.body is not None:
        content, kind = json.dumps(fill(attack.body)).encode(), {"content-type": "application/json"}
    answer = target.ask(
        attack.who, attack.method, fill(attack.path), content=content, headers={**kind, **fill(attack.headers)}
    )
    assert answer.status_code in attack.expected, answer.text[:500]
    said = answer.text.lower()
    assert not [secret for secret in (*SECRETS, *attack.never) if secret.lower() in said]
    assert attack.holds in answer.text
    assert "access-control-allow-origin" not in answer.headers or attack.path.startswith("/shown/")


def test_what_ada_has_is_still_hers(target: Target, victims: Victims, backend: Backend) -> None:
    """The attacks above asked for things that are there."""
    ada = victims(target)
    ada.check(backend.number)
    for path in ("call/generate/{call}", "queue/data?session_hash={session}"):  # each is sent once
        assert SECRET in target.ask("ada", "GET", ada.fill(f"{API}/{path}")).text
    assert target.healthy() and not target.copies(CANARY)


def test_the_log_holds_no_secret(target: Target) -> None:
    log = target.log()
    assert '"message": "request"' in log
    for secret in ("SECRET", "password of", "pasdedeux_", CANARY, "Traceback"):
        assert secret not in log
