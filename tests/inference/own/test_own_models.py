"""From a table of the settings to a motion: released files under their own names, and what is wrong with them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import torch

from motion import InputError
from motion.formats import read
from tests.inference.own.released_files import write_intergen
from tests.inference.runs import run
from webdemo import cli
from webdemo.inference import Engine, GenerateRequest, ReactRequest
from webdemo.inference.methods import failed, method, register_settings
from webdemo.inference.own import entries, released
from webdemo.inference.pipelines import intergen

TABLE = """
[models.my-run]
method = "intergen"
label = "InterGen, the authors'"
files = ["intergen.ckpt", "global_mean.npy", "global_std.npy", "bpe_simple_vocab_16e6.txt.gz"]
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("released")
    write_intergen(folder)
    return folder


@pytest.fixture
def settings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """The settings file in force; :func:`use` fills it."""
    path = tmp_path / "lab.toml"
    monkeypatch.setenv(entries.SETTINGS_VARIABLE, str(path))
    yield path
    path.unlink(missing_ok=True)
    register_settings()


def use(settings: Path, text: str, files: Path | None = None) -> None:
    """Takes tables as the settings, with copies of the released files beside them."""
    settings.write_text(text)
    for file in files.iterdir() if files is not None else ():
        if not (settings.parent / file.name).exists():
            (settings.parent / file.name).symlink_to(file)
    register_settings()


def why(name: str) -> str:
    """The one sentence or two on why a model cannot be used, in the shell's words as well."""
    sentence = failed()[name]
    with pytest.raises(InputError) as refused:
        GenerateRequest(prompt="Two people wave.", model=name)
    assert str(refused.value) == sentence and "\n" not in sentence
    return sentence


def test_released_files_become_a_motion_in_the_shell(
    settings: Path, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    use(settings, TABLE, files)
    found = method("my-run")
    assert found.label == "InterGen, the authors'" and "GB of memory" in found.summary
    out = tmp_path / "a.npz"
    words = ["--prompt", "Two people wave.", "--model", "my-run", "--seconds", "2", "--steps", "4"]
    assert cli.main(["generate", *words, "--out", str(out)]) == 0
    printed = capsys.readouterr()
    answer = json.loads(printed.out.splitlines()[-1])
    assert "262 numbers" in printed.err and any("cm on average" in note for note in answer["notes"])
    assert answer["manifest"]["model"] == "my-run" and len(answer["manifest"]["weights_sha256"]) == 64
    assert read(out).num_frames == 60

    # As a partner of a given person, who stays as they are.
    actor = read(out).a  # type: ignore[union-attr]
    request = ReactRequest(actor=actor, model="my-run", steps=4, role="b", prompt="They wave.")
    duet = run(Engine(), request).duets[0]
    assert np.array_equal(duet.b.positions, actor.positions)  # type: ignore[union-attr]
    assert any("section 5.4" in note for note in run(Engine(), request).notes)
    assert request.damping == 0.0


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ('method = "nothing"\nfiles = ["intergen.ckpt"]', "there is no method 'nothing': choose one of"),
        ('method = "intergen"', "`files` names no checkpoint file"),
        ('method = "intergen"\nfiles = ["gone.ckpt", "a_mean.npy", "a_std.npy"]', "There is no file"),
        ('method = "intergen"\nfiles = ["a.ckpt", "b.ckpt"]', "two files of one role"),
        ('method = "intergen"\nweights = "a"', "unknown key 'weights'"),
        ("", "give it either `method` with `files`, or `pipeline`"),
        ('method = "intergen"\nprecision = "int3"', "choose one of auto, float32, bfloat16"),
    ],
)
def test_a_wrong_table_fails_alone(settings: Path, files: Path, change: str, sentence: str) -> None:
    use(settings, f"{TABLE}\n[models.wrong]\n{change}\n", files)
    assert sentence in why("wrong")
    assert method("my-run").label == "InterGen, the authors'"


def damage(folder: Path, name: str, data: bytes | None) -> None:
    (folder / name).unlink()
    if data is None:
        with (folder / name).open("wb") as file:
            file.truncate(20 * 2**30)  # sparse: it takes no room
    else:
        (folder / name).write_bytes(data)


class Code:
    """What a hostile checkpoint holds: code that unpickling would run."""

    def __init__(self, marker: Path) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple[object, ...]:
        return os.mkdir, (str(self.marker),)


def test_a_damaged_checkpoint_gets_one_sentence(settings: Path, files: Path, tmp_path: Path) -> None:
    whole = (files / "intergen.ckpt").read_bytes()
    for data in (None, whole[: len(whole) // 2], b"", b"not a checkpoint"):
        use(settings, TABLE, files)
        damage(tmp_path, "intergen.ckpt", data)
        register_settings()
        assert "cannot be read as plain tensors" in why("my-run")
        (tmp_path / "intergen.ckpt").unlink()


def test_code_in_a_checkpoint_is_never_run(settings: Path, files: Path, tmp_path: Path) -> None:
    use(settings, TABLE, files)
    (tmp_path / "intergen.ckpt").unlink()
    state = torch.load(files / "intergen.ckpt", weights_only=True)
    torch.save(state | {"hyper_parameters": Code(tmp_path / "ran")}, tmp_path / "intergen.ckpt")
    register_settings()
    assert "holds code or other objects" in why("my-run")
    assert not (tmp_path / "ran").exists()


def test_another_networks_checkpoint_is_named(settings: Path, files: Path, tmp_path: Path) -> None:
    use(settings, TABLE, files)
    (tmp_path / "intergen.ckpt").unlink()
    torch.save({"net.weight": torch.zeros(2, 2)}, tmp_path / "intergen.ckpt")
    register_settings()
    assert "is not a checkpoint of InterGen: it has no decoder.net.blocks.* tensors" in why("my-run")


def test_a_model_that_does_not_fit_is_refused(settings: Path, files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    use(settings, TABLE, files)
    monkeypatch.setattr(released, "free_memory", lambda: 1e6)
    with pytest.raises(InputError, match=r"needs about .* GB of memory and 0\.0 GB are free"):
        run(Engine(), GenerateRequest(prompt="Two people wave.", model="my-run"))
    monkeypatch.setattr("webdemo.inference.own.released.total_memory", lambda: 1e6)
    register_settings()
    assert "choose a smaller model" in why("my-run")


def test_numbers_that_are_too_coarse_give_way_to_float32(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def compile_network(network: object, key: str, *, precision: str = "f32") -> bool:
        asked.append((key, precision))
        return precision == "f32"

    monkeypatch.setattr(intergen, "compile_network", compile_network)
    assert intergen.compiled_near(torch.nn.Identity(), "weights", "bf16")
    assert asked == [("weights bf16", "bf16"), ("weights f32", "f32")]
