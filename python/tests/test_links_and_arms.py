"""One class for one link and for arms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT
from test_arrays import strip

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
OF_LINK = "hub_angle hub_rate hub_acceleration tip_displacement nodes"
OF_ARM = "chord_angle tip"
OF_PLAY = "energy work dissipated holding_torque"


@pytest.fixture(scope="module")
def arm() -> flexlink.Solution:
    return flexlink.solve(flexlink.Arm.read(ARM), PATH)


def refused(of: Any, name: str) -> str:
    assert not hasattr(of, name)
    with pytest.raises(AttributeError) as caught:
        getattr(of, name)
    return str(caught.value)


def test_a_link_is_an_arm_of_one_link() -> None:
    assert flexlink.Arm is flexlink.Link
    segment = {"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}
    one = flexlink.Arm(links=[{"segments": [segment], "hub": {"inertia": 0.1}}])
    assert repr(one) == "Link('', length=1.5)" and one.lengths == [1.5]
    assert one.rigid_inertia == strip().rigid_inertia
    two = flexlink.Link.read(ARM)
    assert repr(two).startswith("Arm('") and len(two.lengths) == 2
    for name in ("length", "rigid_inertia"):
        assert refused(two, name) == f"{name} is for one link, and the arm has several"
    with pytest.raises(flexlink.InputError, match="an arm of several links, but must be one"):
        flexlink.Motion(MOTION, link=two)


def test_names_of_the_other_kind_are_absent(arm: flexlink.Solution, tmp_path: Path) -> None:
    link = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    short = slice(0, 200)
    played = flexlink.simulate(
        flexlink.Link.read(LINK), link.time[short], torque=link.torque[short]
    )
    assert set(played.errors) == {"tip", "hub_angle"}
    for solution, name in ((link, "link"), (arm, "arm")):
        solution.write(tmp_path / name, every=10)
    runs = [flexlink.read(tmp_path / name) for name in ("link", "arm")]
    for name in OF_LINK.split():
        several = f"{name} is for one link, and the arm has several"
        assert refused(arm, name) == several
        if hasattr(runs[0], name):
            assert refused(runs[1], name) == several
    for name in OF_ARM.split():
        one = f"{name} is for an arm, and this is one link"
        assert refused(link, name) == refused(played, name) == one
        if hasattr(runs[1], name):
            assert refused(runs[0], name) == one
    assert all(refused(played, name).endswith("this is one link") for name in OF_PLAY.split())
    for of, method, given in (
        (link, "positions", [0]),
        (played, "positions", [0]),
        (arm, "displacements", []),
        (runs[1], "displacements", []),
    ):
        with pytest.raises(AttributeError, match=f"{method} is for "):
            getattr(of, method)(*given)


def test_what_both_have_has_the_shape_of_its_joints(
    arm: flexlink.Solution, tmp_path: Path
) -> None:
    assert arm.torque.shape == (arm.time.size, 2)
    assert arm.summary["results"] == arm.results and len(arm.results["joints"]) == 2
    arm.write(tmp_path / "a")
    run = flexlink.read(tmp_path / "a")
    peak = np.abs(arm.rigid_torque).max()
    assert np.abs(run.rigid_torque - arm.rigid_torque).max() < 1e-9 * peak


def test_a_summary_is_a_dictionary_of_the_caller(arm: flexlink.Solution) -> None:
    first = arm.errors
    first["tip"] = None
    assert arm.errors["tip"] is not None


def test_remarks_state_how_the_file_of_a_path_was_read(tmp_path: Path) -> None:
    rows = PATH.read_text().splitlines()
    header = next(k for k, row in enumerate(rows) if row.startswith("time"))
    other = [row.replace(",", ";") for row in rows[header:]]
    (tmp_path / "p.csv").write_text("\n".join(other) + "\n")
    solution = flexlink.solve(flexlink.Arm.read(ARM), tmp_path / "p.csv")
    read = [remark for remark in solution.remarks if remark.kind == "reading"]
    assert len(read) == 1 and "p.csv: read" in read[0].message
    again = flexlink.solve(flexlink.Arm.read(ARM), PATH)
    assert (solution.torque == again.torque).all()
    assert "reading" not in [remark.kind for remark in again.remarks]


def test_a_program_for_any_number_of_links_has_the_same_names(arm: flexlink.Solution) -> None:
    link = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    for of, joints in ((link, 1), (arm, 2)):
        shape = of.time.shape if joints == 1 else (of.time.size, joints)
        for name in (
            "torque rigid_torque joint_angle joint_rate joint_acceleration rigid_joint_angle root_moment"
        ).split():
            assert getattr(of, name).shape == shape, name
        # The rate is the derivative of the angle, the acceleration that of the rate.
        step = of.time[1] - of.time[0]
        for whole, slope in (("angle", "rate"), ("rate", "acceleration")):
            of_whole = getattr(of, f"joint_{whole}")
            change = np.gradient(of_whole, step, axis=0) - getattr(of, f"joint_{slope}")
            assert abs(change[2:-2]).max() < 1e-2 * abs(getattr(of, f"joint_{slope}")).max()
        for number in range(joints):
            nodes = of.nodes_of(number)
            moments = of.moments(link=number)
            assert moments.shape == of.deflections(link=number).shape == (of.time.size, nodes.size)
            root = of.root_moment if joints == 1 else of.root_moment[:, number]
            assert abs(moments[:, 0] - root).max() < 1e-3 * abs(root).max()
            few = of.moments([0, 2], every=7, link=number)
            assert (few == moments[::7, [0, 2]]).all()
        with pytest.raises(flexlink.InputError, match="link = 5, but must be below"):
            of.moments(link=5)
    assert (link.joint_angle == link.hub_angle).all()
    assert (link.joint_acceleration == link.hub_acceleration).all()
    with pytest.raises(flexlink.InputError, match="nodes = 999, but must be below"):
        arm.moments([999])


def test_forces_in_an_arm_are_those_of_the_motion_of_its_masses() -> None:
    bar = {"segments": [{"length": 0.5, "EI": 1e6, "mass_per_length": 0.4}]}
    stiff = flexlink.Arm(links=[bar, bar | {"payload": {"mass": 0.3}}])
    time = np.linspace(0, 2, 401)
    s = time / 2
    course = s**4 * (35 - 84 * s + 70 * s**2 - 20 * s**3)
    solution = flexlink.solve(stiff, time, angle1=0.3 + 0.8 * course, angle2=-0.4 + 1.1 * course)
    assert solution.reaction.shape == (solution.time.size, 2, 2)
    assert solution.chord_length.max() < 0.5 + 1e-6 and solution.chord_rate.shape[1] == 2
    assert solution.tip_velocity.shape == solution.tip_acceleration.shape == solution.tip.shape
    # Newton's law of the outer bar with its payload, from the accelerations of its ends.
    ends = solution.positions(1, nodes=[0, solution.nodes_of(1).size - 1])
    step = solution.time[1] - solution.time[0]
    moved = np.gradient(np.gradient(ends, step, axis=0), step, axis=0)
    force = 0.2 * (moved[:, 0] + moved[:, 1]) / 2 + 0.3 * moved[:, 1]
    off = abs(solution.reaction[:, 1] - force)[5:-5].max()
    assert off < 2e-3 * abs(force).max()


def test_columns_of_motors_are_those_of_the_joints(tmp_path: Path) -> None:
    gear = {"gear_ratio": 50, "rotor_inertia": 1e-5}
    bar = {"segments": [{"length": 0.5, "EI": 40.0, "mass_per_length": 0.4}]}
    outer = bar | {"drive": gear, "payload": {"mass": 0.1}}
    with_drive = flexlink.Arm(links=[bar, outer], elbow="left")
    motion = flexlink.trajectory(
        "septic", path="line", start=(0.8, -0.2), to=(0.4, 0.6), duration=1.5, step=0.005
    )
    solution = flexlink.solve(with_drive, **motion)
    assert solution.motor_torque is not None and solution.motor_rate is not None
    assert np.isnan(solution.motor_torque[:, 0]).all() and solution.motor_current is None
    assert np.allclose(solution.motor_rate[:, 1], 50 * solution.joint_rate[:, 1], rtol=1e-9)
    solution.write(tmp_path / "run")
    run = flexlink.read(tmp_path / "run")
    assert np.isnan(run.motor_torque[:, 0]).all()
    peak = abs(solution.motor_torque[:, 1]).max()
    assert abs(run.motor_torque[:, 1] - solution.motor_torque[:, 1]).max() < 1e-9 * peak
    frame = solution.to_pandas()
    assert "motor_torque2" in frame and "motor_torque1" not in frame
    assert flexlink.solve(flexlink.Link.read(LINK), MOTION).motor_torque is None


def test_a_run_has_the_names_of_its_solution(arm: flexlink.Solution, tmp_path: Path) -> None:
    link = flexlink.solve(flexlink.Link.read(LINK), MOTION)
    names = "torque rigid_torque joint_angle joint_rate joint_acceleration rigid_joint_angle"
    for solution, place in ((link, "link"), (arm, "arm")):
        solution.write(tmp_path / place, every=3)
        run = flexlink.read(tmp_path / place)
        for name in names.split():
            own, peak = getattr(solution, name), abs(getattr(solution, name)).max()
            assert abs(getattr(run, name) - own).max() < 1e-9 * peak, name
        assert run.results == solution.results and run.errors == solution.errors
        assert run.summary["title"] == run.title and run.folder == tmp_path / place
        assert (run.nodes_of(0) == solution.nodes_of(0)).all()
    assert run.positions(1).shape == (run.nodal_time.size, arm.nodes_of(1).size, 2)
    off = run.positions(1) - arm.positions(1, every=3)
    assert abs(off).max() < 1e-9
    assert run.tip_velocity is None
