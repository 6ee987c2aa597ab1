"""All problems in their quick form, and that they notice a solver that is wrong."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from ddf.verify import scenes
from ddf.verify.problem import LATTICE, SHELL_MEMBRANE, Options
from ddf.verify.registry import MODULES, load_problem

QUICK = Options(quick=True)
SHELL = Options(quick=True, formulation=SHELL_MEMBRANE)


@pytest.mark.parametrize("name", [name for name in MODULES if LATTICE in load_problem(name).formulations])
def test_quick_form_passes(name):
    answer = load_problem(name).solve(QUICK)
    assert answer.checks
    assert [check for check in answer.checks if not check.passed] == []
    assert any(check.bound is not None for check in answer.checks)
    assert len({len(column) for column in answer.table.values()}) == 1


@pytest.mark.parametrize("name", ["hemisphere", "capstan"])
def test_two_threads_give_the_same_bits(name):
    one, two = (load_problem(name).solve(replace(QUICK, threads=threads)).table for threads in (1, 2))
    assert one.keys() == two.keys()
    for column in one:
        np.testing.assert_array_equal(one[column], two[column])


def _sheets(key, factor):
    def change(scene):
        sheets = scene.model.sheets.copy()
        sheets[key] *= factor
        return replace(scene, model=scene.model._replace(sheets=sheets))

    return change


def _pool(key, node, factor):
    def change(scene):
        values = getattr(scene.model, key).copy()
        values[node] *= factor
        return replace(scene, model=scene.model._replace(**{key: values}))

    return change


def _shear(factor):
    def change(scene):
        tables = scene.model.shear_tables.copy()
        tables[:, :-1] *= factor
        return replace(scene, model=scene.model._replace(shear_tables=tables))

    return change


def _tangent(factor):
    def change(scene):
        return replace(scene, model=scene.model._replace(tangents=scene.model.tangents * factor))

    return change


def _damped(scene):
    return scenes.damped(scene, 1.0)


def _heavy(scene):
    return scenes.with_gravity(scene, (0.0, 0.0, -1.0))


WRONG = {
    "tension": _sheets("eh1", 1.002),
    "picture-frame": _shear(1.01),
    "bias-extension": _shear(0.95),
    "heavy-elastica": _sheets("bend2", 1.05),
    "peirce-cantilever": _sheets("bend2", 0.96),
    "buckling-strip": _sheets("bend2", 0.97),
    "buckling-tension": _sheets("bend2", 0.9),
    "buckling-foundation": _sheets("bend2", 0.9),
    "rigid-motion": _heavy,
    "patch-test": _pool("bar1", 60, 1.01),
    "zero-energy-modes": _pool("triple1", slice(None), 0.0),
    "free-vibration": _damped,
}


WRONG_SHELL = {
    "tension": _sheets("eh1", 1.002),
    "picture-frame": _tangent(1.01),
    "peirce-cantilever": _sheets("bend2", 0.96),
}


def _solve_wrong(name, change, options, monkeypatch):
    """Solve with a scene that differs from what the answer expects by the least that should be noticed."""
    problem = load_problem(name)
    module = import_module(f"ddf.verify.{MODULES[name]}")
    maker = "ply_scene" if hasattr(module, "ply_scene") else "case_scene"
    right = getattr(scenes, maker)
    monkeypatch.setattr(module, maker, lambda *a, **k: change(right(*a, **k)))
    return problem.solve(options)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_solver_misses_a_bound(name, monkeypatch):
    assert not _solve_wrong(name, WRONG[name], QUICK, monkeypatch).passed


@pytest.mark.parametrize("name", [*WRONG_SHELL, "misaligned-fibres"])  # the elastica takes a minute
def test_quick_form_passes_with_shell_membrane_plies(name):
    answer = load_problem(name).solve(SHELL)
    assert [check for check in answer.checks if not check.passed] == []


@pytest.mark.parametrize("name", WRONG_SHELL)
def test_wrong_shell_membrane_misses_a_bound(name, monkeypatch):
    assert not _solve_wrong(name, WRONG_SHELL[name], SHELL, monkeypatch).passed
