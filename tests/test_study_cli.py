"""``python -m webdemo study``: the studies of a lab's data folder from a shell."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from tests.server.lab import stub_module
from webdemo import cli
from webdemo.server.lab import studies_of
from webdemo.server.settings import read_settings
from webdemo.server.store.database import Database
from webdemo.study import Stimulus
from webdemo.ui.studies import NewStudy


def say(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str]:
    code = cli.main([str(word) for word in words])
    said = capsys.readouterr()
    return code, said.out.splitlines()[-1] if code == 0 else said.err


def test_a_lab_reads_its_studies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "data"))
    code, error = say(capsys, "study", "list")
    assert code == 2 and "There is no lab's history in" in error and not (tmp_path / "data").exists()
    settings = read_settings()
    database = Database(settings.database_url)
    studies = studies_of(settings, database)
    motion = stub_module().walking(0.5)
    sets = {name: [Stimulus("They walk.", motion)] for name in ("ours", "theirs")}
    made = studies.create("user ada", NewStudy(question="Which?", sets=sets, checks=0))
    studies.clock = lambda: 0.0
    shown = studies.hand_out(made.key, "eve")
    assert shown is not None
    studies.clock = lambda: 5.0
    studies.vote(made.key, "eve", shown.ticket, "=")
    database.close()

    code, said = say(capsys, "study", "list")
    (listed,) = json.loads(said)["studies"]
    assert (listed["id"], listed["owner"], listed["sets"]) == (made.id, "user ada", ["ours", "theirs"])
    assert made.id.isalnum()  # Else one in 64 would be taken for an option.
    code, said = say(capsys, "study", "result", made.id[:6])
    answer = json.loads(said)
    assert (code, answer["raters"], answer["comparisons"][0]["ties"]) == (0, 1, 1)
    code, said = say(capsys, "study", "export", made.id, "--out", tmp_path / "votes.csv")
    assert code == 0 and json.loads(said)["votes"] == 1
    (row,) = csv.DictReader((tmp_path / "votes.csv").open())
    assert (row["chosen"], row["seconds"]) == ("tie", "5.0")
    for words, says in (
        (("export", made.id), "Name the file to write"),
        (("result", "nothing"), "0 studies begin with 'nothing'"),
        (("result",), "Give the id of a study"),
    ):
        code, error = say(capsys, "study", *words)
        assert code == 2 and says in error and error.count("\n") == 1


def test_ids_of_older_labs_may_begin_with_a_dash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "data"))
    monkeypatch.setattr("webdemo.server.store.studies.secrets.token_hex", lambda count: "-7U94L")
    settings = read_settings()
    database = Database(settings.database_url)
    motion = stub_module().walking(0.5)
    sets = {name: [Stimulus("They walk.", motion)] for name in ("ours", "theirs")}
    studies_of(settings, database).create("user ada", NewStudy(question="Which?", sets=sets, checks=0))
    database.close()
    code, said = say(capsys, "study", "result", "--", "-7U94L")
    assert (code, json.loads(said)["id"]) == (0, "-7U94L")
