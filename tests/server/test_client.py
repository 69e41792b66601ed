"""The documented way to call a lab from a notebook."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from functools import partialmethod
from pathlib import Path
from typing import Any

import gradio_client
import pytest
from gradio_client import Client
from gradio_client.exceptions import AppError, AuthenticationError

from webdemo.inference.run import Result

from .clients import served_on_loopback
from .lab import ROOT, add_accounts, stub_module

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("own_temporary")]


class Engine(stub_module().StubEngine):  # type: ignore[misc]  # made by a path
    """The stub engine, whose results name their weights."""

    def run(self, request: Any, cancel: Any = None) -> Iterator[Any]:
        for event in super().run(request, cancel):
            if isinstance(event, Result):
                event.manifest["weights_sha256"] = "0" * 64
            yield event


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("lab")
    add_accounts(folder / "data", "ada")
    with served_on_loopback(folder, engine=Engine(pause=0.02), accounts=True) as (host, port):
        yield f"http://{host}:{port}/"


def test_generate_from_a_notebook(url: str, tmp_path: Path) -> None:
    lab = Client(url, auth=("ada", "password of ada"), verbose=False, download_files=str(tmp_path))
    answer, files = lab.predict(prompt="Two people walk.", seconds=1, seed=4, steps=2, api_name="/generate")
    assert answer["manifest"]["request"]["seed"] == 4
    assert {Path(file).suffix for file in files} >= {".npz", ".bvh", ".json"}
    with pytest.raises(AppError) as caught:
        lab.predict(prompt="impossible", api_name="/generate")
    assert str(caught.value) == "The stub cannot do this: ask for something possible."
    with pytest.raises(AppError) as caught:
        lab.predict(prompt="crash", steps=3, api_name="/generate")
    assert "(RuntimeError); its log says more under " in str(caught.value)


def test_a_sentence_is_read_without_generating(url: str) -> None:
    lab = Client(url, auth=("ada", "password of ada"), verbose=False)
    plan = lab.predict("She hugs him, then he leaves.", api_name="/read")
    assert [(act["act"], act["agents"], act["patient"]) for act in plan["acts"]][:1] == [("hug", ["a"], "b")]
    with pytest.raises(AppError) as caught:
        lab.predict("word " * 1000, api_name="/read")
    assert "characters: shorten it" in str(caught.value)


def test_a_notebook_sees_how_far_a_run_is(url: str, tmp_path: Path) -> None:
    lab = Client(url, auth=("ada", "password of ada"), verbose=False, download_files=str(tmp_path))
    job = lab.submit(prompt="Two people walk.", seconds=1, steps=60, api_name="/generate")
    seen = []
    while not job.done():
        seen += job.status().progress_data or []
        time.sleep(0.02)
    assert job.result()[0]["manifest"]["request"]["steps"] == 60
    steps = [unit.index for unit in seen if unit.desc and unit.desc.startswith("Denoising: step")]
    assert steps == sorted(steps) and len(set(steps)) > 3 and {unit.length for unit in seen} >= {60}


def test_the_documents_examples_run(
    url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What docs/hosting.md shows is what is run here, one block after the other."""
    text = (ROOT / "docs" / "hosting.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 2 and "https://lab.example/motion/" in blocks[0] and '"PASSWORD"' in blocks[0]
    monkeypatch.setattr(
        gradio_client.Client,
        "__init__",
        partialmethod(gradio_client.Client.__init__, verbose=False, download_files=str(tmp_path)),
    )
    names: dict[str, Any] = {}
    for block in blocks:
        block = block.replace("https://lab.example/motion/", url).replace("PASSWORD", "password of ada")
        exec(compile(block.replace("time.sleep(1)", "time.sleep(0.02)"), "hosting.md", "exec"), names)
    said = capsys.readouterr().out
    assert str(tmp_path) in said and "Denoising: step" in said
    assert names["job"].result()[0]["manifest"]["request"]["prompt"] == "Two people hug."
    (fetch,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "using.md").read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    sign_in = f'Client("{url}", auth=("ada", "password of ada"))'
    exec(compile(fetch.replace('Client("http://127.0.0.1:7860")', sign_in), "using.md", "exec"), {})
    assert len([*tmp_path.glob("*_a.bvh"), *tmp_path.glob("*_b.bvh")]) == 2


def test_nobody_else_gets_in(url: str) -> None:
    with pytest.raises(AuthenticationError):
        Client(url, auth=("ada", "wrong horse"), verbose=False)
