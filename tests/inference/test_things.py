"""The things and the looks of a result."""

from __future__ import annotations

import numpy as np

from acts import read
from motion import Duet
from motion.looks import UNSAID
from motion.skeleton import SBU15
from tests.acts.things.furnishing import FPS, standing
from webdemo.inference.finish.looks import furnished
from webdemo.inference.run import Result


def test_other_skeletons_stay_as_they_are():
    duet = Duet.from_positions(np.random.default_rng(0).normal(size=(2, 9, 15, 3)), fps=30, skeleton=SBU15)
    same = furnished(Result(duets=(duet,), manifest={}), [(read("A holds a cup."), 0, None, None)])
    assert same.duets[0] is duet and same.manifest == {}


def test_people_look_as_their_plans_say():
    """A later plan adds what an earlier one leaves open and changes nothing that it says."""
    result = Result(duets=(Duet.from_positions(standing().astype(np.float32), fps=FPS),), manifest={})
    first, second = read("She bows."), read("An old man waves at a boy.")
    both = furnished(result, [(first, 0, 60, 0), (second, 60, None, 1)]).duets[0]
    assert both.looks == ("old-woman", "boy")
    assert furnished(result, []).duets[0].looks == UNSAID
