"""The locator: the line of every key path, in every way TOML has of writing it."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ddf.case.locate import Lines, locate
from ddf.case.template import TEMPLATE

TEXT = '''\
a = 1 # c = 2
"quoted.key" = "x # y"
b.c = 'lit\\'
b.'d e' = 3

[t]
m = """
[not.a.table]
z = 1 \\""" """"
n = \'\'\'
''z = "\'\'\'\'
o = [ # comment ]
  1,
  [2,
   3], {p = 4,q = [5, "}"]},
]
date = 1979-05-27 07:32:00Z
last = {x.y = 1, "z" = {}}

[[plies]]
element_mm = 2
[plies.sub]
k = 1
[[plies]]
element_mm = 4
[[plies.inner]]
k = 1
[[ plies . inner ]]
k = 2
[u.v.w]
k = true
'''
WHERE = {
    ("a",): 1,
    ("quoted.key",): 2,
    ("b", "c"): 3,
    ("b", "d e"): 4,
    ("b",): 3,
    ("t",): 6,
    ("t", "m"): 7,
    ("t", "n"): 10,
    ("t", "o"): 12,
    ("t", "o", 0): 13,
    ("t", "o", 1): 14,
    ("t", "o", 1, 1): 15,
    ("t", "o", 2, "q", 1): 15,
    ("t", "date"): 17,
    ("t", "last", "x", "y"): 18,
    ("t", "last", "z"): 18,
    ("plies", 0): 20,
    ("plies", 0, "element_mm"): 21,
    ("plies", 0, "sub", "k"): 23,
    ("plies", 1): 24,
    ("plies", 1, "element_mm"): 25,
    ("plies", 1, "inner", 0, "k"): 27,
    ("plies", 1, "inner", 1): 28,
    ("plies", 1, "inner", 1, "k"): 29,
    ("u", "v", "w", "k"): 31,
    # Missing keys stand at the table that would hold them, or on line 1.
    ("plies", 1, "missing"): 24,
    ("t", "missing", "deeper"): 6,
    ("nowhere",): 1,
    (): 1,
}


def paths(value, path=()):
    """Yield the key path of every table, list item and value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield (*path, key)
        yield from paths(item, (*path, key))


@pytest.mark.parametrize("path", WHERE, ids=str)
def test_line(path):
    assert locate(TEXT).at(path) == WHERE[path]


@pytest.mark.parametrize(
    "text", [TEXT, TEMPLATE, *(p.read_text() for p in (Path(__file__).parents[2] / "cases").glob("*.toml"))]
)
def test_every_path_has_a_line_that_names_its_key(text):
    found = locate(text).lines
    lines = text.splitlines()
    for path in paths(tomllib.loads(text)):
        assert path in found
        if isinstance(path[-1], str):
            assert path[-1] in lines[found[path] - 1]


def test_no_lines():
    assert Lines().at(("a", 0)) == 1


@settings(max_examples=200, deadline=None)
@given(st.lists(st.sampled_from([*TEXT.splitlines(), "[", "]", "{", "x =", '"', "'''", "\\"]), max_size=12))
def test_the_locator_ends_quietly_on_anything(lines):
    text = "\n".join(lines)
    found = locate(text).lines
    try:
        tables = tomllib.loads(text)
    except ValueError:
        return
    assert set(paths(tables)) <= set(found)
