"""A stored run once more, under names of this version and of older ones."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from motion import SMPL22, Clip, Duet
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.plans import KeptPlan, WindowPlan
from webdemo.inference.run import Result
from webdemo.inference.story import Beat, SceneRequest
from webdemo.ui.again import request_of, verdict

STANDING = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def duet() -> Duet:
    a, b = (Clip(np.repeat(STANDING[None] + [0, 0, z], 60, axis=0).astype("f4"), 30.0) for z in (0.0, 1.0))
    return Duet(a, b)


@pytest.fixture
def request_() -> ReactRequest:
    return ReactRequest(actor=duet().a, model="regennet", first_pose=STANDING + np.array([0, 0, 1.0]), seed=3)


def test_the_first_pose_of_a_stored_reaction_is_read(request_: ReactRequest) -> None:
    opened: Any = SimpleNamespace(
        entry=SimpleNamespace(kind="react", request=request_.to_dict(), title="A reaction"),
        result=SimpleNamespace(duets=(duet(),), manifest={}),
    )
    found = request_of(opened)
    assert isinstance(found, ReactRequest) and found.first_pose is not None
    np.testing.assert_array_equal(found.first_pose, request_.first_pose)
    assert found.to_dict() == request_.to_dict()


def test_a_verdict_says_when_the_request_differs(request_: ReactRequest) -> None:
    new = request_.to_dict()
    moved = Duet(duet().a, Clip(duet().b.positions + np.float32(0.01), 30.0))
    results = [Result(duets=(d,), manifest={"request": r}) for d, r in ((duet(), new), (moved, new))]
    assert "the request" not in verdict(*results)
    changed = Result(duets=(moved,), manifest={"request": new | {"seed": 4}})
    assert "the request" in verdict(results[0], changed)


def opened_run(asked: Any, manifest: dict[str, Any]) -> Any:
    request = asked.to_dict()
    return SimpleNamespace(
        entry=SimpleNamespace(kind=request["kind"], request=request, title="A run"),
        result=SimpleNamespace(duets=(duet(),), manifest=manifest),
    )


@pytest.mark.parametrize("asked", [GenerateRequest(prompt="They wave."), SceneRequest(beats=(Beat("They wave."),))])
def test_a_stored_run_is_made_again_from_its_plan(asked: Any) -> None:
    plan = KeptPlan(notes=("From the words: nothing.",), windows=(WindowPlan((1.0, 2.0, 0.5)),))
    found: Any = request_of(opened_run(asked, {"plan": plan.to_dict()}))
    assert found.plan is not None and found.plan.to_dict() == plan.to_dict()
    assert found.to_dict() == asked.to_dict()
    older: Any = request_of(opened_run(asked, {}))
    assert older.plan is None and older.to_dict() == asked.to_dict()
