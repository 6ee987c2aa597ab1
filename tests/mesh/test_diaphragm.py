import builtins

import numpy as np
import pytest

from ddf.errors import MeshError
from ddf.mesh.diaphragm import mesh_diaphragm
from ddf.mesh.gmsh_session import gmsh_session


def ratios(lines):
    steps = np.diff(lines)
    return np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:])


@pytest.mark.parametrize("growth", [1.05, 1.2, 2.0])
def test_grading(growth):
    mesh = mesh_diaphragm(1320.0, 620.0, (-180.0, 180.0, -150.0, 170.0), 3.5, 25.0, growth)
    for lines, half, low, high in ((mesh.x_lines, 660, -180, 180), (mesh.y_lines, 310, -150, 170)):
        steps, middle = np.diff(lines), 0.5 * (lines[1:] + lines[:-1])
        fine = (middle > low) & (middle < high)
        assert (lines[0], lines[-1]) == (-half, half)
        assert steps.min() > 0.9 * 3.5
        assert steps[fine].max() <= 3.5 + 1e-9
        assert np.ptp(steps[fine]) < 1e-9
        assert steps.max() <= 25.0 * (1 + 1e-9)
        assert ratios(lines).max() <= growth * (1 + 1e-9)
    assert mesh.x.shape == (3, mesh.x_lines.size, mesh.y_lines.size)
    assert (mesh.x[0] == mesh.x_lines[:, None]).all()
    assert (mesh.x[1] == mesh.y_lines[None]).all()
    assert (mesh.x[2] == 0.0).all()


def test_reaches_the_largest_element():
    mesh = mesh_diaphragm(1320.0, 620.0, (-180.0, 180.0, -180.0, 180.0), 3.0, 20.0, 1.3)
    assert np.diff(mesh.x_lines).max() > 15.0


def test_symmetric_to_the_last_bit():
    mesh = mesh_diaphragm(1320.0, 620.0, (-181.3, 181.3, -99.9, 99.9), 2.7, 20.0, 1.1)
    assert (mesh.x_lines == -mesh.x_lines[::-1]).all()
    assert (mesh.y_lines == -mesh.y_lines[::-1]).all()


@pytest.mark.parametrize("gap", [0.0, 0.01, 1.0, 3.0, 5.0, 9.0])
def test_box_near_the_frame_is_widened(gap):
    mesh = mesh_diaphragm(200.0, 200.0, (-100 + gap, 100 - gap, -40.0, 100 - gap), 3.0, 20.0, 1.2)
    assert ratios(mesh.x_lines).max() <= 1.2 + 1e-9
    assert ratios(mesh.y_lines).max() <= 1.2 + 1e-9
    assert np.diff(mesh.x_lines).max() < 5.0
    assert mesh.y_lines[[0, -1]].tolist() == [-100.0, 100.0]


def test_without_growth_the_grid_is_uniform():
    mesh = mesh_diaphragm(200.0, 100.0, (-40.0, 40.0, -20.0, 20.0), 3.0, 20.0, 1.0)
    assert np.ptp(np.diff(mesh.x_lines)) < 1e-9


@pytest.mark.parametrize(
    ("box", "element", "growth"),
    [
        ((-120, 40, -20, 20), 3.0, 1.1),
        ((-40, 40, 20, -20), 3.0, 1.1),
        ((-40, 40, -20, 20), 30.0, 1.1),
        ((-40, 40, -20, 20), 3.0, 0.9),
    ],
)
def test_impossible_requests(box, element, growth):
    with pytest.raises(MeshError):
        mesh_diaphragm(200.0, 100.0, box, element, 20.0, growth)


def test_missing_system_library_is_named(monkeypatch):
    real = builtins.__import__

    def broken(name, *args, **kwargs):
        if name == "gmsh":
            raise OSError("libGLU.so.1: cannot open shared object file")
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", broken)
    with pytest.raises(MeshError, match="libglu1-mesa libxrender1"), gmsh_session():
        pass


def test_session_may_be_nested_and_turns_gmsh_errors():
    with gmsh_session("outer") as gmsh:
        mesh_diaphragm(100.0, 100.0, (-20, 20, -20, 20), 5.0, 10.0, 1.2)
        assert gmsh.isInitialized()
        assert gmsh.model.getCurrent() == "outer"
    assert not gmsh.isInitialized()
    with pytest.raises(MeshError, match="gmsh failed"), gmsh_session() as gmsh:
        gmsh.model.getType(2, 99)
