"""examples/ in Python: the notebook and the sweep on a cluster."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT


def test_the_notebook_runs() -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(ROOT / "examples/flexlink.ipynb", as_version=4)
    # Its own assertions fail the run.
    nbclient.NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(ROOT / "examples")}}
    ).execute()
    shown = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    assert sum("image/png" in out.get("data", {}) for out in shown) >= 4


def test_a_dask_cluster_gives_the_table_of_one_process(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    pandas = pytest.importorskip("pandas")
    words = [sys.executable, str(ROOT / "examples/sweep_dask.py"), str(LINK), str(MOTION)]
    words += ["--cases", "25", "-o", str(tmp_path / "s.csv")]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("25 cases, 0 failed")
    table = pandas.read_csv(tmp_path / "s.csv")
    cases = [{"segments.*.EI*": factor} for factor in np.geomspace(0.5, 32, 25)]
    motion = pandas.read_csv(MOTION, comment="#")
    time, acceleration = motion["time"].to_numpy(), motion["acceleration"].to_numpy()
    alone = flexlink.sweep(flexlink.Link.read(LINK), cases, time, acceleration=acceleration)
    for name, column in alone.items():
        if name not in ("warnings", "error"):
            np.testing.assert_allclose(table[name], column, rtol=1e-14)
