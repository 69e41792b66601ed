"""``python -m webdemo scene``: a story file becomes motion, and a mistake in it one line."""

from pathlib import Path

import numpy as np

from motion.formats import read

from .test_cli import Run, answer, refused, run, weights

__all__ = ["run", "weights"]
STORY = '[[beat]]\nwords = "They wave."\nseconds = 1\n[[beat]]\nwords = "They bow."\nseconds = 1\n'


def test_a_story_becomes_a_file_that_can_be_changed(run: Run, tmp_path: Path) -> None:
    (tmp_path / "story.toml").write_text(STORY)
    code, said, _ = run("scene", tmp_path / "story.toml", "--steps", 2, "--seed", 5, "--out", tmp_path / "one.npz")
    assert code == 0
    asked = answer(said)["manifest"]["request"]
    assert (asked["kind"], asked["seed"], asked["steps"], len(asked["beats"])) == ("scene", 5, 2, 2)
    one = read(tmp_path / "one.npz").positions
    assert one.shape == (2, 60, 22, 3)
    span = ("--motion", tmp_path / "one.npz", "--start", 0.5, "--end", 1.5)
    code, _, _ = run("scene", "--prompt", "They hug.", *span, "--steps", 2, "--out", tmp_path / "two.npz")
    assert code == 0
    two = read(tmp_path / "two.npz").positions
    np.testing.assert_array_equal(two[:, 45:], one[:, 45:])
    assert np.abs(two[:, 15:45] - one[:, 15:45]).max() > 1e-3


def test_mistakes_are_one_line(run: Run, tmp_path: Path) -> None:
    story, out = tmp_path / "story.toml", tmp_path / "x.npz"
    assert "Give a story" in refused(run("scene", "--out", out))
    assert "cannot be read" in refused(run("scene", story, "--out", out))
    story.write_text(STORY.replace("seconds = 1", "secnods = 1", 1))
    assert "Line 3: there is no key 'secnods'" in refused(run("scene", story, "--out", out))
    story.write_text(STORY)
    assert "suffix" in refused(run("scene", story, "--out", tmp_path / "x.txt"))
    assert not out.exists()
