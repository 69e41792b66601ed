"""Acts of folders beside the lexicon, for every reader; what is wrong in them is said with file and line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from acts import lexicon, read
from motion import InputError

OLLIE = '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]\n'
BOW = '[bow]\nframes = ["{a} bow"]\ncaption = ["{a} [bow]"]\nreads = ["Two people bow."]\n'


def folder_of(path: Path, **files: str) -> Path:
    path.mkdir(exist_ok=True)
    for name, text in files.items():
        (path / f"{name}.toml").write_text(text)
    return path


def acts_of(text: str) -> list[str]:
    return [act.act for act in read(text).acts]


def test_folders_of_the_environment_count_for_every_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert acts_of("She ollies.") == [] and not lexicon().own
    first, second = folder_of(tmp_path / "one", own=OLLIE), folder_of(tmp_path / "two", more=BOW)
    monkeypatch.setenv("PASDEDEUX_ACTS", f"{first}{os.pathsep}{second}")
    assert acts_of("She ollies.") == ["ollie"]
    assert lexicon().own == {"ollie", "bow"}
    assert lexicon().entries["bow"].reads == ("Two people bow.",), "a lab's entry replaces ours"


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"a": "[x\n"}, "a.toml is not TOML.*line 1"),
        ({"b": OLLIE + '\n[zig]\nframes = ["he zigs"]\n'}, r"b.toml, line 6, \[zig\]: "),
        ({"c": "[Zag]\n"}, r"c.toml, line 1, \[Zag\]: a name has at most 60 small letters"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_line(
    files: dict[str, str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PASDEDEUX_ACTS", str(folder_of(tmp_path / "own", **files)))
    with pytest.raises(InputError, match=said):
        read("She ollies.")


def test_a_folder_that_is_missing_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_ACTS", str(tmp_path / "nowhere"))
    with pytest.raises(InputError, match="is not a folder of acts"):
        lexicon()
