"""The voting page over HTTP: who is let in, what is sent, and what is refused with a sentence."""

from __future__ import annotations

import json
from typing import Any

import pytest
from fastapi.testclient import TestClient

from tests.server.clients import HERE, HTML, lab_of, sign_in
from tests.server.lab import stub_module
from webdemo.server.store import voting
from webdemo.study import Stimulus
from webdemo.ui.studies import NewStudy, StudyEntry

walking = stub_module().walking
ORIGIN = {"origin": HERE}
SECRETS = ("InterGen", "BiGraphDiff", "guidance", "manifest", "ada", "Which runs")


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(voting, "SOONEST", 0.0)


def study(client: TestClient, owner: str, **fields: Any) -> StudyEntry:
    sets = {
        name: [Stimulus("They walk.", walking(seconds))]
        for name, seconds in (("InterGen", 0.5), ("BiGraphDiff guidance 3", 1.0))
    }
    asked: dict[str, Any] = {
        "question": "Which <b>is</b> @script@ longer?",
        "title": "Which runs",
        "sets": sets,
    }
    return lab_of(client).studies.create(owner, NewStudy(**(asked | {"checks": 0} | fields)))


def browser(client: TestClient, key: str) -> dict[str, str]:
    """The headers of a browser that has opened a study's page, which gave it a cookie."""
    client.cookies.clear()
    answer = client.get(f"/study/{key}", headers=HTML)
    assert answer.status_code == 200
    client.cookies.clear()
    return ORIGIN | {"cookie": answer.headers["set-cookie"].split(";")[0]}


def test_a_person_with_the_link_votes_once_and_sees_no_names(local: TestClient, quick: None) -> None:
    made = study(local, "local")
    page = local.get(f"/study/{made.key}", headers=HTML)
    assert "Which &lt;b&gt;is&lt;/b&gt; @script@ longer?" in page.text and "default-src 'none'" in str(
        page.headers
    )
    me = browser(local, made.key)
    first = local.post(f"/study/{made.key}/next", headers=me)
    handed = first.json()
    assert (handed["total"], handed["done"], handed["pair"]["title"]) == (1, 0, "They walk.")
    assert [cell["caption"] for cell in handed["pair"]["samples"][0]["cells"]] == ["1", "2"]
    handed["pair"]["samples"] = [{**s, "positions": 0, "cells": 0} for s in handed["pair"]["samples"]]
    for secret in SECRETS:
        assert secret not in json.dumps(handed) and secret not in page.text
    vote = {"ticket": handed["ticket"], "answer": "1"}
    done = local.post(f"/study/{made.key}/vote", headers=me, json=vote)
    assert done.json() == {
        "question": "Which <b>is</b> @script@ longer?", "total": 1, "done": 1, "result": None,
    }  # fmt: skip
    again = local.post(f"/study/{made.key}/vote", headers=me, json=vote)
    assert again.status_code == 422 and "voted on this pair already" in again.json()["detail"]
    assert lab_of(local).studies.mine("local")[0].votes == 1


def test_programs_strangers_and_nonsense_get_a_sentence(local: TestClient) -> None:
    made = study(local, "local")
    me = browser(local, made.key)
    handed = local.post(f"/study/{made.key}/next", headers=me).json()
    good = {"ticket": handed["ticket"], "answer": "1"}
    other = browser(local, made.key)
    cases: list[tuple[dict[str, str], Any, int, str]] = [
        (me, good, 422, "before the pair can have been seen"),
        ({"cookie": me["cookie"]}, good, 403, "on the study's own page"),
        (ORIGIN, good, 403, "Allow this page to keep a cookie"),
        ({"origin": "http://elsewhere"} | {"cookie": me["cookie"]}, good, 403, "Another site's page"),
        (other, good, 422, "was not sent to you"),
        (me, {**good, "answer": 1}, 400, "cannot be read"),
        (me, {"ticket": "x" * 2000, "answer": "1"}, 400, "cannot be read"),
        (me, [good], 400, "cannot be read"),
    ]
    for headers, body, status, says in cases:
        answer = local.post(f"/study/{made.key}/vote", headers=headers, json=body)
        assert (answer.status_code, says in answer.json()["detail"]) == (status, True), (says, answer.text)
    missing = local.get("/study/nothing", headers=HTML)
    assert missing.status_code == 404 and "There is no such study" in missing.text
    assert local.post("/study/nothing/next", headers=me).status_code == 422
    assert lab_of(local).studies.mine("local")[0].votes == 0


def test_with_accounts_a_person_is_an_account(shared: TestClient, quick: None) -> None:
    made = study(shared, "user ada", shows_result=True)
    shared.cookies.clear()
    asked = shared.get(f"/study/{made.key}", headers=HTML)
    assert asked.status_code == 303 and asked.headers["location"] == f"/login?next=%2Fstudy%2F{made.key}"
    assert "to vote in the study" in shared.get(asked.headers["location"], headers=HTML).text
    assert shared.post(f"/study/{made.key}/next", headers=ORIGIN).status_code == 401
    eve = sign_in(shared, "eve") | ORIGIN
    handed = shared.post(f"/study/{made.key}/next", headers=eve).json()
    vote = {"ticket": handed["ticket"], "answer": "skip"}
    done = shared.post(f"/study/{made.key}/vote", headers=eve, json=vote).json()
    assert done["result"]["comparisons"][0]["skips"] == 1 and done["result"]["votes"] == 0
    elsewhere = sign_in(shared, "eve") | ORIGIN  # another browser is no other person
    assert "pair" not in shared.post(f"/study/{made.key}/next", headers=elsewhere).json()
