"""Requests that share passes come out as they do alone."""

import numpy as np
import pytest
import torch

from motion import SMPL22, Clip
from webdemo.inference import Engine, GenerateRequest, Result
from webdemo.inference.engine.batch import Meeting, _Question, answer_together, run_batch
from webdemo.inference.finish import damping
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import Cancelled, CancelToken, Progress


def request(prompt: str = "Two people shake hands.", **fields) -> GenerateRequest:
    return GenerateRequest(prompt=prompt, **({"seconds": 1.0, "steps": 4} | fields))


def standing(frames: int = 36) -> Clip:
    rest = SMPL22.rest_positions() + np.array([0.0, 0.98, 0.0])
    sway = 0.05 * np.sin(np.arange(frames) / 5)[:, None, None]
    return Clip((rest[None] + sway).astype(np.float32), 30.0)


def ends(engine: Engine, requests: list) -> dict[int, Result | Exception]:
    found: dict[int, Result | Exception] = {}
    for i, event in run_batch(engine, [(r, CancelToken()) for r in requests]):
        if not isinstance(event, Progress):
            assert i not in found
            found[i] = event
    return found


def test_results_are_those_of_running_alone(either_engine: Engine) -> None:
    engine = either_engine
    requests = [
        request(seed=1),
        request("One person waves.", seed=2, samples=2, guidance=1.0),
        request("They walk away from each other.", seed=3, seconds=1.2, damping=0.0, guidance=5.0),
        ReactRequest(actor=standing(), prompt="One person waves.", steps=4, seed=4),
    ]
    together = ends(engine, requests)
    for i, wanted in enumerate(requests):
        *_, alone = engine.run(wanted)
        got = together[i]
        assert isinstance(got, Result) and len(got.duets) == wanted.samples
        assert got.manifest == alone.manifest
        for duet, other in zip(got.duets, alone.duets, strict=True):
            np.testing.assert_allclose(duet.positions, other.positions, atol=2e-4)
    assert not np.allclose(together[0].duets[0].positions, together[1].duets[0].positions[:30], atol=0.05)


def test_one_pass_answers_all(engine: Engine) -> None:
    counted: list[int] = []
    denoiser = engine.pipeline("intergen").model.denoiser
    handle = denoiser.register_forward_hook(lambda module, args, out: counted.append(len(args[0])))
    try:
        ends(engine, [request(seed=i, steps=3) for i in range(3)])
    finally:
        handle.remove()
    assert counted == [6, 6, 6]  # three requests, both halves of the guidance


def test_damping_is_shared_by_those_of_one_length(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    counted: list[int] = []

    def energy(positions: torch.Tensor, *rest: object) -> torch.Tensor:
        counted.append(len(positions))
        return whole(positions, *rest)

    whole = damping.energy
    monkeypatch.setattr(damping, "energy", energy)
    list(engine.run(request(damping=0.7)))
    alone = len(counted)
    counted.clear()
    # One that is longer is corrected by itself, one without damping waits, a given person stays as they are.
    others = [request(seed=2, samples=2), request(seed=3, seconds=1.2), request(seed=4, damping=0.0)]
    given = ReactRequest(actor=standing(30), model="intergen", steps=4, seed=5)
    found = ends(engine, [request(damping=0.7), *others, given])
    assert all(isinstance(end, Result) for end in found.values())
    assert sorted(counted) == [1] * alone + [4] * alone
    np.testing.assert_array_equal(found[4].duets[0].a.positions, given.actor.positions)


def test_a_cancelled_request_leaves_the_others(engine: Engine) -> None:
    tokens = [CancelToken(), CancelToken()]
    wanted = [request(seed=1, steps=6), request(seed=2, steps=6)]
    found = {}
    for i, event in run_batch(engine, list(zip(wanted, tokens, strict=True))):
        if i == 0 and isinstance(event, Progress) and event.stage == "sample":
            tokens[0].cancel()
        if not isinstance(event, Progress):
            found[i] = event
    *_, alone = engine.run(wanted[1])
    assert isinstance(found[0], Cancelled)
    np.testing.assert_allclose(found[1].duets[0].positions, alone.duets[0].positions, atol=2e-4)


class Broken:
    """A denoiser without memory."""

    def guided(self, *args, **options):
        raise RuntimeError("no memory")


def test_an_error_of_the_pass_reaches_everybody() -> None:
    meeting = Meeting(Broken(), 1)  # type: ignore[arg-type]
    question = _Question(torch.zeros(1, 2, 4), torch.tensor([5]), torch.zeros(1, 3), None, 1.0)
    with pytest.raises(RuntimeError, match="no memory"):
        meeting.predict(0, question)
    meeting.leave(0)


@pytest.mark.parametrize("lengths", [(4, 4), (3, 5)])
def test_padding_is_not_attended_to(engine: Engine, lengths: tuple[int, int]) -> None:
    model = engine.pipeline("intergen").model
    generator = torch.Generator().manual_seed(0)
    questions = [
        _Question(
            torch.randn(1, n, 2 * model.layout.token_features, generator=generator),
            torch.tensor([500]),
            torch.randn(1, 64, generator=generator),
            None,
            scale,
        )
        for n, scale in zip(lengths, (3.0, 1.0), strict=True)
    ]
    with torch.no_grad():
        together = answer_together(model.denoiser, questions)
        for q, answer in zip(questions, together, strict=True):
            alone = model.denoiser.guided(q.x, q.t, q.cond, scale=q.scale)
            torch.testing.assert_close(answer, alone, atol=1e-5, rtol=1e-5)
