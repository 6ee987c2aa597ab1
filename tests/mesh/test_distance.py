import numpy as np
import pytest
from numba.core.errors import TypingError

from ddf.errors import MeshError
from ddf.mesh.analytic import primitive_distance
from ddf.mesh.distance import OUTSIDE_MM, DistanceField, distance_field, sample
from ddf.mesh.solids import Dimensions
from ddf.mesh.tool import build_tool

SIZES = {
    "cube-corner-tetrahedron": Dimensions(height_mm=50.0),
    "regular-tetrahedron": Dimensions(height_mm=82.0),
    "hemisphere": Dimensions(radius_mm=40.0),
    "box": Dimensions(height_mm=30.0, length_mm=70.0, width_mm=50.0),
    "cylinder": Dimensions(height_mm=30.0, radius_mm=40.0),
}


@pytest.fixture(scope="module")
def fields():
    made = {}

    def get(shape):
        if shape not in made:
            made[shape] = distance_field(build_tool(shape, **vars(SIZES[shape])))
        return made[shape]

    return get


def places(field, count=60_000):
    low, high = field.origin, field.origin + field.spacing * (np.array(field.values.shape[:3]) - 1)
    low = np.array([low[0], low[1], 0.0])
    return low + (high - low) * np.random.default_rng(5).random((count, 3)) * (1 - 1e-9)


def exact_gradient(shape, points, step=1e-4):
    size, parts = SIZES[shape], []
    for axis in step * np.eye(3):
        ahead, behind = (primitive_distance(shape, points + s * axis, size) for s in (1, -1))
        parts.append((ahead - behind) / (2 * step))
    return np.stack(parts, axis=1)


@pytest.mark.parametrize("shape", SIZES)
def test_distance_agrees_with_the_exact_one(fields, shape):
    field = fields(shape)
    points = places(field)
    exact = primitive_distance(shape, points, SIZES[shape])
    near, out = np.abs(exact) < 4.0, (exact > 0.0) & (exact < 4.0)
    error = np.abs(field.distance(points) - exact)
    assert near.sum() > 2000
    assert error[near].max() < 0.2
    assert error[out].max() < 0.08
    assert np.percentile(error[near], 90) < 0.05
    assert np.median(error[near]) < 0.02


@pytest.mark.parametrize("shape", SIZES)
def test_gradient_agrees_off_the_medial_axis(fields, shape):
    field = fields(shape)
    points = places(field)
    exact = primitive_distance(shape, points, SIZES[shape])
    points = points[(exact > -1.0) & (exact < 4.0)]
    cosine = np.sum(field.gradient(points) * exact_gradient(shape, points), axis=1)
    angle = np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))
    assert angle.max() < 6.0
    assert np.median(angle) < 0.5


@pytest.mark.parametrize("shape", SIZES)
def test_sign_says_inside_or_outside(fields, shape):
    points = places(fields(shape))
    exact = primitive_distance(shape, points, SIZES[shape])
    sure = np.abs(exact) > 0.1
    assert (np.sign(fields(shape).distance(points))[sure] == np.sign(exact[sure])).all()


@pytest.mark.parametrize("shape", SIZES)
def test_far_field_of_tool_and_platform(fields, shape):
    points = places(fields(shape))
    exact = primitive_distance(shape, points, SIZES[shape])
    obstacle = np.minimum(exact, points[:, 2])
    error = np.abs(fields(shape).platform_distance(points) - obstacle)
    assert error[exact > 0.0].max() < 0.2


def test_faces_are_exact(fields):
    rng = np.random.default_rng(2)
    count = 4000
    top = np.stack([rng.uniform(-28, 28, count), rng.uniform(-18, 18, count), rng.uniform(26.5, 34, count)], 1)
    np.testing.assert_allclose(fields("box").distance(top), top[:, 2] - 30.0, atol=2e-3)
    np.testing.assert_allclose(fields("box").gradient(top), np.tile([0.0, 0.0, 1.0], (count, 1)), atol=1e-3)


def test_errors_fall_with_the_spacing():
    mesh = build_tool("box", **vars(SIZES["box"]), chord_mm=0.005)
    errors = []
    for spacing in (2.0, 1.0):
        field = distance_field(mesh, spacing, 6.0)
        points = places(field)
        exact = primitive_distance("box", points, SIZES["box"])
        keep = (exact > 0.0) & (exact < 3.0)
        errors.append(np.sqrt(np.mean((field.distance(points) - exact)[keep] ** 2)))
    assert np.log2(errors[0] / errors[1]) > 1.5


def test_grid_and_storage(fields, tmp_path):
    field = fields("hemisphere")
    assert field.values.dtype == np.float32
    assert field.values.shape[3] == 4
    assert field.origin[2] == -10.0
    np.testing.assert_allclose(np.linalg.norm(field.values[..., 1:], axis=-1), 1.0, atol=1e-5)
    top = field.origin + field.spacing * (np.array(field.values.shape[:3]) - 1)
    assert top[2] >= 40.0 + 8.0
    field.save(tmp_path / "field.npz")
    again = DistanceField.load(tmp_path / "field.npz")
    assert (again.values == field.values).all()
    assert (again.origin == field.origin).all()
    assert again.spacing == field.spacing
    (tmp_path / "bad.npz").write_text("no")
    with pytest.raises(MeshError):
        DistanceField.load(tmp_path / "bad.npz")


def test_outside_the_grid(fields):
    field = fields("hemisphere")
    points = np.array([[500.0, 0.0, 10.0], [0.0, 0.0, -40.0], [np.nan, 0.0, 0.0]])
    assert (field.distance(points) == OUTSIDE_MM).all()
    assert (field.gradient(points) == [0.0, 0.0, 1.0]).all()
    assert field.platform_distance(points)[0] == 10.0
    assert sample(field.values, field.origin, field.spacing, 0.0, 0.0, 45.0)[0] == pytest.approx(5.0, abs=0.03)


def test_same_field_every_time(fields):
    mesh = build_tool("hemisphere", **vars(SIZES["hemisphere"]))
    assert (distance_field(mesh).values == fields("hemisphere").values).all()


def test_spacing_must_fit_the_band():
    mesh = build_tool("box", height_mm=20.0, fillet_mm=0.0)
    with pytest.raises(MeshError, match="spacing_mm"):
        distance_field(mesh, 5.0, 8.0)


def test_values_are_read_rightly_however_they_lie_in_memory():
    rng = np.random.default_rng(0)
    values, points = rng.normal(size=(6, 5, 4, 4)).astype(np.float32), rng.uniform(0.0, 3.0, (20, 3))
    row_by_row = DistanceField(values, np.zeros(3), 1.0)
    column_by_column = DistanceField(np.asfortranarray(values), np.zeros(3), 1.0)
    assert np.array_equal(row_by_row.distance(points), column_by_column.distance(points))
    with pytest.raises(TypingError, match="contiguous"):
        sample(np.asfortranarray(values), np.zeros(3), 1.0, 1.5, 1.5, 1.5)
