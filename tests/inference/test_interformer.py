"""InterFormer in the engine: a person in, another one out, whole and on constant bones."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.errors import WeightsError
from models.interformer.compact import CompactInterFormer, CompactInterFormerConfig
from models.weights_io import save_network
from motion import SMPL22, InputError
from motion.kinematics import bone_lengths
from webdemo.inference import GenerateRequest, ReactRequest, Result
from webdemo.inference.engine import Engine

from .people import waver


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Engine:
    torch.manual_seed(0)
    model = CompactInterFormer(CompactInterFormerConfig(joint_width=4, ff_size=16, window=12))
    torch.nn.init.normal_(model.out.weight, std=0.05)  # which begins at zero
    model.step_std.fill_(0.01)
    model.stance.copy_(torch.tensor(SMPL22.rest_positions()).float() + torch.tensor([0.0, 0.98, 0.0]))
    folder = tmp_path_factory.mktemp("weights")
    save_network(folder / "interformer", model, card={"summary": "a tiny untrained model"})
    return Engine(folder)


REQUEST = ReactRequest(actor=waver(3.0), model="interformer", seed=4)


def react(engine: Engine, **changed: object) -> Result:
    return next(e for e in engine.run(replace(REQUEST, **changed)) if isinstance(e, Result))


def test_the_actor_stays_and_the_reactor_has_constant_bones_without_popping(engine: Engine) -> None:
    duet = react(engine).duets[0]
    assert duet.roles == ("actor", "reactor")
    np.testing.assert_array_equal(duet.a.positions, REQUEST.actor.positions)
    reactor = duet.b.positions
    assert reactor.shape == (90, 22, 3) and np.isfinite(reactor).all()
    assert np.ptp(bone_lengths(reactor), axis=0).max() < 1e-4
    # Windows of 12 frames at 15 a second end within the motion, where nothing may be seen of it.
    assert np.abs(np.diff(reactor, axis=0)).max() < 0.1


def test_it_answers_more_than_ten_seconds_window_by_window(engine: Engine) -> None:
    assert react(engine, actor=waver(12.0), cleanup=False).duets[0].b.num_frames == 360
    with pytest.raises(InputError, match=r"61\.0 s: trim it to 60 s or less"):
        replace(REQUEST, actor=waver(61.0))


def test_a_reaction_begins_in_the_given_first_pose(engine: Engine) -> None:
    pose = react(engine).duets[0].b.positions[0].astype(float) + np.array([0.2, 0.0, 0.1])
    found = react(engine, first_pose=pose, cleanup=False).duets[0].b.positions[0]
    np.testing.assert_allclose(found, pose, atol=1e-4)


def test_a_seed_repeats_and_noise_makes_another_reaction(engine: Engine) -> None:
    one, again = react(engine, samples=2), react(engine)
    np.testing.assert_allclose(one.duets[0].b.positions, again.duets[0].b.positions, atol=1e-5)
    assert np.abs(one.duets[1].b.positions - one.duets[0].b.positions).max() > 1e-3
    assert np.abs(react(engine, seed=5).duets[0].b.positions - again.duets[0].b.positions).max() > 1e-3


def test_what_it_cannot_do_is_said(engine: Engine, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="InterFormer does not generate: choose one of intergen"):
        GenerateRequest(prompt="Two people wave.", model="interformer")
    with pytest.raises(WeightsError):
        list(Engine(tmp_path).run(REQUEST))
