"""Studies: who may see what, one vote a pair and person, and what is refused."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import Duet, InputError
from tests.server.clients import DATABASES, database_url, drop_tables, no_room
from tests.server.lab import stub_module
from webdemo.server.lab import studies_of
from webdemo.server.settings import Settings
from webdemo.server.store.database import Database
from webdemo.server.store.studies import Studies
from webdemo.server.store.voting import SOONEST
from webdemo.study import Stimulus
from webdemo.ui.studies import NewStudy, StudyEntry

ME, OTHER = "user ada", "user eve"
walking = stub_module().walking


class Clock:
    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture(params=DATABASES)
def studies(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Studies]:
    database = Database(database_url(request.param, tmp_path))
    yield Studies(database, tmp_path / "studies", clock=Clock(), address_people=2)
    drop_tables(database.engine)
    database.close()


def sets(count: int = 3) -> dict[str, list[Stimulus]]:
    """Walks of 1 s in the one set and of 2 s in the other, so that they differ."""
    return {
        name: [Stimulus(f"They walk {i}.", walking(seconds, i)) for i in range(count)]
        for name, seconds in (("short", 1.0), ("long", 2.0))
    }


def new(studies: Studies, owner: str = ME, **fields: Any) -> StudyEntry:
    asked: dict[str, Any] = {"question": "Which is longer?", "sets": sets(), "checks": 1} | fields
    return studies.create(owner, NewStudy(**asked))


def way(motion: Any) -> float:
    """Metres that all joints travel: more where pieces jump."""
    return float(np.abs(np.diff(motion.positions, axis=-3)).sum())


def press(studies: Studies, key: str, person: str, *, attentive: bool = True) -> str:
    """Answers the next pair: always the longer one, and never the shuffled one by an attentive person."""
    shown = studies.hand_out(key, person)
    assert shown is not None
    studies.clock.now += SOONEST + 1  # type: ignore[attr-defined]
    if shown.left.num_frames == shown.right.num_frames:
        pressed = "2" if (way(shown.left) > way(shown.right)) == attentive else "1"
    else:
        pressed = "1" if shown.left.num_frames > shown.right.num_frames else "2"
    studies.vote(key, person, shown.ticket, pressed)
    return pressed


def vote_all(studies: Studies, key: str, person: str, **more: Any) -> list[str]:
    total = studies.invitation(key, person).total
    return [press(studies, key, person, **more) for _ in range(total)]


def test_votes_of_several_people_become_a_result(studies: Studies, tmp_path: Path) -> None:
    study = new(studies)
    assert (study.sets, study.pairs, study.checks) == (("short", "long"), 3, 1)
    pressed = [vote_all(studies, study.key, f"voter {i}") for i in range(4)]
    vote_all(studies, study.key, "careless", attentive=False)
    assert {side for each in pressed for side in each} == {"1", "2"}, "sides are drawn"
    assert studies.hand_out(study.key, "voter 0") is None
    result = studies.result(study.id, ME)
    (each,) = result.comparisons
    assert (each.wins, each.losses, each.ties) == (0, 12, 0)
    assert (result.raters, result.excluded, result.agreement) == (4, 1, 1.0)
    assert studies.export(study.id, ME, tmp_path / "votes.csv") == 20
    (mine,) = studies.mine(ME)
    assert (mine.raters, mine.votes) == (5, 20)


def test_a_voter_sees_motions_without_names_and_in_an_order_of_their_own(studies: Studies) -> None:
    study = new(studies, sets=sets(8), checks=0)
    orders = []
    for person in ("one", "two"):
        captions = []
        for _ in range(8):
            shown = studies.hand_out(study.key, person)
            assert shown is not None and isinstance(shown.left, Duet)
            assert not shown.left.manifest and shown.left.roles == ("a", "b")
            captions.append(shown.caption)
            press(studies, study.key, person)
        orders.append(captions)
    assert sorted(orders[0]) == sorted(orders[1]) and len(set(orders[0])) == 8
    assert orders[0] != orders[1]  # equal once in 40,320 times
    hidden = studies.hand_out(new(studies, shows_sentence=False).key, "one")
    assert hidden is not None and hidden.caption == ""


def test_every_person_votes_once_on_a_pair_and_not_before_it_can_be_seen(studies: Studies) -> None:
    study = new(studies)
    with pytest.raises(InputError, match="was not sent to you"):
        studies.vote(study.key, "ada", "made up", "1")
    shown = studies.hand_out(study.key, "ada")
    again = studies.hand_out(study.key, "ada")
    assert shown and again and shown.ticket == again.ticket, "a reload does not skip a pair"
    with pytest.raises(InputError, match="came before the pair can have been seen"):
        studies.vote(study.key, "ada", shown.ticket, "1")
    studies.clock.now += SOONEST  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="was not sent to you"):
        studies.vote(study.key, "eve", shown.ticket, "1")
    with pytest.raises(InputError, match="1, 2, = or skip"):
        studies.vote(study.key, "ada", shown.ticket, "3")
    studies.vote(study.key, "ada", shown.ticket, "=")
    with pytest.raises(InputError, match="voted on this pair already"):
        studies.vote(study.key, "ada", shown.ticket, "1")
    assert studies.result(study.id, ME).votes in (0, 1)  # 0 where it was an attention check


def test_two_tabs_of_one_person_cannot_vote_twice(studies: Studies) -> None:
    study = new(studies)
    said: list[str] = []
    tickets: list[str] = []

    def take() -> None:
        shown = studies.hand_out(study.key, "ada")
        assert shown is not None
        tickets.append(shown.ticket)

    def cast() -> None:
        try:
            studies.vote(study.key, "ada", tickets[0], "1")
            said.append("")
        except InputError as error:
            said.append(str(error))

    for job in (take, cast):
        studies.clock.now += SOONEST + 1  # type: ignore[attr-defined]
        threads = [threading.Thread(target=job) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert len(tickets) == 4 and len(set(tickets)) == 1
    assert said.count("") == 1 and len(said) == 4
    assert studies.mine(ME)[0].votes == 1


def test_nobody_reads_or_changes_what_is_not_theirs(studies: Studies, tmp_path: Path) -> None:
    study = new(studies)
    assert studies.mine(OTHER) == [] and studies.mine("") == []
    for owner in (OTHER, ""):
        for act in (
            lambda who: studies.result(study.id, who),
            lambda who: studies.close(study.id, who, closed=True),
            lambda who: studies.delete(study.id, who),
            lambda who: studies.export(study.id, who, tmp_path / "theirs.csv"),
        ):
            with pytest.raises(InputError, match="no such study of yours"):
                act(owner)
    for key in (study.id, "../x", ""):
        with pytest.raises(InputError, match="There is no such study"):
            studies.hand_out(key, "ada")
    assert not (tmp_path / "theirs.csv").exists() and len(studies.mine(ME)) == 1


def test_results_are_hidden_from_whoever_is_voting(studies: Studies, tmp_path: Path) -> None:
    study = new(studies, shows_result=True)
    press(studies, study.key, ME)
    with pytest.raises(InputError, match="hidden until your last pair, 1 of 4 done"):
        studies.result(study.id, ME, ME)
    with pytest.raises(InputError, match="hidden until your last pair"):
        studies.export(study.id, ME, tmp_path / "votes.csv", ME)
    assert studies.invitation(study.key, ME).result is None
    for _ in range(3):
        press(studies, study.key, ME)
    assert studies.result(study.id, ME, ME).votes == 3
    shown = studies.invitation(study.key, ME).result
    assert shown is not None and shown.votes == 3
    silent = new(studies)
    vote_all(studies, silent.key, "eve")
    assert studies.invitation(silent.key, "eve").result is None, "the owner did not want it shown"


def test_people_with_few_pairs_each_cover_all_of_them(studies: Studies) -> None:
    study = new(studies, sets=sets(6), pairs_each=2, checks=1)
    for i in range(3):
        assert len(vote_all(studies, study.key, f"voter {i}")) == 3
    assert studies.result(study.id, ME).votes == 6
    assert studies.result(study.id, ME).agreement is None, "no pair came twice"


def test_a_closed_study_takes_no_votes_and_a_deleted_one_is_gone(studies: Studies) -> None:
    study = new(studies)
    vote_all(studies, study.key, "done")
    shown = studies.hand_out(study.key, "ada")
    assert shown is not None
    studies.clock.now += SOONEST  # type: ignore[attr-defined]
    studies.close(study.id, ME, closed=True)
    for act in (
        lambda: studies.vote(study.key, "ada", shown.ticket, "1"),
        lambda: studies.hand_out(study.key, "eve"),
    ):
        with pytest.raises(InputError, match="closed: nobody can vote"):
            act()
    assert studies.hand_out(study.key, "done") is None, "whoever has voted on all pairs is thanked"
    studies.close(study.id, ME, closed=False)
    studies.vote(study.key, "ada", shown.ticket, "1")
    folder = studies.folder / study.id
    assert len(list(folder.iterdir())) == 7, "six motions and a shuffled copy"
    studies.delete(study.id, ME)
    assert not folder.exists() and studies.mine(ME) == []
    with pytest.raises(InputError, match="There is no such study"):
        studies.invitation(study.key, "ada")


def test_a_lab_behind_one_address_may_vote(tmp_path: Path) -> None:
    """The voters of a study have a limit of their own, higher than the share of an address in all else."""
    database = Database(f"sqlite:///{tmp_path / 's.db'}")
    assert studies_of(Settings(data=tmp_path), database).address_people >= 5 * Settings().address_people
    assert studies_of(Settings(data=tmp_path, study_voters=3), database).address_people == 3


def test_one_address_has_a_limited_number_of_voters(studies: Studies) -> None:
    study = new(studies)
    for person in ("one", "two"):
        assert studies.hand_out(study.key, person, "203.0.113.9") is not None
    with pytest.raises(InputError, match="2 people vote in this study from your network already"):
        studies.hand_out(study.key, "three", "203.0.113.9")
    assert studies.hand_out(study.key, "one", "203.0.113.9") is not None
    assert studies.hand_out(study.key, "three", "203.0.113.10") is not None


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"sets": {}}, "2 to 6 sets of motions, not 0"),
        ({"sets": {"short": sets()["short"]}}, "2 to 6 sets of motions, not 1"),
        ({"sets": {"short": sets()["short"], "none": []}}, "The set 'none' has no motions"),
        ({"sets": {"x" * 100 + "1": sets()["short"], "x" * 100 + "2": sets()["long"]}}, "the same name"),
        ({"question": "  "}, "has no question"),
        ({"question": "?" * 301}, "The question has 301 characters"),
        ({"checks": 21}, "0 to 20 attention checks"),
        ({"pairs_each": -1}, "0 or more pairs"),
        ({"sets": {name: [Stimulus("a", walking(61.0))] for name in "ab"}}, "60 s at most"),
    ],
)
def test_what_makes_no_study_is_a_sentence_and_leaves_nothing(
    tmp_path: Path, fields: dict[str, Any], says: str
) -> None:
    studies = Studies(Database(f"sqlite:///{tmp_path / 'h.db'}"), tmp_path / "studies")
    with pytest.raises(InputError, match=says):
        new(studies, **fields)
    with pytest.raises(InputError, match="sign in or allow cookies"):
        new(studies, owner="")
    assert studies.mine(ME) == [] and not (tmp_path / "studies").exists()
    studies.database.close()


def test_a_full_disk_leaves_no_half_study(tmp_path: Path) -> None:
    studies = Studies(Database(f"sqlite:///{tmp_path / 'h.db'}"), tmp_path / "studies")
    motion = walking(0.2)
    many = {name: [Stimulus(f"They walk {i}.", motion) for i in range(80)] for name in "ab"}
    with no_room(studies.database), pytest.raises(InputError, match="disk is full"):
        new(studies, sets=many)
    assert list((tmp_path / "studies").iterdir()) == []
    studies.storage.total_bytes = 1
    with pytest.raises(InputError, match="nothing of others is removed for yours"):
        new(studies)
    assert list((tmp_path / "studies").iterdir()) == []
    studies.database.close()
