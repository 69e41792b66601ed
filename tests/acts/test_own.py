"""A lab's own acts: folders of the settings, for every reader, with what is wrong left out and said."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from acts import config, lexicon, read
from acts.config import acts_folders, look_again, own_files
from acts.lexicon import look_at_own_acts
from motion import InputError

OLLIE = '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]\n'


@pytest.fixture(autouse=True)
def no_folders(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.delenv("PASDEDEUX_ACTS", raising=False)
    monkeypatch.delenv("PASDEDEUX_SETTINGS", raising=False)
    monkeypatch.setattr(config, "LOOK_EVERY", 0.0)
    yield
    monkeypatch.undo()
    look_again()


def acts_of(text: str) -> list[str]:
    return [act.act for act in read(text).acts]


def folder_of(path: Path, **files: str) -> Path:
    path.mkdir(exist_ok=True)
    for name, text in files.items():
        (path / f"{name}.toml").write_text(text)
    return path


def test_folders_of_the_environment_count_for_every_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert acts_of("She ollies.") == [] and lexicon().own == ()
    first, second = folder_of(tmp_path / "one", own=OLLIE), folder_of(tmp_path / "two", more=_bow("Two"))
    monkeypatch.setenv("PASDEDEUX_ACTS", f"{first}{os.pathsep}{second}")
    assert acts_of("She ollies.") == ["ollie"]
    assert lexicon().own == ("ollie", "bow") and lexicon().problems == ()
    assert lexicon().entries["bow"].reads == ("Two people bow.",), "a lab's entry replaces ours"
    monkeypatch.setenv("PASDEDEUX_ACTS", f'["{second}"]')
    assert lexicon().own == ("bow",) and acts_of("She ollies.") == []


def _bow(who: str) -> str:
    return f'[bow]\nframes = ["{{a}} bow"]\ncaption = ["{{a}} [bow]"]\nreads = ["{who} people bow."]\n'


def test_folders_of_the_settings_file_are_relative_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder_of(tmp_path / "ours", own=OLLIE)
    (tmp_path / "lab.toml").write_text('acts = ["ours"]\nport = 8000\n')
    monkeypatch.setenv("PASDEDEUX_SETTINGS", str(tmp_path / "lab.toml"))
    assert lexicon().own == ("ollie",)
    monkeypatch.setenv("PASDEDEUX_ACTS", str(folder_of(tmp_path / "other", own=_bow("Two"))))
    assert lexicon().own == ("bow",), "the environment goes before the file"


def test_what_is_wrong_is_said_with_file_and_line_and_the_rest_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    folder = folder_of(tmp_path / "own", a="[x\n", b=OLLIE + '\n[zig]\nframes = ["he zigs"]\n', c="[Zag]\n")
    monkeypatch.setenv("PASDEDEUX_ACTS", f"{folder}{os.pathsep}{tmp_path / 'nowhere'}")
    with caplog.at_level(logging.WARNING):
        look_at_own_acts()
    known = lexicon()
    assert known.own == ("ollie",) and acts_of("She ollies.") == ["ollie"]
    said = sorted(known.problems)
    assert len(said) == 4
    assert said[0].startswith("There is no folder of acts nowhere")
    assert said[1].startswith("a.toml is no TOML") and "line 1" in said[1]
    assert said[2].startswith("b.toml, line 6, [zig]: ")
    assert said[3].startswith("c.toml, line 1, [Zag]: a name has at most 60 small letters")
    assert all(problem in caplog.text for problem in said)


def test_a_file_that_is_saved_is_read_with_the_next_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_of(tmp_path / "own", own=OLLIE)
    monkeypatch.setenv("PASDEDEUX_ACTS", str(folder))
    assert acts_of("She ollies.") == ["ollie"] and acts_of("She zigzoops.") == []
    (folder / "own.toml").write_text(OLLIE.replace("ollie", "zigzoop"))
    assert acts_of("She zigzoops.") == ["zigzoop"] and acts_of("She ollies.") == []


def test_between_two_looks_the_folders_are_left_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_ACTS", str(folder_of(tmp_path / "own", own=OLLIE)))
    look_again()
    monkeypatch.setattr(config, "LOOK_EVERY", 1000.0)
    (tmp_path / "own" / "more.toml").write_text(_bow("Two"))
    assert len(own_files().files) == 1
    assert len(look_again().files) == 2


@pytest.mark.parametrize("text", ["[1]", "[", '["a"'])
def test_a_setting_that_is_no_list_is_said(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_ACTS", text)
    with pytest.raises(InputError, match="PASDEDEUX_ACTS must be folders"):
        acts_folders()
    assert "PASDEDEUX_ACTS must be folders" in lexicon().problems[0]


@pytest.mark.parametrize("text", ['acts = "own"', "acts = [3]", "acts = ["])
def test_a_settings_file_that_is_wrong_is_said(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lab.toml").write_text(text)
    monkeypatch.setenv("PASDEDEUX_SETTINGS", str(tmp_path / "lab.toml"))
    with pytest.raises(InputError, match=r"setting acts must be a list|lab.toml cannot be read"):
        acts_folders()
