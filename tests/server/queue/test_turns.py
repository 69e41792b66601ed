"""The account of the work done for each person, and how long a run waits."""

from types import SimpleNamespace

import pytest

from webdemo.server.queue import turns
from webdemo.server.queue.turns import Accounts, Job, Pace, in_turn, next_job, units


def job(person: str, cost: float, started: float = 0.0) -> Job:
    return Job(person, None, cost, started=started)


@pytest.fixture(autouse=True)
def now(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock shows 100 s."""
    monkeypatch.setattr(turns, "time", type("Clock", (), {"monotonic": staticmethod(lambda: 100.0)}))


def test_work_grows_with_samples_steps_and_seconds() -> None:
    assert units(SimpleNamespace(samples=2, steps=50, seconds=4.0)) == 2 * (50 * 4 + 10)
    assert units(SimpleNamespace(actor=SimpleNamespace(seconds=3.0), steps=10)) == 40
    assert units(SimpleNamespace()) == 15


def test_the_pace_is_learned_and_later_runs_count() -> None:
    pace = Pace()
    assert pace.seconds_a_unit is None
    pace.learn(10, 20)
    assert pace.seconds_a_unit == 2
    pace.learn(10, 10)
    assert pace.seconds_a_unit == pytest.approx(0.7 * 2 + 0.3 * 1)


def test_a_job_waits_for_those_before_it_and_for_the_rest_of_what_runs() -> None:
    running, pace = [job("c", 10, started=95.0)], Pace(2.0)  # takes 20 s, 5 of which are over
    assert pace.wait(5, running, 1) == 15 + 2 * 5
    assert pace.wait(5, running, 2) == pytest.approx(5)
    assert Pace().wait(5, running, 1) is None


def test_a_late_run_is_taken_to_need_a_tenth_yet() -> None:
    assert Pace(2.0).wait(0, [job("c", 10, started=0.0)], 1) == pytest.approx(2.0)


def test_those_who_wait_take_turns_by_what_they_have_had() -> None:
    jobs = [job("a", 5), job("a", 5), job("b", 2), job("b", 2), job("b", 2)]
    assert [each.person for each in in_turn(jobs, {"a": 1.0})] == ["b", "a", "b", "b", "a"]
    assert next_job(jobs, {}, [job("a", 5)], 1) is jobs[2]
    assert next_job(jobs[:2], {}, [job("a", 5)], 1) is None


def test_a_newcomer_starts_where_the_least_served_person_is() -> None:
    accounts = Accounts()
    accounts.served = {"ada": 30.0, "bob": 10.0}
    accounts.meet("eve", ["ada", "bob"])
    assert accounts.served["eve"] == 10.0
    accounts.meet("ada", ["bob"])
    assert accounts.served["ada"] == 30.0
