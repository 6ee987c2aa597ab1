"""A small net on a hemisphere that stands off the frame's centre, turned."""

import pytest
from nets import NET

from ddf.case import case_from_dict
from ddf.export.part import formed_part
from ddf.run import run_case


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("export") / "run"
    run_case(case_from_dict(NET), folder)
    return folder


@pytest.fixture(scope="session")
def part(run):
    return formed_part(run)
