"""Each form of `solve --write --with` read by a program that it is for."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
import yaml

import flexlink

from conftest import LINK, MOTION, ROOT, Command
from test_arrays import strip

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
STEP_S = 0.001953125
QUANTITIES = "position,velocity,acceleration,effort"
UNITS = {"position": "rad", "velocity": "rad_s", "acceleration": "rad_s2", "effort": "n_m"}
OF_ARM = [
    *("joint1_rad", "joint2_rad", "joint1_rate_rad_s", "joint2_rate_rad_s"),
    *("joint1_acceleration_rad_s2", "joint2_acceleration_rad_s2", "torque1_n_m", "torque2_n_m"),
]

Columns = dict[str, np.ndarray[Any, np.dtype[np.float64]]]


def table(path: Path) -> Columns:
    """The columns of a csv below its comment."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), rows.T, strict=True))


@pytest.fixture
def arm(command: Command, tmp_path: Path) -> Columns:
    """Set-points of an arm of two links in every form, and as numbers of the csv."""
    for file in ["move.csv", "move.npz", "move.mat", "move.h", "move.m", "move.yaml", "move.json"]:
        options = ["--with", QUANTITIES, "--start-at", "0", "-q"]
        done = command("solve", ARM, PATH, "--write", file, *options)
        assert done.returncode == 0, done.stderr
    columns = table(tmp_path / "move.csv")
    assert list(columns) == ["time_s", *OF_ARM]
    np.testing.assert_allclose(np.diff(columns["time_s"]), STEP_S, rtol=1e-9)
    return columns


def side_by_side(columns: Columns, quantity: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    names = OF_ARM[2 * list(UNITS).index(quantity) :][:2]
    return np.stack([columns[name] for name in names], axis=1)


def begins_s(path: Path) -> float:
    """The first number of the csv's first line."""
    first = path.read_text().splitlines()[0]
    assert first.startswith("# motion begins at "), first
    return float(first.split()[4])


def test_numpy_reads_the_arrays(arm: Columns, tmp_path: Path) -> None:
    with np.load(tmp_path / "move.npz") as file:
        np.testing.assert_allclose(file["time_s"], arm["time_s"], atol=1e-12)
        for quantity, unit in UNITS.items():
            ours, theirs = file[f"{quantity}_{unit}"], side_by_side(arm, quantity)
            np.testing.assert_allclose(ours, theirs, atol=1e-9 * np.abs(theirs).max())
        assert file["step_s"] == STEP_S
        assert file["motion_begins_s"] == pytest.approx(begins_s(tmp_path / "move.csv"), abs=1e-9)
        assert file["joint_names"].tolist() == ["joint1", "joint2"]
        assert "flexlink solve " in str(file["about"])


def test_scipy_reads_the_mat_file(arm: Columns, tmp_path: Path) -> None:
    file = scipy.io.loadmat(tmp_path / "move.mat", squeeze_me=True)
    np.testing.assert_allclose(file["time_s"], arm["time_s"], atol=1e-12)
    for quantity, unit in UNITS.items():
        theirs = side_by_side(arm, quantity)
        np.testing.assert_allclose(
            file[f"{quantity}_{unit}"], theirs, atol=1e-9 * np.abs(theirs).max()
        )
    assert list(file["joint_names"]) == ["joint1", "joint2"]
    assert "flexlink solve " in str(file["about"])


def test_octave_reads_the_mat_file_and_the_script(arm: Columns, tmp_path: Path) -> None:
    octave = shutil.which("octave-cli")
    if octave is None:
        pytest.skip("octave is not installed")
    # Octave lacks timeseries, which the script makes last.
    program = (
        "load move.mat; try; move; catch; end; "
        "printf('%.17g ', size(position_rad), joint_names{2}(6) - '0', "
        "max(abs(effort_n_m - move_effort_n_m)(:)), max(abs(time_s - move_time_s)), "
        "max(abs(position_rad - move_position_rad)(:)), effort_n_m(end, 2));"
    )
    done = subprocess.run(
        [octave, "--quiet", "--eval", program], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    rows, joints, number, *differences, last = map(float, done.stdout.split())
    assert (rows, joints, number) == (arm["time_s"].size, 2, 2)
    assert max(differences) < 1e-8
    assert last == pytest.approx(arm["torque2_n_m"][-1], abs=1e-8)


def test_a_compiler_reads_the_header(arm: Columns, tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    main = """
    #include "move.h"
    #include "move.h"
    #include <stdio.h>
    int main(void) {
        for (int k = 0; k < MOVE_LENGTH; k++) {
            for (int joint = 0; joint < MOVE_JOINTS; joint++)
                printf("%.17g %.17g %.17g %.17g ", move_position_rad[k][joint],
                       move_velocity_rad_s[k][joint], move_acceleration_rad_s2[k][joint],
                       move_effort_n_m[k][joint]);
            printf("%.17g\\n", move_time_s[k]);
        }
        return MOVE_STEP_S == 0.001953125 && MOVE_MOTION_BEGINS_S > 0 ? 0 : 1;
    }
    """
    (tmp_path / "main.c").write_text(main)
    flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([compiler, *flags, "main.c", "-o", "main"], cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True)
    rows = np.array([[float(x) for x in line.split()] for line in done.stdout.splitlines()])
    for place, quantity in enumerate(UNITS):
        theirs = side_by_side(arm, quantity)
        np.testing.assert_allclose(
            rows[:, [place, 4 + place]], theirs, atol=1e-8 * np.abs(theirs).max()
        )
    np.testing.assert_allclose(rows[:, 8], arm["time_s"], atol=1e-12)


FIELDS = {
    "positions": "position",
    "velocities": "velocity",
    "accelerations": "acceleration",
    "effort": "effort",
}


@pytest.mark.parametrize("file", ["move.yaml", "move.json"])
def test_a_joint_trajectory_has_the_fields_of_the_message(
    arm: Columns, tmp_path: Path, file: str
) -> None:
    text = (tmp_path / file).read_text()
    message = yaml.safe_load(text)
    if file.endswith("json"):
        assert json.loads(text) == message
    assert list(message) == ["header", "joint_names", "points"]
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    assert message["joint_names"] == ["joint1", "joint2"]
    points = message["points"]
    assert all(list(point) == [*FIELDS, "time_from_start"] for point in points)
    for field, quantity in FIELDS.items():
        ours, theirs = np.array([point[field] for point in points]), side_by_side(arm, quantity)
        assert all(isinstance(x, float) for point in points for x in point[field])
        np.testing.assert_allclose(ours, theirs, atol=1e-9 * np.abs(theirs).max())
    times = [point["time_from_start"] for point in points]
    assert all(0 <= time["nanosec"] < 10**9 for time in times)
    nanoseconds = [time["sec"] * 10**9 + time["nanosec"] for time in times]
    assert nanoseconds == [1_953_125 * k for k in range(len(points))]


def test_a_joint_trajectory_may_lack_efforts_and_has_the_names_of_the_controller(
    command: Command, tmp_path: Path
) -> None:
    names = "shoulder,it's the elbow"
    options = ["--with", "position,velocity", "--joint-names", names, "-q"]
    done = command("solve", ARM, PATH, "--write", "move.yaml", *options)
    assert done.returncode == 0, done.stderr
    message = yaml.safe_load((tmp_path / "move.yaml").read_text())
    assert message["joint_names"] == names.split(",")
    assert {(len(p["positions"]), len(p["effort"])) for p in message["points"]} == {(2, 0)}


def test_lines_of_halstreamer_are_numbers_of_its_pins(command: Command, tmp_path: Path) -> None:
    options = ["--cycle", "2 ms", "--counts", "position=-4096/360 deg+2048", "-q"]
    with_ = ["--with", "position,effort", "--form", "halstreamer"]
    done = command("solve", LINK, MOTION, "--write", "move.txt", *with_, *options)
    assert done.returncode == 0, done.stderr
    done = command("solve", LINK, MOTION, "--write", "move.csv", "--with", "position,effort", "-q")
    whole = table(tmp_path / "move.csv")
    lines = (tmp_path / "move.txt").read_text().splitlines(keepends=True)
    # Its reader takes lines of at most 3999 letters, skips those with # and needs a blank behind
    # each number: strtol for s, strtod for f.
    assert all(len(line) < 4000 and line.endswith("\n") for line in lines)
    comment = [line for line in lines if line.startswith("#")]
    assert any(line.endswith("cfg=sf\n") for line in comment)
    rows = [line.split() for line in lines if not line.startswith("#")]
    assert {len(row) for row in rows} == {2}
    counts = np.array([int(row[0]) for row in rows])
    efforts = np.array([float(row[1]) for row in rows])
    position, torque = whole["hub_angle_rad"], whole["torque_n_m"]
    # Rows stand at multiples of the cycle, as every second one of the motion's step does.
    first = round(whole["time_s"][0] / 0.001) % 2
    expected = 2048 - position[first::2] * 4096 / (2 * np.pi)
    assert np.abs(counts - expected).max() <= 0.5 + 1e-6
    np.testing.assert_allclose(efforts, torque[first::2], atol=1e-8)


# Names of a solution for each quantity: of a link, of an arm's joints, of a carriage.
NAMES = {
    "position": ("hub_angle", "joint_angle", "carriage", "rad", "m"),
    "velocity": ("hub_rate", "joint_rate", "carriage_velocity", "rad/s", "m/s"),
    "acceleration": (
        *("hub_acceleration", "joint_acceleration", "carriage_acceleration"),
        *("rad/s^2", "m/s^2"),
    ),
    "effort": ("torque", "torque", "force", "N m", "N"),
}


@pytest.mark.parametrize("kind", ["link", "arm", "carriage", "arm on a carriage"])
def test_each_quantity_is_a_column_of_other_libraries(kind: str) -> None:
    step = flexlink.trajectory("septic", distance=0.05, duration=1.5, step=0.005)
    if kind == "link":
        solution = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    elif kind == "arm":
        solution = flexlink.solve(flexlink.Arm.read(ARM), PATH)
    elif kind == "carriage":
        sheet = flexlink.Link.read(ROOT / "specs/carriages/sheet.toml")
        solution = flexlink.solve(sheet, step["time"], acceleration=step["acceleration"])
    else:
        gantry = flexlink.Arm.read(ROOT / "specs/carriages/gantry_arm.toml")
        solution = flexlink.solve(gantry, ROOT / "trajectories/arms/gantry_1.5s.csv")
    quantity: Any
    for quantity, (hub, joint, carriage, turning, sliding) in NAMES.items():
        # A table of accelerations needs a quantity that a drive holds, too.
        others: list[Any] = ["effort"] if quantity == "acceleration" else []
        table = solution.table(quantities=[quantity, *others])
        columns = {}
        if kind == "link":
            columns[hub] = (turning, getattr(solution, hub))
        elif kind.startswith("arm"):
            both = getattr(solution, joint).T
            columns = {f"{joint}{n}": (turning, own) for n, own in enumerate(both, 1)}
        if kind.endswith("carriage"):
            columns[carriage] = (sliding, getattr(solution, carriage))
        frame, data = table.to_pandas(), table.to_xarray()
        assert set(columns) <= set(frame) and (others or len(frame.columns) == len(columns))
        all_joints = getattr(table, quantity).reshape(table.time.size, -1)
        for place, (name, (unit, values)) in enumerate(columns.items()):
            close = {"rtol": 1e-9, "atol": 1e-9 * abs(values).max(), "err_msg": name}
            np.testing.assert_allclose(frame[name], values, **close)
            np.testing.assert_allclose(all_joints[:, place], values, **close)
            assert data[name.rstrip("12")].attrs["units"] == unit
        for absent in set(NAMES) - {quantity, *others}:
            assert getattr(table, absent) is None, absent


def test_set_points_of_a_motor_have_its_names() -> None:
    geared = strip(drive={"gear_ratio": 50.0, "rotor_inertia": 1e-5})
    solution = flexlink.solve(geared, MOTION)
    quantities: Any = ["position", "velocity", "acceleration", "effort"]
    table = solution.table(side="motor", quantities=quantities)
    assert list(table.to_pandas()) == [
        *("motor_torque", "motor_angle", "motor_rate", "motor_acceleration")
    ]
    assert table.torque is None and table.hub_angle is None
    np.testing.assert_allclose(table.motor_angle, 50 * solution.hub_angle, atol=1e-9)
    # A rigid gear: the motor's torque is that of the joint over the ratio, and the rotor's.
    turning = 1e-5 * 50 * solution.hub_acceleration
    expected = solution.torque / 50 + turning
    np.testing.assert_allclose(table.motor_torque, expected, atol=1e-6 * abs(expected).max())


def test_units_and_counts_are_those_of_the_file_and_arrays_stay_si(tmp_path: Path) -> None:
    solution = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    in_degrees = solution.table(quantities=["position"], units={"position": "deg"})
    np.testing.assert_array_equal(in_degrees.position, solution.hub_angle)
    in_degrees.write(tmp_path / "deg.csv")
    (degrees,) = [own for name, own in table(tmp_path / "deg.csv").items() if "deg" in name]
    np.testing.assert_allclose(degrees, np.degrees(solution.hub_angle), atol=1e-7)
    counted = solution.table(quantities=["position"], counts={"position": "65536/360 deg"})
    counts = counted.position * 65536 / (2 * np.pi)
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
    assert abs(counts - solution.hub_angle * 65536 / (2 * np.pi)).max() <= 0.5 + 1e-6
    assert counted.tip_error is not None


def test_names_of_joints_and_the_form_of_a_file(tmp_path: Path) -> None:
    solution = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    named = solution.table(quantities=["position"], joint_names=["shoulder"])
    named.write(tmp_path / "move.yaml")
    message = yaml.safe_load((tmp_path / "move.yaml").read_text())
    assert message["joint_names"] == ["shoulder"]
    assert len(message["points"]) == solution.time.size
    lines = solution.table(quantities=["position", "effort"], form="halstreamer")
    lines.write(tmp_path / "move.txt")
    text = (tmp_path / "move.txt").read_text().splitlines()
    rows = np.array([line.split() for line in text if not line.startswith("#")], dtype=float)
    np.testing.assert_allclose(rows[:, 0], solution.hub_angle, atol=1e-7)
    np.testing.assert_allclose(rows[:, 1], solution.torque, atol=1e-7)
    with pytest.raises(flexlink.InputError, match='must end in .txt with form="halstreamer"'):
        lines.write(tmp_path / "move.csv")
