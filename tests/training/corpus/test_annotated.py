"""Files of InterHuman, Inter-X and HumanML3D become a corpus, on which the trainer runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.metrics.sentences import load_sentences
from motion.transforms import canonicalize
from tests.motion.bodies import marching
from tests.training.trainers.runs import SETTINGS, SIZES, flags
from training import prepare
from training.corpus import annotated
from training.trainers import intergen

POSITIONS, _ = marching(60)
OTHER = POSITIONS * [-1, 1, -1] + np.array([0.0, 0.0, 1.5])


def frames_of(positions: np.ndarray) -> np.ndarray:
    """(T, 492), Z up, with noise in the columns that hold fingers and rotations."""
    found = np.random.default_rng(0).normal(size=(len(positions), 492)).astype(np.float32)
    found[:, :66] = (positions[..., [0, 2, 1]] * [1, -1, 1]).reshape(-1, 66)
    return found


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("InterHuman")
    for person, positions in (("person1", POSITIONS), ("person2", OTHER)):
        (folder / "motions_processed" / person).mkdir(parents=True)
        np.save(folder / "motions_processed" / person / "7.npy", frames_of(positions))
    (folder / "annots").mkdir()
    kept_out = load_sentences()[0].words  # by which networks are judged
    said = f"Two people march.\n\n{kept_out}\nThey walk in step.\nBoth lift their knees.\n"
    (folder / "annots" / "7.txt").write_text(said)
    return folder


@pytest.fixture(scope="module")
def corpus(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("corpus")
    assert annotated.main(["--data", str(data), "--out", str(out)]) == 0
    return out


def test_a_motion_keeps_its_people_and_its_sentences(corpus: Path) -> None:
    motions, (row,) = prepare.load_corpus(corpus)
    assert row["captions"] == ["Two people march.", "They walk in step.", "Both lift their knees."]
    assert row["split"] == "train" and row["sources"] == ["interhuman/7"] and row["frames"] == 60
    wanted = canonicalize(np.stack([POSITIONS, OTHER]))
    np.testing.assert_allclose(np.asarray(motions).swapaxes(0, 1), wanted, atol=0.002)


def test_the_trainer_of_our_own_corpus_runs_on_it(corpus: Path, tmp_path: Path) -> None:
    scenes = tmp_path / "scenes.safetensors"
    assert prepare.main(["--corpus", str(corpus), "--out", str(scenes)]) == 0
    sizes = flags(replace(SETTINGS, batch=1, steps=10), *SIZES, "steps")
    assert intergen.main(["--scenes", str(scenes), "--out", str(tmp_path / "run"), *sizes]) == 0
    assert '"step": 10' in (tmp_path / "run" / "log.jsonl").read_text()
    words = ["--scenes", str(scenes), "--out", str(tmp_path / "other"), "--export", str(tmp_path / "made")]
    assert intergen.main([*words, *sizes]) == 2 and not (tmp_path / "other").exists(), "there is no test split"


def test_lists_give_the_split_and_what_is_damaged_is_left_out(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import shutil

    shutil.copytree(data, tmp_path / "copy")
    (tmp_path / "copy" / "split").mkdir()
    (tmp_path / "copy" / "split" / "test.txt").write_text("7\n")
    np.save(tmp_path / "copy" / "motions_processed" / "person1" / "8.npy", np.full((40, 492), np.nan))
    (scene,) = annotated.read_annotated(tmp_path / "copy")
    assert scene.split == "test" and "8.npy" in capsys.readouterr().err


def test_another_folder_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert annotated.main(["--data", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "person1" in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_inter_x_is_read_by_its_parameters_and_the_actor_comes_first(tmp_path: Path) -> None:
    (tmp_path / "texts").mkdir()
    for name in ("G001", "G002"):
        (tmp_path / "motions" / name).mkdir(parents=True)
        (tmp_path / "texts" / f"{name}.txt").write_text("Two people stand.\n")
        for person, place in (("P1", 0.0), ("P2", 1.0)):
            np.savez(
                tmp_path / "motions" / name / f"{person}.npz",
                root_orient=np.zeros((60, 3), np.float32),
                pose_body=np.zeros((60, 63), np.float32),
                trans=np.tile(np.float32([place, 0.0, 2.0 * place]), (60, 1)),
                mocap_frame_rate=np.float32(30.0),
            )
    (tmp_path / "second.txt").write_text("G002\n")
    words = ["--data", str(tmp_path), "--out", str(tmp_path / "corpus")]
    assert annotated.main([*words, "--second-acts", str(tmp_path / "second.txt")]) == 0
    motions, rows = prepare.load_corpus(tmp_path / "corpus")
    assert [row["sources"] for row in rows] == [["interx/G001"], ["interx/G002"]]
    gaps = [np.asarray(motions[row["start"], 1, 0] - motions[row["start"], 0, 0]) for row in rows]
    np.testing.assert_allclose(gaps[0][[0, 2]], -gaps[1][[0, 2]], atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(gaps[0][[0, 2]]), 5**0.5, atol=0.05)


def test_single_people_of_humanml3d_do_what_their_sentences_say_and_keep_apart(tmp_path: Path) -> None:
    (tmp_path / "new_joint_vecs").mkdir()
    (tmp_path / "texts").mkdir()
    for name, speed in (("000001", 0.06), ("000002", 0.0)):  # one walks 3.6 m ahead, one stands
        features = np.zeros((60, 263))
        features[:, 2], features[:, 3] = speed, POSITIONS[0, 0, 1]
        features[:, 4:67] = (POSITIONS[0, 1:] - POSITIONS[0, 0] * [1, 0, 1]).reshape(-1)
        np.save(tmp_path / "new_joint_vecs" / f"{name}.npy", features)
    whole = "#a/DET person/NOUN#0.0#0.0\n"
    (tmp_path / "texts" / "000001.txt").write_text(
        f"a person walks ahead.{whole}arms swing{whole}a man nods#-#1.0#2.0\n"
    )
    (tmp_path / "texts" / "000002.txt").write_text(f"Someone stands{whole}")
    assert annotated.main(["--data", str(tmp_path), "--out", str(tmp_path / "corpus")]) == 0
    motions, rows = prepare.load_corpus(tmp_path / "corpus")
    assert sorted(row["captions"] for row in rows) == [
        ["person A stands, and person B walks ahead"],
        ["person A walks ahead, and person B stands"],
    ]
    assert sorted(row["alone"][0] for row in rows) == [["person A stands"], ["person A walks ahead"]]
    for row in rows:
        places = np.asarray(motions[row["start"] : row["start"] + row["frames"], :, 0])[..., [0, 2]]
        assert np.linalg.norm(places[:, 0] - places[:, 1], axis=-1).min() > 0.75
        assert sorted(np.linalg.norm(places[-1] - places[0], axis=-1) > 3.0) == [False, True]
