"""The endpoints read files in places that people share."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gradio as gr
import pytest

from motion import InputError
from webdemo.ui.api import PROGRESS, GenerateEndpoint


def test_one_persons_files_are_read_one_after_the_other() -> None:
    """A large one takes seconds and 100 MB; twenty at once took the process's memory."""
    lock, reading, most = threading.Lock(), 0, 0

    def read() -> Any:
        nonlocal reading, most
        with lock:
            reading += 1
            most = max(most, reading)
        time.sleep(0.02)
        with lock:
            reading -= 1
        raise InputError("The file is empty.")

    def ask(_: int) -> None:
        with pytest.raises(gr.Error, match="The file is empty"):
            GenerateEndpoint(None)._answer(read, "x", PROGRESS, reads=True)  # type: ignore[arg-type]  # no run is begun

    with ThreadPoolExecutor(20) as people:
        list(people.map(ask, range(20)))
    assert most == 1
