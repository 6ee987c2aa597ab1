"""Teams of threads: every task is drawn once, and nobody passes a barrier early."""

import numpy as np
import pytest
from numba import njit

from ddf.dynamics.team import Team, barrier, draw


@njit(nogil=True)
def _phases(member, members, sync, counts, seen, late):
    """Count each task; after the barrier every task of the phase must have been counted."""
    base = 0
    tasks = counts.shape[1]
    for phase in range(counts.shape[0]):
        t = draw(sync, base)
        while t < tasks:
            counts[phase, t] += 1
            seen[member] += 1
            t = draw(sync, base)
        base += tasks + members
        barrier(sync, members)
        for k in range(tasks):
            if counts[phase, k] != 1:
                late[member] += 1
        barrier(sync, members)


@pytest.mark.parametrize("members", [1, 2, 3, 5])
@pytest.mark.parametrize("tasks", [0, 1, 7])
def test_each_task_is_done_once_in_every_phase(members, tasks):
    team = Team(members)
    try:
        for _ in range(2):  # the team starts over
            counts, seen, late = np.zeros((200, tasks)), np.zeros(members, np.int64), np.zeros(members, np.int64)
            team.run(_phases, counts, seen, late)
            assert (counts == 1).all()
            assert seen.sum() == 200 * tasks
            assert not late.any()
    finally:
        team.close()


def test_an_error_of_a_member_is_raised():
    def fails(member, members, sync):
        if member == 1:
            raise RuntimeError("member 1")

    team = Team(2)
    try:
        with pytest.raises(RuntimeError, match="member 1"):
            team.run(fails)
    finally:
        team.close()


@pytest.mark.parametrize("members", [1, 2, 4])
def test_tasks_shared_among_the_team_return_in_their_order(members):
    team = Team(members)
    assert team.each([lambda k=k: k * k for k in range(7)]) == [k * k for k in range(7)]
    assert team.each([]) == []

    def fails():
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        team.each([lambda: 1, fails, lambda: 2])
    team.close()
