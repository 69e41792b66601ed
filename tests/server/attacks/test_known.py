"""Every known attack, against a real process."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

import pytest

from .backend import Backend
from .known import API, KNOWN, Attack
from .target import CANARY, Target
from .victim import SECRET, Victim

Victims = Callable[[Target], Victim]
SECRETS = (CANARY, "root:", "sqlite format 3", "traceback (most recent")
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
        attack.who,
        attack.method,
        fill(attack.path),
        content=content,
        headers={**kind, **fill(attack.headers)},
    )
    assert answer.status_code in attack.expected, answer.text[:500]
    said = answer.text.lower()
    assert not [secret for secret in (*SECRETS, *attack.never) if secret.lower() in said]
    assert attack.holds in answer.text
    assert "access-control-allow-origin" not in answer.headers or attack.path.startswith("/shown/")


def test_a_study_s_ticket_is_its_voter_s(target: Target, victims: Victims) -> None:
    """Ada's ticket, which she was sent, is worth nothing to eve; ada then votes with it."""
    page = f"/study/{victims(target).things['study_key']}"
    here = {"origin": target.url}
    pair = target.ask("ada", "POST", f"{page}/next", headers=here).json()
    vote = {"ticket": pair["ticket"], "answer": "1"}
    stolen = target.ask("eve", "POST", f"{page}/vote", json=vote, headers=here)
    assert (stolen.status_code, "was not sent to you" in stolen.json()["detail"]) == (422, True)
    time.sleep(pair["wait"] + 0.1)
    assert target.ask("ada", "POST", f"{page}/vote", json=vote, headers=here).json()["done"] == 1


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
