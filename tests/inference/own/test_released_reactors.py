"""Released ReGenNet, InterFormer and BiGraphDiff: from a file under the released names to a motion."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from models.regennet.released import decode, encode
from motion import Clip, Duet, InputError
from motion.formats import read
from tests.inference.own.released_files import write_bigraphdiff, write_interformer, write_regennet, write_vocabulary
from tests.inference.runs import run
from webdemo.inference import Engine, GenerateRequest, ReactRequest
from webdemo.inference.methods import failed, method, register_settings, variants
from webdemo.inference.own import entries

ROOT = Path(__file__).resolve().parents[3]
TABLES = """
[models.online]
method = "regennet"
files = "online.pt"
label = "ReGenNet (authors)"

[models.whole]
method = "regennet"
files = ["whole.pt"]
labels = ["hug", "wave", "kick"]

[models.former]
method = "interformer"
files = ["former.pth"]

[models.graph]
method = "bigraphdiff"
files = ["graph.tar", "bpe_simple_vocab_16e6.txt.gz"]

[models.swapped]
method = "interformer"
files = ["online.pt"]
"""


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    folder = tmp_path_factory.mktemp("released")
    write_regennet(folder / "online.pt", online=True)
    write_regennet(folder / "whole.pt", online=False, actions=3)
    write_interformer(folder / "former.pth")
    write_bigraphdiff(folder / "graph.tar")
    write_vocabulary(folder)
    (folder / "lab.toml").write_text(TABLES)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(entries.SETTINGS_VARIABLE, str(folder / "lab.toml"))
        register_settings()
        yield Engine()
    register_settings()


@pytest.fixture(scope="module")
def actor() -> Clip:
    duet = read(ROOT / "static" / "examples" / "wave.npz")
    assert isinstance(duet, Duet)
    return duet.a.cut(0, 45)


def test_regennets_rotations_hold_a_motion(actor: Clip) -> None:
    numbers = encode(actor.positions.astype(np.float64))
    assert numbers.shape == (56, 6, 45)
    assert np.abs(decode(numbers) - actor.positions).max() < 2e-3


def test_regennet_reacts_whole_and_frame_by_frame(engine: Engine, actor: Clip) -> None:
    assert [v.label for v in variants("react").values() if v.method.name == "online"] == [
        "ReGenNet (authors), whole motion",
        "ReGenNet (authors), frame by frame",
    ]
    whole = run(engine, ReactRequest(actor=actor, model="online", steps=2))
    live = run(engine, ReactRequest(actor=actor, model="online", steps=2, mode="online", cleanup=False))
    plain = run(engine, ReactRequest(actor=actor, model="online", steps=2, cleanup=False))
    assert np.array_equal(whole.duets[0].a.positions, actor.positions)  # type: ignore[union-attr]
    assert np.abs(live.duets[0].b.positions - plain.duets[0].b.positions).max() < 1e-3  # type: ignore[union-attr]
    assert "SMPL-X" in whole.notes[0]


def test_regennets_actions_are_words(engine: Engine, actor: Clip) -> None:
    assert "words" in method("whole").takes

    def answer(prompt: str, guidance: float = 1.0) -> np.ndarray:
        request = ReactRequest(actor=actor, model="whole", steps=2, prompt=prompt, guidance=guidance)
        return run(engine, request).duets[0].positions

    assert np.array_equal(answer("Wave"), answer("1")) and not np.array_equal(answer("wave"), answer("kick"))
    assert not np.array_equal(answer("wave"), answer("wave", guidance=3.0))
    with pytest.raises(InputError, match="choose one of: hug; wave; kick"):
        answer("dance")


def test_interformer_answers_pose_after_pose(engine: Engine, actor: Clip) -> None:
    result = run(engine, ReactRequest(actor=actor, model="former", samples=2))
    assert len(result.duets) == 2 and result.duets[0].num_frames == 45
    for said in ("network saw 15", "all samples"):
        assert any(said in note for note in result.notes)
    long = Clip(np.concatenate([actor.positions] * 3), actor.fps)  # longer than the table of positions
    assert run(engine, ReactRequest(actor=long, model="former")).duets[0].num_frames == 135


def test_bigraphdiff_makes_two_people_from_words(engine: Engine) -> None:
    request = GenerateRequest(prompt="two wave", model="graph", seconds=1.5, steps=4)
    result = run(engine, request)
    duet = result.duets[0]
    assert isinstance(duet, Duet) and duet.positions.shape == (2, 45, 22, 3)
    assert any("25 joints" in note and "cm from the network" in note for note in result.notes)
    other = run(engine, GenerateRequest(prompt="peo", model="graph", seconds=1.5, steps=4)).duets[0]
    assert isinstance(other, Duet) and not np.array_equal(duet.positions, other.positions)
    with pytest.raises(InputError, match="at most 3 seconds"):
        run(engine, GenerateRequest(prompt="two wave", model="graph", seconds=4, steps=4))


def test_a_checkpoint_of_another_network_is_named(engine: Engine) -> None:
    assert "online.pt is not a checkpoint of InterFormer: it is ReGenNet's." in failed()["swapped"]
