"""Imported once in the process from which the servers of tests are forked: that takes far longer than to serve."""

import tests.ui.stub_engine  # noqa: F401
import webdemo.server.serve  # noqa: F401
from acts import read

read("They wave.")
