"""``python -m webdemo react`` as a shell meets it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import SMPL22, Clip, Duet, InputError
from motion.formats import ImportChoices, read, write
from tests.motion.bodies import marching, swaying
from tests.motion.formats.characters import glb_takes
from tests.motion.formats.rigs import RIGS, bvh_text
from webdemo import cli
from webdemo.cli import generation
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import Result


def standing(frames: int, x: float = 0.0) -> Clip:
    return Clip(swaying(frames, x), 30.0, SMPL22)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[ReactRequest]:
    """What the shell asks of the engine, whose answer is the actor and a copy beside it."""
    requests: list[ReactRequest] = []

    def run(request: ReactRequest) -> Result:
        requests.append(request)
        actor = request.actor
        other = actor.with_positions(actor.positions + np.float32([0, 0, 1.5]))
        duet = Duet(actor, other, ("actor", "reactor"))
        manifest = {"request": request.to_dict()}
        return Result(duets=(duet,) * request.samples, manifest=manifest)

    monkeypatch.setattr(generation, "run", run)
    return requests


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    """A file of two people, four seconds."""
    return write(Duet(standing(120), standing(120, x=2.0)), tmp_path / "pair.npz")[0]


def react(capsys: pytest.CaptureFixture[str], *words: Any) -> tuple[int, str, str]:
    code = cli.main(["react", *map(str, words)])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_one_person_of_a_file_is_trimmed_and_answered(
    pair: Path, tmp_path: Path, asked: list[ReactRequest], capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "answer.npz"
    words = ["--person", "b", "--start", 1, "--end", 3, "--prompt", "They bow.", "--model", "intergen", "--role", "b"]
    words += ["--mode", "offline", "--seed", 5, "--steps", 9, "--guidance", 3, "--damping", 0.5, "--no-cleanup"]
    code, said, _ = react(capsys, "--actor", pair, *words, "--out", out)
    assert code == 0
    answer = json.loads(said.splitlines()[-1])
    assert answer["files"] == [str(out)]
    request = answer["manifest"]["request"]
    told = {"prompt": "They bow.", "role": "b", "seed": 5, "steps": 9, "guidance": 3, "damping": 0.5}
    told |= {"cleanup": False, "mode": "offline", "model": "intergen"}
    assert request | told == request
    duet = read(out)
    assert duet.roles == ("actor", "reactor")
    np.testing.assert_array_equal(duet.a.positions, standing(120, x=2.0).positions[30:90])


def test_an_actor_is_as_long_as_the_method_takes(
    tmp_path: Path, asked: list[ReactRequest], capsys: pytest.CaptureFixture[str]
) -> None:
    write(Duet(standing(600), standing(600, x=2.0)), tmp_path / "long.npz")
    words = ("--actor", tmp_path / "long.npz", "--person", "a", "--out", tmp_path / "answer.npz")
    assert react(capsys, *words, "--model", "interformer")[0] == 0 and asked[0].actor.num_frames == 600
    assert react(capsys, *words, "--model", "intergen")[0] == 2 and len(asked) == 1


def test_a_model_comes_with_its_own_number_of_steps(
    pair: Path, tmp_path: Path, asked: list[ReactRequest], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--actor", pair, "--person", "a", "--out", tmp_path / "x.npz"]
    for more, expected in (
        ([], ("regennet", "offline", 5)),
        (["--prompt", "They wave."], ("intergen", "offline", 8)),
        (["--mode", "online"], ("regennet", "online", 5)),
        (["--model", "regennet"], ("regennet", "offline", 5)),
        (["--model", "regennet", "--mode", "online", "--steps", 7], ("regennet", "online", 7)),
    ):
        code, _, _ = react(capsys, *words, *more)
        assert code == 0
        assert (asked[-1].model, asked[-1].mode, asked[-1].steps) == expected


def test_the_other_person_of_a_file_says_where_to_begin(
    pair: Path, tmp_path: Path, asked: list[ReactRequest], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--actor", pair, "--person", "b", "--start", 1, "--keep-start", "--out", tmp_path / "x.npz"]
    code, said, _ = react(capsys, *words, "--model", "regennet")
    assert code == 0
    np.testing.assert_allclose(asked[-1].first_pose, standing(120).positions[30], atol=1e-5)
    assert json.loads(said.splitlines()[-1])["manifest"]["request"]["first_pose"] == asked[-1].first_pose.tolist()
    code, _, said = react(capsys, *words, "--model", "intergen")
    assert code == 2 and "InterGen takes no first pose" in said
    one = write(standing(120), tmp_path / "one.npz")[0]
    code, _, said = react(capsys, "--actor", one, "--keep-start", "--model", "regennet", "--out", words[-1])
    assert code == 2 and "does not hold two people" in said


def test_the_rate_and_the_upper_axis_of_a_file_can_be_told(
    tmp_path: Path, asked: list[ReactRequest], capsys: pytest.CaptureFixture[str]
) -> None:
    positions, rotations = marching(90)
    path = tmp_path / "slow.bvh"
    path.write_text(bvh_text(rotations, positions[:, 0], RIGS["mixamo"], frame_time=0.1))
    words = ["--actor", path, "--out", tmp_path / "x.npz"]
    for more, seconds, stands in (([], 9.0, True), (["--file-fps", 30], 3.0, True), (["--file-up", "z"], 9.0, False)):
        assert react(capsys, *words, *more)[0] == 0
        actor = asked[-1].actor
        assert actor.seconds == pytest.approx(seconds, abs=0.2)
        assert bool(actor.positions[:, SMPL22.index("head"), 1].min() > 1.3) is stands


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "holds two people: choose person a or b"),
        (["--person", "c"], "Person 'c' is not known: pair.npz has a or b"),
        (["--person", "a", "--end", "0.5"], "0.50 s: give 1 s or more"),
        (["--person", "a", "--start", "9"], "after the end of the motion"),
        (["--person", "a", "--model", "intergen", "--mode", "online"], "choose offline"),
        (["--person", "a", "--steps", "0"], "DDIM steps"),
        (["--actor", "none.bvh"], "cannot be read"),
        (["--actor", "none.mov"], "cannot be read: use"),
        (["--person", "a", "--out", "answer.xyz"], "cannot be written"),
    ],
)
def test_errors_are_one_line_and_write_nothing(
    pair: Path,
    tmp_path: Path,
    asked: list[ReactRequest],
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    says: str,
) -> None:
    before = set(tmp_path.iterdir())
    code, said, error = react(capsys, "--actor", pair, "--out", tmp_path / "answer.npz", *words)
    assert code == 2
    assert said == ""
    assert says in error
    assert error.count("\n") == 1
    assert set(tmp_path.iterdir()) == before
    assert asked == []


def test_other_commands_choose_an_animation_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    positions, rotations = marching(60)
    file = tmp_path / "takes.glb"
    file.write_bytes(glb_takes(rotations, positions[:, 0], ["walk", "glide"]))
    note = "Of the 2 animations in takes.glb, 2 (“glide”) was taken; the other is 1 (“walk”)."
    assert cli.main(["render", str(file), "--animation", "glide", "--frames", "2", "--width", "300"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["notes"] == [note]
    words = ["predict", "--past", str(file), "--animation", "2", "--model", "still", "--out", str(tmp_path / "p.npz")]
    requests: list[Any] = []

    def stop(request: Any) -> Any:
        requests.append(request)
        raise InputError("Stopped.")

    monkeypatch.setattr(generation, "run", stop)
    assert cli.main(words) == 2
    np.testing.assert_array_equal(
        requests[0].motion.positions, read(file, choices=ImportChoices(animation="glide")).positions
    )
    for wrong, says in (
        (["render", str(file), str(file), "--animation", "1"], "chooses within one file"),
        (["scene", "--prompt", "They bow.", "--animation", "1", "--out", str(tmp_path / "s.npz")], "give --motion"),
        (["scene", "--prompt", "They bow.", "--motion", str(file), "--animation", "9", "--out", words[-1]], "no such"),
    ):
        capsys.readouterr()
        assert cli.main(wrong) == 2 and says in capsys.readouterr().err
