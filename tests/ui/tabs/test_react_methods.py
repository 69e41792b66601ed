"""The methods of the tab React."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")


from tests.ui.tab_events import built
from webdemo.inference.methods import variants
from webdemo.ui.components.actors import react_choices
from webdemo.ui.tabs.react import ReactTab

from .reacting import run, upload


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
    source = upload(tab, walker)[-1]["state"]
    run(tab, source, method=method)
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode) == (model, mode)
    role, steps_slider, pace, _, damping, *_ = tab.fit_method(method)
    assert steps_slider["value"] == steps and pace["interactive"] == steps_slider["interactive"]
    assert role["interactive"] is (model == "intergen")
    assert damping["interactive"] is (mode == "offline")


def test_a_method_streams_where_it_can_answer_pose_by_pose(tab: ReactTab) -> None:
    streams = {key for _, key in react_choices() if tab.fit_method(key)[-1]["visible"]}
    assert streams == {"automatic", "regennet", "regennet-online", "agent"}


def test_the_steps_of_every_method_can_be_set(tab: ReactTab) -> None:
    """A value outside of the slider's range is refused by the page before the job begins."""
    for method in variants("react"):
        steps = tab.fit_method(method)[1]
        assert tab.sampling.steps.minimum <= steps["value"] <= tab.sampling.steps.maximum, method
