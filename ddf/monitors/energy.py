"""Energies of a scene by kind and sheet, and their balance.

kinetic + strain + contact springs + dissipated = work of pressures, tool and thinning layers (`elements.squeeze`),
up to the error of the steps.
Kinetic energy is taken in mid-step: velocities are advanced by half a kick with the last forces. What the
implicit steps of fibre tension dissipate (`fibre_waves`) is the work done on the tension less the strain energy
that the fibres hold; plies start unstretched. Of shell-membrane plies it is the work of their stresses less what
they store (`elements.shell_membrane.energy`): fibre damping, and what their rate law does not give back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddf.elements.bending import bending_energy
from ddf.elements.fold import fold_energy, fold_lattice_energy
from ddf.elements.plate import plate_energy
from ddf.elements.rubber import rubber_energy
from ddf.elements.shear import shear_energy
from ddf.elements.shell_membrane.energy import elastic_energies, stored_energies
from ddf.elements.shell_membrane.history import HISTORY
from ddf.elements.tension import tension_energy
from ddf.model import (
    CONTACT_DAMPING,
    FIBRE_WORK,
    FRICTION,
    MASS_DAMPING,
    PLY,
    PRESSURE_WORK,
    SHELL_PLY,
    SQUEEZE_WORK,
    TOOL_DAMPING,
    TOOL_FRICTION,
    TOOL_WORK,
    Model,
    State,
    sheet_scalars,
    sheet_shells,
    sheet_vectors,
)

WORK_WORTH_MENTIONING = 1.0e4
"""Energy errors of a run are judged against at least this much work [N mm] (10 J)."""


@dataclass(frozen=True)
class Energies:
    """Energies [N mm]. `strain` and `kinetic` are by sheet."""

    kinetic: tuple[float, ...]
    strain: tuple[dict[str, float], ...]
    contact_spring: float
    dissipated: dict[str, float]
    work: dict[str, float]

    @property
    def total_strain(self) -> float:
        """Strain energy of all sheets."""
        return sum(sum(s.values()) for s in self.strain)

    @property
    def total_work(self) -> float:
        """Work of pressures and tool."""
        return sum(self.work.values())

    @property
    def total_kinetic(self) -> float:
        """Kinetic energy of all sheets."""
        return sum(self.kinetic)

    @property
    def error(self) -> float:
        """Work less all that it became."""
        kept = self.total_kinetic + self.total_strain + self.contact_spring + sum(self.dissipated.values())
        return self.total_work - kept

    @property
    def error_share(self) -> float:
        """Error over the work done (over all energies handled, where no work is done)."""
        scale = max(abs(self.total_work), self.total_strain + self.total_kinetic, 1e-12)
        return self.error / scale

    @property
    def error_percent(self) -> float:
        """Error over the work done, or over WORK_WORTH_MENTIONING where less was done: what stops a run [%]."""
        return 100.0 * self.error / max(abs(self.total_work), WORK_WORTH_MENTIONING)

    def kinetic_share(self, k: int | None = None) -> float:
        """Kinetic over internal (strain) energy, of sheet k or of all."""
        if k is None:
            return self.total_kinetic / max(self.total_strain, 1e-12)
        return self.kinetic[k] / max(sum(self.strain[k].values()), 1e-12)


def sheet_strain(model: Model, state: State, k: int) -> dict[str, float]:
    """Strain energies of sheet k by kind [N mm]."""
    sheet = model.sheets[k]
    x = sheet_vectors(model, state.x, k)

    def pool(values: np.ndarray) -> np.ndarray:
        return sheet_scalars(model, values, k)

    if sheet["kind"] == PLY:
        first, second = tension_energy(x, pool(model.bar1), pool(model.bar2), sheet)
        bend = bending_energy(x, pool(model.bar1), pool(model.bar2), pool(model.triple1), pool(model.triple2), sheet)
        folding, _ = fold_lattice_energy(
            x, pool(model.triple1), pool(model.triple2), (float(sheet["a1"]), float(sheet["a2"])),
            float(sheet["hourglass"]), float(sheet["fold_radius"]),
        )  # fmt: skip
        return {
            "fibre_tension": first + second,
            "shear": shear_energy(x, pool(model.cell), model.shear_tables[sheet["shear"]]),
            "bending": bend,
            "folding": folding,
        }
    if sheet["kind"] == SHELL_PLY:
        cell, director = pool(model.cell), sheet_shells(model, state.director, k, 3)
        history = sheet_shells(model, state.history, k, HISTORY)
        folding, _ = fold_lattice_energy(
            x, pool(model.triple1), pool(model.triple2), (float(sheet["a1"]), float(sheet["a2"])),
            float(sheet["hourglass"]), float(sheet["fold_radius"]),
        )  # fmt: skip
        stored = stored_energies(history, cell, model.shear_tables[sheet["shear"]], sheet)
        return stored | elastic_energies(x, director, cell, sheet) | {"folding": folding}
    a, n, m = int(sheet["line"]), int(sheet["rows"]), int(sheet["cols"])
    dx, dy = model.lines[a : a + n - 1], model.lines[a + n - 1 : a + n + m - 2]
    membrane, hourglass, twist = rubber_energy(x, dx, dy, sheet, model.ogden)
    bending = twist + plate_energy(x, dx, dy, float(sheet["rigidity"]))
    folding, _ = fold_energy(x, dx, dy, float(sheet["hourglass"]), float(sheet["fold_radius"]))
    return {"membrane": membrane, "hourglass": hourglass, "bending": bending, "folding": folding}


#: strain energies that the work in the ledger's FIBRE_WORK went to, by the kind of sheet
_KEPT = {PLY: ("fibre_tension",), SHELL_PLY: ("fibre_tension", "shear", "bending")}


def kinetic_energy(model: Model, state: State, k: int) -> float:
    """Kinetic energy of sheet k [N mm]; a ply's is that of its last half step, for its forces lack the tension."""
    if model.sheets[k]["kind"] == PLY:
        v = sheet_vectors(model, state.v, k)
        return float(0.5 * np.sum(sheet_scalars(model, model.mass, k) * (v * v).sum(axis=0)))
    v, f = sheet_vectors(model, state.v, k), sheet_vectors(model, state.f, k)
    middle = v + 0.5 * model.dt * sheet_scalars(model, model.inverse_mass, k) * f
    mass = sheet_scalars(model, model.mass, k)
    kinetic = float(0.5 * np.sum(mass * (middle * middle).sum(axis=0)))
    if model.sheets[k]["kind"] == SHELL_PLY:
        spin = sheet_shells(model, state.spin, k, 3)
        kinetic += 0.5 * float(model.sheets[k]["gyration"]) * float(np.sum(mass * (spin * spin).sum(axis=0)))
    return kinetic


def energies(model: Model, state: State) -> Energies:
    """All energies of a state."""
    ledger = state.ledger.sum(axis=0)
    count = model.sheets.size
    strain = tuple(sheet_strain(model, state, k) for k in range(count))
    kept = 0.0
    for k, parts in enumerate(strain):
        kept += sum(parts[name] for name in _KEPT.get(int(model.sheets[k]["kind"]), ()))
    return Energies(
        kinetic=tuple(kinetic_energy(model, state, k) for k in range(count)),
        strain=strain,
        contact_spring=float(state.springs.sum()),
        dissipated={
            "friction": float(ledger[FRICTION]),
            "contact_damping": float(ledger[CONTACT_DAMPING]),
            "tool_friction": float(ledger[TOOL_FRICTION]),
            "tool_damping": float(ledger[TOOL_DAMPING]),
            "mass_damping": float(ledger[MASS_DAMPING]),
            "fibre_waves": -float(ledger[FIBRE_WORK]) - kept,
        },
        work={
            "pressure": float(ledger[PRESSURE_WORK]),
            "tool": float(ledger[TOOL_WORK]),
            "thinning": float(ledger[SQUEEZE_WORK]),
        },
    )
