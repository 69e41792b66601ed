"""The measurement of live streams, on a server whose partner needs no network."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from motion import InputError
from webdemo.benchmark import live, served

from .test_load import STUB_APP

pytestmark = pytest.mark.slow
AT_ANY_PACE = f"""
import sys
sys.path.insert(0, {str(served.ROOT)!r})
import webdemo.server.live.streams as streams
streams.BUSIEST = float("inf")
{STUB_APP}
"""
"""The server lets in as many as its settings say, however busy the machine is."""


def run_live(**options: Any) -> dict[str, Any]:
    """In a thread of its own: a browser test before it leaves a loop running in this one."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(lambda: live.run_live(**options)).result()


def test_twenty_people_are_answered_and_one_more_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "app.py").write_text(AT_ANY_PACE)
    monkeypatch.setattr(served, "ROOT", tmp_path)
    figures = run_live(people=20, minutes=0.03)
    assert figures["refused"] == figures["log_lines_of_errors"] == 0, figures
    (sentence,) = figures["refused_of_one_more"]
    assert "as this server allows (20)" in sentence, figures
    assert figures["frames_a_second_least"] > 5 and figures["delay_median_ms"] > 0, figures


def test_numbers_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="1 to 100 people"):
        live.run_live(people=0, minutes=1)
