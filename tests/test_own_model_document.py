"""docs/own-model.md: every block of it is run, and what it promises of broken models holds."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from motion import InputError
from tests.server.lab import free_port
from webdemo import cli
from webdemo.benchmark.server import wait_until
from webdemo.inference import Engine, GenerateRequest
from webdemo.inference.methods import failed, method, methods, register_settings
from webdemo.inference.own import entries
from webdemo.inference.own.classes import find_class, method_of_class

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / "docs" / "own-model.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", DOCUMENT.read_text(), re.DOTALL | re.MULTILINE)
TOY = next(text for kind, text in BLOCKS if kind == "python")
TABLE = next(text for kind, text in BLOCKS if kind == "toml")
COMMANDS = [line for kind, text in BLOCKS if kind == "sh" for line in text.replace("\\\n", " ").splitlines() if line]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A newcomer's folder with the files of the document."""
    (tmp_path / "toy.py").write_text(TOY)
    (tmp_path / "pasdedeux.toml").write_text(TABLE)
    (tmp_path / "mine.json").write_text(next(text for kind, text in BLOCKS if kind == "json"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(entries.SETTINGS_VARIABLE, raising=False)
    register_settings()
    yield tmp_path
    (tmp_path / "pasdedeux.toml").unlink()
    register_settings()


def test_the_commands_of_the_document_work(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ran = []
    for command in COMMANDS:
        words = shlex.split(command)
        if words[:3] != ["python", "-m", "webdemo"] or words[3] in ("serve", "benchmark"):
            continue
        assert cli.main(words[3:]) == 0, command
        ran.append(words[3])
        answer = json.loads(capsys.readouterr().out.splitlines()[-1])
        assert all(Path(file).is_file() for file in answer["files"])
    assert ran == ["generate", "react", "render", "score"]
    assert answer["model"] == "toy" and answer["motions"] == 2 and answer["judged"] == 1
    assert set(answer["physical"]) == {"foot_skate", "jerk", "penetration", "bone_drift"}


def test_the_page_of_the_document_shows_the_toy(folder: Path) -> None:
    (serve,) = [shlex.split(command) for command in COMMANDS if command.endswith("serve")]
    port = free_port()
    command = [sys.executable, *serve[1:], "--port", str(port)]
    environment = {"PYTHONPATH": str(ROOT), "XDG_DATA_HOME": str(folder / "data"), "PATH": "/usr/bin:/bin"}
    with subprocess.Popen(command, cwd=folder, env=environment) as server:
        try:
            wait_until(url := f"http://127.0.0.1:{port}/config", "", server)
            page = httpx.get(url, timeout=60).text
        finally:
            server.terminate()
    assert "Toy twins" in page


def test_the_tables_of_the_document_are_read(folder: Path) -> None:
    tables = [text for kind, text in BLOCKS if kind == "toml" and "[models." in text]
    named = set()
    for text in tables:
        (folder / "pasdedeux.toml").write_text(text)
        found, wrong = entries.read_entries()
        assert not wrong
        named |= {entry.method for entry in found.values()}
    assert named == {"", "intergen", "regennet", "interformer", "bigraphdiff"}


def test_weights_of_own_data_are_planned_for_as_the_shipped_ones(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "own-data.md").read_text()
    (code,) = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    (tmp_path / "ours.py").write_text(code)
    ours = method_of_class(find_class("ours.py:Ours", tmp_path))
    shipped = method("intergen")
    assert (ours.tasks, ours.takes) == (shipped.tasks, shipped.takes)


RUN = "    def run(self, request, cancel, timer):\n"
BROKEN = {
    "raises.py:M": ("class M:\n" + RUN + "        yield timer.progress('sample')\n        1 / 0\n", "division by zero"),
    "empty.py:M": ("class M:\n" + RUN + "        yield timer.progress('sample')\n", "without a Result"),
    "odd.py:M": ("class M:\n" + RUN + "        yield 7\n", "gave 7, not Progress or a Result"),
    "leaves.py:M": ("import sys\nclass M:\n" + RUN + "        yield sys.exit(3)\n", "SystemExit: 3"),
    "loads.py:M": (
        "class M:\n    def __init__(self):\n        open('nowhere')\n" + RUN + "        yield 1\n",
        "cannot be loaded: it raised FileNotFoundError",
    ),
    "nothing.py:M": (
        "from webdemo.inference import Result\nclass M:\n" + RUN + "        yield Result(duets=(), manifest={})\n",
        "no motion of two people",
    ),
    "nan.py:M": (
        "import numpy as np\nfrom motion import Duet\nfrom webdemo.inference import Result\nclass M:\n"
        + RUN
        + "        duet = Duet.from_positions(np.full((2, 30, 22, 3), 1.0), fps=30.0)\n"
        + "        duet.a.positions[3, 2, 1] = np.nan\n        yield Result(duets=(duet,), manifest={})\n",
        "not finite",
    ),
}
UNUSABLE = {
    "syntax.py:M": ("class M(\n", "raised SyntaxError"),
    "imports.py:M": ("import nothing_of_this_name\n", "ModuleNotFoundError"),
    "exits.py:M": ("raise SystemExit(1)\n", "SystemExit"),
    "empty_file.py:M": ("", "has no class M"),
    "plain.py:M": ("class M:\n    pass\n", "not a class with a method `run"),
    "task.py:M": ("class M:\n    tasks = ('dance',)\n" + RUN + "        yield 1\n", "its `tasks` must be some of"),
    "gone.py:M": (None, "there is no file"),
    "M": (None, "must be file.py:Class or package.module:Class"),
}


def test_a_broken_class_fails_alone(folder: Path) -> None:
    text = TABLE
    for place, (source, _) in (BROKEN | UNUSABLE).items():
        name = place.partition(".")[0].lower().replace("_", "-")
        if source is not None:
            (folder / place.partition(":")[0]).write_text(source)
        text += f'\n[models.broken-{name}]\npipeline = "{place}"\n'
    (folder / "pasdedeux.toml").write_text(text)
    register_settings()
    for place, (_, sentence) in UNUSABLE.items():
        name = "broken-" + place.partition(".")[0].lower().replace("_", "-")
        assert sentence in failed()[name] and name not in {m.name for m in methods()}
    engine = Engine()
    for place, (_, sentence) in BROKEN.items():
        name = f"broken-{place.partition('.')[0]}"
        with pytest.raises(InputError) as refused:
            list(engine.run(GenerateRequest(prompt="Sway.", model=name, seconds=1.0)))
        assert sentence in str(refused.value) and "\n" not in str(refused.value), name
    *_, result = engine.run(GenerateRequest(prompt="Sway.", model="toy", seconds=1.0))
    assert result.duets[0].num_frames == 30  # type: ignore[union-attr]
    assert method("intergen").name == "intergen"
