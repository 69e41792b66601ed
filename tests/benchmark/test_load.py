"""The load test itself, on a server whose engine needs no networks."""

from __future__ import annotations

import json
import signal
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from motion import InputError
from tests.server.lab import ROOT
from webdemo.benchmark import attackers, load, server
from webdemo.benchmark.attackers import ATTACKERS
from webdemo.benchmark.load import GOALS, KINDS, LivePerson, Tally, attacked_figures, goals_missed
from webdemo.cli import main
from webdemo.server.settings import Settings

pytestmark = pytest.mark.slow

STUB_APP = f"""
import os, runpy, sys
sys.argv = ["lab.py", os.environ["PASDEDEUX_PORT"], os.environ["PASDEDEUX_DATA"]]
runpy.run_path({str(ROOT / "tests" / "server" / "lab.py")!r}, run_name="__main__")
"""


def run_load(**options: Any) -> dict[str, Any]:
    """The load test in a thread of its own: a browser test before it leaves a loop running in this one."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(lambda: load.run_load(**options)).result()


def test_every_kind_of_job_comes_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "app.py").write_text(STUB_APP)
    monkeypatch.setattr(server, "ROOT", tmp_path)
    monkeypatch.setattr(load, "REST_SECONDS", 0.1)
    monkeypatch.setattr(load, "PROBE_EVERY", 0.1)
    monkeypatch.setenv("PASDEDEUX_GRACE_SECONDS", "1")
    monkeypatch.setenv("PASDEDEUX_EVENTS", "8")
    assert len(attackers.large_trc()) < Settings.model_fields["upload_megabytes"].default * 2**20
    for name, less in (("FRAMES", 200), ("EVENTS", 12), ("TOP_UP", 2), ("PAGES", 4), ("UNREAD", 5), ("MESSAGES", 10)):
        monkeypatch.setattr(attackers, name, less)  # each way is tried, in a fraction of the time
    people = len(KINDS)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as in a shell's background job
    try:
        figures = run_load(people=people, minutes=0.001, steps=2)
    finally:
        signal.signal(signal.SIGINT, before)
    assert figures["runs_done"] >= people == figures["people_served"], figures
    assert figures["runs_lost"] == figures["runs_swapped"] == figures["runs_refused_or_failed"] == 0, figures
    assert figures["memory_at_rest_before_mb"] > 0 and figures["memory_most_mb"] > 0
    assert figures["page_worst_seconds"] > 0 < figures["attacked_healthz_worst_seconds"]
    assert figures["attack_events_taken"] > 0 < figures["attack_events_refused"], figures
    assert figures["attack_files_taken"] > 0 == figures.get("attack_uploads_refused", 0), figures
    assert figures["attack_messages_answered"] > 0 < figures["attack_messages_replaced"], figures
    assert figures["attacked_runs_done"] >= people == len(figures["attacked_waits_over_fair_share"]), figures
    assert figures["attacked_runs_lost"] == figures["attacked_runs_refused_or_failed"] == 0, figures
    assert figures["attacked_live_wait_over_fair_share"] > 0 < figures["attacked_live_frames_over_fair_share"]


def test_a_server_that_ends_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "app.py").write_text("raise SystemExit(1)")
    monkeypatch.setattr(server, "ROOT", tmp_path)
    with pytest.raises(InputError, match="ended before it was ready"):
        run_load(people=1, minutes=0.01)


def test_shares_are_compared_by_work() -> None:
    waits = {0: {"react": [(1.0, 1.0), (9.0, 4.0)]}, 1: {"generate": [(12.0, 2.0)], "render": [(90.0, 1.0)]}}
    tally = Tally(done=3, kinds=waits, memory=[5.0, 9.0, 7.0, 6.0], healthz=[0.1] * 98 + [2.0, 4.0])
    figures = tally.figures()
    times = [figures[f"healthz_{name}_seconds"] for name in ("median", "99th", "worst")]
    assert times == pytest.approx([0.1, 2.02, 4.0]) and "page_worst_seconds" not in figures
    assert figures["longest_wait_over_fair_share"] == 1.5
    assert figures["memory_most_mb"] == 9.0 and figures["memory_last_over_first_quarter"] == 1.2


def test_what_attackers_leave_is_compared_with_a_fair_share() -> None:
    """As many attackers as people are entitled to half, so that waits twice as long are fair."""
    calm = Tally(kinds={0: {"generate": [(1.0, 1.0)], "render": [(4.0, 1.0)]}, 1: {"generate": [(3.0, 1.0)]}})
    attacked = Tally(
        kinds={0: {"generate": [(9.0, 1.0), (15.0, 5.0)]}, 1: {"generate": [(8.0, 1.0)], "render": [(40.0, 1.0)]}}
    )
    calm.live = LivePerson(delays=[0.2, 0.1, 0.3], frames=60, seconds=2.0)
    attacked.live = LivePerson(delays=[1.2], frames=30, seconds=2.0)
    figures = attacked_figures(calm, attacked, ATTACKERS)
    assert figures["attacked_waits_over_fair_share"] == [1.0, 4.0]
    assert figures["attacked_longest_wait_over_fair_share"] == 4.0
    assert figures["attacked_live_wait_over_fair_share"] == pytest.approx(2.0)
    assert figures["attacked_live_frames_over_fair_share"] == 1.0
    calm.live = LivePerson(refused="The server is too busy.")
    figures = attacked_figures(calm, attacked, ATTACKERS)
    assert "attacked_live_wait_over_fair_share" not in figures
    assert figures["live_refused"] == ["The server is too busy."]


def test_the_command_says_which_goals_are_missed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr(load, "run_load", lambda **options: asked.update(options) or {"goals_missed": []})
    assert main(["benchmark", "--load", "--people", "7", "--minutes", "0.5"]) == 0
    assert asked == {"people": 7, "minutes": 0.5, "steps": 8}
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["goals_missed"] == []
    good = {name: least for name, (least, _) in GOALS.items()}
    assert goals_missed(good) == []
    bad = {"runs_swapped": 1, "page_worst_seconds": None, "longest_wait_over_fair_share": float("nan")}
    assert goals_missed(good | bad) == ["runs_swapped", "longest_wait_over_fair_share", "page_worst_seconds"]
