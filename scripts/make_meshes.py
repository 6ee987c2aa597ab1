"""Write the shipped tool geometry to meshes/: a STEP file for each primitive, and a table of them.

Run from anywhere: python scripts/make_meshes.py [folder]
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from ddf.mesh.tool import build_tool, write_step

TOOLS: dict[str, dict[str, float]] = {
    "cube-corner-tetrahedron": {"height_mm": 82.0, "fillet_mm": 5.0},
    "regular-tetrahedron": {"height_mm": 82.0, "fillet_mm": 5.0},
    "hemisphere": {"radius_mm": 60.0},
    "box": {"length_mm": 120.0, "width_mm": 80.0, "height_mm": 40.0, "fillet_mm": 5.0},
    "cylinder": {"radius_mm": 60.0, "height_mm": 40.0, "fillet_mm": 5.0},
}

HEADER = """# Tool geometry

STEP files (mm) of the tools that `ddf` builds itself, to look at, to change in a CAD program, or as patterns
for your own: a case takes them with `shape = "file"`. The platform is the plane z = 0 and the apex or axis is
on x = y = 0. Each solid goes on below the platform (17 mm), so that its base edges play no role. Lengths in
mm.

| file | size | top at z | extent in x | extent in y | triangles |
|---|---|---|---|---|---|
"""

FOOTER = """
The cube-corner tetrahedron has three mutually perpendicular faces that meet at the apex, 54.7 deg from the
base; the regular one has faces 70.5 deg from the base. Their height is that of the sharp solid: a fillet of
radius r lowers the top by r (sqrt 3 - 1) and by 2 r. Base corners are at polar angles 90, 210 and 330 deg.
Extents include the part below the platform; triangles are those of the default surface mesh. Made by
`scripts/make_meshes.py`.
"""


def main(folder: Path) -> None:
    """Write all STEP files and README.md into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for shape, size in TOOLS.items():
        path = folder / f"{shape}.step"
        write_step(shape, path, **size)
        # A fixed time stamp: the file changes only when the geometry does.
        text = re.sub(r"'\d{4}-\d\d-\d\dT[\d:]+'", "'2000-01-01T00:00:00'", path.read_text())
        path.write_text(text)
        mesh = build_tool("file", file=path)
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        named = ", ".join(f"{key.removesuffix('_mm')} {value:g}" for key, value in size.items())
        rows.append(
            f"| {path.name} | {named} | {mesh.top_mm:.1f} | {low[0]:.1f} to {high[0]:.1f} "
            f"| {low[1]:.1f} to {high[1]:.1f} | {len(mesh.triangles)} |"
        )
    (folder / "README.md").write_text(HEADER + "\n".join(rows) + "\n" + FOOTER)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent / "meshes")
