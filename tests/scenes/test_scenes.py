"""A fixed dozen of the random scenes come to rest; the rest of them: scripts/random_scenes.py."""

import pytest
from judge import judged_run
from random_scenes import random_case

DOZEN = (
    1,
    2,
    17,
    22,
    28,
    32,
    34,
    38,
    39,
    43,
    46,
    19,
)  # of all tools and most orders of loading, 1 to 4 plies; the quickest


@pytest.mark.parametrize("number", DOZEN)
def test_scene_comes_to_rest(number, tmp_path):
    row = judged_run(random_case(number), tmp_path / "run")
    assert row["end"] == "settled", row
    assert row["ply_in_tool_mm"] < 0.5
