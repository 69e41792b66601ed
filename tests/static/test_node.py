"""The page's modules that need no page, tested by Node's own runner: ``node --test tests/static`` runs them alone."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.static.node import newest_node

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted(Path(__file__).parent.rglob("*.test.mjs"))


def test_there_is_something_to_test() -> None:
    assert len(FILES) >= 3


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_modules_in_node(file: Path) -> None:
    command = [newest_node(), "--test", "--test-reporter=tap", str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    (passed,) = re.findall(r"^# pass (\d+)$", done.stdout, re.MULTILINE)
    assert int(passed) >= 1, "a file without tests passes, too"
