"""ReGenNet in the engine: what *online* promises, from the clip to the picture."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.diffusion import make_scheduler, top_timesteps
from models.motion_tokens import FEATURES, encode
from models.regennet.compact import CompactReGenNet, CompactReGenNetConfig, CompactStream
from models.weights_io import load_network, save_network
from motion import SMPL22, InputError
from motion.kinematics import bone_lengths
from webdemo.inference import ReactRequest, Result
from webdemo.inference.engine import Engine
from webdemo.inference.pipelines import regennet as reactor
from webdemo.view.payload import player_payload

from .people import waver


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.manual_seed(0)
    model = CompactReGenNet(
        CompactReGenNetConfig(
            latent_dim=32, ff_size=32, num_layers=2, num_heads=2, cond_dim=32, text_layers=1, window=8
        )
    )
    torch.nn.init.normal_(model.offline)
    rest = torch.tensor(SMPL22.rest_positions()).float() + torch.tensor([0.0, 0.98, 0.0])
    control = encode(rest.expand(41, -1, -1), torch.ones(41, 4), model.layout)
    model.mean.copy_(control.mean(0))
    model.std.fill_(0.1)
    folder = tmp_path_factory.mktemp("weights")
    save_network(folder / "regennet", model, card={"summary": "a tiny untrained model"})
    return folder


@pytest.fixture(scope="module")
def engine(folder: Path) -> Engine:
    return Engine(folder)


@pytest.fixture(scope="module")
def network(folder: Path) -> CompactReGenNet:
    return load_network(folder / "regennet", CompactReGenNet)[0]


REQUEST = ReactRequest(actor=waver(2.5), model="regennet", mode="online", steps=3, seed=4)


def react(engine: Engine, **changed: object) -> Result:
    return next(e for e in engine.run(replace(REQUEST, **changed)) if isinstance(e, Result))


@pytest.mark.parametrize("changed", [{}, {"prompt": "Two people wave.", "guidance": 2.0, "samples": 2}])
@pytest.mark.parametrize("until", [1, 43])
def test_online_the_future_changes_no_frame_by_a_bit(engine: Engine, until: int, changed: dict) -> None:
    """From the clip to the picture: what the player is sent of the reaction is the same up to that frame."""
    positions = waver(2.5).positions.copy()
    positions[until:] = positions[until:, ::1] + np.float32([3.0, 0.4, -2.0])
    one = react(engine, **changed).duets
    other = react(engine, actor=waver(2.5).with_positions(positions), **changed).duets
    for a, b in zip(one, other, strict=True):
        assert a.b.positions[:until].tobytes() == b.b.positions[:until].tobytes()
        assert a.b.positions[until + 8 :].tobytes() != b.b.positions[until + 8 :].tobytes()
        shown = [json.dumps(player_payload(d.b.cut(0, until)), sort_keys=True) for d in (a, b)]
        assert shown[0] == shown[1]


@pytest.mark.parametrize("mode", ["online", "offline"])
def test_a_reaction_begins_in_the_given_first_pose(engine: Engine, mode: str) -> None:
    pose = waver(2.5).positions[0] + np.array([0.3, 0.0, 1.2])
    free = react(engine, mode=mode, cleanup=False).duets[0].b.positions
    held = react(engine, mode=mode, cleanup=False, first_pose=pose).duets[0].b.positions
    assert np.abs(free[0] - pose).max() > 0.1
    assert np.abs(held[0] - pose).max() < 1e-4
    steps = np.linalg.norm(np.diff(held, axis=0), axis=-1).max()
    assert steps < np.linalg.norm(np.diff(free, axis=0), axis=-1).max() + 0.5  # no jump: it settles


@pytest.mark.parametrize(
    ("pose", "model", "why"),
    [
        (np.zeros((21, 3)), "regennet", "22 joints"),
        (np.full((22, 3), np.nan), "regennet", "finite|NaN"),
        (np.zeros((22, 3)), "regennet", "bones"),
        (waver(2.5).positions[0], "intergen", "no first pose"),
    ],
)
def test_bad_first_poses_are_refused(pose: np.ndarray, model: str, why: str) -> None:
    with pytest.raises(InputError, match=why):
        ReactRequest(actor=waver(2.5), model=model, first_pose=pose)


def test_sampling_begins_with_pure_noise(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list = []

    def make(*of: object, **how: object) -> object:
        made.append(make_scheduler(*of, **how))
        return made[0]

    monkeypatch.setattr(reactor, "make_scheduler", make)
    react(engine, mode="offline")
    assert made[0].timesteps.tolist() == top_timesteps(REQUEST.steps).tolist()


def test_offline_sees_the_future(engine: Engine) -> None:
    positions = waver(2.5).positions.copy()
    positions[60:] += np.float32([1.0, 0, 0])
    one = react(engine, mode="offline").duets[0].b.positions
    other = react(engine, mode="offline", actor=waver(2.5).with_positions(positions)).duets[0].b.positions
    assert np.abs(one[:30] - other[:30]).max() > 1e-4


def test_the_stream_is_the_sampling_of_the_whole_at_once(network: CompactReGenNet) -> None:
    """Cached keys, the window and the one row at a time change nothing but the order of the sums."""
    from models.diffusion import denoise, make_scheduler

    frames, actor = 90, torch.from_numpy(np.asarray(waver(3.0).positions)).float()
    rows = network.num_rows(frames)
    noise = torch.randn(rows, 1, FEATURES, generator=torch.Generator().manual_seed(1))
    condition = torch.randn(1, 32, generator=torch.Generator().manual_seed(2))
    stream = CompactStream(network, condition, steps=3, max_frames=frames)
    left = iter(noise)
    streamed = torch.stack([stream.step(frame, noise=left)[0][0] for frame in actor])
    seen = network.actor_rows(actor[None])

    def predict(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        return network(x, t, seen, condition, causal=True)

    sample = denoise(predict, noise.transpose(0, 1), make_scheduler("ddim", 3, spacing="top"))
    whole = network.positions(sample, frames)[0][0]
    torch.testing.assert_close(streamed, whole, atol=1e-4, rtol=0)


@pytest.mark.parametrize("mode", ["online", "offline"])
def test_the_given_person_stays_and_the_reaction_differs_by_seed_and_words(engine: Engine, mode: str) -> None:
    result = react(engine, mode=mode, samples=2)
    for duet in result.duets:
        assert duet.a.positions.tobytes() == waver(2.5).positions.tobytes()
    one, two = (duet.b.positions for duet in result.duets)
    assert np.abs(one - two).max() > 1e-3
    first = react(engine, mode=mode).duets[0].b.positions
    assert first.tobytes() == react(engine, mode=mode).duets[0].b.positions.tobytes()
    assert np.abs(first - react(engine, mode=mode, seed=5).duets[0].b.positions).max() > 1e-3
    assert np.abs(first - react(engine, mode=mode, prompt="They bow.").duets[0].b.positions).max() > 1e-6


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"role": "b"}, "makes the person who reacts"),
        ({"sampler": "dpm++"}, "does not sample with dpm"),
        ({"mode": "backwards"}, "choose offline or online"),
    ],
)
def test_what_regennet_cannot_do_is_said_in_one_sentence(changed: dict, says: str) -> None:
    with pytest.raises(InputError, match=rf"\A.*{says}.*\Z"):
        replace(REQUEST, **changed)


def test_offline_damping_moves_the_reactor_alone(engine: Engine) -> None:
    plain = react(engine, mode="offline", damping=0.0, cleanup=False)
    damped = react(engine, mode="offline", damping=1.0, cleanup=False)
    actor = REQUEST.actor.positions
    for result in (plain, damped):
        np.testing.assert_array_equal(result.duets[0].a.positions, actor)
    moved = np.abs(damped.duets[0].b.positions - plain.duets[0].b.positions).max()
    assert 1e-3 < moved < 2.0
    assert bones_off(damped.duets[0].b.positions) < bones_off(plain.duets[0].b.positions)


def bones_off(positions: np.ndarray) -> float:
    """How far bones are from the skeleton's, on average, in metres."""
    return float(np.abs(bone_lengths(positions) - SMPL22.bone_lengths[1:]).mean())


def test_words_that_ask_for_a_touch_reach_the_damping(
    engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hands = (("right_wrist", "right_wrist"),)
    network = load_network(engine.weights / "regennet", CompactReGenNet)[0]
    asking = CompactReGenNet(replace(network.config, touches=(hands,)))
    asking.load_state_dict(network.state_dict(), strict=False)
    assert asking.touch_reader is not None
    with torch.no_grad():  # whatever is said is taken for a handshake
        asking.touch_reader.net[-1].weight.zero_()
        asking.touch_reader.net[-1].bias.copy_(torch.tensor([-9.0, 9.0]))
    save_network(tmp_path / "regennet", asking)
    heard = []

    class Listening(reactor.Damping):
        def __init__(self, *given: object, touches: object, **named: object) -> None:
            heard.append(list(touches))
            super().__init__(*given, touches=touches, **named)

    monkeypatch.setattr(reactor, "Damping", Listening)
    for chosen in (engine, Engine(tmp_path)):
        for prompt in ("", "They shake hands."):
            react(chosen, mode="offline", prompt=prompt, samples=2)
    assert heard == [[], [(), ()], [], [hands, hands]]
