"""Pipelines without a part, which show what the others do."""

from __future__ import annotations

from typing import Any

from acts.staging.given import places_alone, plan_parts
from motion import InputError


def silence(pipeline: Any) -> None:
    """Puts zeros, a network's mean pose, in the place of all that a diffusion network predicts from now on.

    Raises:
        InputError: for a method that has none.
    """
    network: Any = getattr(model := getattr(pipeline, "model", None), "denoiser", model)
    if network is None or not hasattr(network, "guided"):
        raise InputError(f"{pipeline.name} has no network that denoises: leave --zeros out.")
    network.guided = lambda x, *_, **__: x.new_zeros(x.shape)


def leave_places(pipeline: Any) -> None:
    """Leaves of the plan only the places and headings, for all that a network of scenes makes from now on.

    Raises:
        InputError: for a method that makes no scenes.
    """
    scenes = getattr(pipeline, "scenes", None)
    if scenes is None:
        raise InputError(f"{pipeline.name} has no plan: leave --places out.")
    scenes.planner = lambda *asked: places_alone(plan_parts(*asked))
