"""The page and a request load no library that they do not use."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
HEAVY = """
heavy = {"pandas.core", "plotly.graph_objs", "networkx", "trimesh", "sympy", "scipy.interpolate", "scipy.optimize",
         "scipy.signal", "scipy.stats", "matplotlib.pyplot", "torch._dynamo"}
print(sorted(heavy & {name for name, module in sys.modules.items() if module}))
"""
PAGE = "import inspect, sys, webdemo.server.serve; inspect.getmodule(sys._getframe())"
NETWORKS = """
import sys, numpy as np, webdemo.inference.engine, webdemo.inference.pipelines.intergen
from models.motion_tokens import TokenLayout
from motion import SMPL22, Duet
from motion.formats.glb import glb_bytes
TokenLayout().fit(10)
glb_bytes(Duet.from_positions(np.stack([[SMPL22.rest_positions()] * 2] * 2), fps=30))
"""
LATE = """
import sys, threading, webdemo, pandas
assert "pandas.core" not in sys.modules
seen = []
threads = [threading.Thread(target=lambda: seen.append(pandas.DataFrame({"a": [1]}).shape)) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
from pandas.io.formats.style import Styler
print(seen == [(1, 1)] * 4, pandas.__version__ != "", hasattr(pandas, "nothing of this name"))
"""


def said(code: str) -> str:
    environment = os.environ | {"GRADIO_ANALYTICS_ENABLED": "False"}
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=REPOSITORY, env=environment, capture_output=True, text=True,
        check=True, timeout=300,
    )  # fmt: skip
    return ran.stdout.strip()


@pytest.mark.parametrize("start", [PAGE, NETWORKS])
def test_what_is_not_used_is_not_loaded(start: str) -> None:
    assert said(f"{start}\n{HEAVY}") == "[]"


def test_a_late_package_is_there_once_it_is_asked_for() -> None:
    assert said(LATE) == "True True False"


def test_a_module_in_a_late_package_comes_after_the_package() -> None:
    assert said("import webdemo, pandas.io.formats.style as s; print(s.Styler.__name__)") == "Styler"
