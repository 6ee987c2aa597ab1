"""The exact test for crossings itself, on sheets whose answer is known."""

import numpy as np
from crossings import crossings


def _grid(x, y, z):
    n, m = x.shape
    number = np.arange(n * m).reshape(n, m)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), quads


def test_sheets_apart_do_not_cross_and_tilted_ones_do():
    u, v = np.meshgrid(np.arange(8.0), np.arange(6.0), indexing="ij")
    flat = _grid(u, v, 0.0 * u)
    assert len(crossings(*flat, *_grid(u + 0.3, v + 0.2, 0.05 + 0.01 * np.sin(u)))) == 0
    tilted = _grid(u + 0.3, v + 0.2, 0.1 * (u - 3.4))
    places = crossings(*tilted, *flat)
    assert len(places) >= 5  # one or more edges in each of the five rows of cells
    assert np.abs(places[:, 2]).max() < 1e-12
    assert np.allclose(places[:, 0], 3.7)  # x = u + 0.3 where u = 3.4


def test_a_sheet_that_folds_through_itself_is_found():
    s, v = np.meshgrid(np.linspace(-1.0, 1.0, 41), np.arange(4.0), indexing="ij")
    loop = _grid(10.0 * (s**3 - 0.5 * s), v, 10.0 * s**2)  # crosses itself where s^2 = 1/2
    places = crossings(*loop)
    assert len(places) > 0
    assert np.allclose(places[:, 2], 5.0, atol=0.1)
    assert len(crossings(*_grid(10.0 * s, v, np.sin(3.0 * s)))) == 0


def test_what_lies_beyond_an_outline_is_no_cloth():
    u, v = np.meshgrid(np.arange(9.0), np.arange(9.0), indexing="ij")
    flat, tilted = _grid(u, v, 0.0 * u), _grid(u, v, 0.1 * (u - 3.4))  # they cross along x = 3.4
    whole = np.array([[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]])

    def left(least_x, loops=(), low=0.0):
        cut = np.array([[least_x, low], [8.0, low], [8.0, 8.0], [least_x, 8.0]])
        cloth = (flat[0][:, :2], [cut, *loops])
        both = crossings(*flat, *tilted, cloth), crossings(*tilted, *flat, None, cloth)
        return np.concatenate(both)

    everything = np.concatenate([crossings(*flat, *tilted), crossings(*tilted, *flat)])
    assert len(left(-1.0)) == len(everything) > 20
    assert len(left(3.3)) == len(everything)  # through the cut cells, but inside
    assert len(left(3.5)) == 0  # through the same cells, beyond the outline
    half = left(3.3, low=4.3)
    assert 0.4 * len(everything) < len(half) < 0.6 * len(everything)
    assert half[:, 1].min() > 3.0
    assert len(left(-1.0, loops=[whole[::-1]])) == 0  # a hole as large as all of it
    hole = np.array([[3.0, 2.2], [3.0, 5.8], [4.0, 5.8], [4.0, 2.2]])
    there = left(-1.0, loops=[hole])
    assert 0 < len(there) < len(everything)
    assert not ((there[:, 1] > 2.9) & (there[:, 1] < 5.1)).any()


def test_a_fold_through_itself_counts_as_far_as_there_is_cloth():
    s, v = np.meshgrid(np.linspace(-1.0, 1.0, 41), np.arange(8.0), indexing="ij")
    points, quads = _grid(10.0 * (s**3 - 0.5 * s), v, 10.0 * s**2)
    flat = np.column_stack([s.ravel(), v.ravel()])
    part = np.array([[-0.6, -1.0], [2.0, -1.0], [2.0, 9.0], [-0.6, 9.0]])  # without one of the two flanks that cross
    both = np.array([[-2.0, 3.5], [2.0, 3.5], [2.0, 9.0], [-2.0, 9.0]])
    assert len(crossings(points, quads, cloth=(flat, [part]))) == 0
    places = crossings(points, quads, cloth=(flat, [both]))
    assert 0 < len(places) < len(crossings(points, quads))
    assert places[:, 1].min() > 2.9
