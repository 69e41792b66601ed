"""The contrastive extractor and its measures, on duets that differ in how they sway."""

from pathlib import Path

import numpy as np
import pytest
import torch

from models.motion_tokens import TokenLayout, encode, foot_contacts
from motion import SMPL22, InputError
from training.evaluate import captions, extractor
from training.evaluate.captions import draw, real_duet
from training.evaluate.extractor import Settings, contrast, fit, load_extractor
from training.prepare import Scenes, save
from webdemo.inference import Engine

SETTINGS = Settings(
    width=32, num_layers=1, num_heads=2, features=16, batch=16, steps=100, learning_rate=2e-3, dropout=0.0
)
KINDS = {"One person jumps.": 1, "They shake hands.": 0, "Somebody dances wildly.": 2, "Two people walk.": -1}


@pytest.fixture(scope="module")
def scenes() -> Scenes:
    torch.set_num_threads(1)
    layout, rng = TokenLayout(), np.random.default_rng(0)
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    frames = layout.num_frames(6)
    parts, rows, start = [], [], 0
    for i in range(48):
        caption = list(KINDS)[i % 4]
        sway = 0.3 * np.sin(np.arange(frames) / 4)[:, None, None] * np.eye(3)[KINDS[caption]]
        a = rest + (KINDS[caption] >= 0) * sway + rng.normal(0, 0.005, (1, 22, 3))
        pair = torch.tensor(np.stack([a, a + np.array([0, 0, 1.2])]), dtype=torch.float32)
        parts.append(encode(pair, foot_contacts(pair), layout).transpose(0, 1).half())
        rows.append(
            {"start": start, "tokens": 6, "family": f"kind {i % 4}", "captions": [caption], "events": {}}
            | {"split": "test" if i < 16 else "train", "sources": []}
        )
        start += 12
    return Scenes(torch.cat(parts), rows, layout)


@pytest.fixture(scope="module")
def trained(scenes: Scenes, tmp_path_factory: pytest.TempPathFactory) -> extractor.Extractor:
    return fit(scenes, SETTINGS, tmp_path_factory.mktemp("cache"))


def test_contrast_is_least_where_pairs_match() -> None:
    rows = torch.eye(4)
    apart = torch.zeros(4, 4, dtype=torch.bool)
    matched = contrast(rows, rows, torch.tensor(0.1), apart)
    assert matched < 0.01 < contrast(rows, rows.roll(1, 0), torch.tensor(0.1), apart)
    # The same caption twice in a batch is no mistake.
    twice = torch.tensor([[1.0, 0], [1, 0], [0, 1]])
    same = twice @ twice.T > 0.5
    assert contrast(twice, twice, torch.tensor(0.1), same) < 0.01


def test_duets_lie_near_their_sentences(scenes: Scenes, trained: extractor.Extractor) -> None:
    features = captions.Features(trained)
    rows = scenes.split("test")
    motion = features.motion([real_duet(scenes, row) for row in rows])
    np.testing.assert_allclose(np.linalg.norm(motion, axis=1), 1, atol=1e-5)
    text = features.text(list(KINDS))
    nearest = np.linalg.norm(motion[:, None] - text[None], axis=-1).argmin(1)
    assert np.mean([list(KINDS)[i] == row["captions"][0] for i, row in zip(nearest, rows, strict=True)]) > 0.7


def test_saved_and_read_again(trained: extractor.Extractor, scenes: Scenes, tmp_path: Path) -> None:
    path = tmp_path / "extractor.safetensors"
    extractor.save(trained, path)
    again = load_extractor(path)
    duet = torch.from_numpy(real_duet(scenes, scenes.rows[0]).positions)
    assert torch.equal(again.of_positions(duet), trained.of_positions(duet))
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError, match=r"run `python -m training\.evaluate\.extractor`"):
        load_extractor(path)


def test_measures_of_recorded_and_of_wrong_motion(
    scenes: Scenes, trained: extractor.Extractor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(captions, "POOL", 4)
    real = {row["captions"][0]: real_duet(scenes, row) for row in scenes.rows}

    def same(tasks, seed):
        return [real[caption] for caption, _ in tasks]

    def still(tasks, seed):
        return [real["Two people walk."] for _ in tasks]

    good = captions.measure(scenes, trained, same, repeats=2, many=2, samples=2)
    bad = captions.measure(scenes, trained, still, repeats=2, many=2, samples=2)
    assert good["generated"]["FID"][0] < 0.3 * bad["generated"]["FID"][0]
    assert good["generated"]["MM distance"][0] < bad["generated"]["MM distance"][0]
    assert good["generated"]["multimodality"] == [0.0, 0.0]
    assert good["real"]["top 3"][0] > bad["generated"]["top 3"][0]
    shown = captions.table(good)
    assert "| FID |" in shown and "| multimodality | 0.000 | – |" in shown


def test_too_few_test_scenes(scenes: Scenes, trained: extractor.Extractor) -> None:
    with pytest.raises(InputError, match="16 test scenes are fewer than the 32"):
        captions.measure(scenes, trained, lambda tasks, seed: [])


def test_command(scenes: Scenes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(scenes, tmp_path / "scenes.safetensors")
    words = ["--scenes", str(tmp_path / "scenes.safetensors"), "--out", str(tmp_path / "e.safetensors")]
    assert extractor.main([*words, "--steps", "2", "--batch", "8"]) == 0
    assert isinstance(load_extractor(tmp_path / "e.safetensors"), extractor.Extractor)
    assert extractor.main(["--scenes", str(tmp_path / "none"), *words[2:]]) != 0
    assert "python -m training.prepare" in "".join(capsys.readouterr())


def test_the_network_alone_makes_a_caption_in_whole_seconds_and_each_by_its_own_seed() -> None:
    tasks = [("Two people hug.", 62), ("Two people hug.", 58)]
    engine = Engine()
    first, second = draw(engine, tasks, 5, steps=2)
    assert first.num_frames == second.num_frames == 60
    assert np.abs(first.positions - second.positions).max() > 1e-3
    (alone,) = draw(engine, tasks[1:], 6, steps=2)
    np.testing.assert_allclose(alone.positions, second.positions, atol=1e-4)
