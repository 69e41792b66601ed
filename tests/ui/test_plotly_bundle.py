"""The player's plotly.js is the one that its inside is known of: that of the installed Python package."""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import plotly

from webdemo.ui.components.player import PLOTLY_JS

WHOLE = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"
VERSION = re.compile(rb"plotly\.js (?:\(gl3d - minified\) )?v([\d.]+)")


def test_it_has_the_version_of_the_python_package() -> None:
    one, other = (VERSION.search(path.read_bytes()[:200]) for path in (PLOTLY_JS, WHOLE))
    assert one is not None and other is not None
    assert one[1] == other[1]


def test_it_is_light() -> None:
    assert len(gzip.compress(PLOTLY_JS.read_bytes(), 6)) < 0.6e6
