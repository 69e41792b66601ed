"""The methods of the tab React: one after the other, and streamed."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")


from tests.ui.tab_events import built, changes
from webdemo.inference.methods import variants
from webdemo.ui.components.live import BATCH, REPEATED
from webdemo.ui.tabs.react import ReactTab
from webdemo.view.payload import unpack_positions

from .reacting import FIELDS, run, upload


@pytest.fixture
def tab(tmp_path: Path) -> ReactTab:
    return built(ReactTab, tmp_path / "files")


@pytest.mark.parametrize(
    ("method", "model", "mode", "steps"),
    [
        ("intergen", "intergen", "offline", 8),
        ("regennet", "regennet", "offline", 5),
        ("regennet-online", "regennet", "online", 5),
    ],
)
def test_a_method_is_a_model_and_a_mode(
    tab: ReactTab, walker: Path, method: str, model: str, mode: str, steps: int
) -> None:
    source = upload(tab, walker)[-1]["source"]
    run(tab, source, method=method)
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode) == (model, mode)
    role, steps_slider, _, damping, *_ = tab.fit_method(method)
    assert steps_slider["value"] == steps
    assert role["interactive"] is (model == "intergen")
    assert damping["interactive"] is (mode == "offline")


def test_the_steps_of_every_method_can_be_set(tab: ReactTab) -> None:
    """A value outside of the slider's range is refused by the page before the job begins."""
    for method in variants("react"):
        steps = tab.fit_method(method)[1]
        assert tab.sampling.steps.minimum <= steps["value"] <= tab.sampling.steps.maximum, method


def test_streamed_frames_come_in_small_messages_and_end_in_a_result(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    began = time.monotonic()
    steps = run(tab, source, stream=True, end=2.0, samples=4, prompt="")
    assert time.monotonic() - began > 1.9, "the actor plays in real time"
    opening = next(step["player"]["value"] for step in steps if "value" in step.get("player", {}))
    assert opening["live"]
    assert opening["samples"][0]["positions"]["shape"] == [1, 60, 22, 3]
    messages = [step["player"]["live"] for step in steps if step.get("player", {}).get("live")]
    assert len(messages) == 10
    streaming = [step["player"] for step in steps if "live" in step.get("player", {})]
    assert all(player["value"] is opening for player in streaming), "the first of several may be lost"
    seen = np.full((60, 22, 3), np.nan)
    for message in messages:
        assert message["id"] == opening["id"]
        part = unpack_positions(message["frames"])[0]
        assert len(part) <= BATCH + REPEATED
        seen[message["start"] : message["start"] + len(part)] = part
    result = steps[-1]["record"].result
    np.testing.assert_allclose(seen, result.duets[0].b.positions, atol=1e-3)
    assert steps[-1]["player"]["value"]["continues"] == opening["id"]
    assert "longest" in steps[-1]["line"]
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode, asked.samples, asked.steps) == ("regennet", "online", 1, 5)


def test_a_streamed_reaction_that_is_cancelled_tells_the_player(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    fields = {"source": source, **FIELDS, "stream": True}
    seen: list[dict[str, Any]] = []
    for updates in tab.run("me", fields):
        seen.append(changes(tab.outputs, updates))
        if len(seen) == 5:
            tab.page.runs.cancel("me")
    assert seen[-2]["player"]["live"]["stop"]
    assert "Cancelled at frame" in seen[-1]["line"]
    assert "record" not in seen[-1]
