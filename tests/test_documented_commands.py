"""Every command that the documents show is one that the program takes: its module, command and flags."""

from __future__ import annotations

import importlib
import importlib.util
import re
import shlex
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    "README.md",
    *(str(p.relative_to(ROOT)) for p in sorted(ROOT.glob("docs/*.md"))),
    *(str(p.relative_to(ROOT)) for p in sorted(ROOT.glob("models/weights/*/CARD.md"))),
]
_FENCED = re.compile(r"^ *```\w*\n(.*?)^ *```", re.DOTALL | re.MULTILINE)
_INLINE = re.compile(r"`([^`]+)`")
_COMMAND = re.compile(r"python -m ((?:webdemo|training)[\w.]*)(.*)")


def documented() -> list[tuple[str, str, tuple[str, ...]]]:
    """(page, module, words) of every command in blocks and in running text."""
    found = []
    for page in PAGES:
        text = (ROOT / page).read_text()
        lines = [line for block in _FENCED.findall(text) for line in block.replace("\\\n", " ").splitlines()]
        lines += [" ".join(code.split()) for code in _INLINE.findall(_FENCED.sub("", text))]
        for line in lines:
            if command := _COMMAND.search(line):
                words = shlex.split(command[2].replace("…", ""), comments=True)
                found.append((page, command[1], tuple(words)))
    return found


COMMANDS = documented()


def test_the_documents_show_commands() -> None:
    assert {"webdemo", "training.trainers.intergen", "training.trainers.bigraphdiff", "training.trainers.mawgan"} <= {
        m for _, m, _ in COMMANDS
    }
    assert len(COMMANDS) > 40


@pytest.mark.parametrize(("page", "module", "words"), COMMANDS, ids=[" ".join(c[1:2] + c[2][:1]) for c in COMMANDS])
def test_a_documented_command_is_taken(
    page: str, module: str, words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    name = module
    if importlib.util.find_spec(module) is not None and (ROOT / module.replace(".", "/")).is_dir():
        name = f"{module}.__main__"
    if module == "webdemo":
        main = importlib.import_module("webdemo.cli").main
        asked = [*words[:1], "--help"] if words and not words[0].startswith("-") else ["--help"]
    else:
        main, asked = importlib.import_module(name).main, ["--help"]

    def said(*words: str) -> str:
        with pytest.raises(SystemExit) as ended:
            main([*words])
        assert ended.value.code == 0
        return capsys.readouterr().out

    help_text = said(*asked)
    if len(words) > 1 and re.search(rf"^    {re.escape(words[1])}\b", help_text, re.MULTILINE):  # an action of its own
        help_text += said(*words[:2], "--help")
    flags = [word.split("=")[0] for word in words if word.startswith("--") and word != "--"]
    missing = [flag for flag in flags if flag != "--help" and not re.search(rf"{flag}(?![\w-])", help_text)]
    assert not missing, f"{page} shows {module} with {missing}"
