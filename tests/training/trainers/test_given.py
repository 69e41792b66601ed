"""What is given in training: every kind is drawn, and each is what its name says."""

import torch
from torch import Tensor

from models.known import FLOOR, Known
from models.motion_tokens import FEATURES, TokenLayout
from training.trainers.given import POSE, Shares, drafted, known_parts

LAYOUT = TokenLayout()
TOKENS = 10
FRAMES = LAYOUT.num_frames(TOKENS)
NONE = Shares(*[0.0] * 9)


def control(batch: int) -> Tensor:
    return torch.randn(batch, 2, 2 * TOKENS, FEATURES, generator=torch.Generator().manual_seed(0))


def draw(kind: str, batch: int = 40, frames: int = FRAMES - 9) -> Known:
    shares = Shares(**{**vars(NONE), kind: 1.0})
    known = known_parts(control(batch), [frames] * batch, [0] * batch, LAYOUT, shares, torch.Generator().manual_seed(1))
    assert known is not None
    assert not known.mask[:, :, frames:].any() and not known.heading_mask[:, :, frames:].any()
    return known


def test_a_person_is_given_whole() -> None:
    mask = draw("person").mask[:, :, : FRAMES - 9]
    assert (mask.flatten(2).all(-1).sum(1) == 1).all() and (mask.flatten(2).any(-1).sum(1) == 1).all()
    assert 5 < mask[:, 0].flatten(1).all(1).sum() < 35


def test_the_past_of_both_is_given_from_the_beginning() -> None:
    mask = draw("past").mask
    assert torch.equal(mask[:, 0], mask[:, 1])
    counts = mask[:, 0, :, 0].sum(1)
    assert counts.min() >= 1 and counts.max() <= 0.6 * (FRAMES - 9) + 1 and len(counts.unique()) > 10
    assert all(row[:count].all() for row, count in zip(mask[:, 0], counts, strict=True))


def test_all_but_a_span_is_given() -> None:
    frames = FRAMES - 9
    mask = draw("span", batch=90).mask[:, :, :frames]
    both = mask.flatten(2).any(-1).all(1)
    assert 10 < both.sum() < 50
    for motion in mask:
        person = motion[int(not motion[0].any())][:, 0]
        hidden = (~person).nonzero().flatten()
        assert 0.1 * frames < len(hidden) < 0.75 * frames
        assert len(hidden) == hidden.max() - hidden.min() + 1


def test_a_few_poses_are_given_without_the_contacts_of_feet() -> None:
    mask = draw("poses").mask
    assert not mask[..., POSE:].any()
    counts = mask[..., 10].sum(2)
    assert counts.max() == 3 and (counts.sum(1) >= 1).all()
    anywhere = mask[..., 10] & ~mask[..., 0]
    assert 0 < anywhere.sum() < mask[..., 10].sum()


def test_paths_are_places_on_the_floor_and_half_of_them_headings() -> None:
    known = draw("path")
    others = [i for i in range(FEATURES) if i not in FLOOR]
    assert not known.mask[..., others].any()
    assert torch.equal(known.mask[..., 0], known.mask[..., 2])
    turned = known.heading_mask.flatten(1).any(1)
    assert 10 < turned.sum() < 30
    assert torch.equal(known.heading_mask[turned], known.mask[turned][..., 0])
    counts = known.mask[..., 0].sum(2)
    assert (counts == FRAMES - 9).any() and ((counts > 0) & (counts <= 6)).any()


def test_places_are_ways_on_the_floor_and_hips_where_people_are_turned() -> None:
    known = draw("places", batch=200)
    mask, turned = known.mask.flatten(0, 1), known.heading_mask.flatten(0, 1)
    ways = turned.any(1)
    assert 250 < ways.sum() < 380, "of both in most, and of one in the others"
    assert not mask[~ways].any()
    hips = mask[ways][..., [3, 5, 6, 8]].all(-1)
    assert torch.equal(hips, turned[ways]), "where a person is turned, the hips are held"
    assert mask[ways][..., 0][turned[ways]].all() and not mask[ways][..., 4].any()
    apart = [row.any(-1).nonzero()[:, 0].diff() for row in mask if row.any()]
    assert sum(bool(len(gaps)) and int(gaps.median()) > 3 for gaps in apart) > 200, "not at every frame"


def test_the_past_of_a_continued_scene_is_given_in_any_case() -> None:
    known = known_parts(control(2), [FRAMES] * 2, [0, 13], LAYOUT, NONE, torch.Generator())
    assert known is not None
    assert not known.mask[0].any() and not known.mask[1, :, 13:].any()
    assert known.mask[1, :, :13].all()


def test_a_draft_is_near_the_motion_and_not_the_motion() -> None:
    still = control(200) * 0.1
    known = drafted(still, [FRAMES - 9] * 200, LAYOUT, 0.75, torch.Generator().manual_seed(1))
    mask, rows = known.mask, LAYOUT.basis(TOKENS) @ still
    assert not mask[:, :, FRAMES - 9 :].any() and not mask[..., [0, 2]].any() and not mask[..., POSE:].any()
    assert not known.heading_mask.any()
    none = (~mask.flatten(1).any(1)).float().mean()
    assert 0.15 < none < 0.5, "in some of the others neither person has one"
    off = (known.rows - rows)[mask].abs()
    assert 0.01 < off.median() < 0.15
    again = drafted(still, [FRAMES - 9] * 200, LAYOUT, 0.75, torch.Generator().manual_seed(1))
    assert torch.equal(again.mask, mask) and torch.equal(again.rows[mask], known.rows[mask])
