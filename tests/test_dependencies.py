"""What the package imports is what it declares, and the documents' examples are cases."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest

from ddf.case import load_case

ROOT = Path(__file__).parents[1]
MODULES = {"vtk": "vtkmodules", "tomli-w": "tomli_w"}  # packages whose module has another name
EXAMPLES = [
    (page.name, number, block)
    for page in sorted((ROOT / "docs").glob("add-*.md"))
    for number, block in enumerate(re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL))
]


def _imported(file):
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name.split(".")[0] for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module.split(".")[0]


def test_every_dependency_is_imported_and_every_import_declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = [*project["dependencies"], *project["optional-dependencies"]["cluster"]]
    declared = {MODULES.get(name, name) for name in (re.match(r"[\w-]+", text)[0] for text in wanted)}
    imported = {name for file in (ROOT / "ddf").rglob("*.py") for name in _imported(file)}
    assert imported - set(sys.stdlib_module_names) - {"ddf", "llvmlite"} == declared  # llvmlite comes with numba


def test_every_dependency_is_explained_with_its_oldest_version():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for wanted in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]:
        name, version = wanted.split(">=")
        assert f"| {name} | {version} |" in text


@pytest.mark.parametrize(("page", "number", "block"), EXAMPLES)
def test_examples_of_the_documents_are_valid(page, number, block, tmp_path):
    file = tmp_path / "case.toml"
    text = (ROOT / "cases/flat-stack.toml").read_text(encoding="utf-8")
    assert "[tool]" not in text
    file.write_text(f"{text}\n{block}", encoding="utf-8")
    load_case(file)  # raises CaseError with what is wrong
