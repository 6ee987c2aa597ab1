"""The cantilever test of the paper, read as a laboratory reads it: by Peirce's formula from the tip.

Thompson et al. (Composites Part B 202 (2020) 108357, 3.1.3): a strip of 100 x 25 mm and 0.5 mm, 10 000 MPa along
both fibres, 30 MPa in shear, a flexural modulus of 100 MPa, under 9.81 m/s2. They read 1.073 N mm with the fibres along
and across the strip and 0.472 N mm at +-45 degrees (printed "0.001073 Nmm", which is N m). The weight is not
given; that of their fabric, 320 g/m2, is taken.

Entered is D = E h^3 / 12 = 1.0417 N mm; what Peirce's formula makes of the exact heavy elastica at this weight is
expected at 0/90. At +-45 with the curvatures kx, ky along and across and the twist kxy the fibres' are
(kx + ky)/2 +- kxy, so U = D/2 [(kx + ky)^2 / 2 + 2 kxy^2]: bent to a cylinder (ky = 0) the strip has D/2 = 0.521,
the most it can have. Free edges let it curl across (ky towards -kx), which costs no bending at all but stretches a
surface of double curvature, here against shear only; so theory gives the range 0 to D/2, and no number. Peirce's
formula reads the cylinder some per cent too stiff at this drop, so readings are compared with its reading.

The lattice turns its grid with the fibres. Shell-membrane cells stay along the strip, the fibres at 45 degrees to
them, as in the paper; the transverse shear stiffness is the paper's 20 N/mm.
"""

from __future__ import annotations

import numpy as np

from ddf.case.schema import WovenMaterial
from ddf.verify.cantilever import Cantilever
from ddf.verify.elastica import heavy_elastica, peirce_rigidity
from ddf.verify.problem import LATTICE, SHELL_MEMBRANE, Answer, Check, Curve, Figure, Options, Problem
from ddf.verify.scenes import GRAVITY, areal_mass, erect_directors, held, ply_scene, positions

LENGTH_MM, WIDTH_MM = 100.0, 25.0
ELEMENT_MM, QUICK_ELEMENT_MM = 2.5, 5.0
DIAGONALS, QUICK_DIAGONALS = 5, 3
"""Diagonals of a cell over the width at +-45."""
PAPER_NMM, PAPER_45_NMM = 1.073, 0.472
BOUND = 0.02
BEYOND_NMM = 0.005
AT_REST = 1e-4

FABRIC = WovenMaterial(
    kind="woven",
    thickness_mm=0.5,
    areal_density_gsm=320.0,
    membrane_modulus_N_mm=(5000.0, 5000.0),
    bending_rigidity_Nmm=(100.0 * 0.5**3 / 12.0, 100.0 * 0.5**3 / 12.0),
    shear_law="published",
    shear_modulus_polynomial_MPa=(30.0,),
)
WEIGHT = areal_mass(FABRIC) * GRAVITY


def _strip(rows: int, row_mm: float, turned: bool) -> Cantilever:
    """The strip along y, near its shape at rest: `rows` lines of nodes apart by row_mm from the last held to the tip.

    The clamp ends half a row before the last held nodes.
    """
    behind = 2 if turned else 1  # held rows more
    size = (WIDTH_MM, (rows + behind) * row_mm)
    scene = ply_scene(FABRIC, size, row_mm * (np.sqrt(2.0) if turned else 1.0), 45.0 if turned else 0.0)
    x = positions(scene)
    x[1] += 0.5 * size[1] + (0.5 - behind) * row_mm  # the last held row is at y = row / 2
    length = (rows + 0.5) * row_mm
    clamp, tip = x[1] < row_mm, np.abs(x[1] - length) < 0.1 * row_mm
    tip &= np.abs(x[0]) < 0.5 * WIDTH_MM + 0.1 * row_mm
    rigidity = FABRIC.bending_rigidity_Nmm[1] * (0.5 if turned else 1.0)
    top = float(x[1].max())
    shape = heavy_elastica(WEIGHT * length**3 / rigidity)
    s = np.maximum(x[1], 0.0) / top
    x[2] = -top * np.interp(s, shape.s, shape.drop)
    x[1] = np.minimum(x[1], 0.0) + top * np.interp(s, shape.s, shape.x)
    x[2][clamp] = 0.0
    return Cantilever(held(scene, clamp), length, rigidity, areal_mass(FABRIC), tip, AT_REST)


def _shell_strip(element_mm: float, turned: bool) -> Cantilever:
    """The strip of shell-membrane cells along y from the held nodes to the tip, near its shape at rest."""
    scene = ply_scene(
        FABRIC, (WIDTH_MM, LENGTH_MM), element_mm, formulation=SHELL_MEMBRANE, fibre_deg=45.0 if turned else 0.0
    )
    x = positions(scene)
    x[1] += 0.5 * LENGTH_MM
    clamp, tip = x[1] < 0.1 * element_mm, x[1] > LENGTH_MM - 0.1 * element_mm
    rigidity = FABRIC.bending_rigidity_Nmm[1] * (0.5 if turned else 1.0)
    shape = heavy_elastica(WEIGHT * LENGTH_MM**3 / rigidity)
    s = x[1] / LENGTH_MM
    x[1], x[2] = LENGTH_MM * np.interp(s, shape.s, shape.x), -LENGTH_MM * np.interp(s, shape.s, shape.drop)
    erect_directors(scene, clamp)
    return Cantilever(held(scene, clamp), LENGTH_MM, rigidity, areal_mass(FABRIC), tip, AT_REST)


def _measure(strip: Cantilever) -> float:
    """Rigidity [N mm] by Peirce's formula."""
    _, ahead, up = strip.sag(WEIGHT)
    return peirce_rigidity(WEIGHT, strip.length, ahead, -up)


def _expected(strip: Cantilever) -> float:
    """What Peirce's formula makes of the exact heavy elastica of the strip's rigidity [N mm]."""
    exact = heavy_elastica(WEIGHT * strip.length**3 / strip.rigidity)
    return peirce_rigidity(WEIGHT, strip.length, strip.length * exact.x[-1], strip.length * exact.drop[-1])


def solve(options: Options) -> Answer:
    """Both lay-ups."""
    element = options.element_mm or (QUICK_ELEMENT_MM if options.quick else ELEMENT_MM)
    if options.shell:
        straight, turned = _shell_strip(element, False), _shell_strip(element, True)
    else:
        straight = _strip(round(LENGTH_MM / element), element, False)
        diagonals = QUICK_DIAGONALS if options.quick else DIAGONALS
        row = 0.5 * WIDTH_MM / diagonals
        turned = _strip(2 * round(0.5 * LENGTH_MM / row), row, True)
    got, got_45 = _measure(straight), _measure(turned)
    expected, cylinder = _expected(straight), _expected(turned)
    beyond = max(0.0, got_45 - cylinder)
    checks = (
        Check("rigidity 0/90, heavy elastica", "N mm", expected, got, BOUND),
        Check("rigidity 0/90, paper", "N mm", PAPER_NMM, got, BOUND),
        Check("rigidity +-45, paper", "N mm", PAPER_45_NMM, got_45, None),
        Check("rigidity +-45, cylinder: the most", "N mm", cylinder, got_45, None),
        Check("rigidity +-45 beyond a cylinder's", "N mm", 0.0, beyond, BEYOND_NMM, relative=False),
    )
    curves, table = [], {"length_mm": np.array([straight.length, turned.length]), "peirce_Nmm": np.array([got, got_45])}
    for name, strip in (("0/90", straight), ("+-45", turned)):
        known = heavy_elastica(WEIGHT * strip.length**3 / strip.rigidity)
        curves.append(Curve(f"cylinder, {name}", strip.length * known.x, -strip.length * known.drop))
        x = positions(strip.scene)
        aside = np.where(strip.scene.model.area.reshape(x.shape[1:]) > 0.0, np.abs(x[0]), np.inf)
        middle = (aside < aside.min() + 0.02 * WIDTH_MM) & (x[1] > 0.0)
        curves.append(Curve(f"ddf, {name}", x[1][middle], x[2][middle], points=True))
    note = (
        f"+-45: theory bounds the rigidity by 0 and D/2 = {turned.rigidity:.4f} N mm, that of a cylinder, which "
        f"Peirce's formula reads as {cylinder:.4f}"
    )
    figure = Figure("ahead of the clamp [mm]", "height [mm]", tuple(curves), equal_axes=True)
    return Answer(checks, figure, table, (note,))


PROBLEM = Problem(
    "peirce-cantilever",
    "Cantilever of the paper, rigidity by Peirce's formula",
    "Thompson et al. 2020, 3.1.3",
    solve,
    (LATTICE, SHELL_MEMBRANE),
)
