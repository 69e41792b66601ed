"""Node, which runs the page's modules without a page."""

from __future__ import annotations

import shutil
import subprocess

import pytest


def newest_node() -> str:
    """The path of Node, which has a test runner from version 18 on; without it the test is skipped."""
    if (node := shutil.which("node")) is None:
        pytest.skip("Node 18 or newer is not installed: the JavaScript modules are tested in pages alone")
    said = subprocess.run([node, "--version"], capture_output=True, text=True).stdout
    if int(said.strip().lstrip("v").split(".")[0]) < 18:
        pytest.skip(f"Node {said.strip()} has no test runner: install Node 18 or newer")
    return node
