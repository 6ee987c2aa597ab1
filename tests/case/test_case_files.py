"""Shipped cases, template, presets, round trip, overrides and the reference of all keys."""

import json
from pathlib import Path

import pytest
from pydantic import ValidationError

from ddf.case import (
    PRESETS,
    case_from_dict,
    hyperelastic_material,
    load_case,
    preset_source,
    resolve_gap_mm,
    resolve_material,
    resolved_toml,
    woven_material,
)
from ddf.case.template import TEMPLATE, schema_json, schema_text
from ddf.errors import CaseError

CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))
MINIMAL = {
    "plies": [{"size_mm": [350, 350]}],
    "process": {"stages": [{"name": "press", "duration_s": 0.02, "cavity_pressure_kPa": 0}]},
}


def reload(case, tmp_path):
    path = tmp_path / "case.resolved.toml"
    path.write_text(resolved_toml(case), encoding="utf-8")
    return load_case(path)


def test_there_are_cases():
    assert len(CASES) >= 8


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_shipped_case_loads_and_survives_the_round_trip(path, tmp_path):
    case = load_case(path)
    assert case.title
    assert "inferred" in path.read_text(encoding="utf-8").lower()
    assert reload(case, tmp_path) == case


def test_published_case():
    case = load_case(next(path for path in CASES if path.stem == "tetrahedron-0-90"))
    assert case.frame.length_mm == 1320
    assert case.plies[0].name == "ply-1"
    assert case.process.duration_s == pytest.approx(0.24)
    assert case.process.largest_lift_mm == 82
    assert case.solver.mass_scaling is None
    assert resolve_gap_mm(case) == pytest.approx(0.7)
    # An 82 mm cube corner has a base edge of 200.9 mm.
    assert case.tool.footprint_radius_mm() * 3**0.5 == pytest.approx(200.86, abs=0.01)


def test_template_is_the_published_case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(TEMPLATE, encoding="utf-8")
    assert load_case(path) == load_case(next(path for path in CASES if path.stem == "tetrahedron-0-90"))


def test_template_names_every_key_of_the_main_sections():
    sections = json.loads(schema_json())["$defs"]
    for name in ("Frame", "Diaphragms", "Ply", "Friction", "Stage", "Breakpoints", "Solver", "Output"):
        for key in sections[name]["properties"]:
            assert f"{key} = " in TEMPLATE


def test_defaults_of_a_minimal_case(tmp_path):
    case = case_from_dict(MINIMAL)
    assert case.tool is None
    assert case.diaphragms.material == "silicone-ogden"
    assert (case.friction.ply_ply, case.friction.ply_diaphragm) == (0.28, 0.52)
    assert case.plies[0].outline_mm()[0] == (-175, -175)
    assert reload(case, tmp_path) == case
    with pytest.raises(ValidationError):
        case.title = "changed"


def test_gap_grows_with_the_plies():
    assert resolve_gap_mm(case_from_dict(MINIMAL | {"plies": [{"size_mm": [9, 9]}] * 3})) == pytest.approx(1.7)
    assert resolve_gap_mm(case_from_dict(MINIMAL | {"diaphragms": {"gap_mm": 0.9}})) == 0.9


def test_presets_hold_the_published_numbers():
    weave, rubber = PRESETS["plain-weave-6k-320"], PRESETS["silicone-ogden"]
    assert weave.membrane_modulus_N_mm == (20_000, 20_000)
    assert weave.bending_rigidity_Nmm[0] == pytest.approx(33 * 0.5**3 / 12)
    assert sum(mu for mu, _ in rubber.abaqus_terms) == pytest.approx(0.9643, abs=1e-4)
    assert all("108357" in preset_source(name) for name in PRESETS)


def test_classical_ogden_is_converted():
    term = {"mu_MPa": 1.0, "alpha": 4.0}
    rubber = {"kind": "hyperelastic", "ogden": [term], "ogden_form": "classical"}
    case = case_from_dict(MINIMAL | {"materials": {"r": rubber}, "diaphragms": {"material": "r"}})
    assert hyperelastic_material(case, "r").abaqus_terms == ((2.0, 4.0),)


def test_base_is_overlaid_and_its_shear_curve_replaced(tmp_path):
    table = {"angle_deg": [0, 30, 60], "normalised_shear_force_N_mm": [0, 0.05, 0.33]}
    own = {"kind": "woven", "base": "plain-weave-6k-320", "thickness_mm": 0.6, "shear_table": table}
    plies = [{"size_mm": [350, 350], "material": "own"}]
    case = case_from_dict(MINIMAL | {"materials": {"own": own}, "plies": plies})
    material = woven_material(case, "own")
    assert (material.thickness_mm, material.areal_density_gsm) == (0.6, 320)
    assert material.shear_modulus_polynomial_MPa is None
    assert reload(case, tmp_path) == case


def test_unlike_families():
    own = {"kind": "woven", "base": "plain-weave-6k-320", "membrane_modulus_N_mm": [100, 200]}
    case = case_from_dict(MINIMAL | {"materials": {"own": own}})
    assert resolve_material(case, "own").membrane_modulus_N_mm == (100, 200)


def test_unknown_material_and_wrong_kind():
    case = case_from_dict(MINIMAL)
    with pytest.raises(CaseError, match="did you mean 'silicone-ogden'"):
        resolve_material(case, "silicone-ogdn")
    with pytest.raises(CaseError, match="not woven"):
        woven_material(case, "silicone-ogden")
    with pytest.raises(CaseError, match="not hyperelastic"):
        hyperelastic_material(case, "plain-weave-6k-320")


def test_tool_file_is_taken_from_the_case_folder(tmp_path):
    (tmp_path / "part.stl").write_text("solid\nendsolid\n")
    path = tmp_path / "case.toml"
    path.write_text(
        '[[plies]]\nsize_mm = [100, 100]\n[tool]\nshape = "file"\nfile = "part.stl"\nunit = "inch"\n'
        '[[process.stages]]\nname = "lift"\nduration_s = 1\ntool_lift_mm = 5\n'
    )
    case = load_case(path)
    assert case.tool.file == str((tmp_path / "part.stl").resolve())
    assert reload(case, tmp_path) == case


def test_breakpoints_round_trip(tmp_path):
    points = {"time_s": [0, 0.1, 0.2], "cavity_pressure_kPa": [101.325, 0, 0]}
    case = case_from_dict(MINIMAL | {"process": {"breakpoints": points}})
    assert case.process.duration_s == 0.2
    assert case.process.largest_lift_mm == 0
    assert reload(case, tmp_path) == case


def test_overrides():
    path = next(path for path in CASES if path.stem == "tetrahedron-double")
    case = load_case(
        path,
        [
            "solver.threads=1",
            "plies.1.element_mm = 4",
            "plies.0.size_mm=[300, 200]",
            "tool.shape=regular-tetrahedron",
            "title=two words",
            "process.stages.3.duration_s=0.5",
            "materials.'my weave'={kind='woven', base='plain-weave-6k-320'}",
            "output.vtu=false",
        ],
    )
    assert case.solver.threads == 1
    assert [ply.element_mm for ply in case.plies] == [2, 4]
    assert case.plies[0].size_mm == (300, 200)
    assert (case.tool.shape, case.title) == ("regular-tetrahedron", "two words")
    assert case.process.stages[3].duration_s == 0.5
    assert "my weave" in case.materials
    assert case.output.vtu is False


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("nonsense", "is not a change"),
        ("=3", "is not a change"),
        ("a b=3", "is not a change"),
        ("plies.7.element_mm=2", "no item '7'"),
        ("plies.x.element_mm=2", "no item 'x'"),
        ("title.x=2", "title is not a table"),
        ("plies.0.size_mm=[1, 2", "not valid TOML"),
        ("solver.threads=", "not valid TOML|is not"),
        ("solver.thread=2", "did you mean 'threads'"),
        ("solver.threads=0", "out of range"),
        ("target.seconds=60", "means nothing without"),
    ],
)
def test_faulty_overrides(text, words):
    with pytest.raises(CaseError, match=words) as caught:
        load_case(CASES[-1], ["output.vtu=true", text])
    assert [(fault.file, fault.line) for fault in caught.value.faults] == [("--set", 2)]


def test_schema_text_has_every_key_with_a_meaning():
    text = schema_text()
    document = json.loads(schema_json())
    for section in [document, *document["$defs"].values()]:
        for key, node in section["properties"].items():
            assert f"| `{key}` |" in text
            assert node.get("description"), key
    assert "| `fillet_mm` | number | `5.0` | >= 0, <= 50 |" in text
    assert "number or list of 2 numbers" in text


def test_the_reference_in_docs_is_the_schema():
    """After a change of keys: ddf schema > docs/case.md."""
    assert (CASES[0].parents[1] / "docs/case.md").read_text(encoding="utf-8") == schema_text() + "\n"
