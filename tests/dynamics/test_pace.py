"""How many members run the next batch, from made-up times."""

import pytest

from ddf.dynamics.pace import EVERY, FIRST, JUMPS, TRIAL, Pace


def batches(pace, count, seconds):
    """Run batches that take seconds[members] a step; returns how many members each had."""
    used = []
    for _ in range(count):
        used.append(pace.count)
        pace.took(seconds[pace.count])
    return used


def test_one_member_has_no_choice():
    assert set(batches(Pace(1), 1000, {1: 1.0})) == {1}


@pytest.mark.parametrize(("members", "half"), [(2, 1), (3, 1), (8, 4)])
def test_all_are_used_where_that_is_quicker_and_trials_are_few(members, half):
    used = batches(Pace(members), 3000, {members: 1.0, half: 1.9})
    assert used[:FIRST] == [members] * FIRST
    assert used[FIRST : FIRST + TRIAL] == [half] * TRIAL
    assert used.count(half) <= TRIAL * (3000 // EVERY + 1)


def test_half_is_used_on_a_busy_machine_until_it_is_idle_again():
    pace = Pace(2)
    used = batches(pace, 600, {2: 2.8, 1: 2.0})
    assert used.count(2) < 0.1 * len(used)
    used = batches(pace, 600, {2: 1.0, 1: 2.0})
    assert used[-400:].count(1) <= 2 * TRIAL


def test_batches_that_suddenly_take_longer_call_for_a_trial():
    pace = Pace(2)
    batches(pace, 50, {2: 1.0, 1: 2.0})
    used = batches(pace, 50, {2: 2.8, 1: 2.0})
    assert used[JUMPS:] == [1] * (50 - JUMPS)
