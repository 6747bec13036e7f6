"""Closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import flexlink

from test_arrays import ACCELERATION, TIME, strip


def test_a_stiff_link_takes_the_torque_of_a_rigid_one() -> None:
    link = strip(segments=[{"length": 1.5, "EI": 5e6, "mass_per_length": 0.8}])
    inertia = 0.1 + 0.8 * 1.5**3 / 3
    assert link.rigid_inertia == pytest.approx(inertia, rel=1e-14)
    # Smooth, so that no frequency of it comes near the first mode, at some 2000 Hz.
    smooth = (TIME - 0.5) * np.exp(-(((TIME - 0.5) / 0.1) ** 2))
    solution = flexlink.solve(link, TIME, acceleration=smooth)
    first = int(np.argmin(abs(solution.time - TIME[0])))
    own = solution.torque[first : first + TIME.size]
    rigid = inertia * smooth / 1.5
    assert abs(own - rigid).max() < 1e-4 * abs(rigid).max()


def test_a_hub_that_starts_under_a_constant_torque_turns_as_a_rigid_body() -> None:
    link = strip(segments=[{"length": 1.5, "EI": 5e6, "mass_per_length": 0.8}])
    with pytest.warns(flexlink.FlexlinkWarning, match="acts on the resting link as a jump"):
        played = flexlink.simulate(link, TIME, torque=np.full(TIME.size, 0.5), hold="zero")
    turned = 0.5 * 0.5 / link.rigid_inertia * TIME**2
    assert abs(played.hub_angle - turned).max() < 1e-4 * turned.max()
    assert played.displacements([0]).max() == 0
    assert played.displacements(every=10).shape == (21, played.nodes.size)


def test_the_tip_of_the_displacements_is_the_tip() -> None:
    solution = flexlink.solve(strip(), TIME, acceleration=ACCELERATION)
    last = solution.nodes.size - 1
    tip = solution.displacements([last])[:, 0]
    travel = abs(solution.tip_displacement).max()
    assert abs(tip - solution.tip_displacement).max() < 1e-5 * travel
    bent = solution.tip_displacement - 1.5 * solution.hub_angle
    assert abs(solution.tip_deflection - bent).max() < 1e-9 * travel
    assert solution.errors["tip"] <= 1e-6
    # A moment at the root turns the hub's inertia: T − M = I θ''.
    torque = solution.root_moment + 0.1 * solution.hub_acceleration
    assert abs(torque - solution.torque).max() < 1e-6 * abs(solution.torque).max()


def test_displacement_velocity_and_angle_say_the_same_motion() -> None:
    link = strip()
    share = np.clip((TIME - 0.1) / 0.8, 0, 1)
    moved = 0.1 * (share - np.sin(2 * np.pi * share) / (2 * np.pi))
    velocity = 0.1 / 0.8 * (1 - np.cos(2 * np.pi * share))
    one = flexlink.solve(link, TIME, displacement=moved)
    peak = abs(one.torque).max()
    by_angle = flexlink.solve(link, TIME, angle=moved / 1.5)
    assert abs(one.torque - by_angle.torque).max() < 1e-9 * peak
    by_velocity = flexlink.solve(link, TIME, velocity=velocity)
    travel = abs(by_velocity.tip_displacement).max()
    assert travel == pytest.approx(0.1, rel=1e-5)


def test_an_arm_of_stiff_links_takes_the_torques_of_a_rigid_one() -> None:
    bar = {"length": 0.5, "EI": 1e6, "mass_per_length": 0.4}
    arm = flexlink.Arm(
        links=[
            {"segments": [bar], "damping": {"ratio": 0.02}, "tip": {"mass": 0.1}},
            {"segments": [bar], "damping": {"ratio": 0.02}},
        ]
    )
    assert arm.lengths == [0.5, 0.5]
    turn = 0.5 * (TIME - np.sin(2 * np.pi * TIME) / (2 * np.pi))
    solution = flexlink.solve(arm, TIME, angle1=turn, angle2=turn + 1.0)
    peak = abs(solution.rigid_torque).max()
    assert abs(solution.torque - solution.rigid_torque).max() < 1e-3 * peak
    # The outer link does not turn against the inner one.
    assert abs(solution.joint_angle[:, 1] - 1.0).max() < 1e-3


def test_a_run_is_read_back(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("run") / "out"
    solution = flexlink.solve(strip(title="it"), TIME, acceleration=ACCELERATION)
    solution.write(folder)
    run = flexlink.read(folder)
    assert (run.command, run.title) == ("solve", "it")
    peak = abs(solution.torque).max()
    assert abs(run.torque - solution.torque).max() < 1e-9 * peak
    assert run.results["peak_torque_n_m"] == solution.results["peak_torque_n_m"]
    frame = solution.to_pandas()
    assert frame.index.name == "time" and list(frame.columns)[:2] == ["torque", "rigid_torque"]
    assert (frame["torque"].to_numpy() == solution.torque).all()
