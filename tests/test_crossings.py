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
