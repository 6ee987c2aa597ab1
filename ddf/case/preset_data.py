"""Numbers of the materials that ship with ddf, in the form of a case file, with their sources."""

from __future__ import annotations

from typing import Any

PRESET_DATA: dict[str, dict[str, Any]] = {
    "plain-weave-6k-320": {
        "kind": "woven",
        "thickness_mm": 0.5,
        "areal_density_gsm": 320.0,
        "membrane_modulus_N_mm": 20_000.0,  # 40 000 MPa x 0.5 mm
        "bending_rigidity_Nmm": 0.34375,  # E h^3/12 with a flexural modulus of 33 MPa
        "shear_modulus_polynomial_MPa": [0.4576, -7.394, 36.36, -59.31, 32.37],
    },
    "silicone-ogden": {
        "kind": "hyperelastic",
        "ogden": [
            {"mu_MPa": 0.150904, "alpha": 3.0918},
            {"mu_MPa": 0.813392, "alpha": 0.81451},
        ],
        "ogden_form": "abaqus",
        "density_kg_m3": 1100.0,
    },
}

PRESET_SOURCES: dict[str, str] = {
    "plain-weave-6k-320": "Plain weave carbon, 6k tows, 320 g/m2. A. J. Thompson, J. P.-H. Belnoue, "
    "S. R. Hallett, Composites Part B 202 (2020) 108357. The published shear modulus is negative between "
    "6.77 and 10.84 deg of shear, which is why the monotone law is the default. The rigidity in the plane of the ply "
    "is inferred: that of fibres which bend one by one.",
    "silicone-ogden": "Silicone diaphragm, Ogden in the Abaqus form, measured by Chen et al. on 1.56 mm "
    "silicone and used by A. J. Thompson, J. P.-H. Belnoue, S. R. Hallett, Composites Part B 202 (2020) "
    "108357. The density is inferred.",
}
