"""Two methods' reactions to one actor, side by side on one clock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from webdemo.inference.run import Result
from webdemo.view.payload import Payload, build_payload

from .show import result_payload

SIDES = ("left", "right")


def comparison_payload(results: Mapping[str, Result], *, title: str = "") -> Payload:
    """The player's value for two results of as many samples: each sample of the second beside the first's.

    Args:
        results: by what is written under each view, left and right.
        title: over the scene.
    """
    left, right = (result_payload(result)["samples"] for result in results.values())
    samples = [_side_by_side(pair, tuple(results)) for pair in zip(left, right, strict=True)]
    first = next(iter(results.values()))
    return build_payload(samples, skeleton=first.duets[0].skeleton, title=title)


def _side_by_side(pair: tuple[dict[str, Any], dict[str, Any]], names: tuple[str, ...]) -> dict[str, Any]:
    """Both under one strip: how far apart the people are in each, and the contacts of both."""
    mine, other = pair
    curves = [
        {**sample["curves"][0], "label": f"{sample['curves'][0]['label']}, {side}"}
        for side, sample in zip(SIDES, pair, strict=True)
    ]
    contacts = [
        {**contact, "label": f"{side.capitalize()}: {contact['label']}"}
        for side, sample in zip(SIDES, pair, strict=True)
        for contact in sample["contacts"]
    ]
    beside = {**other, "caption": names[1]}
    return {**mine, "curves": curves, "contacts": contacts, "caption": names[0], "beside": beside}
