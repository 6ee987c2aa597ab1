"""Faults of plies and their outlines."""

import pytest
from fault_files import check_fault, polygon, swap

FAULTS = {
    "no outline": (swap("size_mm = [350, 350]\n", ""), "plies.0.size_mm", 1, "is required", ""),
    "two outlines": (
        swap("350]\n", "350]\npolygon_mm = [[0,0],[9,0],[0,9]]\n"),
        "plies.0.polygon_mm",
        3,
        "together",
        "",
    ),
    "same ply name": (
        swap("[tool]", "[[plies]]\nname = 'ply-1'\nsize_mm = [9, 9]\n[tool]"),
        "plies.1.name",
        5,
        "already",
        "",
    ),
    "ply beyond the frame": (swap("[350, 350]", "[350, 600]"), "plies.0.size_mm", 2, "10 mm too far along y", ""),
    "ply moved out": (swap("350]\n", "350]\noffset_mm = [500, 0]\n"), "plies.0.offset_mm", 3, "along x", ""),
    "coarse ply": (swap("350]\n", "350]\nelement_mm = 20\n").replace("350]", "30]"), "plies.0.element_mm", 3, "", ""),
    "crossing edges": (polygon("[[0,0],[9,9],[9,0],[0,9]]"), "plies.0.polygon_mm", 2, "edges 1 and 3", ""),
    "folded edge": (polygon("[[0,0],[90,0],[40,0],[40,90]]"), "plies.0.polygon_mm", 2, "cross or touch", ""),
    "closed polygon": (polygon("[[0,0],[90,0],[0,90],[0,0]]"), "plies.0.polygon_mm", 2, "corners 4 and 1", ""),
    "hole outside": (
        swap("350]\n", "350]\nholes_mm = [[[170,0],[180,0],[170,9]]]\n"),
        "plies.0.holes_mm.0",
        3,
        "not inside",
        "",
    ),
    "hole in a notch": (
        polygon("[[-90,-90],[90,-90],[90,90],[0,-50],[-90,90]]", "holes_mm = [[[-5,50],[5,50],[0,60]]]"),
        "plies.0.holes_mm.0",
        3,
        "not inside",
        "",
    ),
    "holes overlap": (
        swap("350]\n", "350]\nholes_mm = [[[0,0],[50,0],[0,50]],\n [[1,1],[9,1],[1,9]]]\n"),
        "plies.0.holes_mm.1",
        4,
        "overlaps",
        "",
    ),
    "crossing hole": (
        swap("350]\n", "350]\nholes_mm = [[[0,0],[9,9],[9,0],[0,9]]]\n"),
        "plies.0.holes_mm.0",
        3,
        "edges 1",
        "",
    ),
    "slit outside": (swap("350]\n", "350]\nslits_mm = [[[0,0],[0,176]]]\n"), "plies.0.slits_mm.0", 3, "not inside", ""),
    "unknown material": (
        swap("350]\n", "350]\nmaterial = 'plain-weave'\n"),
        "plies.0.material",
        3,
        "no material",
        "plain-weave-6k-320",
    ),
    "rubber ply": (swap("350]\n", "350]\nmaterial = 'silicone-ogden'\n"), "plies.0.material", 3, "not woven", ""),
    "name of the run's files": (swap("350]\n", "350]\nname = 'Tool'\n"), "plies.0.name", 3, "taken by", ""),
    "one corner twice": (polygon("[[0,0],[90,0],[90,0],[0,90]]"), "plies.0.polygon_mm", 2, "corners 2 and 3", ""),
    "polygon of two corners": (polygon("[[0,0],[90,0]]"), "plies.0.polygon_mm", 2, "has 2 items", ""),
    "corner of three numbers": (polygon("[[0,0],[90,0,1],[0,90]]"), "plies.0.polygon_mm.1", 2, "has 3 items", ""),
    "corner far away": (polygon("[[0,0],[1e9,0],[0,90]]"), "plies.0.polygon_mm.1.0", 2, "out of range", ""),
    "flat polygon": (polygon("[[0,0],[90,0],[45,0]]"), "plies.0.polygon_mm", 2, "cross or touch", ""),
    "cuts of too many points": (
        swap("350]\n", f"350]\nslits_mm = {[[[k, 0] for k in range(150)]] * 70}\n"),
        "plies.0.slits_mm",
        3,
        "10500 points",
        "",
    ),
    "coarse ply for the tool": (
        swap("\n\n[[proc", "\nheight_mm = 20\n\n[[proc").replace("350]\n", "350]\nelement_mm = 40\n"),
        "plies.0.element_mm",
        3,
        "too large for a tool",
        "",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_one_fault(name, tmp_path):
    check_fault(tmp_path, name, *FAULTS[name])
