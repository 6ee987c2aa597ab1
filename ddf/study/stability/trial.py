"""A scene under the guards of a run, without a folder: what would refuse, stop or warn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ddf.case import Case
from ddf.monitors.audit import Check, audit
from ddf.monitors.energy import Energies, energies
from ddf.monitors.stability import check_state
from ddf.plausible.cost import examine_steps
from ddf.plausible.findings import Findings
from ddf.plausible.prepare import examine
from ddf.scene import Scene
from ddf.simulate import Simulation
from ddf.study.stability.map import REFUSED, STOPPED, WARNED

STATEMENTS = ("added mass", "edges of layers through each other")
"""Lines of the audit that say what was done rather than what went wrong: mass that the shipped cases add on purpose,
and elements as large as the tool's roundings, which a map's small scenes have."""


@dataclass(frozen=True)
class Trial:
    """How a scene went: the first guard that spoke, by its kind and in its words; empty where none did."""

    kind: str
    guard: str
    energy: Energies
    checks: tuple[Check, ...] = ()

    @property
    def finished(self) -> bool:
        """Whether it ran to its end."""
        return self.kind != STOPPED


def refusal(case: Case, scene: Scene) -> str:
    """What refuses the case before its run, empty where nothing does."""
    found = examine(case)
    examine_steps(scene, found)
    return "; ".join(f"{'.'.join(map(str, fault.path))}: {fault.problem}" for fault in found.faults)


def warnings_of(examined: Findings) -> str:
    """Warnings before the run, in one line."""
    return "; ".join(f"{'.'.join(map(str, w.path))}: {w.problem}" for w in examined.warnings)


def run_guarded(scene: Scene, look: Callable[[Simulation], None] = lambda _: None) -> Trial:
    """Run a scene to its end under the guards of `ddf run`; `look` is called at each check. Audited at the end."""
    names, start = [sheet.name for sheet in scene.sheets], scene.state.x.copy()
    solver, sim, history = scene.case.solver, Simulation(scene), scene.case.output.history_interval_steps
    energy, peak = energies(scene.model, scene.state), 0.0
    try:
        while sim.step < scene.steps:
            sim.advance(min(solver.check_interval_steps, scene.steps - sim.step))
            alarm = check_state(scene.model, scene.state, names, start)
            if alarm is not None:
                words = f"{alarm.problem.partition(' of ')[0]} in {alarm.sheet}"
                return Trial(STOPPED, words, energy)
            look(sim)
            if sim.step % history < solver.check_interval_steps or sim.step == scene.steps:
                energy = energies(scene.model, scene.state)
                peak = max(peak, energy.total_kinetic)
            if not abs(energy.error_percent) <= solver.energy_error_limit_percent:
                return Trial(STOPPED, "energy error", energy)
    finally:
        sim.close()
    checks = tuple(audit(scene, energy, sim.time, None, peak))
    failed = [check["name"] for check in checks if not check["ok"] and check["name"] not in STATEMENTS]
    return Trial(WARNED if failed else "", "; ".join(failed), energy, checks)


def run_case_guarded(case: Case, scene: Scene, look: Callable[[Simulation], None] = lambda _: None) -> Trial:
    """`run_guarded`, with what would have refused the case first; it runs all the same, to see what it would do."""
    refused = refusal(case, scene)
    trial = run_guarded(scene, look)
    if not refused:
        return trial
    behind = f"; let through: {trial.guard}" if trial.guard else "; let through: no guard"
    return Trial(REFUSED, refused + behind, trial.energy, trial.checks)
