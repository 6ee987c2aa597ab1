"""A patch of 5 x 5 cells drawn by its ends along each fibre family.

The law of the fibres is E h w ln(lambda) / lambda, so the modulus E h is that of the Kirchhoff stress (force
times stretch over the width) over the logarithmic strain ln(lambda), at any strain; force over width against
l/l0 - 1 starts with the same slope and falls off as 1 - 3/2 strain. There is no Poisson effect. The force is that of
the step on the held ends, after they were drawn apart to 1 % and the patch has come to rest at each load.

Thompson et al. (Composites Part B 202 (2020) 108357, 3.2) found 40 036 MPa for 40 000 with shells of 33 MPa
laid over membranes; on the lattice bending does not stretch, so what was entered is expected. Shell-membrane cells have
both, and their law is that of the Cauchy stress: force over width against ln(lambda), modulus 40 033 as entered.
"""

from __future__ import annotations

import numpy as np

from ddf.simulate import Simulation
from ddf.verify.probe import acting_forces
from ddf.verify.problem import (
    LATTICE,
    SHELL_MEMBRANE,
    Answer,
    Check,
    Curve,
    Figure,
    FloatArray,
    Options,
    Problem,
    worst,
)
from ddf.verify.scenes import damped, fabric_of, held, lead, ply_scene, positions, settle

CELLS = 5
ELEMENT_MM = 10.0
STRAINS = np.array([0.001, 0.002, 0.004, 0.006, 0.008, 0.01])
BOUND = 0.001
WIDTH_BOUND = 1e-4
DAMPING_1_S = 500.0
PAPER_MPA = 40_036.0


def pull_patch(options: Options, family: int) -> tuple[FloatArray, FloatArray]:
    """Forces on the moving end [N] and widths in the middle [mm] at all STRAINS, pulled along family 1 or 2."""
    fabric = fabric_of(options)
    a = options.element_mm or ELEMENT_MM
    side = CELLS * a
    scene = damped(ply_scene(fabric, (side, side), a, formulation=options.formulation), DAMPING_1_S)
    along, across = family - 1, 2 - family
    start = positions(scene).copy()
    near, far = start[along] < -0.49 * side, start[along] > 0.49 * side
    scene = held(scene, near | far)
    sim, forces, widths = Simulation(scene), [], []
    for strain in STRAINS:
        target = start[:, near | far].copy()
        target[along] *= 1.0 + strain
        lead(sim, near | far, target, 200)
        sim.state.v[:] = 0.0
        settle(sim, 1e-3, 2.0)
        forces.append(-acting_forces(scene)[along, far].sum())
        middle = np.moveaxis(positions(scene), along + 1, 1)[across, CELLS // 2]
        widths.append(middle[-1] - middle[0])
    return np.array(forces), np.array(widths)


def solve(options: Options) -> Answer:
    """Moduli along both families, worst over the strains."""
    fabric = fabric_of(options)
    side = CELLS * (options.element_mm or ELEMENT_MM)
    stretch = 1.0 + STRAINS
    checks, curves, table = [], [], {"strain": STRAINS}
    line = np.linspace(0.0, STRAINS[-1], 50)
    per_width = 0.0 if options.shell else 1.0  # of the stretch: Cauchy or Kirchhoff stress
    for family in (1, 2):
        entered = fabric.membrane_modulus_N_mm[family - 1]
        if options.shell:
            entered += 12.0 * fabric.bending_rigidity_Nmm[family - 1] / fabric.thickness_mm**2
        force, width = pull_patch(options, family)
        modulus = force * stretch**per_width / side / np.log(stretch)
        at = [f"{100 * strain:.1f} %" for strain in STRAINS]
        checks.append(worst(f"E h along family {family}", "N/mm", at, np.full(STRAINS.size, entered), modulus, BOUND))
        across = float(np.abs(width / side - 1.0).max())
        checks.append(Check(f"strain across family {family}", "1", 0.0, across, WIDTH_BOUND, relative=False))
        table |= {f"force_{family}_N": force, f"modulus_{family}_N_mm": modulus}
        curves.append(Curve(f"law, family {family}", 100 * line, entered * np.log(1 + line) / (1 + line) ** per_width))
        curves.append(Curve(f"ddf, family {family}", 100 * STRAINS, force / side, points=True))
    if options.shell and options.fabric is None:
        got = float(table["modulus_1_N_mm"][-1]) / fabric.thickness_mm
        checks.append(Check("modulus, Thompson et al.", "MPa", PAPER_MPA, got, BOUND))
    figure = Figure("strain l/l0 - 1 [%]", "force over width [N/mm]", tuple(curves))
    return Answer(tuple(checks), figure, table)


PROBLEM = Problem(
    "tension",
    "Tension along each fibre family, 5 x 5 cells",
    "the entered law, log strain",
    solve,
    (LATTICE, SHELL_MEMBRANE),
)
