"""Checks of values that are possible each by itself and not together: thicknesses, densities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ddf.case.faults import Problem
from ddf.case.preset_data import PRESET_DATA
from ddf.case.schema import WovenMaterial

LIGHTEST_KG_M3, HEAVIEST_KG_M3 = 1.0, 25_000.0  # aerogel, osmium: no fabric lies beyond


def material_problems(weaves: Mapping[str, WovenMaterial | None]) -> Iterator[Problem]:
    """Check that mass per area and thickness of each weave give a density that exists: else a unit is wrong."""
    for name, weave in weaves.items():
        if weave is None:
            continue
        density = weave.areal_density_gsm / weave.thickness_mm  # g/m2 over mm is kg/m3
        if not LIGHTEST_KG_M3 <= density <= HEAVIEST_KG_M3:
            problem = (
                f"{weave.areal_density_gsm:g} g/m2 in {weave.thickness_mm:g} mm is a density of {density:.3g} kg/m3"
            )
            allowed = f"{LIGHTEST_KG_M3:g} to {HEAVIEST_KG_M3:g} kg/m3; thickness in mm, areal density in g/m2"
            yield Problem(("materials", name, "areal_density_gsm"), problem, allowed)


def gap_problem(
    gap_mm: float | None, materials: Sequence[Any], weaves: Mapping[str, WovenMaterial | None]
) -> Iterator[Problem]:
    """Check that the plies fit between the diaphragms, as far as their materials are known."""
    thickness = [_thickness(name, weaves) for name in materials]
    known = sum(t for t in thickness if t is not None)
    if gap_mm is not None and gap_mm < known * (1.0 - 1e-9):
        problem = f"{gap_mm:g} is less than the plies' thickness of {known:g} mm in all: they would start inside it"
        yield Problem(("diaphragms", "gap_mm"), problem, f">= {known:g}, or left out")


def _thickness(name: Any, weaves: Mapping[str, WovenMaterial | None]) -> float | None:
    if not isinstance(name, str):
        return None
    weave = weaves.get(name)
    if weave is not None:
        return weave.thickness_mm
    return None if name in weaves else PRESET_DATA.get(name, {}).get("thickness_mm")
