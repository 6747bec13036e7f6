"""`verify`, `compare`, `report`, and tables for a controller."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, Command
from test_arrays import strip

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"


@pytest.fixture(scope="module")
def solution() -> flexlink.Solution:
    return flexlink.solve(flexlink.Link.read(LINK), MOTION)


def test_verify_has_the_checks_of_the_command(
    command: Command, solution: flexlink.Solution
) -> None:
    done = command("verify", LINK, MOTION, "--json")
    assert done.returncode == 0, done.stderr
    verified = flexlink.verify(solution)
    assert verified.passes and not verified.warnings
    assert verified.checks == json.loads(done.stdout)
    assert flexlink.verify(flexlink.Link.read(LINK), MOTION, digits=10).checks == verified.checks


def test_a_check_out_of_its_bound_is_a_warning() -> None:
    limited = strip().changed({"limits.torque": 0.01})
    motion = flexlink.trajectory("min-jerk", distance=0.5, duration=0.9, step=0.005)
    with pytest.warns(flexlink.FlexlinkWarning):
        solved = flexlink.solve(limited, **motion)
    with pytest.warns(flexlink.FlexlinkWarning, match="out of bounds"):
        verified = flexlink.verify(solved)
    assert not verified.passes
    failed = [check for check in verified.checks if not check["passes"]]
    assert [warning.kind for warning in verified.warnings] == ["out_of_bounds"] * len(failed)
    arguments: tuple[Any, ...]
    for arguments in ((strip(),), (1.0,), (solved, motion["time"])):
        with pytest.raises(TypeError, match="a solution alone, or a link with its motion"):
            flexlink.verify(*arguments)


def test_compare_takes_folders_files_objects_and_arrays(
    solution: flexlink.Solution, tmp_path: Path
) -> None:
    solution.write(tmp_path / "few", nodes=[0, 5], every=4, digits=8)
    solution.write(tmp_path / "golden", golden=True)
    run = flexlink.read(tmp_path / "few")
    torque = {"time_s": solution.time, "torque_n_m": solution.torque}
    pairs: list[tuple[Any, Any]] = [
        (solution, solution),
        (tmp_path / "few", solution),
        (solution, tmp_path / "few"),
        (run, solution),
        (tmp_path / "golden", solution),
        (tmp_path / "few/torque.csv", solution),
        (solution, tmp_path / "golden/torque.csv"),
        (torque, torque),
    ]
    for expected, actual in pairs:
        found = flexlink.compare(expected, actual, rtol=2e-8)
        assert found.is_equal, (expected, actual, found.files)
    assert flexlink.compare(tmp_path / "few/torque.csv", torque, rtol=2e-8).is_equal
    other = flexlink.solve(flexlink.Link.read(LINK, {"segments.*.EI*": 1.01}), MOTION)
    found = flexlink.compare(tmp_path / "few", other, common_rows=True)
    assert not found.is_equal
    assert "torque.csv" in {file["file"] for file in found.files if file["outcome"] != "equal"}
    assert flexlink.compare(solution, other, rtol=1.0, common_rows=True, atol=10).files
    with pytest.raises(flexlink.InputError, match="must be two files or two folders"):
        flexlink.compare(tmp_path / "few", tmp_path / "few/torque.csv")
    with pytest.raises(TypeError, match="must be a result of flexlink"):
        flexlink.compare(tmp_path / "few", 3)
    with pytest.raises(TypeError, match="must be a path with bless"):
        flexlink.compare(torque, torque, bless=True)
    assert flexlink.compare(tmp_path / "new", other, bless=True).summary["blessed"]["written"]
    assert flexlink.compare(tmp_path / "new", other).is_equal


def test_report_makes_the_page_of_the_command(
    command: Command, solution: flexlink.Solution, tmp_path: Path
) -> None:
    solution.write(tmp_path / "solution")
    done = command("report", "solution")
    assert done.returncode == 0, done.stderr
    theirs = (tmp_path / "solution/report.html").read_text()
    page = flexlink.report(tmp_path / "solution")
    assert page.html == theirs
    assert flexlink.report(flexlink.read(tmp_path / "solution")).html == theirs
    of_object = flexlink.report(solution)
    assert set(of_object.figures) == set(page.figures) and "torque" in page.figures
    assert page.png("torque").startswith(b"\x89PNG")
    with pytest.raises(flexlink.InputError, match="must be one of torque, "):
        page.png("nothing")
    page.write(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == theirs
    for wrong in (solution.table(), 3):
        with pytest.raises(TypeError, match="must be a r"):
            flexlink.report(wrong)
    with pytest.raises(flexlink.InputError, match="^sweep.csv: .*must be those of a sweep"):
        flexlink.report({"torque": [1.0]})


def test_a_sweep_has_the_figures_of_its_table(command: Command, tmp_path: Path) -> None:
    values = ("4", "5", "-1")
    done = command("sweep", LINK, MOTION, "--vary", "hub.inertia=" + ",".join(values), "-o", "a.csv")
    assert done.returncode in (0, 1), done.stderr
    cases = [{"hub.inertia": float(value)} for value in values]
    with pytest.warns(flexlink.FlexlinkWarning, match="1 of 3 cases failed"):
        table = flexlink.sweep(flexlink.Link.read(LINK), cases, MOTION)
    theirs, ours = flexlink.report(tmp_path / "a.csv"), flexlink.report(table)
    assert set(ours.figures) == set(theirs.figures) and len(ours.figures) > 2
    assert "failed" in ours.html and "failed" in theirs.html
    del table["error"], table["warnings"]
    numbers = flexlink.read(tmp_path / "a.csv")
    del numbers["error"], numbers["warnings"]
    assert flexlink.compare(numbers, table, rtol=1e-9).is_equal


def test_errors_do_not_name_the_files_of_objects() -> None:
    with pytest.raises(flexlink.InputError) as caught:
        flexlink.compare({"a": [1.0]}, ROOT / "nowhere.csv")
    assert "flexlink-" not in caught.value.message


def test_pages_stand_side_by_side_and_in_a_notebook(solution: flexlink.Solution) -> None:
    arm = flexlink.Arm.read(ARM)
    solved = flexlink.solve(arm, PATH)
    played = flexlink.simulate(
        arm,
        solved.time,
        torque=solved.torque,
        feedback=(50, 1),
        reference=solved.joint_angle,
        reference_rate=solved.joint_rate,
    )
    page = flexlink.report(solved, played)
    assert "solution 1" in page.html and "simulation 2" in page.html
    for shown in (solution, played, flexlink.report(solved)):
        frame = shown._repr_html_()
        assert frame is not None and frame.startswith("<iframe srcdoc=\"<!DOCTYPE html>")
        # The text of the attribute ends where it should.
        assert frame.count('"') == 2 + 2 * 3 and len(frame) < 1_000_000


def test_a_table_is_played_at_the_times_of_its_motion() -> None:
    motion = flexlink.trajectory("septic", distance=0.5, duration=1, step=0.002)
    table = flexlink.solve(strip(), **motion).table(start_at=0.5)
    wanted = flexlink.Motion(**motion)
    played = flexlink.simulate(strip(), table, target=wanted)
    late = flexlink.simulate(strip(), table.time, torque=table.torque, target=wanted)
    assert table.time[0] == 0.5 and played.time[0] < 0
    assert played.tip_error["share"] < 5e-3 < 0.1 < late.tip_error["share"]


def test_a_table_for_a_controller_is_that_of_the_command(
    command: Command, solution: flexlink.Solution, tmp_path: Path
) -> None:
    options = ("--window", "2%", "--hold", "zero", "--start-at", "0.5")
    done = command("solve", LINK, MOTION, "--write", "a.csv", *options)
    assert done.returncode == 0, done.stderr
    with pytest.warns(flexlink.FlexlinkWarning, match="the torque table moves the tip off"):
        table = solution.table(window="2%", hold="zero", start_at=0.5)
    table.write(tmp_path / "b.csv")
    ours, theirs = ((tmp_path / name).read_text() for name in ("b.csv", "a.csv"))
    assert ours == theirs.replace("a.csv", "b.csv")
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", comments=("#", "t"))
    assert np.allclose(rows[:, 0], table.time, atol=1e-12) and table.time[0] == 0.5
    assert np.allclose(rows[:, 1], table.torque, atol=1e-9 * abs(table.torque).max())
    assert table.tip_error is not None and any("tip off" in note for note in table.notes)
    assert table.summary["rows"] == table.time.size
    whole = solution.table()
    assert whole.tip_error is None and (whole.torque == solution.torque).all()
    assert solution.table(window=0.02, hold="zero", start_at="500 ms").notes == table.notes
    table.write(tmp_path / "torque.h", digits=6)
    assert "static const double" in (tmp_path / "torque.h").read_text()
    with pytest.raises(flexlink.InputError, match="must end in .csv, .h, "):
        table.write(tmp_path / "torque.xlsx")
    with pytest.raises(flexlink.InputError, match="unexpected keyword `write`"):
        solution.table(write="a.csv")  # type: ignore[call-arg]
    with pytest.raises(flexlink.InputError, match="unexpected keyword `windows`"):
        solution.table(windows=0.02)  # type: ignore[call-arg]
    assert repr(table) == f"SetPoints(rows={table.time.size})"


def test_the_error_of_a_table_is_that_of_a_simulation_of_its_rows() -> None:
    link = strip(damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002})
    solution = flexlink.solve(link, MOTION)
    end = float(solution.time[-1])
    for window in (0.02, 0.005):
        with pytest.warns(flexlink.FlexlinkWarning, match="the torque table moves the tip off"):
            table = solution.table(window=window, hold="zero")
        played = flexlink.simulate(link, table.time, torque=table.torque, hold="zero", until=end)
        wanted = np.interp(played.time, solution.time, solution.tip_displacement)
        worst = abs(played.tip_displacement - wanted).max()
        assert table.tip_error["worst_m"] == pytest.approx(worst, rel=1e-3), window
        # The table itself is played as it is held.
        whole = flexlink.simulate(link, table, until=end)
        assert abs(whole.tip_displacement - played.tip_displacement).max() < 1e-3 * worst, window


def test_a_played_sweep_is_that_of_the_command(
    command: Command, solution: flexlink.Solution, tmp_path: Path
) -> None:
    solution.write(tmp_path / "s", digits="full")
    factors = (0.9, 1.0, 1.1)
    vary = ("--vary", "segments.*.EI*=" + ",".join(map(str, factors)))
    gains = ("--feedback", "20,2", "--reference", "s/hub_angle.csv")
    cases = [{"segments.*.EI*": factor} for factor in factors]
    link = flexlink.Link.read(LINK)
    ways: list[tuple[tuple[str, ...], dict[str, Any]]] = [
        ((), {}),
        (gains, {"feedback": (20, 2), "reference": solution}),
        (("--input", "hub-angle"), {"input": "hub_angle"}),
    ]
    for options, keywords in ways:
        table = "s/hub_angle.csv" if "--input" in options else "s/torque.csv"
        done = command(
            "sweep", LINK, MOTION, "--torque", table, *vary, *options, "-o", "a.csv"
        )
        assert done.returncode == 0, done.stderr
        theirs = flexlink.read(tmp_path / "a.csv")
        ours = flexlink.sweep(link, cases, MOTION, torque=solution, **keywords)
        for name, column in theirs.items():
            if name not in ("warnings", "error"):
                np.testing.assert_allclose(ours[name], column, rtol=1e-8, atol=1e-12)
        assert ours["error"] == [None] * 3
    columns = {"time": solution.time, "torque": solution.torque}
    for torque in (columns, tmp_path / "s/torque.csv", solution.table()):
        again = flexlink.sweep(link, cases, MOTION, torque=torque, outputs=tmp_path / "o")
        open_loop = flexlink.sweep(link, cases, MOTION, torque=solution)
        np.testing.assert_allclose(again["tip_error_m"], open_loop["tip_error_m"], rtol=1e-9)
    played = flexlink.read(tmp_path / "o/2")
    assert played.command == "simulate" and played.torque.size >= solution.time.size


def test_refusals_of_a_played_sweep_name_the_keyword(solution: flexlink.Solution) -> None:
    link, cases = flexlink.Link.read(LINK), [{"payload.mass": 0.1}]

    def message(**keywords: Any) -> str:
        with pytest.raises((flexlink.InputError, TypeError)) as caught:
            flexlink.sweep(link, cases, MOTION, **keywords)
        return str(caught.value)

    assert "feedback without torque, the table to play" in message(feedback=(1, 2))
    assert "reference without torque" in message(reference=solution)
    assert "torque" in message(torque={"time": [0, 1, 2], "effort": [0, 1, 0]})
    assert "/tmp" not in message(torque={"time": [0, 1, 2], "effort": [0, 1, 0]})
    assert "must be the path of a file, or a dictionary" in message(torque=3)
    assert "input" in message(torque=solution, input="speed")
    text = message(torque=solution, moments=True, outputs="o")
    assert "moments has no effect on a played torque" in text
