"""Runs that are found again, by whom, for how long, and what a full disk or a killed process leaves."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy import update

from motion import InputError, formats, stacked_positions
from tests.server.clients import no_room
from tests.server.lab import stub_module
from webdemo.inference import Engine
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.predict import PredictRequest, PredictResult
from webdemo.server.store.database import Database, Run, Share
from webdemo.server.store.history import DAY
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Entry, Search

from .runs import ME, OTHER, kept, made


def entries(history: Notebook, owner: str = ME) -> Sequence[Entry]:
    return history.search(owner, Search()).entries


def test_a_run_is_found_again_as_it_was(history: Notebook) -> None:
    run = kept(history, seed=9, samples=2)
    opened = history.open(run, ME)
    assert (opened.entry.title, opened.entry.state) == ("Two people walk.", "done")
    assert opened.entry.request["seed"] == 9
    first = made(GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1, samples=2, seed=9))
    np.testing.assert_array_equal(opened.result.duets[1].positions, first.duets[1].positions)
    assert opened.result.readouts[0]["after"] == first.readouts[0]["after"]
    assert [entry.id for entry in entries(history)] == [run]


@pytest.mark.parametrize(("people", "marker"), [(2, 1.5), (1, 1.5), (2, 3.0)])
def test_a_prediction_keeps_its_marker_and_what_really_followed(history: Notebook, people: int, marker: float) -> None:
    motion = stub_module().walking(3.0)
    engine = Engine(Path("no weights are needed"))
    request = PredictRequest(motion=motion if people == 2 else motion.a, marker=marker, seconds=1.0, model="still")
    *_, result = engine.run(request)
    run = history.begin(ME, request.to_dict(), "After")
    history.finish(run, result)
    opened = history.open(run, ME)
    kept = opened.result
    assert isinstance(kept, PredictResult) and kept.past_frames == result.past_frames == round(30 * marker)
    assert (kept.error, kept.speed, kept.true_speed) == (result.error, result.speed, result.true_speed)
    assert (kept.truth is None) == (marker == 3.0)
    end = min(90, kept.past_frames + 30)
    np.testing.assert_array_equal(stacked_positions(kept.given), stacked_positions(request.motion)[:, :end])
    np.testing.assert_array_equal(stacked_positions(kept.duets[0]), stacked_positions(result.duets[0]))


def test_others_see_nothing_but_by_a_link_that_lasts(history: Notebook) -> None:
    run = kept(history)
    assert entries(history, OTHER) == []
    for act in (history.open, history.delete, history.link, history.revoke):
        with pytest.raises(InputError, match="There is no such run"):
            act(run, OTHER)
    with pytest.raises(InputError):
        history.favour(run, OTHER, favourite=True)
    key, until = history.link(run, ME)
    assert until == pytest.approx(time.time() + 30 * DAY, abs=60)
    assert history.open(key, OTHER).entry.id == run
    assert history.open(key, "").entry.id == run
    assert entries(history)[0].links == 1
    with pytest.raises(InputError):
        history.delete(key, OTHER)  # a link shows; it gives no power
    assert history.revoke(run, ME) == 1
    with pytest.raises(InputError):
        history.open(key, OTHER)


def test_a_run_has_one_link_at_a_time(history: Notebook) -> None:
    run = kept(history)
    first, _ = history.link(run, ME)
    assert history.link(run, ME)[0] == first and history.publish(run, ME).key != first
    assert history.revoke(run, ME) == 1 and history.link(run, ME)[0] != first


def test_a_link_ends(history: Notebook) -> None:
    key, _ = history.link(kept(history), ME)
    with history.database.session.begin() as session:
        session.execute(update(Share).values(until=time.time() - 1))
    with pytest.raises(InputError, match="its link has expired"):
        history.open(key, OTHER)


def test_age_removes_the_oldest_but_no_favourites(history: Notebook) -> None:
    runs = [kept(history, seed=i) for i in range(5)]
    history._since -= DAY
    assert history.clean() == 0
    with history.database.session.begin() as session:
        for i, run in enumerate(runs):
            session.execute(update(Run).where(Run.id == run).values(created=time.time() - (40 - 8 * i) * DAY))
    history.favour(runs[0], ME, favourite=True)
    assert history.clean() == 1  # 32 days old; the one of 40 days is a favourite
    assert {entry.id for entry in entries(history)} == {runs[0], *runs[2:]}
    assert {path.name for path in history.folder.iterdir()} == {runs[0], *runs[2:]}


@pytest.mark.parametrize("days", [60, -60])
def test_a_clock_that_jumps_removes_nothing_until_it_is_steady(history: Notebook, days: int) -> None:
    run = kept(history)
    history._since -= DAY
    history.clock = lambda: time.time() + days * DAY
    assert [history.clean(), history.clean()] == [0, 0]
    history._since -= DAY
    assert history.clean() == (days > 0)
    assert [entry.id for entry in entries(history)] == ([] if days > 0 else [run])


def test_a_full_disk_in_the_middle_of_a_run_leaves_it_ended(history: Notebook) -> None:
    """SQLite's own limit stands for the disk; what could not be written is said at the next start."""
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1)
    run = history.begin(ME, request.to_dict(), "x")
    with no_room(history.database):
        history.end(run, "failed", "y" * 100_000)
        assert [entry.state for entry in entries(history)] == ["running"]
    history.recover()
    assert [entry.state for entry in entries(history)] == ["interrupted"]


def test_a_result_that_does_not_fit_is_a_sentence_and_leaves_no_files(history: Notebook) -> None:
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1)
    run = history.begin(ME, request.to_dict(), "x")
    with no_room(history.database), pytest.raises(InputError, match="disk is full"):
        history.finish(run, replace(made(request), notes=("y" * 100_000,)))
    history.recover()
    assert entries(history)[0].state in ("failed", "interrupted")
    assert not (history.folder / run).exists()


def test_a_damaged_database_is_a_sentence_and_no_sql(history: Notebook) -> None:
    runs = [kept(history, seed=i) for i in range(3)]
    with history.database.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE runs SET outcome = '{', request = '['")
    assert len(entries(history)) == 3
    with pytest.raises(InputError, match="gone or damaged"):
        history.open(runs[0], ME)
    with history.database.engine.begin() as connection:
        connection.exec_driver_sql("DROP TABLE shares")
    for act in (lambda: entries(history), lambda: history.link(runs[0], ME)):
        with pytest.raises(InputError) as error:
            act()
        assert "history cannot be read or written" in str(error.value) and "shares" not in str(error.value)


def test_a_run_that_is_removed_while_it_runs_leaves_no_files(history: Notebook) -> None:
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1)
    run = history.begin(ME, request.to_dict(), "removed")
    history.delete(run, ME)
    history.finish(run, made(request))
    assert entries(history) == [] and not any(history.folder.iterdir())


def test_what_a_killed_process_left_is_marked(history: Notebook) -> None:
    whole = kept(history)
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0)
    lost = history.begin(ME, request.to_dict(), "lost")
    half = history.folder / f".{lost}"
    half.mkdir()
    (half / "1.npz").write_bytes(b"half")
    assert history.recover() == 1
    states = {entry.id: entry.state for entry in entries(history)}
    assert states == {whole: "done", lost: "interrupted"}
    assert not half.exists()
    with pytest.raises(InputError, match="run it again"):
        history.open(lost, ME)
    history.open(whole, ME)


def test_a_full_disk_is_a_sentence_and_leaves_nothing(history: Notebook, monkeypatch: pytest.MonkeyPatch) -> None:
    before = kept(history)
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1, samples=2)
    run = history.begin(ME, request.to_dict(), "full")

    def full(duet: Any, path: Path) -> None:
        Path(path).write_bytes(b"half a file")
        raise InputError(f"{path} could not be written because the disk is full.")

    with monkeypatch.context() as patch:
        patch.setattr(formats, "write", full)
        with pytest.raises(InputError, match="disk is full"):
            history.finish(run, made(request))
    assert {path.name for path in history.folder.iterdir()} == {before}
    assert entries(history)[0].message == "1.npz could not be written because the disk is full."
    history.storage.free_bytes = 1e18
    with pytest.raises(InputError, match="disk is full"):
        history.begin(ME, request.to_dict(), "more")
    history.open(before, ME)


def test_damaged_files_are_a_sentence(history: Notebook) -> None:
    run = kept(history)
    (history.folder / run / "1.npz").write_bytes(b"PK\x03\x04 nothing")
    with pytest.raises(InputError, match="gone or damaged"):
        history.open(run, ME)


def test_a_database_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "h.db").write_bytes(b"this is no database at all" * 100)
    with pytest.raises(InputError, match="database"):
        Database(tmp_path / "h.db")
