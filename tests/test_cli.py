"""``python -m webdemo`` as a shell meets it: files, one JSON line, and one line where something is wrong."""

import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import app
from motion.formats import read, read_pair
from tests.inference import conftest as tiny
from webdemo import cli
from webdemo.inference import engine, methods

weights = tiny.weights
PROMPT = "Two people shake hands."
STORY = '[[beat]]\nwords = "They wave."\nseconds = 1\n[[beat]]\nwords = "They bow."\nseconds = 1\n'
QUICK = ("--seconds", 1, "--steps", 2, "--damping", 0)

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(weights: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """``run(word, …)`` gives exit code, stdout and stderr of a command with a tiny untrained model."""
    monkeypatch.setattr(engine, "Engine", partial(engine.Engine, weights))

    def call(*words: Any) -> tuple[int, str, str]:
        code = cli.main([str(word) for word in words])
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def generate(run: Run, out: Path, *words: Any) -> tuple[int, str, str]:
    return run("generate", "--prompt", PROMPT, *QUICK, "--out", out, *words)


def answer(said: str) -> dict[str, Any]:
    return json.loads(said.splitlines()[-1])


def refused(outcome: tuple[int, str, str]) -> str:
    """The one line on stderr of a command that must fail."""
    code, said, error = outcome
    assert code == 2
    assert said == ""
    assert error.count("\n") == 1
    assert "Traceback" not in error
    return error


@pytest.mark.parametrize("command", ["generate", "react", "scene", "render", "info", "benchmark", "serve"])
def test_every_command_has_help(run: Run, capsys: pytest.CaptureFixture[str], command: str) -> None:
    with pytest.raises(SystemExit) as ended:
        run(command, "--help")
    assert ended.value.code == 0
    assert f"webdemo {command}" in capsys.readouterr().out


@pytest.mark.parametrize("suffix", [".npz", ".bvh", ".glb"])
def test_generate_writes_a_file_and_one_json_line(run: Run, tmp_path: Path, suffix: str) -> None:
    code, said, _ = generate(run, tmp_path / f"duet{suffix}", "--seed", 3)
    assert code == 0
    printed = answer(said)
    files = [Path(name) for name in printed["files"]]
    assert set(files) == set(tmp_path.iterdir())
    assert printed["manifest"]["request"]["seed"] == 3
    assert printed["manifest"]["weights_sha256"]
    assert printed["wall_seconds"] > 0
    if suffix == ".glb":
        assert files[0].read_bytes()[:4] == b"glTF"
        return
    duet = read_pair(*files) if suffix == ".bvh" else read(files[0])
    assert duet.num_frames == 30
    assert np.isfinite(duet.positions).all()


def test_generate_tries_further_seeds(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "x.npz"
    code, said, err = run("generate", "--prompt", "A falls down and B walks away.", *QUICK, "--tries", 2, "--out", out)
    assert code == 0
    manifest = answer(said)["manifest"]
    assert manifest["tries"]["asked"] == manifest["request"]["tries"] == 2
    assert {row["act"] for row in manifest["checked"]} == {"fall-down", "walk-away"}
    assert " tries" in err
    refused(run("generate", "--prompt", PROMPT, "--tries", 5, "--out", tmp_path / "y.npz"))


def test_the_same_command_gives_the_same_bytes(run: Run, tmp_path: Path) -> None:
    for name in ("x.npz", "y.npz"):
        assert generate(run, tmp_path / name)[0] == 0
    assert generate(run, tmp_path / "z.npz", "--seed", 99)[0] == 0
    one, same, other = (read(tmp_path / name).positions for name in ("x.npz", "y.npz", "z.npz"))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--prompt", ""], "prompt is empty"),
        (["--seconds", "soon"], "invalid float"),
        (["--steps", "0"], "steps"),
        (["--samples", "0"], "sample"),
        (["--guidance", "inf"], "uidance"),
        (["--sampler", "magic"], "sampler"),
        (["--model", "magic"], "model"),
        (["--out", "duet"], "cannot be written"),
        (["--colour", "red"], "see `python -m webdemo"),
    ],
)
def test_bad_values_are_one_line_and_leave_no_file(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert says.lower() in refused(generate(run, tmp_path / "duet.npz", *words)).lower()
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_one_line_and_leaves_no_file(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, data: bytes) -> int:
        path.open("wb").write(data[:10])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    assert "the disk is full" in refused(generate(run, tmp_path / "duet.bvh"))
    assert list(tmp_path.iterdir()) == []


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


def test_mistakes_in_a_story_are_one_line(run: Run, tmp_path: Path) -> None:
    story, out = tmp_path / "story.toml", tmp_path / "x.npz"
    assert "Give a story" in refused(run("scene", "--out", out))
    assert "cannot be read" in refused(run("scene", story, "--out", out))
    story.write_text(STORY.replace("seconds = 1", "secnods = 1", 1))
    assert "Line 3: there is no key 'secnods'" in refused(run("scene", story, "--out", out))
    story.write_text(STORY)
    assert "suffix" in refused(run("scene", story, "--out", tmp_path / "x.txt"))
    assert not out.exists()


@pytest.mark.parametrize("suffix", [".npz", ".bvh"])
def test_render_draws_what_generate_wrote(run: Run, tmp_path: Path, suffix: str) -> None:
    files = answer(generate(run, tmp_path / f"duet{suffix}")[1])["files"]
    code, said, _ = run("render", files[0], "--out", tmp_path / "sheet.png", "--frames", 4)
    assert code == 0
    printed = answer(said)
    assert printed["files"] == [str(tmp_path / "sheet.png")]
    assert printed["frames"] == 30
    with Image.open(tmp_path / "sheet.png") as picture:
        picture.load()
        assert picture.format == "PNG"
        assert picture.width == 1600
        assert len(picture.getcolors(1 << 20)) > 10


def test_render_refuses_in_one_line(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motion = answer(generate(run, tmp_path / "duet.npz")[1])["files"][0]
    assert "1 to 24" in refused(run("render", motion, "--frames", 25))
    assert "frames 0 to 29" in refused(run("render", motion, "--frames", "0,30"))
    assert "such as 0,30,75" in refused(run("render", motion, "--frames", "all"))
    assert "ends in .mp4" in refused(run("render", motion, "--out", tmp_path / "sheet.jpg"))
    assert "such as 1280x720" in refused(run("render", motion, "--out", tmp_path / "x.gif", "--size", "wide"))
    assert "are even" in refused(run("render", motion, "--out", tmp_path / "x.gif", "--size", "641x360"))
    assert "cannot be read" in refused(run("render", tmp_path / "none.npz"))
    (tmp_path / "broken.npz").write_bytes(b"PK no motion")
    refused(run("render", tmp_path / "broken.npz"))

    def full(picture: Image.Image, path: Path, **_: Any) -> None:
        path.write_bytes(b"half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Image.Image, "save", full)
    assert "the disk is full" in refused(run("render", motion))
    assert {path.name for path in tmp_path.iterdir()} == {"duet.npz", "broken.npz"}


def test_info_tells_the_model_and_the_formats(run: Run) -> None:
    code, said, _ = run("info")
    assert code == 0
    printed = answer(said)
    assert printed["model"]["summary"] == "a tiny untrained model"
    assert printed["weights"] == ["intergen"]
    assert printed["formats"][".npz"] == {"read": True, "write": True}
    assert printed["versions"]["torch"]


def test_benchmark_reports_figures(run: Run, weights: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in (*methods.WEIGHTS.iterdir(), weights / "intergen"):  # the tiny InterGen among the shipped others
        (tmp_path / folder.name).unlink(missing_ok=True)
        (tmp_path / folder.name).symlink_to(folder)
    monkeypatch.setattr(engine, "Engine", partial(engine.Engine.func, tmp_path))
    code, said, _ = run("benchmark", "--seconds", 1, "--steps", 2, "--repeats", 1)
    assert code == 0
    printed = answer(said)
    assert printed["frames"] == 30
    assert printed["request_seconds"] > 0
    for figure in ("class_over_sentence", "predict_ms_motion-mlp", "reaction_frame_ms"):
        assert printed[figure] > 0


def test_app_takes_the_options_of_serve(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_PORT", "8001")
    assert app.main(["--print-settings", "--port", "8002"]) == 0
    assert "port = 8002" in capsys.readouterr().out
    assert app.main(["--port", "many"]) == 2
    assert "invalid int value: 'many'" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="0"):
        app.main(["--help"])


@pytest.mark.parametrize("place", ["webdemo.cli.service.info", "builtins.print"])
def test_a_reader_who_has_gone_is_no_traceback(run: Run, monkeypatch: pytest.MonkeyPatch, place: str) -> None:
    def gone(*_: Any, **__: Any) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(place, gone)
    assert run("info") == (141, "", "")


def test_the_shell_starts_without_what_only_some_jobs_need() -> None:
    heavy = {"torch", "gradio", "scipy.ndimage", "scipy.interpolate", "scipy.linalg", "scipy.spatial"}
    code = f"import sys, webdemo.cli; sys.exit(', '.join({heavy!r} & set(sys.modules)) or 0)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"loaded: {done.stderr}"
