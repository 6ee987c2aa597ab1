"""The model, the state, and the one glossary of names, shapes and units that the solver uses.

Units are consistent: mm, tonne, s, N, MPa (so energies are N mm = mJ).

Every sheet (ply or diaphragm) is a logically rectangular grid of rows x cols nodes. Sheets lie one behind
the other in flat pools; `nodes[k]` is the first node of sheet k.

============== ===================== =========================================================================
name           shape                 meaning [unit]
============== ===================== =========================================================================
x, v, f        pool (3 N,)           position [mm], velocity [mm/s], force [N] without fibre tension;
                                     sheet k is the slice 3*node : 3*(node + rows*cols) as (3, rows, cols)
place          (5, P)                a contact slave on its master: grid coordinates (u, v), gap (where it touches: less
                                     the depth that its springs have taken) [mm], its rate, viscous normal force [N]
slip           (2, P)                slip of its friction spring, along the master's grid lines and across [mm]
tool_anchor    (7, 3, n, m)          anchors of the points of a node and its cell: tool frame; on walls: box [mm]
spots          (k, 5)                places of the tool's sharp vertices on its sheet, see `contact.summit`
ledger         (blocks, LEDGER)      cumulative work and dissipation of a block of rows [N mm]
row            grid index i          runs along fibre family 1 (ply) or x (diaphragm)
col            grid index j          runs along fibre family 2 (ply) or y (diaphragm)
cell (i, j)    stored at node (i, j) the quadrilateral of nodes (i, j) .. (i+1, j+1); last row and column are 0
bar1, bar2     pool (N,)             width that the bar (i,j)-(i+1,j), (i,j)-(i,j+1) stands for [mm]
tension1, 2    pool (N,)             tension of these bars [N]
rise           pool (N,)             how far the bed under a ply's node has risen [mm]
press          pool (N,)             running mean of the normal forces of all contacts on a node [N]
director       pool (3 S,)           unit normals of the plies of shell-membrane cells; S nodes, `shell` the first of
                                     a sheet; likewise spin, their angular velocities [1/s], and pull, the
                                     gradients of the energy by them, sign changed [N mm]
history        pool (19 S,)          what these plies' cells remember, see `elements.shell_membrane.history`
step           dt                    one evaluation of all forces [s]
============== ===================== =========================================================================
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from ddf.jit import INLINE

#: kinds of sheets; a SHELL_PLY is a ply of shell-membrane cells, a PLY one of the lattice
PLY, DIAPHRAGM, SHELL_PLY = 0, 1, 2

#: columns of the ledger: work done on a sheet, energy that left the sheets, and (FIBRE_WORK) work
#: that fibre tension did on the plies' motion, work of contact pressure on layers that thin, per block of rows [N mm]
(
    PRESSURE_WORK,
    TOOL_WORK,
    FRICTION,
    CONTACT_DAMPING,
    TOOL_FRICTION,
    TOOL_DAMPING,
    MASS_DAMPING,
    FIBRE_WORK,
    SQUEEZE_WORK,
) = range(9)
LEDGER = 9
#: columns of the springs: energy stored now in the contacts of a block (normal, tangential; tool likewise)
(NORMAL_SPRING, TANGENTIAL_SPRING, TOOL_NORMAL_SPRING, TOOL_TANGENTIAL_SPRING) = range(4)
SPRINGS = 4
#: columns of the schedule, one row a step
(TIME, PRESSURE_TOP, PRESSURE_BOTTOM, TOOL_Z, TOOL_SPEED, DAMPING) = range(6)
SCHEDULE = 6

SHEET = np.dtype(
    [
        ("kind", np.int64),
        ("node", np.int64),
        ("rows", np.int64),
        ("cols", np.int64),
        ("line", np.int64),  # first entry of a diaphragm's reference cell sizes in `lines`
        ("shear", np.int64),  # row of `shear_tables`
        ("face", np.int64),  # diaphragm: column of the schedule with its net pressure
        ("a1", np.float64),
        ("a2", np.float64),
        ("eh1", np.float64),  # membrane modulus of family 1 [N/mm]
        ("eh2", np.float64),
        ("bend1", np.float64),  # bending rigidity along family 1 [N mm]
        ("bend2", np.float64),
        ("bend_in_plane", np.float64),
        ("thickness", np.float64),
        ("bed_stiffness", np.float64),  # [N/mm3]
        ("bed_friction", np.float64),  # on the tool, through the sheets between
        ("bed", np.float64),  # ply: distance from the tool at which it bears the ply itself, see `contact.bed` [mm]
        ("rigidity", np.float64),  # diaphragm: plate bending rigidity [N mm]
        ("hourglass", np.float64),  # modulus 4 mu t of the diaphragms: hourglass strains, fold struts [N/mm]
        ("squeeze", np.float64),  # thickness on which contact pressure acts in the plane, 0: on none [mm]
        ("fold_radius", np.float64),  # least radius of a fold [mm]
        ("shell", np.int64),  # SHELL_PLY: first node in the pools of directors and histories
        ("fibre", np.float64),  # angle of family 1 to the grid's first direction [rad]
        ("transverse", np.float64),  # transverse shear stiffness [N/mm]
        ("glass", np.float64),  # hourglass coefficient
        ("gyration", np.float64),  # rotary inertia over mass [mm2]
        ("viscous", np.float64),  # damping of the fibres' stretching over their stiffness [s]
    ],
    align=True,
)

BLOCK = np.dtype(
    [
        ("sheet", np.int64),
        ("low", np.int64),  # rows low .. high-1
        ("high", np.int64),
    ],
    align=True,
)

PAIR = np.dtype(
    [
        ("slave", np.int64),
        ("master", np.int64),
        ("first", np.int64),  # first entry of the slave's nodes in `place`
        ("buffer", np.int64),  # first entry in the master force buffers
        ("span", np.int64),  # first entry in the buffers' row spans
        ("sign", np.float64),  # +1: slave above the master, -1: below
        ("offset", np.float64),  # half thicknesses [mm]
        ("friction", np.float64),
        ("stiffness", np.float64),  # [N/mm3]
        ("damping", np.float64),  # [N s/mm3]
        ("mass", np.float64),  # reduced areal mass of both sheets [tonne/mm2]
    ],
    align=True,
)

RIM = np.dtype(
    [
        ("node", np.int64),  # of the rim, and one of those that it goes on from, with its weight: see `contact.rim`
        ("parent", np.int64),
        ("weight", np.float64),
    ],
    align=True,
)


class Model(NamedTuple):
    """All that does not change during a run."""

    sheets: np.ndarray  # SHEET
    blocks: np.ndarray  # BLOCK, sheet by sheet, rows ascending
    pairs: np.ndarray  # PAIR
    mass: np.ndarray  # (N,) [tonne], scaled
    inverse_mass: np.ndarray  # (N,) [1/tonne]; 0 holds a node at its given velocity
    line_mass: np.ndarray  # (N,) the same; below 0 for nodes that do not leave the mirror plane, see `elements.tension`
    area: np.ndarray  # (N,) reference area of a node, for contact [mm2]
    inverse_area: (
        np.ndarray
    )  # (N,) one over a node's area in `elements.squeeze`, of the whole in a half; 0: none [1/mm2]
    bar1: np.ndarray
    bar2: np.ndarray
    cell: np.ndarray  # (N,) reference area of the cloth in a cell [mm2]
    triple1: np.ndarray  # (N,) area of the bending triple centred on a node, along family 1 [mm2]
    triple2: np.ndarray
    weight: np.ndarray  # (4 N,) weights of the bars around a node in its tangents, see `bending.tangent_weights`
    lines: np.ndarray  # reference sizes of diaphragm cells: rows then cols [mm]
    tool_lines: np.ndarray  # the same as the tool's contact takes them: 0 for cells beyond the mirror plane
    shear_tables: np.ndarray  # (laws, intervals, 5)
    tangents: np.ndarray  # (laws, intervals): h G [N/mm] over the shear angle, 0 .. `shear_law.TANGENT_SPAN`
    ogden: np.ndarray  # (pairs, 2): mu [MPa], alpha
    exposed: np.ndarray  # (P,) bool: slave nodes a pair has to follow
    cover: np.ndarray  # (N,) share of contact stiffness that a master gives at a node, see `build.rim.ply_cover`
    centre: np.ndarray  # (2 N,) int32: centre of the contact patch around a node
    rim: np.ndarray  # (R,) RIM, by nodes
    rim_first: np.ndarray  # (blocks + 1,) first of each block's rim nodes
    rim_parents: np.ndarray  # (R,) the same RIM, by parents
    parent_first: np.ndarray  # (blocks + 1,) first of those whose parents each block has
    tool: np.ndarray  # (nx, ny, nz, 4) float32 signed distance and gradient
    tool_origin: np.ndarray  # (3,)
    tool_spacing: float
    tool_sheet: int  # sheet that meets the tool, -1 without a tool
    tool_offset: float  # half thickness of that sheet [mm]
    tool_stiffness: float
    tool_damping: float
    tool_mass: float  # least areal mass of that sheet [tonne/mm2]
    tool_friction: float
    tool_boxed: bool  # whether the box's walls stand under that sheet's edges, which run along x and y
    tool_walls: np.ndarray  # (4,) where they stand: least and largest x, then y [mm]
    summits: np.ndarray  # (k, SUMMIT) sharp vertices of the tool, see `contact.summit`
    gravity: np.ndarray  # (3,) acceleration that all (scaled) masses feel [mm/s2]
    mirror: int  # component normal to the mirror plane of a half model (`dynamics.mirror`), -1 in a whole one
    ghosts: np.ndarray  # (G, 2) nodes of the pools: beyond the plane, and its image; by blocks of the first
    ghost_first: np.ndarray  # (blocks + 1,) first ghost of each block
    images: np.ndarray  # (G,) numbers of ghosts, by blocks of their images
    image_first: np.ndarray  # (blocks + 1,)
    plane: np.ndarray  # (P,) nodes on the plane, by blocks
    plane_first: np.ndarray  # (blocks + 1,)
    twins: np.ndarray  # (T, 2) 2 k + family - 1 of bar k beyond the plane, and of its image; by blocks of the first
    twin_first: np.ndarray  # (blocks + 1,)
    away: np.ndarray  # (N,) bool: nodes so far from the plane that they may meet their sheet's image
    dt: float


class State(NamedTuple):
    """All that a restart needs, besides time and step number (in `clock`)."""

    x: np.ndarray
    v: np.ndarray
    f: np.ndarray
    place: np.ndarray
    slip: np.ndarray
    tool_anchor: np.ndarray
    spots: np.ndarray  # (k, SPOT) where on the sheet each summit is
    press: np.ndarray  # (N,) mean contact force on each node [N]
    tension1: np.ndarray  # (N,) tension of each bar, as the last step left it [N]
    tension2: np.ndarray
    rise: np.ndarray  # (N,) how far the bed under each node of a ply has risen, see `contact.bed` [mm]
    director: np.ndarray
    spin: np.ndarray
    pull: np.ndarray
    history: np.ndarray
    ledger: np.ndarray
    springs: np.ndarray  # (blocks, SPRINGS)
    clock: np.ndarray  # (4,): step number, time [s]; the same where the step last changed


def without_mirror(inverse_mass: np.ndarray, blocks: int) -> dict[str, Any]:
    """Fields of a whole model that a half one has otherwise."""
    none, firsts = np.zeros(0, np.int64), np.zeros(blocks + 1, np.int64)
    return {
        "line_mass": inverse_mass, "mirror": -1, "ghosts": np.zeros((0, 2), np.int64), "ghost_first": firsts,
        "images": none, "image_first": firsts, "plane": none, "plane_first": firsts,
        "twins": np.zeros((0, 2), np.int64), "twin_first": firsts, "away": np.zeros(inverse_mass.size, bool),
    }  # fmt: skip


@njit(**INLINE)
def vectors(pool, sheet):
    """Sheet's slice of a vector pool as (3, rows, cols)."""
    n = sheet.rows * sheet.cols
    return pool[3 * sheet.node : 3 * (sheet.node + n)].reshape((3, sheet.rows, sheet.cols))


@njit(**INLINE)
def scalars(pool, sheet):
    """Sheet's slice of a scalar pool as (rows, cols)."""
    n = sheet.rows * sheet.cols
    return pool[sheet.node : sheet.node + n].reshape((sheet.rows, sheet.cols))


@njit(**INLINE)
def shell_fields(pool, sheet, count):
    """Sheet's slice of a pool of `count` numbers a node of shell plies as (count, rows, cols)."""
    n = sheet.rows * sheet.cols
    return pool[count * sheet.shell : count * (sheet.shell + n)].reshape((count, sheet.rows, sheet.cols))


@njit(**INLINE)
def fours(pool, sheet):
    """Sheet's slice of a pool of four numbers a node as (4, rows, cols)."""
    n = sheet.rows * sheet.cols
    return pool[4 * sheet.node : 4 * (sheet.node + n)].reshape((4, sheet.rows, sheet.cols))


def sheet_vectors(model: Model, pool: np.ndarray, k: int) -> np.ndarray:
    """View of sheet k in a vector pool, shape (3, rows, cols)."""
    s = model.sheets[k]
    n = int(s["rows"] * s["cols"])
    a = int(s["node"])
    return pool[3 * a : 3 * (a + n)].reshape(3, int(s["rows"]), int(s["cols"]))


def sheet_shells(model: Model, pool: np.ndarray, k: int, count: int) -> np.ndarray:
    """View of shell ply k in a pool of `count` numbers a node of such plies, shape (count, rows, cols)."""
    s = model.sheets[k]
    n, a = int(s["rows"] * s["cols"]), int(s["shell"])
    return pool[count * a : count * (a + n)].reshape(count, int(s["rows"]), int(s["cols"]))


def sheet_scalars(model: Model, pool: np.ndarray, k: int) -> np.ndarray:
    """View of sheet k in a scalar pool, shape (rows, cols)."""
    s = model.sheets[k]
    n = int(s["rows"] * s["cols"])
    a = int(s["node"])
    return pool[a : a + n].reshape(int(s["rows"]), int(s["cols"]))
