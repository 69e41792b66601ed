from __future__ import annotations

from pathlib import Path

import pytest

from acts.__main__ import check_entry, check_folder
from acts.lexicon import OURS, lexicon
from acts.reading import read, wordnet
from acts.staging.stage import score_of

ENTRIES = lexicon().entries


@pytest.mark.parametrize("group", sorted({entry.group for entry in ENTRIES.values()}))
def test_every_entry_is_read_as_its_examples_say(group: str) -> None:
    wrong = [problem for name, entry in ENTRIES.items() if entry.group == group for problem in check_entry(name, entry)]
    assert not wrong


def test_every_synset_is_one_of_wordnet() -> None:
    assert not {name for entry in ENTRIES.values() for name in entry.synsets if wordnet.synset(name) is None}


def test_names_stand_in_one_file_each() -> None:
    names = [
        line.strip()[1:-1] for path in OURS.glob("*.toml") for line in path.read_text().splitlines() if line[:1] == "["
    ]
    assert len(names) == len(set(names)) == len(ENTRIES)


HEAD = 'caption = ["x"]\nreads = ["x"]'
WRONG = {
    "hug": (f'[hug]\nframes = ["he hugs"]\n{HEAD}', "A frame begins with a slot"),
    "slot": ('[x]\nframes = ["{a} hug {c}"]\ncaption = ["x"]\nreads = ["x"]', "{c} in the frame"),
    "field": ('[x]\nframes = ["{a} hug"]\ncaption = ["x"]\nreads = ["x"]\nlength = 3', "length"),
    "empty": ('[x]\nframes = []\ncaption = ["x"]\nreads = ["x"]', "frames"),
    "shape": (
        '[x]\nframes = ["{a} hug"]\ncaption = ["x"]\nreads = ["x"]\nstage = [{do = "fly"}]',
        "stage.0: 'fly' is not known: use one of 'go', ",
    ),
    "table": ("x = 3\n", "write the entry as a table"),
    "reads": ('\n[zig]\nframes = ["{a} zig"]\ncaption = ["x"]\nreads = ["She sleeps."]', "is not read as zig"),
    "ignores": ('[zig]\nframes = ["{a} bow"]\ncaption = ["x"]\nreads = ["She bows."]\nignores = ["He bows."]', "zig"),
    "alone": (f'[bow]\nframes = ["{{a}} bow"]\nalone = "zig"\n{HEAD.replace("x", "He bows.")}', "zig"),
    "rule": (
        '[zig]\nframes = ["{a} zigzag"]\ncaption = ["x"]\nreads = ["She zigzags."]\nrule = ["happens(flies(who))"]',
        "flies",
    ),
}


@pytest.mark.parametrize("case", sorted(WRONG))
def test_a_wrong_entry_is_named_with_its_file(case: str, tmp_path: Path) -> None:
    text, said = WRONG[case]
    (tmp_path / "own.toml").write_text(text)
    problems = list(check_folder(tmp_path))
    assert problems and said in problems[0] and "own.toml" in problems[0], problems


def test_a_lab_adds_an_act_with_one_entry(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]'
    )
    assert list(check_folder(tmp_path)) == []
    assert "ollie" in lexicon((tmp_path,)).entries
    assert "ollie" not in lexicon().entries


@pytest.mark.parametrize("figure", ["jumps", "bows"])
def test_an_entry_that_jumps_or_bows_and_gestures_does_both(
    figure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own.toml").write_text(
        '[ollie]\nframes = ["{a} ollie"]\ncaption = ["{a} [jump]"]\nreads = ["She ollies."]\n'
        f'stage = [{{do = "figure", figure = "{figure}"}}, {{do = "gesture", gesture = "spread"}}]'
    )
    monkeypatch.setenv("PASDEDEUX_ACTS", str(tmp_path))
    score = score_of(read("She ollies.").acts)
    assert "a" in score.figures and "a" in score.gestures
    assert "a" not in score.gesturing, "who only gestures stands still"
