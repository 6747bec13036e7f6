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
OF_LINK = "hub_angle hub_rate hub_acceleration tip_displacement tip_velocity tip_acceleration nodes"
OF_ARM = "joint_angle joint_rate chord_angle tip"
OF_PLAY = "joint_acceleration energy work dissipated holding_torque"


@pytest.fixture(scope="module")
def arm() -> flexlink.Solution:
    return flexlink.solve(flexlink.Arm.read(ARM), PATH)


def refused(of: Any, name: str) -> str:
    assert not hasattr(of, name)
    with pytest.raises(AttributeError) as caught:
        getattr(of, name)
    return str(caught.value)


def test_a_link_is_an_arm_of_one_link() -> None:
    assert flexlink.Arm is flexlink.Link and flexlink.ArmSolution is flexlink.Solution
    assert flexlink.ArmRun is flexlink.Run and flexlink.ArmSimulation is flexlink.Simulation
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
        (arm, "deflections", []),
        (arm, "moments", []),
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
