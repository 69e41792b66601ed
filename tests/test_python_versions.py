"""Every file that says which Pythons are promised says the same, and the requirements can be had for them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import metadata, version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PYTHONS = [f"3.{minor}" for minor in range(8, 30)]
PROMISED = [p for p in PYTHONS if p in SpecifierSet(PROJECT["project"]["requires-python"])]


def requirements() -> list[Requirement]:
    lines = (ROOT / "requirements.txt").read_text().splitlines()
    wanted = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return [w for w in wanted if w.marker is None or w.marker.evaluate()]


def pythons_of(name: str) -> list[str]:
    """The Pythons that the installed release of a package allows; any patch release of each counts."""
    allowed = SpecifierSet(metadata(name)["Requires-Python"] or "")
    return [python for python in PYTHONS if f"{python}.99" in allowed]


def is_pinned(wanted: Requirement) -> bool:
    """Whether a requirement allows one line of releases alone, so that another Python gets the same one."""
    following = re.sub(r"^(\d+)\.(\d+).*", lambda m: f"{m[1]}.{int(m[2]) + 1}.0", version(wanted.name))
    return following not in wanted.specifier


def test_the_promise_is_said_alike_everywhere() -> None:
    oldest, newest = PROMISED[0], PROMISED[-1]
    assert f"Python {', '.join(PROMISED[:-1])} or {newest} and" in (ROOT / "README.md").read_text()
    make = (ROOT / "Makefile").read_text()
    assert f"Python {oldest} to {newest}" in make and f"PYTHON=python{newest}" in make
    assert f"version < {tuple(map(int, oldest.split('.')))}" in make
    assert f"version > {tuple(map(int, newest.split('.')))}" in make
    assert PROJECT["tool"]["ruff"]["target-version"] == f"py{oldest.replace('.', '')}"
    assert PROJECT["tool"]["mypy"]["python_version"] == oldest


def test_the_image_and_the_space_run_a_promised_python() -> None:
    images = set(re.findall(r"^ARG BASE=python:([\d.]+)", (ROOT / "Dockerfile").read_text(), re.MULTILINE))
    (python,) = images
    assert python in PROMISED
    assert f'python_version: "{python}"' in (ROOT / "README.md").read_text()
    assert f"for Python {python} on Linux" in (ROOT / "requirements.lock").read_text()
    assert f"--python-version {python} " in (ROOT / "Makefile").read_text()


def test_the_requirements_allow_what_is_promised() -> None:
    pinned = [wanted.name for wanted in requirements() if is_pinned(wanted)]
    assert {"torch", "plotly", "diffusers"} <= set(pinned)
    allowed = [python for python in PYTHONS if all(python in pythons_of(name) for name in pinned)]
    assert allowed[0] == PROMISED[0], "the oldest Python promised is the oldest that can be installed"
    refused = {w.name for w in requirements() if PROMISED[-1] not in pythons_of(w.name)}
    assert not refused, f"Python {PROMISED[-1]} is promised"


@pytest.mark.parametrize(
    ("pretended", "said", "goes_on"),
    [
        ("2, 7", "and this is 2.7", False),
        ("3, 10", "and this is 3.10", False),
        ("3, 11", "", True),
        ("3, 13", "", True),
        ("3, 14", "Some packages may not install", True),
    ],
)
def test_make_says_which_python_it_needs(pretended: str, said: str, goes_on: bool, tmp_path: Path) -> None:
    if (make := shutil.which("make")) is None:
        pytest.skip("no make on this machine")
    python = tmp_path / "python"  # it makes no environment: that is where this test ends
    python.write_text(
        "#!/bin/sh\n"
        'test "$1" = -c || { echo "makes an environment"; exit 1; }\n'
        f'exec "{sys.executable}" -c "import sys; sys.version_info = ({pretended}, 0); exec(sys.argv[1])" "$2"\n'
    )
    python.chmod(0o755)
    venv = tmp_path / "venv"
    done = subprocess.run(
        [make, f"PYTHON={python}", f"VENV={venv}", f"{venv}/.runtime"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "MAKEFLAGS": ""},
    )
    assert done.returncode != 0 and not venv.exists()
    assert ("makes an environment" in done.stdout) == goes_on
    sentences = [line for line in done.stderr.splitlines() if "needs Python" in line]
    assert len(sentences) == bool(said) and all(said in sentence for sentence in sentences)
