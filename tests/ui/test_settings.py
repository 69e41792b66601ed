"""Settings that follow a motion."""

from webdemo.ui.components.fields import FittedSlider


def test_a_value_that_was_on_its_way_when_the_motion_became_shorter_is_its_end() -> None:
    slider = FittedSlider(0, 4.0, value=4.0)
    assert [slider.preprocess(seconds) for seconds in (5.0, 3.0, -1.0)] == [4.0, 3.0, 0]
