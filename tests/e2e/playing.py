"""Hands and eyes of the tests that look at the player: see the fixture ``player``."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image


def press(page, name: str) -> None:
    """Presses a button of the harness, which lies after the player's own."""
    page.get_by_role("button", name=name, exact=True).last.click()


def hook(page, name: str):
    return page.evaluate(f"window.__pasdedeux.{name}")


def unfold(page, *folds: str) -> None:
    """Opens folded parts of the page, by their selectors; what is open already stays so."""
    for fold in folds:
        button = page.locator(f"{fold} > button.label-wrap")
        button.wait_for()
        if "open" not in (button.get_attribute("class") or "").split():
            button.click()
            page.wait_for_timeout(500)  # Gradio puts the first values over what is set as the contents appear


def set_number(page, box: str, value: float | str) -> None:
    """Types a number into a field; Gradio puts the first value back over what is typed as a fold opens."""
    field = page.locator(f"{box} input[type=number]").first
    for _ in range(20):
        field.fill(str(value))
        field.press("Tab")
        page.wait_for_timeout(500)
        if field.input_value() == str(value):
            return
    raise AssertionError(f"{box} does not take {value}.")


def choose(page, box: str, option: str) -> None:
    """Chooses in a dropdown of the page; another one's list may still be fading out beside it."""
    page.click(f"{box} input")
    page.locator(box).get_by_role("option", name=option, exact=True).click()


def give_file(page, field: str, file) -> None:
    """Gives a file to a field, which takes none while it shows another."""
    clear = page.locator(f"{field} button[aria-label='Clear']")
    if clear.count():
        clear.click()
    page.set_input_files(f"{field} input[type=file]", file)


def settled_box(locator) -> dict[str, float]:
    """The box of a handle once it lies still: the player places it with the next picture."""
    until(locator.page, "document.querySelector('.pdd-handle')?.style.transform")
    box = None
    for _ in range(100):
        last, box = box, locator.bounding_box()
        if box is not None and box == last:
            return box
        locator.page.wait_for_timeout(50)
    raise AssertionError("It does not come to rest.")


def until(page, expression: str, seconds: float = 120) -> None:
    """Waits until an expression is true; it may speak of what the page has not made yet."""
    page.wait_for_function(
        f"() => {{ try {{ return {expression}; }} catch {{ return false; }} }}", timeout=1000 * seconds
    )


def pause(page) -> None:
    if hook(page, "playing"):
        page.locator(".pdd-play").click()
    until(page, "!window.__pasdedeux.playing && window.__pasdedeux.loops === 0")


def stage_pixels(page) -> np.ndarray:
    """The scene alone: names and buttons have the same colours."""
    style = ".pdd-labels, .pdd-tools { visibility: hidden }"
    shot = page.locator(".pdd-stage:visible").screenshot(style=style)
    image = Image.open(io.BytesIO(shot)).convert("RGB")
    return np.asarray(image, dtype=np.int16)


def has_color(pixels: np.ndarray, *, blue: bool) -> bool:
    """Whether some thousand pixels are clearly of A's blue or of B's orange, which is stronger than skin."""
    warmth = pixels[..., 0] - pixels[..., 2]
    return int((warmth < -80 if blue else warmth > 130).sum()) > 1000


def drag(page, dx: float, dy: float, steps: int = 12) -> None:
    box = page.locator(".pdd-touch").bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx, y + dy, steps=steps)
    page.mouse.up()


def yaw(page) -> float:
    return page.evaluate("window.__pasdedeux.player.orbit.yaw")
