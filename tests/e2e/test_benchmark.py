"""The figures of ``benchmark --browser``, of the page with an engine that needs no networks."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from motion import InputError
from webdemo.benchmark import browser as benchmark_browser
from webdemo.benchmark import server

pytestmark = pytest.mark.e2e

REPOSITORY = Path(__file__).resolve().parents[2]
STUB_APP = f"""
import os, sys, tempfile
from pathlib import Path
sys.path.insert(0, {str(REPOSITORY)!r})
from tests.ui.stub_engine import StubEngine
from tests.ui.stub_page import stub_context
from webdemo.ui.page import build_page, launch_options
page = build_page(stub_context(StubEngine(pause=0.1), Path(tempfile.mkdtemp(dir=Path(__file__).parent))))
page.launch(server_name="127.0.0.1", server_port=int(os.environ["PASDEDEUX_PORT"]), **launch_options())
"""


def test_page_and_player_are_measured(chromium: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``chromium`` says whether there is a browser; the benchmark starts one of its own."""
    (tmp_path / "app.py").write_text(STUB_APP)
    monkeypatch.setattr(server, "ROOT", tmp_path)
    monkeypatch.setattr(benchmark_browser, "WATCHED", 1.0)
    with ThreadPoolExecutor(1) as thread:  # Playwright takes one browser a thread, and the fixture has one
        figures = thread.submit(benchmark_browser.measure_browser).result()
    print(f"\n{figures}")
    assert 0 < figures["page_first_answer_seconds"] < figures["page_prompt_seconds"]
    assert figures["page_prompt_seconds"] <= figures["page_model_ready_seconds"]
    assert 0 < figures["page_first_paint_seconds"] < figures["page_prompt_seconds"]
    assert 0 <= figures["page_layout_shift"] < 0.1
    assert 0.5 < figures["page_megabytes"] < 20
    assert figures["page_request_seconds"] > 0.1
    assert 0 <= figures["page_result_to_body_seconds"] <= figures["page_result_to_motion_seconds"] < 30
    assert figures["player_pixels"] == "960x640"
    assert figures["player_fps"] > 1


def test_no_chromium_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="install the package chromium"), benchmark_browser.chromium():
        raise AssertionError("a browser was found")
