"""Histories in other libraries of tables, read by these."""

from __future__ import annotations

import gc
from importlib import import_module
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT


@pytest.fixture(scope="module")
def results() -> list[Any]:
    link = flexlink.Link.read(LINK)
    solution = flexlink.solve(link, MOTION)
    played = flexlink.simulate(link, solution.time, torque=solution.torque)
    arm = flexlink.Arm.read(ROOT / "specs/arms/two_links.toml")
    solved = flexlink.solve(arm, ROOT / "trajectories/arms/line_1.5s.csv")
    return [solution, solution.table(), played, solved]


def test_nanoarrow_reads_the_numbers_where_they_are(results: list[Any]) -> None:
    nanoarrow, c_array = import_module("nanoarrow"), import_module("nanoarrow.c_array")
    for result in results:
        frame = result.to_pandas()
        stream = nanoarrow.c_array_stream(result)
        schema = stream.get_schema()
        names = [child.name for child in schema.children]
        assert names == ["time", *frame.columns]
        units = [dict(child.metadata.items()) for child in schema.children]
        assert units[0] == {b"unit": b"s"} and units[1] in ({b"unit": b"N m"}, {b"unit": b"N"})
        (table,) = list(stream)
        columns = [np.asarray(child.view().buffer(1)) for child in c_array.c_array(table).children]
        for name, column in zip(names, columns):
            expected = result.time if name == "time" else frame[name].to_numpy()
            np.testing.assert_array_equal(column, expected, err_msg=name)
    solution = results[0]
    address = solution.torque.__array_interface__["data"][0]
    (table,) = list(nanoarrow.c_array_stream(solution))
    assert table.child(1).buffers[1] == address


def test_columns_outlive_their_result() -> None:
    nanoarrow = import_module("nanoarrow")
    link = flexlink.Link.read(LINK)
    solution = flexlink.solve(link, MOTION)
    kept = solution.torque.copy()
    unread = solution.__arrow_c_stream__()
    (table,) = list(nanoarrow.c_array_stream(solution))
    del solution, unread
    gc.collect()
    again = flexlink.solve(link.changed({"segments.*.EI*": 3}), MOTION)
    assert (np.asarray(table.child(1).view().buffer(1)) == kept).all() and again.time.size


def test_polars_pyarrow_duckdb_and_pandas_read_a_solution(results: list[Any]) -> None:
    solution = results[0]
    polars = import_module("polars")
    frame = polars.DataFrame(solution)
    assert frame["torque"].to_numpy().tolist() == solution.torque.tolist()
    pyarrow = import_module("pyarrow")
    table = pyarrow.table(solution)
    assert table["hub_angle"].to_numpy().tolist() == solution.hub_angle.tolist()
    assert table.schema.field("torque").metadata == {b"unit": b"N m"}
    table.validate(full=True)
    duckdb = import_module("duckdb")
    ((peak,),) = duckdb.sql("select max(abs(torque)) from solution").fetchall()
    assert peak == abs(solution.torque).max()


def test_xarray_has_units_and_dimensions(results: list[Any]) -> None:
    solution, table, played, solved = results
    data = solution.to_xarray()
    assert data["torque"].attrs["units"] == "N m" and data["time"].attrs["units"] == "s"
    assert data.attrs["title"] == solution.summary["title"] and "joint" not in data.dims
    nearest = np.abs(solution.time - 0.1).argmin()
    found = data["hub_angle"].sel(time=0.1, method="nearest")
    assert float(found) == solution.hub_angle[nearest]
    data = solved.to_xarray()
    assert data["torque"].dims == ("time", "joint")
    assert data["reaction"].dims == ("time", "joint", "axis")
    assert (data["torque"].sel(joint=2) == solved.torque[:, 1]).all()
    assert (data["tip"].sel(axis="y") == solved.tip[:, 1]).all()
    assert (data["reaction"].sel(joint=2, axis="x") == solved.reaction[:, 1, 0]).all()
    assert set(table.to_xarray().data_vars) == {"torque"}
    assert played.to_xarray()["hub_rate"].attrs["units"] == "rad/s"
