"""Steps drawn by worker processes are those that one process draws."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
import torch
from torch import Tensor

from training.core.loop import drawn_ahead, moved


@dataclass
class Draw:
    step: int
    numbers: Tensor


def draw(step: int) -> Draw:
    return Draw(step, torch.rand(1000, generator=torch.Generator().manual_seed(step)))


def test_workers_draw_the_same_in_the_same_order() -> None:
    alone, ahead = [draw(step) for step in range(3, 14)], list(drawn_ahead(draw, range(3, 14), 2, "cpu"))
    assert [one.step for one in ahead] == [*range(3, 14)]
    assert all(torch.equal(a.numbers, b.numbers) for a, b in zip(alone, ahead, strict=True))


def test_a_dataclass_is_moved_with_all_that_it_holds() -> None:
    @dataclass
    class Outer:
        inner: Draw
        name: str

    there = moved(Outer(draw(1), "x"), "meta")
    assert there.inner.numbers.device.type == "meta" and there.name == "x" and there.inner.step == 1


def fail(step: int) -> Draw:
    raise ValueError(f"step {step}")


def test_the_error_of_a_worker_is_raised_where_the_step_is_taken() -> None:
    with pytest.raises(ValueError, match="step 3"):
        next(drawn_ahead(fail, range(3, 14), 1, "cpu"))
