"""The voting page over HTTP: who is let in, what is sent, and what is refused with a sentence."""

from __future__ import annotations

import json

from fastapi.testclient import TestClient

from tests.server.clients import HERE, HTML, lab_of, sign_in
from tests.server.lab import stub_module
from webdemo.study import Pair, StudyEntry

walking = stub_module().walking
ORIGIN = {"origin": HERE}
SECRETS = ("InterGen", "BiGraphDiff", "guidance", "manifest", "ada")


def study(client: TestClient, owner: str) -> StudyEntry:
    runs = ("InterGen", "BiGraphDiff guidance 3")
    pairs = [Pair(walking(0.5), walking(1.0), "They walk.")]
    return lab_of(client).studies.create(owner, "Which <b>is</b> @files@ longer?", runs, pairs)


def browser(client: TestClient, key: str) -> dict[str, str]:
    """The headers of a browser that has opened a study's page, which gave it a cookie."""
    client.cookies.clear()
    answer = client.get(f"/study/{key}", headers=HTML)
    assert answer.status_code == 200
    client.cookies.clear()
    return ORIGIN | {"cookie": answer.headers["set-cookie"].split(";")[0]}


def test_a_person_with_the_link_votes_once_and_sees_no_names(local: TestClient) -> None:
    made = study(local, "local")
    page = local.get(f"/study/{made.key}", headers=HTML)
    assert "Which &lt;b&gt;is&lt;/b&gt; @files@ longer?" in page.text
    assert "default-src 'none'" in str(page.headers)
    me = browser(local, made.key)
    handed = local.post(f"/study/{made.key}/next", headers=me).json()
    assert (handed["total"], handed["done"], handed["pair"]["title"]) == (1, 0, "They walk.")
    assert [cell["caption"] for cell in handed["pair"]["samples"][0]["cells"]] == ["1", "2"]
    handed["pair"]["samples"] = [{**s, "positions": 0, "cells": 0} for s in handed["pair"]["samples"]]
    for secret in SECRETS:
        assert secret not in json.dumps(handed) and secret not in page.text
    done = local.post(f"/study/{made.key}/vote/0/1", headers=me)
    assert done.json() == {"done": 1, "total": 1, "number": None, "pair": None}
    again = local.post(f"/study/{made.key}/vote/0/1", headers=me)
    assert again.status_code == 422 and "voted on this pair already" in again.json()["detail"]
    assert lab_of(local).studies.mine("local")[0].voters == 1


def test_with_accounts_a_person_is_an_account(shared: TestClient) -> None:
    made = study(shared, "user ada")
    shared.cookies.clear()
    asked = shared.get(f"/study/{made.key}", headers=HTML)
    assert asked.status_code == 303 and asked.headers["location"] == f"/login?next=%2Fstudy%2F{made.key}"
    assert "to vote in the study" in shared.get(asked.headers["location"], headers=HTML).text
    assert shared.post(f"/study/{made.key}/next", headers=ORIGIN).status_code == 401
    eve = sign_in(shared, "eve") | ORIGIN
    assert shared.post(f"/study/{made.key}/vote/0/=", headers=eve).json()["done"] == 1
    elsewhere = sign_in(shared, "eve") | ORIGIN  # another browser is no other person
    assert shared.post(f"/study/{made.key}/next", headers=elsewhere).json()["pair"] is None
