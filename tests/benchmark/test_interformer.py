"""The figures of InterFormer's speed."""

from webdemo.benchmark.interformer import measure_interformer


def test_both_ways_are_measured_beside_their_goals() -> None:
    figures = measure_interformer(1)
    assert figures["interformer_weights"] in ("shipped", "untrained")
    assert figures["interformer_48_frames"] > 0 and figures["interformer_48_frames_goal"] == 0.3
    assert figures["interformer_plain_over_cached"] > 0 and figures["interformer_plain_over_cached_goal"] == 5
