"""What Python writes and returns is what the command writes, to the byte."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, Command, files

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"


def columns(path: Path) -> dict[str, list[str]]:
    with path.open(newline="") as file:
        header, *rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return {name: [row[k] for row in rows] for k, name in enumerate(header)}


def test_a_solution_of_files_writes_the_files_of_the_command(
    command: Command, tmp_path: Path
) -> None:
    done = command("solve", LINK, MOTION, "-o", "a", "--set", "segments.*.EI*=2", "--every", 10)
    assert done.returncode == 0, done.stderr
    link = flexlink.Link.read(LINK, {"segments.*.EI*": 2})
    flexlink.solve(link, MOTION).write(tmp_path / "b", every=10)
    assert files(tmp_path / "a") == files(tmp_path / "b")
    assert "torque.csv" in files(tmp_path / "b")


def test_arrays_give_the_tables_of_the_command(command: Command, tmp_path: Path) -> None:
    command("solve", LINK, MOTION, "-o", "a")
    motion = np.loadtxt(MOTION, delimiter=",", skiprows=2)
    solution = flexlink.solve(flexlink.Link.read(LINK), motion[:, 0], acceleration=motion[:, 1])
    solution.write(tmp_path / "b")
    ours, theirs = files(tmp_path / "b"), files(tmp_path / "a")
    # The record alone has no files to name.
    ours.pop("summary.json"), theirs.pop("summary.json")
    assert ours == theirs


def test_an_arm_writes_the_files_of_the_command(command: Command, tmp_path: Path) -> None:
    done = command("solve", ARM, PATH, "-o", "a", "--every", 50)
    assert done.returncode == 0, done.stderr
    solution = flexlink.solve(flexlink.Arm.read(ARM), PATH)
    solution.write(tmp_path / "b", every=50)
    assert files(tmp_path / "a") == files(tmp_path / "b")
    path = np.loadtxt(PATH, delimiter=",", skiprows=2)
    given = flexlink.solve(flexlink.Arm.read(ARM), path[:, 0], x=path[:, 1], y=path[:, 2])
    assert given.torque.shape == (given.time.size, 2)
    assert given.positions(1).shape[0] == given.time.size


def test_tables_over_frequency_and_motions_are_those_of_the_command(
    command: Command, tmp_path: Path
) -> None:
    command("frf", LINK, "--from", 0.5, "--to", 20, "--points", 40, "-o", "frf.csv")
    found = flexlink.frf(flexlink.Link.read(LINK), start=0.5, stop=20, points=40)
    for name, texts in columns(tmp_path / "frf.csv").items():
        assert [float(text) for text in texts] == found[name].tolist(), name
    options = ("--distance", 0.5, "--duration", 0.88, "--step", 0.001, "-o", "motion.csv")
    command("trajectory", "min-jerk", *options)
    motion: Any = flexlink.trajectory("min-jerk", distance=0.5, duration=0.88, step=0.001)
    for name, texts in columns(tmp_path / "motion.csv").items():
        # Times are written to so many decimals as the step has.
        np.testing.assert_allclose(motion[name], [float(x) for x in texts], rtol=1e-15, atol=1e-15)
    shaped = ("--shape", "zv", "--of", "held", "--modes", "1,2", "--link", LINK)
    command("trajectory", "min-jerk", *options, *shaped)
    motion = flexlink.trajectory(
        "min-jerk",
        distance=0.5,
        duration=0.88,
        step=0.001,
        shape="zv",
        of="held",
        modes=[1, 2],
        link=LINK,
    )
    np.testing.assert_array_equal(
        motion["displacement"],
        np.loadtxt(tmp_path / "motion.csv", delimiter=",", skiprows=2)[:, 1],
    )
    assert motion["displacement"].size > 881


def test_a_sweep_has_the_numbers_of_the_command(command: Command, tmp_path: Path) -> None:
    factors = [0.5, 1, 2, 4]
    done = command("sweep", LINK, MOTION, "--vary", "segments.*.EI*=0.5,1,2,4", "-o", "s.csv")
    assert done.returncode == 0, done.stderr
    cases = [{"segments.*.EI*": factor} for factor in factors]
    table = flexlink.sweep(flexlink.Link.read(LINK), cases, MOTION, threads=2)
    theirs = columns(tmp_path / "s.csv")
    assert list(table) == list(theirs)
    for name in set(table) - {"warnings", "error"}:
        # The command writes twelve digits or more.
        np.testing.assert_allclose(table[name], [float(x) for x in theirs[name]], rtol=1e-11)
    assert table["error"] == [None] * 4
    read = flexlink.read(tmp_path / "s.csv")
    assert read["segments.*.EI*"].tolist() == factors


def test_a_case_that_fails_says_why_and_the_others_are_solved() -> None:
    link = flexlink.Link.read(LINK)
    scaled = {"distance*": 2.0, "duration*": 0.5}
    cases: list[dict[str, float]] = [{}, {"hub.inertia": -1}, scaled]
    table = flexlink.sweep(link, cases, MOTION)
    assert table["error"][0] is None and table["error"][2] is None
    assert "hub.inertia = -1 kg m^2, but must be" in table["error"][1]
    assert np.isnan(table["peak_torque_n_m"][1])
    # Twice the travel in half the time: eight times the acceleration.
    slow, fast = table["peak_rigid_torque_n_m"][[0, 2]]
    assert fast == pytest.approx(8 * slow, rel=1e-9)


def test_errors_have_the_text_and_the_hint_of_the_command(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bad.toml").write_text("segments = [{ lenght = 1, EI = 1, mass_per_length = 1 }]")
    printed = command("solve", "bad.toml", MOTION)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(flexlink.InputError) as caught:
        flexlink.Link.read("bad.toml")
    error = caught.value
    assert error.hint is not None
    assert printed.stderr == f"error: {error.message}\nhint: {error.hint}\n"
    assert str(error) == f"{error.message}\nhint: {error.hint}"
    assert isinstance(error, ValueError)


def test_warnings_are_those_of_the_command(command: Command, tmp_path: Path) -> None:
    coarse = {"mesh.elements": 3}
    printed = command("solve", LINK, MOTION, "--set", "mesh.elements=3")
    link = flexlink.Link.read(LINK, coarse)
    with pytest.warns(flexlink.FlexlinkWarning) as caught:
        solution = flexlink.solve(link, MOTION)
    given = [warning.message for warning in caught]
    assert [str(own) for own in given] == [str(own) for own in solution.warnings]
    assert solution.warnings[0].kind
    for warning in solution.warnings:
        assert f"warning: {warning.message}\nhint: {warning.hint}\n" in printed.stderr
    assert given[0].__class__ is flexlink.FlexlinkWarning
    assert [w.filename for w in caught] == [__file__] * len(given)


@pytest.mark.skipif("FLEXLINK_PROGRAM" not in os.environ, reason="no program to compare with")
def test_the_command_is_the_program(tmp_path: Path) -> None:
    script = str(Path(sys.executable).with_name("flexlink"))
    program = os.environ["FLEXLINK_PROGRAM"]
    runs: list[list[str]] = [
        ["--version"],
        ["--help"],
        ["help", "files"],
        ["solve", str(LINK), str(MOTION), "-o", "out", "--every", "20"],
        ["modes", str(LINK), "--json"],
        ["solve", str(LINK), "missing.csv"],
        ["solve", "--nonsense"],
        ["completions", "bash"],
    ]
    for arguments in runs:
        done = []
        for number, name in enumerate([script, program]):
            folder = tmp_path / str(number)
            folder.mkdir(exist_ok=True)
            run = subprocess.run([name, *arguments], cwd=folder, capture_output=True, check=False)
            done.append((run.returncode, run.stdout, run.stderr))
        assert done[0] == done[1], arguments
    assert files(tmp_path / "0/out") == files(tmp_path / "1/out")


def test_a_fit_writes_the_record_of_the_command(command: Command, tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(
        '[[frequency]]\nmode = 1\nvalue = "1.8 Hz"\n[[frequency]]\nmode = 2\nvalue = "5.3 Hz"\n'
    )
    done = command("fit", LINK, "m.toml", "--free", "segments.*.EI", "-o", "a.toml")
    assert done.returncode == 0, done.stderr
    record = (tmp_path / "a.json").read_bytes()
    found = flexlink.fit(flexlink.Link.read(LINK), tmp_path / "m.toml", ["segments.*.EI"])
    assert found.is_believed
    found.write(tmp_path / "b.toml")
    assert (tmp_path / "a.toml").read_bytes() == (tmp_path / "b.toml").read_bytes()
    assert (tmp_path / "b.json").read_bytes() == record
