"""A sweep on a Dask cluster of two worker processes, one of which is lost."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from ddf.errors import UsageError
from ddf.sweep.file import load_sweep
from ddf.sweep.sweep import run_sweep

NET = """
model = "kinematic"
output.pictures = false
[[plies]]
size_mm = [100.0, 100.0]
element_mm = 10.0
[tool]
shape = "hemisphere"
radius_mm = 60.0
"""


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "net.toml").write_text(NET)
    file = tmp_path / "s.toml"
    file.write_text('case = "net.toml"\nmethod = "grid"\nvary."kinematic.offset_mm" = [0, 2, 4]\n')
    return load_sweep(file)


def test_no_scheduler_is_said_so(plan, tmp_path, monkeypatch):
    monkeypatch.setattr("ddf.sweep.cluster.CONNECT_S", 1)
    with pytest.raises(UsageError, match="Dask"):
        run_sweep(plan, tmp_path / "out", scheduler="tcp://127.0.0.1:1")


def test_cases_of_a_lost_worker_go_to_another(plan, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        pids = [worker.pid for worker in cluster.workers.values()]
        logs = tmp_path / "out" / "logs"

        def lose_one():
            while not logs.is_dir() or not list(logs.iterdir()):
                time.sleep(0.02)
            os.kill(pids[0], signal.SIGKILL)

        threading.Thread(target=lose_one, daemon=True).start()
        result = run_sweep(plan, tmp_path / "out", scheduler=cluster.scheduler_address)
    assert [outcome.state for outcome in result.finished] == ["finished"] * 3, result.failed
    assert Path(tmp_path / "out" / "table.csv").exists()
