"""How quick this machine is, learned from runs."""

import pytest

from ddf.describe import estimate_source, expected_seconds, seconds_estimate
from ddf.past_runs import KEPT, learn, slowness


def test_nothing_is_known_before_the_first_run():
    assert slowness() == (1.0, 0)
    assert "no run has ended here" in estimate_source()


def test_the_median_of_the_last_runs_counts(past_runs):
    for ratio in [9.0] * 4 + [0.5] * KEPT:
        learn(100.0, 100.0 * ratio)
    assert slowness() == (0.5, KEPT)
    learn(100.0, 5000.0)  # one slow run among many
    assert slowness() == (0.5, KEPT)
    assert [file.name for file in past_runs.parent.iterdir()] == [past_runs.name]


def test_short_runs_say_nothing():
    learn(1.0, 0.5)
    assert slowness() == (1.0, 0)


@pytest.mark.parametrize("text", ["", "{}", "[1.0", '["quick", -1, 0, 1e9, null]'])
def test_a_spoilt_file_is_as_none(past_runs, text):
    past_runs.write_text(text)
    assert slowness() == (1.0, 0)
    learn(10.0, 20.0)
    assert slowness() == (2.0, 1)


def test_estimates_follow(make_scene):
    scene = make_scene("tetrahedron-0-90-coarse")
    before = expected_seconds(scene, 2)
    learn(100.0, 30.0)
    assert expected_seconds(scene, 2) == pytest.approx(0.3 * before)
    assert expected_seconds(scene, 1) == pytest.approx(0.3 * seconds_estimate(scene))
    assert "the last run here" in estimate_source()
