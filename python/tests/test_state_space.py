"""State space, with python-control, SciPy and the files of the command."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import control  # type: ignore[import-untyped]
import numpy as np
import numpy.typing as npt
import pytest
import scipy

import flexlink

from conftest import LINK, ROOT, Command

Complex = npt.NDArray[np.complex128]
STRIP: dict[str, Any] = {
    "segments": [{"length": 1.0, "EI": 8.0, "mass_per_length": 0.6}],
    "hub": {"inertia": 0.1, "viscous_friction": 0.2},
    "payload": {"mass": 0.2},
    "mesh": {"elements": 12},
    "damping": {"model": "rayleigh", "alpha": 0.3, "beta": 1e-3},
}


def column(table: dict[str, npt.NDArray[np.float64]], name: str) -> Complex:
    return np.asarray(table[f"{name}_real"] + 1j * table[f"{name}_imag"])


def test_python_control_has_the_response_of_frf() -> None:
    link = flexlink.Link(**STRIP)
    space = link.state_space(modes=4)
    plant = control.ss(*space, **space.names)
    assert plant.output_labels == space.outputs
    kept = flexlink.Link(**STRIP, analysis={"modes": 4})
    exact = flexlink.frf(kept, start=0.1, stop=50, points=60)
    omega = 2 * np.pi * exact["frequency_hz"]
    found = plant(1j * omega)
    tip = column(exact, "tip_displacement_per_torque_1_n")
    hub = column(exact, "hub_angle_per_tip_displacement_rad_m") * tip
    for name, wanted in [("tip_displacement", tip), ("hub_angle", hub)]:
        own = found[space.outputs.index(name), 0]
        assert abs(own / wanted - 1).max() < 1e-9, name


def test_an_arm_in_a_pose_has_the_response_of_frf() -> None:
    arm = flexlink.Arm.read(ROOT / "specs/arms/two_links.toml")
    space = arm.state_space(modes=40, at=[-1.0, 0.3], residual=True)
    assert space.inputs == ["torque1", "torque2"]
    exact = flexlink.frf(arm, at=[-1.0, 0.3], start=0.1, stop=20, points=30)
    omega = 2 * np.pi * exact["frequency_hz"]
    found = control.ss(*space)(1j * omega)
    for name, column_of in [
        ("tip_x", "tip_x_per_torque1_1_n"),
        ("joint2", "joint2_per_torque1_rad_n_m"),
    ]:
        own = found[space.outputs.index(name), 0]
        wanted = column(exact, column_of)
        assert abs(own - wanted).max() < 1e-6 * abs(wanted).max(), name


def test_a_step_in_python_control_is_that_of_simulate() -> None:
    link = flexlink.Link(**STRIP)
    space = link.state_space(modes=8, residual=True)
    time = np.arange(0, 1.0005, 0.001)
    step = np.full(time.size, 0.3)
    with pytest.warns(flexlink.FlexlinkWarning, match="acts on the resting link as a jump"):
        played = flexlink.simulate(link, time, torque=step, hold="zero")
    plant = control.ss(*space, **space.names)
    answer = control.forced_response(plant, time, step)
    hub = answer.outputs[space.outputs.index("hub_angle")]
    tip = answer.outputs[space.outputs.index("tip_displacement")]
    assert abs(played.time - time).max() < 1e-12
    assert abs(hub - played.hub_angle).max() < 1e-4 * abs(hub).max()
    assert abs(tip - played.tip_displacement).max() < 1e-4 * abs(tip).max()


def test_scipy_takes_the_matrices() -> None:
    space = flexlink.Link(**STRIP).state_space(modes=2, stations=[0.5])
    system = scipy.signal.StateSpace(*space)
    assert system.A.shape == (6, 6) and system.C.shape == (7, 6)
    assert len(space) == 4 and np.array_equal(space[0], system.A) and len(space[1:]) == 3
    assert space.units["station1"] == "m" and space.units["torque"] == "N m"
    with pytest.raises(flexlink.FlexlinkError, match="modes = 0, but must be 1 to 1000"):
        flexlink.Link(**STRIP).state_space(modes=0)


def test_the_files_have_the_same_matrices(command: Command, tmp_path: Path) -> None:
    space = flexlink.Link.read(LINK).state_space(modes=3, stations=[0.6])
    for ending in ("json", "npz", "mat"):
        options = ["--count", 3, "--stations", 0.6, "--state-space", f"s.{ending}"]
        done = command("modes", LINK, *options)
        assert done.returncode == 0, done.stderr
        assert space.description in done.stderr
    texts = json.loads((tmp_path / "s.json").read_text())
    arrays = np.load(tmp_path / "s.npz")
    matlab = scipy.io.loadmat(tmp_path / "s.mat")
    for name, own in zip("ABCD", space):
        for found in (np.array(texts[name]), arrays[name], matlab[name]):
            assert np.array_equal(found, own), name
    for key, names in space.names.items():
        assert texts[key] == names == list(arrays[key])
        assert [str(cell[0]) for cell in matlab[key].ravel()] == names


def test_single_modes_and_their_matrices_are_those_of_all() -> None:
    link = flexlink.Link(**STRIP)
    all_modes = link.state_space(modes=4)
    few = link.state_space(modes=[3, 1])
    assert few.states == ["mode_0", "mode_1", "mode_3", "mode_0_rate", "mode_1_rate", "mode_3_rate"]
    kept = [0, 1, 3]
    assert np.array_equal(few.stiffness, all_modes.stiffness[np.ix_(kept, kept)])
    assert np.array_equal(few.damping, -few.A[3:, 3:])
    assert np.array_equal(few.mass, np.eye(3))
    with pytest.raises(flexlink.FlexlinkError, match="modes = 0, but must be"):
        link.state_space(modes=[])
