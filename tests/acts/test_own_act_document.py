"""docs/acts.md: the first act in five minutes, as it is written there, from an empty folder to a motion."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from acts.__main__ import main as acts_main
from motion.formats import read as read_motion

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = (ROOT / "docs" / "acts.md").read_text(encoding="utf-8")


def first_act() -> tuple[str, list[str]]:
    """The entry and the commands of the section."""
    section = DOCUMENT.split("## Your first act in five minutes")[1].split("\n## ")[0]
    lines = section.replace("\n   ", "\n")
    (entry,) = re.findall(r"```toml\n(.*?)```", lines, re.DOTALL)
    commands = "".join(re.findall(r"```sh\n(.*?)```", lines, re.DOTALL)).splitlines()
    return entry, commands


def test_the_first_act_goes_from_an_empty_folder_to_a_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from webdemo.cli import main

    monkeypatch.chdir(tmp_path)
    entry, commands = first_act()
    done = []
    for command in commands:
        words = re.findall(r'"[^"]*"|\S+', command)
        words = [word.strip('"') for word in words]
        if words[0] == "mkdir":
            (tmp_path / words[1]).mkdir()
            (name,) = re.findall(r"^# (\S+)$", entry, re.MULTILINE)
            (tmp_path / name).write_text(entry)
        elif words[0] == "export":
            variable, _, value = words[1].partition("=")
            monkeypatch.setenv(variable, value)
        elif words[:3] == ["python", "-m", "acts"]:
            monkeypatch.setattr("sys.argv", ["acts", *words[3:]])
            assert acts_main() == 0, capsys.readouterr().out
        else:
            assert words[:3] == ["python", "-m", "webdemo"]
            assert main(words[3:]) == 0, capsys.readouterr().err
            answer = json.loads(capsys.readouterr().out.splitlines()[-1])
            done.append(words[3])
            plan = answer["plan"] if words[3] == "read" else answer["manifest"]["plan"]["acts"][0]
            assert [act["act"] for act in plan["acts"]] == ["ollie"]
            if words[3] == "generate":
                assert "jumps up high" in json.dumps(answer["manifest"])
    assert done == ["read", "generate"]
    assert read_motion(tmp_path / "ollie.npz").positions.shape[0] == 2
