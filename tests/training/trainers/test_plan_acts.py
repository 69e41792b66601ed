"""What a network is told of a scene's label, and training with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch

from models.intergen.plan_track import PACE, TimedAct
from motion import InputError
from tests.training.trainers.runs import SETTINGS, begin, prepared, take
from training import prepare
from training.corpus.cues import Beat, label
from training.trainers import plan_acts
from training.trainers.plan_acts import PlanShares, acts_of_label, mirrored_act, sides_named, told, vocabulary
from training.trainers.traits import TRAITS

ALL = PlanShares(untimed=0, minor=0, side=0)
STILL_DRAWS = [0.5] * 20
"""Numbers that leave nothing out of a plan of :data:`ALL` and move nothing."""


def scene() -> dict[str, Any]:
    """A row whose label says that a walks up, then pushes b with the left hand, roughly."""
    beats = [
        Beat(("walk-up", "stand-still"), 0, 40, minor=True),
        Beat(("push", "stagger"), 40, 90, sides=("left", None), styles=("angry", "normal")),
    ]
    return {"label": label(beats, 90).row()}


def test_a_label_gives_its_acts_with_people_and_times() -> None:
    acts = acts_of_label(scene())
    by_name = {one.act.name: one for one in acts}
    push = by_name["push"].act
    assert (push.agents, push.patient, push.start, push.stop) == ((0,), 1, 40, 90)
    assert (push.side, push.manner) == ("left", ("angrily",))
    assert by_name["walk-up"].minor and not by_name["push"].minor
    assert by_name["stagger"].act.agents == (1,)
    assert acts_of_label({"label": None}) == ()


def test_only_what_is_common_has_a_word_and_so_has_its_mirror_image() -> None:
    acts = acts_of_label(scene())
    words = vocabulary([acts] * 3, fewest=3)
    assert {"do push", "undergo push", "manner angrily", "side left", "side right"} <= set(words)
    assert list(words) == sorted(words)
    assert vocabulary([acts] * 2, fewest=3) == ()


def test_a_plan_is_moved_cut_and_thinned_as_the_draws_say() -> None:
    acts = acts_of_label(scene())
    whole = told(acts, ALL, STILL_DRAWS, frames=90)
    assert [act.name for act in whole] == [one.act.name for one in acts]
    later = told(acts, ALL, [0.5, 0.5, *([0.5, 1.0, 1.0] * 6)], frames=90)
    assert [act.start - before.start for act, before in zip(later, whole, strict=True)] == [10] * len(whole)
    cut = told(acts, ALL, STILL_DRAWS, before=50, frames=40)
    assert {act.name for act in cut} == {"push", "stagger"}
    assert {(act.start, act.stop) for act in cut if act.name == "push"} == {(-10, 40)}
    assert "walk-up" not in {act.name for act in told(acts, replace(ALL, minor=1), STILL_DRAWS, frames=90)}
    untimed = told(acts, replace(ALL, untimed=1, side=1), STILL_DRAWS, frames=90)
    assert {(act.start, act.stop, act.side) for act in untimed} == {(0, 90, None)}


def test_mirror_images_exchange_sides_and_turns() -> None:
    act = TimedAct("circle", (0,), 0, 9, side="left", direction="clockwise")
    assert mirrored_act(act) == replace(act, side="right", direction="counterclockwise")
    assert mirrored_act(mirrored_act(act)) == act
    assert sides_named([act, replace(act, side="both")]) == "the left hand"


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Prepared scenes with labels."""
    path = prepared(tmp_path_factory.mktemp("made"))
    made = prepare.load(path)
    for i, row in enumerate(made.rows):
        act = ("wave", "stand-still") if i % 2 else ("push", "")
        row["label"] = label([Beat(act, 0, 40, sides=("left", None))], 40).row()
    prepare.save(made, path)
    return path


PLANS = replace(SETTINGS, plans=True, told=PlanShares(neither=0, words=0.3, plan=0.4))


@pytest.fixture(autouse=True)
def rare_words_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan_acts, "FEWEST", 1)


def test_words_plan_or_both_are_told_as_often_as_the_shares_say(scenes: Path, tmp_path: Path) -> None:
    data = begin(scenes, tmp_path, PLANS).data
    assert {"do wave", "do push"} <= set(data.plan_words)
    acts = [bool(word.startswith("do ")) for word in (*data.plan_words, *PACE, *TRAITS)] * 2
    told_of = [
        (batch.read.any(1), batch.plan[..., acts].flatten(1).any(1)) for batch in map(data.batch, range(60))
    ]
    read, planned = (torch.cat(parts) for parts in zip(*told_of, strict=True))
    assert (read | planned).all()
    for share, chosen in ((0.3, read & ~planned), (0.4, planned & ~read), (0.3, read & planned)):
        assert chosen.float().mean().item() == pytest.approx(share, abs=0.1)


def test_a_run_with_plans_learns_to_read_them_and_is_resumed(scenes: Path, tmp_path: Path) -> None:
    trainer = take(begin(scenes, tmp_path, PLANS), 3)
    adapter = trainer.model.denoiser.plan_adapter
    assert adapter.added[0].weight.any() and adapter.whole.weight.any()
    resumed = begin(scenes, tmp_path, PLANS)
    assert resumed.step == 3 and resumed.model.config.plan_words == trainer.data.plan_words
    with_none = begin(scenes, tmp_path / "none", replace(PLANS, plans=False))
    assert with_none.model.denoiser.plan_adapter is None and with_none.data.batch(0).plan.shape[-1] == 0


def test_only_what_reads_the_plan_is_trained_if_asked(scenes: Path, tmp_path: Path) -> None:
    settings = replace(PLANS, only_plan=True)
    trainer = begin(scenes, tmp_path, settings)
    torch.nn.init.normal_(trainer.model.denoiser.out.linear.weight)  # a trained network's is not zero
    begun = {name: value.clone() for name, value in trainer.model.state_dict().items()}
    trained = take(trainer, 3).model.state_dict()
    changed = {name for name, value in trained.items() if not value.equal(begun[name])}
    assert changed and all(name.startswith("denoiser.plan_adapter.") for name in changed)
    resumed = begin(scenes, tmp_path, settings)
    assert resumed.step == 3
    assert all(value.equal(trained[name]) for name, value in resumed.model.state_dict().items())
    with pytest.raises(InputError, match="give --plans"):
        replace(PLANS, only_plan=True, plans=False)
