"""People who are posed in the player: the arithmetic of pulling, and hands, keys and fingers that pull."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion import SMPL22
from motion.kinematics import bone_lengths

from .playing import pause, settled_box, until

pytestmark = pytest.mark.e2e

PULL = """async ([pose, joint, target]) => {
    const { pull } = await import("/player/reach.js");
    return pull(pose, joint, target);
}"""
DIRECT = """() => {
    window.kept = [];
    window.__pasdedeux.player.directing.direct({
        posesAt: () => [null, null],
        keepPoses: (frame, poses) => window.kept.push({ frame, poses }),
    });
}"""
OTHER = """(() => {
    const { player } = window.__pasdedeux, tabs = document.querySelector(".pdd-tabs");
    tabs.innerHTML = "<button role='tab'></button><button role='tab'></button>";
    const { select } = player;
    player.select = () => { throw Error("another sample"); };
    tabs.lastChild.click();
    Object.assign(player, { select });
    tabs.replaceChildren();
})()"""
WRIST, ANKLE, HEAD = (SMPL22.index(name) for name in ("right_wrist", "left_ankle", "head"))
FREE = SMPL22.index("left_wrist")
"""The hand that no other's lies over: the right ones shake each other."""


@pytest.fixture
def still(player) -> Any:
    """A player that stands at frame 60 and may be posed."""
    page = player()
    pause(page)
    page.evaluate(DIRECT)
    page.evaluate("window.__pasdedeux.player.seek(60)")
    until(page, "window.__pasdedeux.frame === 60 && window.__pasdedeux.loops === 0")
    return page


def positions(page: Any, person: int = 0) -> np.ndarray:
    until(page, "window.__pasdedeux.loops === 0")
    return np.array(page.evaluate(f"window.__pasdedeux.positions[{person}]"))


def test_bones_keep_their_lengths_and_joints_go_where_they_reach(still: Any) -> None:
    pose = positions(still)[:, [2, 0, 1]]  # scene axes: z up
    rng = np.random.default_rng(0)
    for name in ("left_wrist", "right_wrist", "left_ankle", "right_ankle", "pelvis", "head"):
        joint = SMPL22.index(name)
        for reach in (0.0, 0.05, 0.3, 3.0):
            way = rng.normal(size=3)
            target = pose[joint] + reach * way / np.linalg.norm(way)
            pulled = np.array(still.evaluate(PULL, [pose.tolist(), joint, target.tolist()]))
            np.testing.assert_allclose(bone_lengths(pulled), bone_lengths(pose), atol=1e-9)
            assert pulled[:, 2].min() > min(pose[:, 2].min(), 0.0) - 1e-9, "nobody is pushed through the floor"
            if reach == 0:
                np.testing.assert_allclose(pulled, pose, atol=2e-3)
    # A hand that is bent back to the chest is reached exactly; hips that sink leave the feet where they stand.
    target = pose[SMPL22.index("right_shoulder")] + [0.25, 0.1, -0.2]
    pulled = np.array(still.evaluate(PULL, [pose.tolist(), WRIST, target.tolist()]))
    np.testing.assert_allclose(pulled[WRIST], target, atol=1e-9)
    pulled = np.array(still.evaluate(PULL, [pose.tolist(), 0, (pose[0] - [0, 0, 0.25]).tolist()]))
    np.testing.assert_allclose(pulled[ANKLE], pose[ANKLE], atol=1e-9)
    ahead = np.cross(pose[1] - pose[2], [0, 0, 1])
    knee = SMPL22.index("left_knee")
    assert (pulled[knee] - pose[knee]) @ ahead > 0, "knees bend forward"
    # The head bends the spine, not more than people can.
    pulled = np.array(still.evaluate(PULL, [pose.tolist(), HEAD, (pose[HEAD] + 9 * ahead).tolist()]))
    bent = np.linalg.norm(pulled[HEAD] - pose[HEAD])
    assert 0.2 < bent < 0.75


def test_a_hand_is_dragged_given_up_and_kept(still: Any) -> None:
    before = positions(still)
    still.locator("[data-act=pose]").click()
    box = settled_box(still.locator(f'.pdd-handle[data-person="0"][data-joint="{FREE}"]'))
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag() -> None:
        still.mouse.move(x, y)
        still.mouse.down()
        still.mouse.move(x + 30, y - 90, steps=4)

    drag()
    assert np.abs(positions(still) - before).max() > 0.1
    still.keyboard.press("Escape")
    still.mouse.up()
    np.testing.assert_allclose(positions(still), before)
    assert still.locator(".pdd-posing").is_visible(), "the drag was given up, not the pose"
    drag()
    still.mouse.up()
    dragged = positions(still)
    assert np.linalg.norm(dragged[FREE] - before[FREE]) > 0.1
    np.testing.assert_allclose(
        positions(still, 1),
        np.array(still.evaluate("window.__pasdedeux.player.everybody(60)[1].map(([z, x, y]) => [x, y, z])")),
    )
    # Another moment or sample is not shown before it is kept or given up.
    still.evaluate(OTHER)
    still.keyboard.press("Home")
    still.locator(".pdd-range").fill("90")
    assert "Keep the pose or cancel" in still.locator(".pdd-posing output").inner_text()
    np.testing.assert_allclose(positions(still), dragged)
    assert still.locator(".pdd-range").input_value() == "60"
    still.get_by_role("button", name="Keep the pose").click()
    (kept,) = still.evaluate("window.kept")
    assert kept["frame"] == 60 and [pose["person"] for pose in kept["poses"]] == ["a"]
    np.testing.assert_allclose(kept["poses"][0]["positions"], dragged, atol=1e-5)
    assert not still.locator(".pdd-posing").is_visible()
    np.testing.assert_allclose(positions(still), before)


def focused(page: Any) -> str:
    return page.evaluate("document.activeElement.title || document.activeElement.className")


def test_a_pose_is_made_without_a_mouse(still: Any) -> None:
    before = positions(still, 0)
    button = still.locator("[data-act=pose]")
    button.focus()
    still.keyboard.press("Enter")
    walked = [focused(still)]
    while len(walked) < 12:
        still.keyboard.press("Tab")
        walked.append(focused(still))
    joints = ("Left hand", "Right hand", "Left foot", "Right foot", "Hips", "Head")
    assert walked == [f"{joint} of {person}" for person in "AB" for joint in joints]
    still.keyboard.press("Tab")
    assert focused(still) == "Leave without keeping it (Escape)", "there is nothing to keep or undo yet"
    for _ in range(11):
        still.keyboard.press("Shift+Tab")
    assert focused(still) == "Right hand of A"
    assert still.locator(".pdd-posing output").inner_text().startswith("Right hand of A at 2.00 s")
    still.keyboard.press("PageUp")
    moved = positions(still, 0)
    assert 0.01 < np.linalg.norm(moved[WRIST] - before[WRIST]) < 0.03
    # The button that undoes the last pull becomes disabled: the focus goes back to the joint.
    undo = still.get_by_role("button", name="Undo")
    undo.focus()
    still.keyboard.press("Enter")
    np.testing.assert_allclose(positions(still, 0), before)
    assert undo.is_disabled() and focused(still) == "Right hand of A"
    still.keyboard.press("ArrowLeft")
    moved = positions(still, 0)
    still.keyboard.press("Enter")
    ((kept,),) = [each["poses"] for each in still.evaluate("window.kept")]
    np.testing.assert_allclose(kept["positions"], moved, atol=1e-5)
    assert focused(still) == button.get_attribute("title"), "the focus is where it was before the pose"
    still.keyboard.press("Enter")
    still.keyboard.press("Escape")
    assert focused(still) == button.get_attribute("title")
    still.locator(".pdd").focus()
    still.keyboard.press("e")
    assert focused(still) == "Left hand of A"
    still.keyboard.press("Escape")
    assert focused(still) == "pdd pdd-styled"
