"""Corpus → tensors → checkpoint → shipped folder, on a corpus that takes a moment to make."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from safetensors import SafetensorError
from safetensors.torch import load_file

from models.intergen.compact import load_folder
from models.motion_tokens import decode
from motion import SMPL22, InputError
from training import export, prepare
from training.core import checkpoint
from training.core.text_features import CaptionFeatures
from training.trainers import intergen
from training.trainers.given import Shares
from training.trainers.intergen import Trainer
from training.trainers.intergen_data import LEAST, SENTENCES, Settings
from training.trainers.reading import UNKNOWN
from webdemo.inference import GenerateRequest, Result
from webdemo.inference.engine import Engine

SETTINGS = Settings(
    latent_dim=32, ff_size=32, num_layers=2, num_heads=2, cond_dim=64, batch=4, steps=6, warmup=2, dropout=0.1
)
SIZES = [
    word
    for name in ("latent_dim", "ff_size", "num_layers", "num_heads", "cond_dim", "batch", "warmup", "dropout")
    for word in ("--" + name.replace("_", "-"), str(getattr(SETTINGS, name)))
]
HANDS_MEET = [{"a": "right_wrist", "b": "right_wrist", "start": 10, "end": 20}]


def write_corpus(folder: Path, scenes: int = 10) -> Path:
    """Two people who sway, for one to two seconds a scene."""
    rng = np.random.default_rng(0)
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    motions, index, start = [], [], 0
    for i in range(scenes):
        frames = int(rng.integers(40, 60))
        time = np.arange(frames) / 30
        a = rest + 0.05 * np.sin(rng.uniform(2, 6) * time)[:, None, None] * rng.normal(size=(1, 22, 3))
        b = np.broadcast_to(rest * [-1, 1, -1] + [0, 0, 1.5], a.shape)
        motions.append(np.stack([a, b], axis=1))
        captions = ["They shake hands." if i % 2 else "One person waves the left hand."] * 2
        split = "test" if i == 0 else "train"
        index.append(
            {"start": start, "frames": frames, "family": "sway", "captions": captions, "split": split}
            | {"events": {"contact": HANDS_MEET} if i % 2 else {}, "sources": []}
        )
        start += frames
    folder.mkdir()
    np.save(folder / "motions.npy", np.concatenate(motions).astype(np.float32))
    (folder / "index.json").write_text(json.dumps(index))
    return folder


@pytest.fixture(scope="module", autouse=True)
def one_thread() -> None:
    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    out = folder / "scenes.safetensors"
    assert prepare.main(["--corpus", str(write_corpus(folder / "corpus")), "--out", str(out)]) == 0
    return out


def begin(scenes: Path, out: Path, settings: Settings = SETTINGS, **options: Path) -> Trainer:
    return Trainer(prepare.load(scenes), settings, out, **options)


def take(trainer: Trainer, steps: int) -> Trainer:
    """Takes some steps, as a run that is stopped then: saved where it stands."""
    for _ in range(steps):
        trainer.train_step()
    trainer.save()
    return trainer


@pytest.fixture(scope="module")
def trained(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of six steps, made by the command."""
    out = tmp_path_factory.mktemp("run")
    assert intergen.main(["--scenes", str(scenes), "--out", str(out), *SIZES, "--steps", "6"]) == 0
    return out


def test_a_run_that_stops_goes_on_as_if_it_never_had(scenes: Path, trained: Path, tmp_path: Path) -> None:
    assert take(begin(scenes, tmp_path), 3).step == 3
    resumed = begin(scenes, tmp_path)
    assert resumed.step == 3
    assert len(list(resumed.run(minutes=10))) == 3
    straight, stopped = load_file(trained / "last.safetensors"), load_file(tmp_path / "last.safetensors")
    assert straight.keys() == stopped.keys()
    assert {key.split("/")[0] for key in straight} == {"model", "ema", "reader", "optimizer"}
    assert [key for key in straight if not torch.equal(straight[key], stopped[key])] == []
    half = begin(scenes, tmp_path / "half")
    assert any(not torch.equal(v, straight[f"model/{k}"]) for k, v in half.model.state_dict().items())


def test_checkpoint_of_other_settings_is_refused(scenes: Path, trained: Path) -> None:
    with pytest.raises(InputError, match="run of other settings"):
        begin(scenes, trained, replace(SETTINGS, learning_rate=1e-3))


@pytest.mark.parametrize(
    "damage", [lambda data: data[: len(data) // 2], lambda data: b"", lambda data: b"x" * 99]
)
def test_damaged_checkpoint_is_refused(
    scenes: Path, trained: Path, tmp_path: Path, damage: Callable[[bytes], bytes]
) -> None:
    whole = (trained / "last.safetensors").read_bytes()
    (tmp_path / "last.safetensors").write_bytes(damage(whole))
    with pytest.raises(InputError, match="missing or damaged"):
        begin(scenes, tmp_path)
    with pytest.raises(InputError, match="missing or damaged"):
        begin(scenes, tmp_path / "new", init=tmp_path / "last.safetensors")


def test_init_begins_with_the_averaged_weights_of_another_run(
    scenes: Path, trained: Path, tmp_path: Path
) -> None:
    other = load_file(trained / "last.safetensors")
    new = begin(scenes, tmp_path, replace(SETTINGS, learning_rate=1e-3), init=trained / "last.safetensors")
    assert new.step == 0
    for module in (new.model, new.ema):
        assert all(torch.equal(value, other[f"ema/{key}"]) for key, value in module.state_dict().items())
    with pytest.raises(InputError, match="other sizes"):
        begin(scenes, tmp_path / "b", replace(SETTINGS, latent_dim=64), init=trained / "last.safetensors")


def test_init_is_an_option_of_the_command(scenes: Path, trained: Path, tmp_path: Path) -> None:
    words = ["--scenes", str(scenes), "--out", str(tmp_path), "--init", str(trained / "last.safetensors")]
    assert intergen.main([*words, *SIZES, "--steps", "0"]) == 0
    begun, other = load_file(tmp_path / "last.safetensors"), load_file(trained / "last.safetensors")
    key = next(key for key in begun if key.startswith("model/denoiser"))
    assert torch.equal(begun[key], other[key.replace("model/", "ema/")])
    assert (tmp_path / "log.jsonl").exists()


def test_export_ships_what_the_engine_runs(scenes: Path, trained: Path, tmp_path: Path) -> None:
    card = tmp_path / "card.json"
    card.write_text(json.dumps({"summary": "a test"}))
    out = tmp_path / "weights" / "intergen"
    words = ["--run", str(trained), "--scenes", str(scenes), "--out", str(out), "--card", str(card)]
    assert export.main(words) == 0
    engine = Engine(out.parent)
    assert engine.info()["summary"] == "a test"
    *_, result = engine.run(GenerateRequest(prompt="They shake hands.", seconds=1.0, steps=2, damping=0.0))
    assert isinstance(result, Result)
    assert result.duets[0].positions.shape == (2, 30, 22, 3)
    assert np.isfinite(result.duets[0].positions).all()
    meta = json.loads((out / "config.json").read_text())
    assert meta["trained_steps"] == 6
    assert json.loads((out / "captions.json").read_text()) == [
        "One person waves the left hand.",
        "They shake hands.",
    ]


def test_a_scene_comes_back_from_its_control_points(scenes: Path) -> None:
    made, corpus = prepare.load(scenes), np.load(scenes.parent / "corpus" / "motions.npy")
    positions, _ = decode(made.scene(made.rows[0]), made.layout)
    error = np.abs(positions.numpy() - corpus[: positions.shape[1]].swapaxes(0, 1)).max()
    assert error < 0.005, f"{1000 * error:.1f} mm"


def corpus_without_scenes(folder: Path) -> None:
    write_corpus(folder)
    (folder / "index.json").write_text("[]")


def corpus_cut_short(folder: Path) -> None:
    write_corpus(folder)
    motions = np.load(folder / "motions.npy")
    np.save(folder / "motions.npy", motions[:50])


def corpus_of_one_person(folder: Path) -> None:
    write_corpus(folder)
    motions = np.load(folder / "motions.npy")
    np.save(folder / "motions.npy", motions[:, 0])


def corpus_with_a_broken_index(folder: Path) -> None:
    write_corpus(folder)
    (folder / "index.json").write_text('[{"start": 0,')


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda folder: None, "holds no readable corpus"),
        (corpus_without_scenes, "no scene of a second or more"),
        (corpus_cut_short, "more frames than there are"),
        (corpus_of_one_person, "another kind of data"),
        (corpus_with_a_broken_index, "holds no readable corpus"),
    ],
)
def test_bad_corpus_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], make: Callable[[Path], None], says: str
) -> None:
    make(tmp_path / "corpus")
    out = tmp_path / "scenes.safetensors"
    assert prepare.main(["--corpus", str(tmp_path / "corpus"), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--batch", "50"], "do not fill a batch of 50"),
        (["--batch", "0"], "batch is 0"),
        (["--num-heads", "5"], "give a multiple"),
        (["--scenes", "none.safetensors"], "no prepared scenes"),
        (["--init", "none.safetensors"], "missing or damaged"),
    ],
)
def test_bad_training_is_refused_in_one_line(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], says: str
) -> None:
    assert intergen.main(["--scenes", str(scenes), "--out", str(tmp_path), *SIZES, *words]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not (tmp_path / "last.safetensors").exists()


def test_a_full_disk_leaves_the_last_checkpoint(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--scenes", str(scenes), "--out", str(tmp_path), *SIZES, "--steps", "4"]
    assert intergen.main([*words, "--minutes", "0"]) == 0
    before = (tmp_path / "last.safetensors").read_bytes()

    def fill(tensors: object, path: Path, metadata: object) -> None:
        Path(path).write_bytes(b"half")
        raise SafetensorError("I/O error: No space left on device (os error 28)")

    monkeypatch.setattr(checkpoint, "save_file", fill)
    assert intergen.main(words) == 2
    assert "free disk space" in capsys.readouterr().err
    assert (tmp_path / "last.safetensors").read_bytes() == before
    assert not list(tmp_path.glob(".last*"))


def test_contact_sheets_are_written_as_it_goes(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.core.samples.PROMPTS", ("Two people wave.",))
    words = ["--scenes", str(scenes), "--out", str(tmp_path), *SIZES, "--steps", "2", "--sheets", "1e-9"]
    assert intergen.main(words) == 0
    sheets = sorted((tmp_path / "samples").iterdir())
    assert [sheet.name for sheet in sheets] == ["0000001.png", "0000002.png"]
    assert Image.open(sheets[0]).size[0] > 800


def test_a_shipped_network_can_be_trained_on(
    scenes: Path, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.trainers.touch.RARE", 1)
    out = tmp_path / "weights"
    assert export.main(["--run", str(trained), "--scenes", str(scenes), "--out", str(out)]) == 0
    shipped, _ = load_folder(out)
    assert shipped.touch_reader is not None
    ours = begin(scenes, tmp_path / "on", init=out).model.state_dict()
    theirs = shipped.state_dict()
    assert set(theirs) - set(ours) == {key for key in theirs if key.startswith("touch_reader.")}
    assert all(torch.equal(value, theirs[key]) for key, value in ours.items())


def with_sentences_for_each(scenes: Path, out: Path) -> Path:
    """The prepared scenes, each with sentences for a and for b alone; what is missing in the first is in the rest."""
    loaded = prepare.load(scenes)
    for i, row in enumerate(loaded.rows[1:]):
        a = ["They put out the right hand.", "They reach out."]
        row["alone"] = [a, ["They wait." if i % 2 else "They turn to the left."]]
    prepare.save(loaded, out)
    return out


def test_sentences_for_each_person_are_read_and_left_out(scenes: Path, tmp_path: Path) -> None:
    trainer = begin(with_sentences_for_each(scenes, tmp_path / "each.safetensors"), tmp_path)
    shares = {tuple(read): 0 for read in SENTENCES} | {(0, 0, 0): 0}
    for step in range(60):
        batch = trainer.data.batch(step)
        conditions, vectors = intergen.condition(trainer.model, batch)
        assert conditions.shape[:2] == (4, 3) and len(vectors) == 4
        # A sentence that is read has rows, and no other has.
        assert torch.equal((conditions != 0).any(-1).any(-1), batch.read.bool())
        for read in batch.read.bool().tolist():
            shares[tuple(read)] += 1
    assert all(shares.values()), shares
    assert shares[True, False, False] > shares[False, True, True] > shares[False, False, True]


def test_person_sentences_change_sides_with_the_mirror(scenes: Path, tmp_path: Path) -> None:
    path = with_sentences_for_each(scenes, tmp_path / "each.safetensors")
    data = begin(path, tmp_path, replace(SETTINGS, unconditional=0.0)).data
    seen = set()
    data.features = lambda captions: (seen.update(captions), CaptionFeatures.batch(data.captions, captions))[
        1
    ]
    for step in range(40):
        data.batch(step)
    assert {"They turn to the left.", "They turn to the right."} <= seen


def with_beats(scenes: Path, out: Path) -> Path:
    """The prepared scenes, each of three beats: an unnamed one in the middle is minor."""
    loaded = prepare.load(scenes)
    for row in loaded.rows:
        beat = {"start": 0, "end": 10, "captions": ["They wait."]}
        row["beats"] = [
            beat,
            beat | {"minor": True},
            beat | {"start": 12, "end": 40, "captions": ["They bow."]},
        ]
    prepare.save(loaded, out)
    return out


def test_a_later_beat_is_learned_with_what_came_before_it_given(scenes: Path, tmp_path: Path) -> None:
    path = with_beats(scenes, tmp_path / "beats.safetensors")
    given = Shares(person=0, past=0, span=0, poses=0, path=0, joints=0, more=0)
    trainer = begin(path, tmp_path, replace(SETTINGS, continued=0.5, unconditional=0.0, given=given))
    told, cut, data = [], 0, trainer.data

    def features(captions: list[str]) -> tuple[torch.Tensor, torch.Tensor]:
        told.extend(captions)
        return CaptionFeatures.batch(data.captions, captions)

    data.features = features
    for step in range(12):
        told.clear()
        batch = trainer.data.batch(step)
        known = trainer.known(batch, torch.Generator().manual_seed(0))
        for i, past in enumerate(batch.past.tolist()):
            if not past:
                assert told[i] != "They bow." and (batch.labels[i] >= 0).all()
                continue
            cut += 1
            assert told[i] == "They bow." and past == 12 and (batch.labels[i] == UNKNOWN).all()
            assert batch.frame_mask[i].sum() >= past + LEAST
            assert torch.equal(known.mask[i].any(-1).sum(-1), torch.tensor([past, past]))
            root = known.rows[i, 0, 0, :3]
            assert root[[0, 2]].abs().max() < 1e-4  # canonical again
            assert known.heading[i, 0, 0, 1] > 0.999
        assert np.isfinite(trainer.train_step()["total"])
    assert 12 < cut < 36


def test_a_beat_that_was_cut_off_is_left_out(scenes: Path, tmp_path: Path) -> None:
    data = begin(scenes, tmp_path, replace(SETTINGS, continued=1.0)).data
    row = data.rows[0] | {"beats": [{}, {"start": 300, "end": 320, "captions": ["They bow."]}]}
    assert data.continued(row, [0.0] * 4) is None
    row["beats"][1] |= {"start": 8, "end": 300}
    assert data.continued(row, [0.0] * 4)[1:] == (8, "They bow.")
    row["beats"][1]["captions"] = []
    assert data.continued(row, [0.0] * 4) is None


def test_grown_from_a_shipped_network_the_first_loss_is_the_same(
    scenes: Path, trained: Path, tmp_path: Path
) -> None:
    """A run without words is exported; one with words begun from it takes its first step from the same loss."""
    old = replace(SETTINGS, words=False, dropout=0.0, seed=3)
    take(begin(scenes, tmp_path / "old", old), 3)
    out = tmp_path / "weights"
    assert export.main(["--run", str(tmp_path / "old"), "--scenes", str(scenes), "--out", str(out)]) == 0
    first = []
    for words in (False, True):
        trainer = begin(scenes, tmp_path / str(words), replace(old, words=words), init=out)
        trainer.model.conditioner.eval()  # its own dropout would draw other numbers
        batch = trainer.data.batch(0)
        t, noise = torch.tensor([10, 300, 700, 990]), torch.randn_like(batch.x0)
        first.append((trainer, batch, t, noise))
    (old_run, batch, t, noise), (new_run, *_) = first
    known = old_run.known(batch, torch.Generator().manual_seed(2))
    assert known is not None
    for run in (old_run, new_run):
        run.model.eval()
    found = [
        {k: v.item() for k, v in run.terms(batch, t, noise, known).items()} for run in (old_run, new_run)
    ]
    assert found[1] == pytest.approx(found[0], rel=0.02)  # in bfloat16


def test_a_run_can_be_given_threads(scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(torch, "set_num_threads", asked.append)
    words = ["--scenes", str(scenes), "--out", str(tmp_path), *SIZES, "--steps", "0", "--threads", "1"]
    assert intergen.main(words) == 0
    assert asked == [1]


def test_export_without_a_run_is_refused_in_one_line(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "weights"
    assert export.main(["--run", str(tmp_path), "--scenes", str(scenes), "--out", str(out)]) == 2
    assert "missing or damaged" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("main", [prepare.main, intergen.main, export.main])
def test_help_is_told(main: Callable[[list[str]], int], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert "--out" in capsys.readouterr().out
