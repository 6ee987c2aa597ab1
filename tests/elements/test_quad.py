"""Four numbers at a time."""

import numpy as np
from numba import njit

from ddf.quad import load, store, transposed


@njit
def _turn(x, y):
    four = np.uint64(4)
    quads = transposed(load(x, np.uint64(0)), load(x, four), load(x, four + four), load(x, four + four + four))
    store(y, np.uint64(0), quads[0])
    store(y, four, quads[1])
    store(y, four + four, quads[2])
    store(y, four + four + four, quads[3])


def test_transposed_turns_rows_into_columns():
    x, y = np.arange(16.0).reshape(4, 4), np.zeros((4, 4))
    _turn(x, y)
    assert (y == x.T).all()
