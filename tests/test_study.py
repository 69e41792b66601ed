"""Which motions stand beside each other in a blind study, and how they are shown."""

from __future__ import annotations

import numpy as np
import pytest

from motion import Duet, InputError
from motion.skeleton import SBU15
from motion.transforms import turn
from tests.server.lab import stub_module
from webdemo.study import FPS, MOST_PAIRS, as_shown, paired

MOTION: Duet = stub_module().walking(1.0)


def test_motions_stand_beside_each_other_in_their_order_and_show_a_common_sentence() -> None:
    hug, bow = ("They hug.", MOTION), ("They bow.", MOTION)
    assert [pair.caption for pair in paired([hug, bow, bow], [hug, hug])] == ["They hug.", ""]


@pytest.mark.parametrize("count", [0, MOST_PAIRS + 1])
def test_none_and_too_many_pairs_are_a_sentence(count: int) -> None:
    with pytest.raises(InputError, match=f"100 pairs of motions, not {count}"):
        paired([("", MOTION)] * count, [("", MOTION)] * count)


def test_motions_of_different_joints_are_a_sentence() -> None:
    other = Duet.from_positions(MOTION.positions[:, :, :15], fps=MOTION.fps, skeleton=SBU15)
    with pytest.raises(InputError, match="different joints"):
        paired([("", MOTION)], [("", other)])


def test_what_is_shown_does_not_tell_where_it_is_from() -> None:
    moved = turn(MOTION.positions, 1.1) + np.array([7.0, 0.0, -3.0])
    other = Duet.from_positions(moved, fps=MOTION.fps, roles=("actor", "reactor"), manifest={"model": "secret"})
    one, two = as_shown(MOTION), as_shown(other)
    np.testing.assert_allclose(one.positions, two.positions, atol=1e-4)
    assert two.manifest is None and two.roles == ("a", "b")
    slow = Duet.from_positions(MOTION.positions[:, ::2], fps=MOTION.fps / 2)
    assert as_shown(slow).fps == FPS and abs(as_shown(slow).seconds - MOTION.seconds) < 0.1
