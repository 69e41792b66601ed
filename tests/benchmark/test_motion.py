"""The table of how planned motion looks."""

import json
import math

from webdemo.benchmark import motion as bench
from webdemo.benchmark.motion import COLUMNS, MEASURES, kinds, table


def test_every_kind_is_asked_for_in_several_ways_and_most_were_recorded() -> None:
    listed, real = kinds(), json.loads(bench.RECORDED.read_text())
    assert all(len(sentences) >= 2 for sentences in listed.values())
    assert set(real) <= {*listed, "all"} and len(real) > 8
    assert all(set(MEASURES) >= set(row) - {"people"} for row in real.values())


def test_the_table_has_a_line_for_each_kind_of_each_measure() -> None:
    row = {measure: dict.fromkeys(COLUMNS, 0.5) for measure in MEASURES}
    row["deep"]["recorded"] = math.nan
    shown = table({"walk": row, "all": row})
    assert shown.count("walk") == len(MEASURES) and "–" in shown and "goal 110" in shown
