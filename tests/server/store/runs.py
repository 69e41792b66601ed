"""Runs of the stub engine that a notebook keeps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from tests.server.lab import stub_module
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.plans import KeptPlan, WindowPlan
from webdemo.inference.run import Result
from webdemo.server.store.notebook import Notebook

ME, OTHER = "user ada", "user eve"
PLAN = KeptPlan(windows=(WindowPlan((1.0, 2.0, 0.5)),))


def made(request: Any) -> Result:
    *_, result = stub_module().StubEngine().run(request)
    return result


def kept(notebook: Notebook, prompt: str = "Two people walk.", *, owner: str = ME, **fields: Any) -> str:
    """The id of a run, with a plan, that is kept."""
    request = GenerateRequest(prompt=prompt, **({"seconds": 1.0, "steps": 1} | fields))
    run = notebook.begin(owner, request.to_dict(), prompt)
    result = made(request)
    notebook.finish(run, replace(result, manifest={**result.manifest, "plan": PLAN.to_dict()}))
    return run
