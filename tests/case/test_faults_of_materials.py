"""Faults of materials."""

import pytest
from fault_files import SHEAR, WEAVE, add, check_fault

FAULTS = {
    "woven diaphragm": (
        add("[diaphragms]\nmaterial = 'plain-weave-6k-320'\n"),
        "diaphragms.material",
        12,
        "not hyperelastic",
        "",
    ),
    "no kind": (add("[materials.w]\nbase = 'silicone-ogden'\n"), "materials.w.kind", 11, "missing", ""),
    "unknown kind": (add("[materials.w]\nkind = 'wovn'\n"), "materials.w.kind", 12, "not one of", "woven"),
    "unknown base": (add(WEAVE.replace("320", "32")), "materials.w.base", 13, "no preset", "plain-weave-6k-320"),
    "base of another kind": (add(WEAVE.replace('"woven"', '"hyperelastic"')), "materials.w.base", 13, "is woven", ""),
    "negative modulus": (
        add(WEAVE + "membrane_modulus_N_mm = -1\n"),
        "materials.w.membrane_modulus_N_mm",
        14,
        "out of range",
        "",
    ),
    "no shear": (
        add(
            "[materials.w]\nkind='woven'\nthickness_mm=1\nareal_density_gsm=1\nmembrane_modulus_N_mm=1\n"
            "bending_rigidity_Nmm=1\n"
        ),
        "materials.w.shear_modulus_polynomial_MPa",
        11,
        "one of",
        "",
    ),
    "two shear curves": (
        add(SHEAR % ([0, 9], [0, 1]) + "shear_modulus_polynomial_MPa = [1]\n"),
        "materials.w.shear_table",
        14,
        "together",
        "",
    ),
    "shear table lengths": (
        add(SHEAR % ([0, 9], [0, 1, 2])),
        "materials.w.shear_table.normalised_shear_force_N_mm",
        14,
        "3 items",
        "",
    ),
    "shear table start": (add(SHEAR % ([1, 9], [0, 1])), "materials.w.shear_table.angle_deg", 14, "starts at 1", ""),
    "shear table order": (
        add(SHEAR % ([0, 9, 9], [0, 1, 2])),
        "materials.w.shear_table.angle_deg.2",
        14,
        "follows",
        "",
    ),
    "shear at rest": (
        add(SHEAR % ([0, 9], [1, 2])),
        "materials.w.shear_table.normalised_shear_force_N_mm",
        14,
        "starts at",
        "",
    ),
    "soft rubber": (
        add("[materials.r]\nkind='hyperelastic'\nogden=[{mu_MPa=-1, alpha=2}]\n"),
        "materials.r.ogden",
        13,
        "not positive",
        "",
    ),
    "zero exponent": (
        add("[materials.r]\nkind='hyperelastic'\nogden=[\n{mu_MPa=1, alpha=0}]\n"),
        "materials.r.ogden.0.alpha",
        14,
        "out of range",
        "",
    ),
    "thickness in metres": (add(WEAVE + "thickness_mm = 0.0005\n"), "materials.w.areal_density_gsm", 11, "density", ""),
    "density in g per cm3": (
        add("[materials.r]\nkind='hyperelastic'\nbase='silicone-ogden'\ndensity_kg_m3=1.1\n"),
        "materials.r.density_kg_m3",
        14,
        "out of range",
        "",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_one_fault(name, tmp_path):
    check_fault(tmp_path, name, *FAULTS[name])
