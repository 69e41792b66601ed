"""The account of the work done for each person, and how long a run waits."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from webdemo.server.queue import turns
from webdemo.server.queue.turns import Accounts, Line, Pace, units


@dataclass(eq=False)
class Job:
    person: str
    cost: float
    started: float = 0.0


def first_come(waiting: list[Any], served: dict[str, float], running: Any) -> list[Any]:
    return waiting[:1]


def line(waiting: list[Job], running: list[Job], pace: Pace, workers: int = 1) -> Line:
    return Line(waiting, running, {}, first_come, pace, workers)


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
    jobs, pace = [Job("a", 5), Job("b", 7)], Pace(2.0)
    running = [Job("c", 10, started=95.0)]  # takes 20 s, 5 of which are over
    assert line(jobs, running, pace).place(jobs[1]) == (2, 15 + 2 * 5)
    assert line(jobs, running, pace, workers=2).place(jobs[1]) == (2, pytest.approx(5))


def test_a_late_run_is_taken_to_need_a_tenth_yet() -> None:
    job, late = Job("a", 5), Job("c", 10, started=0.0)
    assert line([job], [late], Pace(2.0)).place(job) == (1, pytest.approx(2.0))


def test_a_newcomer_starts_where_the_least_served_person_is() -> None:
    accounts = Accounts()
    accounts.served = {"ada": 30.0, "bob": 10.0}
    accounts.meet("eve", ["ada", "bob"])
    assert accounts.served["eve"] == 10.0
    accounts.meet("ada", ["bob"])
    assert accounts.served["ada"] == 30.0
