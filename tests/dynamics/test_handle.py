"""One pointer for a named tuple: compiled code reads and writes the tuple's own arrays through it."""

import sys
from typing import NamedTuple

import numpy as np
from numba import njit

from ddf.dynamics.handle import _hold


class Fields(NamedTuple):
    values: np.ndarray
    pair: tuple[np.ndarray, np.ndarray]
    factor: float


@njit  # not `handle.held`: a type of this module in the users' cache could not be read by anybody else
def held(data):
    return _hold(data)


@njit
def _work(data):
    data.values[1:] *= data.factor
    data.pair[1][0] = data.pair[0].sum()
    return data.values.sum()


def _fields():
    return Fields(np.arange(4.0), (np.ones((2, 3)), np.zeros(2)), 3.0)


def test_compiled_code_works_on_the_tuple_s_own_arrays():
    fields = _fields()
    handle = held(fields)
    assert _work(handle) == 18.0
    assert fields.values.tolist() == [0.0, 3.0, 6.0, 9.0]
    assert fields.pair[1][0] == 6.0


def test_a_handle_does_what_the_tuple_does():
    first, second = _fields(), _fields()
    assert _work(held(first)) == _work.py_func(second)
    np.testing.assert_array_equal(first.values, second.values)


def test_arrays_are_not_owned():
    fields = _fields()
    before = sys.getrefcount(fields.values)
    handles = [held(fields) for _ in range(10)]
    assert [_work(handle) >= 0.0 for handle in handles] == [True] * 10
    after = sys.getrefcount(fields.values)
    assert after == before
