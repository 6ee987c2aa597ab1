"""What is written: tables, page and pictures of judged claims, and of variants."""

import csv
import json

import pytest
from stars import formed, star

from ddf.claims.cases import DOUBLE, VACUUM_FIRST
from ddf.claims.claims import CLAIMS
from ddf.claims.pictures import draw_claim
from ddf.claims.report import decided_by, text_lines, write_page, write_tables
from ddf.claims.verdict import judge
from ddf.output.figures import figure_bytes
from ddf.output.folder import RunFolder


def two(amplitude):
    return formed(*(star(angle, (0, 90), amplitude=amplitude, percent=amplitude) for angle in (45, 0)))


def claim_5(first, second):
    return [judge(CLAIMS[4], {DOUBLE: [two(first)], VACUUM_FIRST: [two(second)]}, {})]


def test_a_variant_that_decides(tmp_path):
    shipped, variants = claim_5(8, 6), {"fillet-8": claim_5(6, 8), "fillet-3": claim_5(8, 7)}
    everything = {"as shipped": shipped, **variants}
    assert decided_by(everything) == ["claim 5: not reproduced by fillet-8; reproduced by as shipped, fillet-3"]
    assert decided_by({"a": shipped, "b": claim_5(8, 7)}) == ["claim 5: reproduced by all 2 variants"]
    out, rows = RunFolder(tmp_path), [{"run": "double", "state": "finished", "reason": "", "wall_s": 1.0}]
    write_tables(out, "title", shipped, variants, rows, ["a note"])
    write_page(out, "title", shipped, variants, rows, ["a note"])
    with (tmp_path / "claims.csv").open() as stream:
        table = list(csv.DictReader(stream))
    assert [row["variant"] for row in table[::3]] == ["as shipped", "fillet-8", "fillet-3"]
    assert [float(row["margin"]) for row in table[::3]] == pytest.approx([1 / 4, -1 / 3, 1 / 8])
    found = json.loads((tmp_path / "claims.json").read_text())
    assert found["variants"] == {"fillet-8": ["not reproduced"], "fillet-3": ["reproduced"]}
    assert "| fillet-8 | not reproduced |" in (tmp_path / "claims.md").read_text()
    page = (tmp_path / "claims.html").read_text()
    assert "<td>fillet-8</td><td>not reproduced</td>" in page
    assert "a note" in page


def test_lines_and_picture():
    judged = claim_5(8, 6)
    lines = text_lines(judged)
    assert lines[0] == "claim 5: vacuum before the lift: less severe: REPRODUCED"
    assert lines[2].split()[-5:] == ["-", "below", "1", "+0.25", "holds"]
    picture = figure_bytes(draw_claim(judged[0], {DOUBLE: [two(8)], VACUUM_FIRST: [two(6)]}))
    assert picture.startswith(b"\x89PNG")
    assert figure_bytes(draw_claim(judge(CLAIMS[4], {}, {}), {})).startswith(b"\x89PNG")  # with no run at all
