"""Studies: who may see what, one vote a pair and person, and what is refused."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from motion import InputError
from tests.server.clients import no_room
from tests.server.lab import stub_module
from webdemo.server.accounts.quotas import Quota
from webdemo.server.store.database import Database
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.study import Pair, StudyEntry

ME, OTHER = "user ada", "user eve"
RUNS = ("short", "=SUM(A1)")
walking = stub_module().walking


@pytest.fixture
def studies(tmp_path: Path) -> Iterator[Studies]:
    database = Database(tmp_path / "h.db")
    yield Studies(Storage(database, tmp_path / "motions"), tmp_path / "studies")
    database.close()


def new(studies: Studies, pairs: int = 3, owner: str = ME, question: str = "Which is longer?") -> StudyEntry:
    """Walks of 1 s in the first run and of 2 s in the second."""
    made = [Pair(walking(1.0, i), walking(2.0, i), f"They walk {i}.") for i in range(pairs)]
    return studies.create(owner, question, RUNS, made)


def press(studies: Studies, key: str, person: str) -> str:
    """Answers the next pair: always the longer one."""
    _, _, number, pair = studies.following(key, person)
    assert number is not None and pair is not None
    pressed = "1" if pair.first.num_frames > pair.second.num_frames else "2"
    studies.vote(key, person, number, pressed)
    return pressed


def test_votes_of_several_people_become_a_result_and_a_table(studies: Studies, tmp_path: Path) -> None:
    study = new(studies)
    assert (study.runs, study.pairs, study.voters) == (RUNS, 3, 0)
    pressed = [press(studies, study.key, f"voter {i}") for i in range(6) for _ in range(3)]
    assert set(pressed) == {"1", "2"}, "sides are drawn"
    assert studies.following(study.key, "voter 0") == (3, 3, None, None)
    number = studies.following(study.key, "last").number
    assert number is not None
    studies.vote(study.key, "last", number, "=")
    (mine,) = studies.mine(ME)
    assert (mine.id, mine.wins, mine.ties, mine.voters) == (study.id, (0, 18), 1, 7)
    assert studies.export(study.id, ME, tmp_path / "votes.csv") == 19
    rows = list(csv.DictReader((tmp_path / "votes.csv").open()))
    assert {row["chosen"] for row in rows} == {"'=SUM(A1)", "tie"}, "a spreadsheet computes nothing"
    assert {row["voter"] for row in rows} == set("1234567")
    sides = {"1": "left", "2": "right"}
    for row in rows:
        assert {row["left"], row["right"]} == {"short", "'=SUM(A1)"}
        assert row["sentence"] == f"They walk {int(row['pair']) - 1}."
    first = [row for row in rows if row["chosen"] != "tie"]
    assert sorted(row[sides[key]] for row, key in zip(first, pressed, strict=True)).count("short") < len(first)


def test_every_person_has_an_order_of_their_own_and_a_reload_skips_nothing(studies: Studies) -> None:
    study = new(studies, pairs=8)
    orders = []
    for person in ("one", "two"):
        captions = []
        for _ in range(8):
            shown, again = (studies.following(study.key, person) for _ in range(2))
            assert shown.pair and again.pair and shown.number == again.number
            assert not shown.pair.first.manifest and shown.pair.first.roles == ("a", "b")
            captions.append(shown.pair.caption)
            press(studies, study.key, person)
        orders.append(captions)
    assert sorted(orders[0]) == sorted(orders[1]) and len(set(orders[0])) == 8
    assert orders[0] != orders[1]  # equal once in 40,320 times


def test_two_tabs_of_one_person_cannot_vote_twice(studies: Studies) -> None:
    study = new(studies)
    said: list[str] = []

    def vote(_: int) -> None:
        try:
            studies.vote(study.key, "ada", 0, "1")
            said.append("")
        except InputError as error:
            said.append(str(error))

    with ThreadPoolExecutor(4) as tabs:
        list(tabs.map(vote, range(4)))
    assert said.count("") == 1 and sum("voted on this pair already" in each for each in said) == 3
    assert sum(studies.mine(ME)[0].wins) == 1


@pytest.mark.parametrize(("number", "pressed"), [(3, "1"), (-1, "1"), (0, "3"), (0, "")])
def test_an_answer_that_no_page_sends_is_a_sentence(studies: Studies, number: int, pressed: str) -> None:
    with pytest.raises(InputError, match="An answer is 1, 2 or ="):
        studies.vote(new(studies).key, "ada", number, pressed)


def test_nobody_reads_or_changes_what_is_not_theirs(studies: Studies, tmp_path: Path) -> None:
    study = new(studies)
    for owner in (OTHER, ""):
        assert studies.mine(owner) == []
        with pytest.raises(InputError, match="There is no such study"):
            studies.delete(study.id, owner)
        with pytest.raises(InputError, match="There is no such study"):
            studies.export(study.id, owner, tmp_path / "theirs.csv")
    for key in (study.id, "../x", ""):
        with pytest.raises(InputError, match="There is no such study"):
            studies.following(key, "ada")
    assert not (tmp_path / "theirs.csv").exists() and len(studies.mine(ME)) == 1


def test_strangers_cannot_vote_without_end(studies: Studies, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("webdemo.server.store.studies.MOST_VOTES", 4)
    key = new(studies, pairs=2).key
    for i in range(4):
        press(studies, key, f"cookie {i}")
    with pytest.raises(InputError, match="has all the votes"):
        press(studies, key, "one cookie more")
    assert studies.mine(ME)[0].voters == 4


def test_a_deleted_study_is_gone(studies: Studies) -> None:
    study = new(studies)
    press(studies, study.key, "ada")
    folder = studies.folder / study.id
    assert len(list(folder.iterdir())) == 6
    studies.delete(study.id, ME)
    assert not folder.exists() and studies.mine(ME) == []
    with pytest.raises(InputError, match="There is no such study"):
        studies.question(study.key)


def test_what_a_killed_process_left_is_gone_at_the_next_start(studies: Studies) -> None:
    kept = new(studies)
    (studies.folder / "half").mkdir()
    (studies.folder / "half" / "0.npz").write_bytes(b"half")
    studies.recover()
    assert [path.name for path in studies.folder.iterdir()] == [kept.id]


def test_what_makes_no_study_is_a_sentence_and_leaves_nothing(studies: Studies) -> None:
    for question in ("  ", "?" * 301):
        with pytest.raises(InputError, match="write 1 to 300"):
            new(studies, question=question)
    with pytest.raises(InputError, match="sign in or allow cookies"):
        new(studies, owner="")
    studies.storage.room = Quota("bytes", everybody=1)
    with pytest.raises(InputError, match="others' runs are not removed for yours"):
        new(studies)
    assert studies.mine(ME) == [] and not any(studies.folder.glob("*"))


def test_a_full_disk_leaves_no_half_study(tmp_path: Path) -> None:
    studies = Studies(Storage(Database(tmp_path / "h.db"), tmp_path / "motions"), tmp_path / "studies")
    many = [Pair(walking(0.2), walking(0.2), "They walk. " * 9)] * 80
    with no_room(studies.database), pytest.raises(InputError, match="disk is full"):
        studies.create(ME, "Which?", RUNS, many)
    assert list((tmp_path / "studies").iterdir()) == []
    studies.database.close()
