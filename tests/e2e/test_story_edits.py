"""Poses stay with their beats while these move, and changes that were not made yet outlive a reload."""

from __future__ import annotations

from typing import Any

import pytest

pytestmark = pytest.mark.e2e

STORY = {
    "beats": [{"words": str(s), "a": "", "b": "", "seconds": s, "auto": s} for s in (2, 3, 4)],
    "poses": [{"person": "a", "seconds": s, "positions": []} for s in (0.5, 3, 8, 9.5)],
    "paths": [], "loop": False, "span": None,
}  # fmt: skip
EDIT = """async ([story, calls]) => {
    const edits = await import("/story/edits.js");
    for (const [name, ...values] of calls) story = edits[name](story, ...values);
    return story.poses.map((pose) => pose.seconds);
}"""


@pytest.mark.parametrize(
    ("calls", "seconds"),
    [
        ([["stretch", 0, 3]], [0.5, 4, 9, 10.5]),
        ([["stretch", 0, 3], ["stretch", 0, 2]], [0.5, 3, 8, 9.5]),
        ([["stretch", 1, 0.5]], [0.5, 2.4667, 5.5, 7]),  # the pose comes to the end of its beat
        ([["move", 0, 1]], [0.5 + 3, 1, 8, 9.5]),
        ([["add", 0]], [0.5, 7, 12, 13.5]),
        ([["remove", 1]], [0.5, 5, 6.5]),
        ([["split", 2]], [0.5, 3, 8, 9.5]),
        ([["split", 2], ["move", 3, -1]], [0.5, 3, 6, 9.5]),
        ([["change", 0, {"words": "w"}]], [0.5, 3, 8, 9.5]),
        ([["change", 0, {"seconds": None}], ["measured", [5, 3, 4]]], [0.5, 6, 11, 12.5]),
    ],
)
def test_poses_stay_with_their_beats(player: Any, calls: list[Any], seconds: list[float]) -> None:
    found = player(None).evaluate(EDIT, [STORY, calls])
    assert found == pytest.approx(sorted(seconds), abs=1e-4)


DRAFT = """async ([before, after]) => {
    const { Draft } = await import("/story/draft.js");
    sessionStorage.clear();
    const made = { beats: [{ words: "They wave.", a: null, b: "", seconds: 2 }] };
    const changed = { ...made, poses: [{ person: "a", seconds: 1, positions: [] }] };
    const draft = new Draft();
    draft.given(null);
    draft.given(before ?? made);
    draft.keep(changed);
    const reloaded = new Draft();
    reloaded.given(null);
    return [reloaded.given(after ?? made)?.poses.length ?? null, sessionStorage.length];
}"""
OTHER = {"beats": [{"words": "They bow.", "a": "", "b": ""}]}


def test_changes_that_were_not_made_outlive_a_reload_with_their_story(player: Any) -> None:
    page = player(None)
    assert page.evaluate(DRAFT, [None, None]) == [1, 1]
    assert page.evaluate(DRAFT, [None, OTHER]) == [None, 0]


def test_what_was_made_is_no_draft(player: Any) -> None:
    found = player(None).evaluate(
        """async (story) => {
            const { Draft } = await import("/story/draft.js");
            const draft = new Draft();
            draft.keep(story);
            draft.given(story);
            return [sessionStorage.length, new Draft().given(story)];
        }""",
        OTHER,
    )
    assert found == [0, None]


def test_a_browser_without_storage_keeps_nothing_and_says_nothing(player: Any) -> None:
    found = player(None).evaluate(
        """async (story) => {
            const { Draft } = await import("/story/draft.js");
            const none = () => { throw new Error("refused"); };
            const draft = new Draft({ getItem: none, setItem: none, removeItem: none });
            draft.keep(story);
            return draft.given(story);
        }""",
        OTHER,
    )
    assert found is None
