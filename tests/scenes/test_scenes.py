"""A fixed dozen of the random scenes come to rest; the rest of them: scripts/random_scenes.py."""

import pytest
from judge import judged_run
from random_scenes import random_case

DOZEN = (1, 2, 3, 4, 9, 22, 25, 28, 32, 34, 39, 43)
"""Among the quickest: all tools, fillets down to none, 1 to 4 plies, most orders of loading."""


@pytest.mark.parametrize("number", DOZEN)
def test_scene_comes_to_rest(number, tmp_path):
    row = judged_run(random_case(number), tmp_path / "run", frames=False)
    assert row["end"] == "settled", row
    assert row["ply_in_tool_mm"] < 0.5
    assert row["strain_percent"] < 0.3
