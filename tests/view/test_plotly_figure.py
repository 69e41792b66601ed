"""The plotly figure of a motion: frames, controls, and an HTML file that needs nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from plotly.graph_objects import Figure

from motion import Clip, Duet, InputError
from tests.motion.bodies import marching
from webdemo.view import figure, write_figure

POSITIONS, _ = marching(31)
DUET = Duet.from_positions(np.stack([POSITIONS, POSITIONS + np.array([0, 0, 1.5])]), fps=30, roles=("Anna", "<b>Ben"))


def test_a_figure_has_frames_a_button_a_slider_a_floor_and_names() -> None:
    made = figure(DUET, title="meet")
    assert isinstance(made, Figure)
    assert len(made.frames) == 16  # 0 to 1 s at fifteen a second
    assert [step.label for step in made.layout.sliders[0].steps] == [frame.name for frame in made.frames]
    assert made.frames[0].name == "0.00" and made.frames[-1].name == "1.00"
    buttons = made.layout.updatemenus[0].buttons
    assert [button.method for button in buttons] == ["animate", "animate"]
    assert buttons[0].args[1]["frame"]["duration"] == pytest.approx(1000 / 15)
    assert made.data[0].name == "floor" and made.data[0].type == "mesh3d"
    assert [t.text[0] for t in made.data[1:] if t.mode == "text"] == ["Anna", "&lt;b&gt;Ben"]


def test_the_frames_hold_the_motion() -> None:
    made = figure(DUET, fps=30)
    assert len(made.frames) == 31
    for moment in (0, 17, 30):
        frame = made.frames[moment]
        assert list(frame.traces) == list(range(1, 9)) and len(frame.data) == 8
        drawn = np.concatenate(
            [np.stack([t.x, t.y, t.z], axis=-1) for t in frame.data[4:7]]  # b's limbs
        ).astype(float)
        drawn = drawn[np.isfinite(drawn).all(-1)]
        for joint in DUET.b.positions[moment]:
            assert np.linalg.norm(drawn - joint, axis=-1).min() < 1e-3


def test_one_person() -> None:
    made = figure(Clip(np.random.default_rng(0).random((4, 22, 3)), 15.0, name="x"))
    assert len(made.frames) == 4 and len(made.data) == 5


def test_the_file_plays_without_a_network(tmp_path: Path) -> None:
    path = write_figure(DUET, tmp_path / "x.html", title="</script><script>alert(1)</script>")
    text = path.read_text(encoding="utf-8")
    assert "Plotly.addFrames" in text and len(text) > 3e6  # plotly.js is inside
    assert "<script>alert(1)" not in text
    assert not re.search(r"<(script|link)[^>]*(src|href)=", text)


@pytest.mark.parametrize(
    ("options", "says"), [({"theme": "pink"}, "no theme"), ({"fps": 0}, "1 to 60"), ({"fps": 61}, "1 to 60")]
)
def test_what_cannot_be_shown_is_one_sentence(options: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        figure(DUET, **options)


def test_a_long_motion_asks_for_fewer_frames(tmp_path: Path) -> None:
    long = Clip(np.zeros((3000, 22, 3)), 30.0)
    with pytest.raises(InputError, match="more than 1,200"):
        write_figure(long, tmp_path / "x.html")
    assert not list(tmp_path.iterdir())
    assert len(figure(long, fps=5).frames) == 501
