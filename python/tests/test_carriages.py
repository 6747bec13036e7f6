"""A link on a carriage: names, plays, and folders read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT

MAST = ROOT / "specs/carriages/stacker_mast.toml"


@pytest.fixture(scope="module")
def mast() -> flexlink.Link:
    damping = {"model": "rayleigh", "beta": 7e-4}
    own = flexlink.Link.read(MAST)
    assert own.rigid_mass == pytest.approx(1331.0376)
    return flexlink.Link(
        carriage={"mass": "800 kg"},
        segments=[{"length": 6, "EI": 5e6, "mass_per_length": 31.84}],
        payload={"mass": 340},
        damping=damping,
    )


@pytest.fixture(scope="module")
def solution(mast: flexlink.Link) -> flexlink.Solution:
    motion = flexlink.trajectory("septic", distance=2, duration=2, step=0.002)
    return flexlink.solve(mast, motion["time"], acceleration=motion["acceleration"])


def test_a_solution_has_the_names_of_a_carriage(solution: flexlink.Solution) -> None:
    names = "force rigid_force carriage carriage_velocity carriage_acceleration rigid_carriage"
    for name in names.split():
        assert getattr(solution, name).shape == solution.time.shape, name
    assert abs(solution.force).max() == pytest.approx(solution.results["peak_force_n"], rel=1e-4)
    for name in ("torque", "hub_angle", "hub_rate", "hub_acceleration"):
        with pytest.raises(AttributeError, match="is for a hub, and this link is on a carriage"):
            getattr(solution, name)
    on_hub = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    with pytest.raises(AttributeError, match="is for a carriage, and this link is on a hub"):
        on_hub.force
    assert repr(solution).startswith("Solution(samples=") and "peak_force=" in repr(solution)


def test_force_and_motion_bring_the_tip_along(
    mast: flexlink.Link, solution: flexlink.Solution, tmp_path: Path
) -> None:
    time, wanted = solution.time, solution.tip_displacement
    for played in (
        flexlink.simulate(mast, time, force=solution.force),
        flexlink.simulate(mast, time, carriage=solution.carriage),
    ):
        assert abs(played.tip_displacement - wanted).max() < 1e-5
        assert abs(played.force - solution.force).max() < 1e-3 * abs(solution.force).max()
        assert abs(played.carriage - solution.carriage).max() < 1e-5
    assert set(played.errors) == {"tip", "carriage_travel"}
    with pytest.raises(flexlink.FlexlinkError, match="force or voltage alone, or carriage with"):
        flexlink.simulate(mast, time)
    with pytest.raises(flexlink.FlexlinkError, match="torque is for a hub"):
        flexlink.simulate(mast, time, torque=solution.force)
    solution.write(tmp_path / "run")
    run = flexlink.read(tmp_path / "run")
    np.testing.assert_allclose(run.carriage, solution.carriage, atol=1e-9)
    nodes = solution.displacements()
    np.testing.assert_allclose(run.displacements(), nodes, atol=1e-9)
    assert "carriage" in solution.to_pandas().columns


def test_an_arm_on_a_carriage_has_its_force(tmp_path: Path) -> None:
    arm = flexlink.Arm.read(ROOT / "specs/carriages/gantry_arm.toml")
    solution = flexlink.solve(arm, ROOT / "trajectories/arms/gantry_1.5s.csv")
    for name in ("force", "rigid_force", "carriage", "carriage_velocity", "carriage_acceleration"):
        assert getattr(solution, name).shape == solution.time.shape, name
    assert solution.torque.shape == (solution.time.size, 2)
    peak = solution.results["carriage"]["peak_force_n"]
    assert abs(solution.force).max() == pytest.approx(peak, rel=1e-4)
    # All of the mass, 12 + 1.16 + 0.54 kg of links and bodies, starts and ends at rest without weight along the rail.
    net = solution.force - 20.0 * solution.carriage_velocity
    impulse, whole = (float(np.trapezoid(force, solution.time)) for force in (net, abs(net)))
    assert abs(impulse) < 1e-4 * whole
    solution.write(tmp_path / "run")
    run = flexlink.read(tmp_path / "run")
    np.testing.assert_allclose(run.force, solution.force, atol=1e-5)
    np.testing.assert_allclose(run.carriage, solution.carriage, atol=1e-8)


def test_an_arm_on_a_carriage_is_played() -> None:
    arm = flexlink.Arm.read(ROOT / "specs/carriages/gantry_arm.toml")
    path = flexlink.trajectory(
        "septic",
        path="line",
        start=(0.5, -0.9),
        to=(1.9, -0.6),
        carriage=(0.0, 0.8),
        duration=1.5,
        step=0.005,
    )
    assert path["carriage"][-1] == pytest.approx(0.8, abs=1e-15)
    solution = flexlink.solve(
        arm, path["time"], x=path["x"], y=path["y"], carriage=path["carriage"]
    )
    time, torque, force = solution.time, solution.torque, solution.force
    held = flexlink.simulate(
        arm,
        time,
        torque=torque,
        force=force,
        feedback=[(50.0, 1.0), (50.0, 1.0), (500.0, 50.0)],
        reference=np.column_stack([solution.joint_angle, solution.carriage]),
        reference_rate=np.column_stack([solution.joint_rate, solution.carriage_velocity]),
    )
    angles, places = solution.joint_angle, solution.carriage
    for played in (
        held,
        flexlink.simulate(arm, time, torque=torque, force=force, target=solution.tip),
        flexlink.simulate(arm, time, hub_angle=angles, carriage=places),
    ):
        assert abs(played.tip - solution.tip).max() < 1e-5
        assert abs(played.carriage - solution.carriage).max() < 1e-5
        assert played.torque.shape == (time.size, 2)
        assert abs(played.force - solution.force).max() < 1e-3 * abs(solution.force).max()
    far = flexlink.simulate(
        arm, time[:20], torque=torque[:20], force=force[:20], at=[-1.0, 0.5], carriage_at=2.0
    )
    assert far.carriage[0] == pytest.approx(2.0, abs=1e-12)
    with pytest.raises(flexlink.FlexlinkError, match="one of torque and force"):
        flexlink.simulate(arm, time, torque=torque, at=[-1.0, 0.5])
    with pytest.raises(flexlink.FlexlinkError, match="carriage_at must stand beside neither"):
        flexlink.simulate(arm, time, hub_angle=angles, carriage=places, carriage_at=1.0)


def test_a_standing_sheet_is_played_with_its_weight() -> None:
    sheet = flexlink.Link.read(ROOT / "specs/carriages/sheet.toml")
    motion = flexlink.trajectory("septic", distance=0.05, duration=1.5, step=0.005)
    solution = flexlink.solve(sheet, motion["time"], acceleration=motion["acceleration"])
    played = flexlink.simulate(sheet, solution.time, force=solution.force)
    assert abs(played.tip_displacement - solution.tip_displacement).max() < 1e-6 * 0.05


def test_the_carriage_of_an_arm_has_no_motor(tmp_path: Path) -> None:
    arm = flexlink.Link.read(ROOT / "specs/carriages/gantry_arm.toml")
    driven = arm.changed({"links.1.drive": {"gear_ratio": 10.0}})
    solution = flexlink.solve(driven, ROOT / "trajectories/arms/gantry_1.5s.csv")
    solution.write(tmp_path / "r")
    for own in (solution, flexlink.read(tmp_path / "r")):
        assert own.motor_torque.shape == own.torque.shape == (own.time.size, 2)
        assert np.isnan(own.motor_torque[:, 0]).all()
        error = own.motor_torque[:, 1] - own.torque[:, 1] / 10
        assert abs(error).max() < 1e-9 * abs(own.torque[:, 1]).max()
    with pytest.raises(flexlink.InputError, match="unknown key `drive` in carriage"):
        arm.changed({"carriage.drive": {"gear_ratio": 10.0}})
