"""What is known is met by what a network makes, and nothing else is moved more than it must be."""

import numpy as np
import pytest
import torch
from torch import Tensor

from models.known import KNOWN_FEATURES, Hold, Known
from models.motion_tokens import FEATURES, TokenLayout, decode, encode, feature_rows, foot_contacts, pack, unpack
from motion import SMPL22
from motion.transforms import heading_matrix

LAYOUT = TokenLayout()
TOKENS = 8
FRAMES = LAYOUT.num_frames(TOKENS)
MEAN, STD = torch.linspace(-0.5, 0.5, FEATURES), torch.linspace(0.2, 1.5, FEATURES)


def people(seed: int = 0) -> Tensor:
    """Two people who walk about and turn: (2, T, 22, 3)."""
    time = np.arange(FRAMES) / 30
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    made = []
    for person in range(2):
        turned = rest @ heading_matrix(0.7 * time + person).swapaxes(-1, -2)
        place = np.stack([np.sin(time + person), 0 * time, time], -1)
        made.append(turned + place[:, None] + 0.05 * np.sin(3 * time + seed)[:, None, None])
    return torch.from_numpy(np.stack(made)).float()


def made_by_a_network(batch: int = 1, seed: int = 3) -> Tensor:
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(batch, TOKENS, 2 * LAYOUT.token_features, generator=generator)


def positions(x: Tensor) -> Tensor:
    return decode(unpack(x, LAYOUT) * STD + MEAN, LAYOUT)[0]


def held(known: Known, x: Tensor) -> Tensor:
    return Hold(known, LAYOUT, MEAN, STD)(x)


def test_a_person_who_is_known_throughout_stays_as_encoded():
    motion, x = people(), made_by_a_network(3)
    known = Known.nothing(FRAMES)
    known.add_person(1, motion[1])
    expected = (encode(motion[1], foot_contacts(motion[1]), LAYOUT) - MEAN) / STD
    control, free = unpack(held(known, x), LAYOUT), unpack(x, LAYOUT)
    assert torch.equal(control[:, 1], expected.expand(3, -1, -1))
    assert torch.equal(control[:, 0], free[:, 0])
    frozen = unpack(Hold(known, LAYOUT, MEAN, STD).frozen, LAYOUT)
    assert frozen[:, 1].all() and not frozen[:, 0].any()


def test_a_pose_is_met_and_the_rest_of_the_motion_stays():
    motion, x = people(), made_by_a_network()
    known = Known.nothing(FRAMES)
    known.add_person(0, motion[0, 21:22], [21])
    before, after = positions(x), positions(held(known, x))
    assert torch.linalg.vector_norm(after[0, 0, 21] - motion[0, 21], dim=-1).max() < 0.01
    assert torch.linalg.vector_norm(before[0, 0, 21] - motion[0, 21], dim=-1).max() > 0.3
    assert torch.equal(after[:, 1], before[:, 1])
    far = [frame for frame in range(FRAMES) if abs(frame - 21) > 16]
    assert torch.allclose(after[0, 0, far], before[0, 0, far], atol=1e-5)
    # Met again at every step of the sampler, it is met to a hair.
    again = positions(held(known, held(known, x)))
    assert torch.linalg.vector_norm(again[0, 0, 21] - motion[0, 21], dim=-1).max() < 1e-4


def test_a_span_is_met_between_its_edges():
    motion = people()
    true = (encode(motion, foot_contacts(motion), LAYOUT) - MEAN) / STD
    x = pack(true[None], LAYOUT) + 0.1 * made_by_a_network()
    known = Known.nothing(FRAMES)
    known.add_person(0, motion[0, 10:30], range(10, 30))
    assert torch.linalg.vector_norm(positions(x)[0, 0, 10:30] - motion[0, 10:30], dim=-1).max() > 0.05
    found = positions(held(known, x))
    assert torch.linalg.vector_norm(found[0, 0, 10:30] - motion[0, 10:30], dim=-1).max() < 0.005
    assert torch.equal(found[:, 1], positions(x)[:, 1])


@pytest.mark.parametrize("frames", [range(FRAMES), [5, 20, 44]])
def test_a_path_is_followed_and_nothing_else_is_known(frames):
    motion, x = people(), made_by_a_network()
    known = Known.nothing(FRAMES)
    at = list(frames)
    known.add_path(1, at, motion[1, at, 0][:, [0, 2]])
    before, after = unpack(x, LAYOUT), unpack(held(known, held(known, x)), LAYOUT)
    found = decode(after * STD + MEAN, LAYOUT)[0][0, 1, at, 0]
    assert (found - motion[1, at, 0])[:, [0, 2]].abs().max() < 1e-3
    others = [i for i in range(FEATURES) if i not in (0, 2)]
    assert torch.equal(after[..., others], before[..., others])
    assert torch.equal(after[:, 0], before[:, 0])


def test_each_motion_of_a_batch_has_its_own_known_part():
    motion, x = people(), made_by_a_network(3)
    known, alone = Known.nothing(FRAMES, batch=3), Known.nothing(FRAMES)
    known.rows[2], known.mask[2, 1, 20:, 3:9] = feature_rows(motion, torch.zeros(2, FRAMES, 4)), True
    alone.rows[0], alone.mask[0] = known.rows[2], known.mask[2]
    found = held(known, x)
    assert torch.equal(found[:2], x[:2])
    assert torch.allclose(found[2:], held(alone, x[2:]), atol=1e-6)
    assert not torch.allclose(found[2], x[2], atol=0.1)


def test_features_say_what_is_known_and_when():
    motion = people()
    known = Known.nothing(FRAMES)
    known.add_path(0, [16], motion[0, 16:17, 0][:, [0, 2]], headings=torch.tensor([0.5]))
    features = Hold(known, LAYOUT, MEAN, STD).features
    assert features.shape == (1, TOKENS, 2 * 2 * KNOWN_FEATURES)
    knots = features.view(1, TOKENS, 2, 2, KNOWN_FEATURES).permute(0, 2, 1, 3, 4).reshape(2, -1, KNOWN_FEATURES)
    assert knots[1].abs().max() == 0
    values, mask, turned, given = knots[0].split([FEATURES, FEATURES, 2, 1], -1)
    at = 16 // 4 + 1  # the knot that lies at frame 16
    assert mask.nonzero().tolist() == [[at, 0], [at, 2]]
    assert given.nonzero().tolist() == [[at, 0]]
    assert torch.allclose(turned[at], torch.tensor([np.sin(0.5), np.cos(0.5)]).float())
    expected = (motion[0, 16, 0] - MEAN[:3]) / STD[:3]
    assert torch.allclose(values[at, [0, 2]], expected[[0, 2]])


def test_a_bend_meets_the_past_with_less_of_a_jolt_than_the_least_move():
    motion, x = people(), torch.zeros(1, TOKENS, 2 * LAYOUT.token_features)
    known = Known.nothing(FRAMES)
    for person in range(2):
        known.add_person(person, motion[person, :20])
    hold = Hold(known, LAYOUT, MEAN, STD)
    least, bent = positions(hold(x))[0], positions(hold.bend(x))[0]
    for made in (least, bent):
        assert torch.linalg.vector_norm(made[:, :20] - motion[:, :20], dim=-1).max() < 0.02
    jolts = [torch.linalg.vector_norm(made[:, 18:26].diff(n=2, dim=1), dim=-1).mean() for made in (least, bent)]
    assert jolts[1] < 0.7 * jolts[0]
    moved = bent - positions(x)[0]
    assert moved[:, -1].abs().max() < 0.2 * moved.abs().max(), "far from what is known the motion stays"


def test_the_share_that_is_laid_out_is_that_which_a_network_no_longer_moves():
    def shares(known: Known) -> Tensor:
        return Hold(known, LAYOUT, MEAN, STD).shares

    motion, known = people(), Known.nothing(FRAMES)
    assert shares(known).shape == (FRAMES,) and not shares(known).any()
    known.add_person(0, motion[0, ::3], range(0, FRAMES, 3))
    assert shares(known) == pytest.approx(0.5, abs=0.01), "between known frames, too, and b is free"
    moved = torch.stack([positions(held(known, made_by_a_network(1, seed)))[0] for seed in range(40)])
    spread, free = (each[:, :-1, 1:].std(0).mean() for each in (moved[:, 0], moved[:, 1]))
    assert spread < 0.02 * free
    known.add_person(1, motion[1, :3], range(3))
    after = shares(known)
    assert after[:3].min() > 0.99 and after[3:].diff().max() < 0.01 and after[12] == pytest.approx(0.5, abs=0.01)
    both = Known.nothing(FRAMES, batch=2)
    both.add_joints(1, motion[1], range(FRAMES), range(11))
    assert shares(both) == pytest.approx(0.25, abs=1e-3), "half of the joints of one of two people"


def test_a_single_pose_says_nothing_of_planted_feet() -> None:
    known = Known.nothing(8)
    known.add_person(0, torch.zeros(1, 22, 3), [3])
    assert known.mask[0, 0, 3, :-4].all() and not known.mask[..., -4:].any()
