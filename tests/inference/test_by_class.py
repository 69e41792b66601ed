"""Two people from a class, as from a sentence: the same request, the same promises."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from models.bigraphdiff.compact import CompactBiGraphDiff, CompactBiGraphDiffConfig
from models.motion_tokens import encode
from models.weights_io import save_network
from motion import SMPL22, InputError
from motion.formats import read
from webdemo import cli
from webdemo.inference import GenerateRequest, Result
from webdemo.inference.engine import Engine
from webdemo.inference.method import WEIGHTS

LABELS = ("shake hands", "wave to each other")
QUICK = {"model": "bigraphdiff", "seconds": 1.5, "steps": 3, "guidance": 2.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.manual_seed(0)
    model = CompactBiGraphDiff(
        CompactBiGraphDiffConfig(
            LABELS,
            ((("right_wrist", "right_wrist"),), ()),
            latent_dim=32,
            ff_size=32,
            num_layers=2,
            num_heads=2,
            embed_dim=32,
            cond_dim=16,
        )
    )
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.05)
    rest = torch.tensor(SMPL22.rest_positions()).float() + torch.tensor([0.0, 0.98, 0.0])
    frames = model.layout.num_frames(4)
    control = encode(rest.expand(frames, -1, -1), torch.ones(frames, 4), model.layout)
    model.mean.copy_(control.mean(0))
    model.std.fill_(0.1)
    made = tmp_path_factory.mktemp("classes")
    save_network(made / "bigraphdiff", model, card={"summary": "a tiny untrained model"})
    return made


@pytest.fixture(scope="module")
def engine(folder: Path) -> Engine:
    return Engine(folder)


def result(engine: Engine, label: str = "shake hands", **asked: object) -> Result:
    (found,) = (e for e in engine.run(GenerateRequest(prompt=label, **{**QUICK, **asked})) if isinstance(e, Result))
    return found


def test_the_same_request_gives_the_same_bytes_and_names_may_be_written_otherwise(engine: Engine) -> None:
    one, other = result(engine), result(engine, "  Shake  HANDS ")
    assert one.duets[0].positions.tobytes() == other.duets[0].positions.tobytes()
    waved = result(engine, "wave to each other")
    assert not np.allclose(one.duets[0].positions, waved.duets[0].positions, atol=1e-4)


def test_no_damping_is_the_plain_sampler_and_more_lets_hands_meet(engine: Engine) -> None:
    plain, damped = (result(engine, damping=d, cleanup=False) for d in (0.0, 1.0))
    wrist = SMPL22.index("right_wrist")

    def nearest(found: Result) -> float:
        a, b = (person.positions[:, wrist] for person in found.duets[0].people)
        return float(np.linalg.norm(a - b, axis=-1).min())

    assert plain.readouts[0]["before"] == plain.readouts[0]["after"]
    asked = 0.08  # metres between two wrists that meet
    assert abs(nearest(damped) - asked) < 0.6 * abs(nearest(plain) - asked)


def test_a_class_that_is_not_known_is_answered_with_those_that_are(engine: Engine) -> None:
    with pytest.raises(InputError, match="no class 'juggle': choose one of: shake hands; wave to each other"):
        result(engine, "juggle")


def test_the_shell_takes_a_class(
    engine: Engine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("webdemo.inference.engine.Engine", lambda: engine)
    words = ["generate", "--class", "shake hands", "--seconds", "1", "--steps", "2", "--out"]
    assert cli.main([*words, str(tmp_path / "hands.npz")]) == 0
    assert read(tmp_path / "hands.npz").num_frames == 30
    capsys.readouterr()
    assert cli.main([*words, str(tmp_path / "both.npz"), "--prompt", "They wave."]) == 2
    assert "not allowed with" in capsys.readouterr().err


def test_the_shipped_classes_shake_hands() -> None:
    """Hands meet, in front of two people who stand as far apart as people do who shake hands."""
    found = result(Engine(WEIGHTS), seconds=4.0, steps=20)
    a, b = (person.positions for person in found.duets[0].people)
    apart = np.linalg.norm(a[:, SMPL22.index("right_wrist")] - b[:, SMPL22.index("right_wrist")], axis=-1)
    assert apart.min() < 0.15
    assert 0.4 < np.linalg.norm((a - b)[apart.argmin(), 0]) < 1.3
