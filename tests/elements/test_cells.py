"""What of a row of a grid there is anything to do for."""

import numpy as np
import pytest

from ddf.elements.cells import filled, filled_nodes

#: a ply askew in its grid: areas of cells, kept at their first nodes; the last row and column have none
ASKEW = np.array([
    [0.0, 0.0, 2.0, 0.0, 0.0],
    [0.0, 2.0, 4.0, 1e-9, 0.0],
    [0.0, 0.0, 3.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 0.0],
])  # fmt: skip


@pytest.mark.parametrize(("row", "least", "expected"), [(0, 0.0, (2, 3)), (1, 0.0, (1, 4)), (1, 1e-6, (1, 3))])
def test_filled_part_of_a_row(row, least, expected):
    assert filled(ASKEW, row, least) == expected


def test_row_of_zeros_is_an_empty_range():
    begin, end = filled(ASKEW, 3, 0.0)
    assert (begin, end) == (5, 0)
    assert len(range(begin, end)) == 0


def test_minus_counts_as_well():
    assert filled(-ASKEW, 1, 1e-6) == (1, 3)


def test_filled_nodes_are_the_corners_of_filled_cells():
    corners = np.zeros(ASKEW.shape, bool)
    for i, j in np.argwhere(ASKEW > 0.0):
        corners[i : i + 2, j : j + 2] = True
    for i, row in enumerate(corners):
        begin, end = filled_nodes(ASKEW, i)
        assert (begin, end) == (np.flatnonzero(row)[0], np.flatnonzero(row)[-1] + 1)
