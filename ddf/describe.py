"""What a scene is and what running it costs, in words: the text of `ddf check`."""

from __future__ import annotations

from ddf.case import woven_material
from ddf.past_runs import slowness
from ddf.scene import Scene

BYTES_A_NODE = 8 * (3 * 3 + 8) + 4 * 2
BYTES_A_CONTACT = 8 * 5 + 2
NANOSECONDS_A_NODE = {"ply": 320.0, "diaphragm": 210.0}
NANOSECONDS_A_CONTACT = 80.0
LIBRARIES_MIB, PICTURES_MIB = 350.0, 450.0  # of a process that has computed, and that has drawn; measured
ONE_BY_ONE = 0.1  # share of a step's work that more threads do not make quicker


def memory_bytes(scene: Scene) -> int:
    """Memory of model, state and contact buffers [byte], about."""
    model = scene.model
    nodes = sum(int(s["rows"] * s["cols"]) for s in model.sheets)
    buffers = 0
    for pair in model.pairs[model.pairs["slave"] != model.pairs["master"]]:  # others: once a sheet touches itself
        master = model.sheets[pair["master"]]
        blocks = int((model.blocks["sheet"] == pair["slave"]).sum())
        buffers += 32 * int(master["rows"] * master["cols"]) * blocks
    return BYTES_A_NODE * nodes + BYTES_A_CONTACT * int(model.exposed.size) + buffers + int(model.tool.nbytes)


def seconds_estimate(scene: Scene) -> float:
    """Wall time of the steps on one core of about 2.5 GHz [s], from measured costs a node."""
    model = scene.model
    total = NANOSECONDS_A_CONTACT * int(model.exposed.sum())
    for info, sheet in zip(scene.sheets, model.sheets, strict=True):
        total += NANOSECONDS_A_NODE[info.kind] * int(sheet["rows"] * sheet["cols"])
    return 1e-9 * total * scene.steps


def speedup(threads: int) -> float:
    """How much faster steps are on so many threads, each with a core, than on one."""
    return 1.0 / (ONE_BY_ONE + (1.0 - ONE_BY_ONE) / threads)


def expected_seconds(scene: Scene, threads: int) -> float:
    """Wall time of the steps on this machine [s]: the estimate, and how it did with the last runs here."""
    return seconds_estimate(scene) * slowness()[0] / speedup(threads)


def estimate_source() -> str:
    """On what `expected_seconds` rests."""
    runs = slowness()[1]
    if runs == 0:
        return "for cores of about 2.5 GHz: no run has ended here yet"
    return f"as the last {runs} runs here went" if runs > 1 else "as the last run here went"


def describe_scene(scene: Scene) -> str:
    """Sheets, laws, tool, load path, step and cost of a scene as lines of text."""
    case, model = scene.case, scene.model
    lines = [case.title or "(no title)", "", "sheets"]
    for info, sheet in zip(scene.sheets, model.sheets, strict=True):
        lines.append(
            f"  {info.name}: {int(sheet['rows'])} x {int(sheet['cols'])} nodes, {info.thickness_mm:g} mm, "
            f"{1e6 * info.true_mass:.1f} g {1e6 * info.added_mass:+.1f} g for the step"
        )
    lines += ["", "physics"]
    for ply in case.plies:
        law = woven_material(case, ply.material).shear_law
        why = "slope kept positive, so shear cannot localise" if law == "monotone" else "as entered, may localise"
        lines.append(
            f"  {ply.name}: {ply.formulation}, {ply.material} at {ply.orientation_deg:g} deg, {law} shear law ({why})"
        )
    bending = "with" if case.diaphragms.bending else "without"
    lines.append(f"  diaphragms: Ogden membrane {bending} plate bending, pre-stretch {case.diaphragms.pre_stretch:g}")
    layers, own = int((model.pairs["slave"] != model.pairs["master"]).sum()), case.solver.self_contact
    folds = "sheets that fold touch themselves" if own else "no self-contact"
    lines.append(f"  contact: {layers} pairs, {int(model.exposed.sum())} nodes followed; {folds}")
    if case.tool is None:
        lines.append("  tool: none")
    else:
        top = scene.tool_mesh.top_mm if scene.tool_mesh is not None else 0.0
        lines.append(f"  tool: {case.tool.shape}, highest point {top:.2f} mm above its base (fillet included)")
    if scene.half is not None:
        lines.append(f"  symmetry: its own mirror image; {scene.half.where} is computed, and the rest is its image")
    elif scene.symmetry:
        lines.append(f"  symmetry: {scene.symmetry}; all of it is computed")
    lines += ["", "process"]
    path = scene.path
    for k, name in enumerate(path.names):
        lines.append(
            f"  {name}: {path.time[k]:g} to {path.time[k + 1]:g} s, ends at cavity {path.cavity[k + 1]:g} kPa, "
            f"box {path.box[k + 1]:g} kPa, lift {path.lift[k + 1]:g} mm"
        )
    arrays = memory_bytes(scene) / 2**20
    memory = arrays + LIBRARIES_MIB + (PICTURES_MIB if case.output.pictures else 0.0)
    lines += [
        "",
        "cost",
        f"  step {model.dt:.3g} s (stable {scene.step_limit:.3g} s with safety), {scene.steps} steps",
        f"  about {memory:.0f} MiB of memory ({arrays:.0f} of them arrays)",
        f"  about {expected_seconds(scene, 1):.0f} s of steps on one core, {expected_seconds(scene, 2):.0f} s on two "
        f"({estimate_source()})",
    ]
    return "\n".join(lines)
