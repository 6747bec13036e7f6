"""Torques played on arms."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time as clock
import warnings
from pathlib import Path

import numpy as np
import pytest

import flexlink

from conftest import ROOT, Command, files

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
GAINS = (50.0, 1.0)


def bars(**keys: object) -> flexlink.Arm:
    """Two stiff bars without damping and friction."""
    bar = {"length": 0.5, "EI": 1e5, "mass_per_length": 0.4}
    link = {"segments": [bar], "damping": {"model": "rayleigh", "beta": 1e-7}}
    return flexlink.Arm(links=[link, link], **keys)


def test_torques_of_arrays_give_the_tables_of_the_command(
    command: Command, tmp_path: Path
) -> None:
    done = command("solve", ARM, PATH, "-o", "s", "--digits", "full", "--every", 50)
    assert done.returncode == 0, done.stderr
    feedback = ("--feedback", "50,1", "--reference", "s/joint_angles.csv")
    outputs = ("-o", "a", "--every", 50, "--save-state", "state.json")
    done = command(
        "simulate", ARM, "s/torques.csv", *feedback, "--target", "s/tip.csv", *outputs
    )
    assert done.returncode == 0, done.stderr
    arm = flexlink.Arm.read(ARM)
    solution = flexlink.solve(arm, PATH)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        played = flexlink.simulate(
            arm,
            solution.time,
            torque=solution.torque,
            feedback=GAINS,
            reference=solution.joint_angle,
            reference_rate=solution.joint_rate,
            target=solution.tip,
        )
    played.write(tmp_path / "b", every=50)
    ours, theirs = files(tmp_path / "b"), files(tmp_path / "a")
    summaries = [json.loads(own.pop("summary.json")) for own in (ours, theirs)]
    assert ours == theirs and len(ours) == 7
    for name in ("results", "errors", "tip_error", "elastica", "feedback"):
        assert summaries[0][name] == summaries[1][name], name
    played.save_state(tmp_path / "own.json")
    assert (tmp_path / "own.json").read_bytes() == (tmp_path / "state.json").read_bytes()
    # The tip follows the path that was solved for.
    assert played.tip_error is not None and played.tip_error["share"] < 1e-6
    travel = np.ptp(solution.tip[:, 0])
    assert abs(played.tip - solution.tip).max() < 1e-6 * travel
    read = flexlink.read(tmp_path / "b")
    assert abs(read.tip - played.tip).max() < 1e-9 and read.command == "simulate"
    frame = played.to_pandas()
    assert (frame["torque2"].to_numpy() == played.torque[:, 1]).all()
    assert (frame["tip_y"].to_numpy() == played.tip[:, 1]).all()


def test_joints_that_move_as_solved_take_the_solved_torques() -> None:
    arm = flexlink.Arm.read(ARM)
    solution = flexlink.solve(arm, PATH)
    played = flexlink.simulate(arm, solution.time, hub_angle=solution.joint_angle)
    assert abs(played.tip - solution.tip).max() < 1e-6 * np.ptp(solution.tip[:, 0])
    assert abs(played.torque - solution.torque).max() < 1e-5 * abs(solution.torque).max()


def test_constant_torque_turns_stiff_bars_as_one_rigid_body() -> None:
    arm = bars()
    time = np.linspace(0, 0.5, 501)
    # Stretched out: the inner torque that turns both as one, the outer one that keeps the outer bar in line.
    alpha = 2.0
    of_both, of_outer = 0.4 * 1.0**3 / 3, 0.4 * (0.5**3 / 3 + 0.5 * 0.5**2 / 2)
    torque = np.tile([of_both * alpha, of_outer * alpha], (time.size, 1))
    with pytest.warns(flexlink.FlexlinkWarning) as told:
        played = flexlink.simulate(arm, time, torque=torque, hold="zero", at=[0.3, 0.3])
    kinds = {own.message.kind for own in told if isinstance(own.message, flexlink.FlexlinkWarning)}
    assert "begins_unheld" in kinds
    assert [own.kind for own in played.warnings][0] == "begins_unheld"
    turned = 0.3 + 0.5 * alpha * time**2
    assert abs(played.joint_angle[:, 0] - turned).max() < 1e-4
    assert abs(played.joint_angle[:, 1]).max() < 1e-4
    assert abs(played.chord_angle - turned[:, None]).max() < 1e-4
    place = np.column_stack([np.cos(turned), np.sin(turned)])
    assert abs(played.tip - place).max() < 2e-4
    # All work is energy of motion: half of inertia times rate squared.
    kinetic = 0.5 * of_both * (alpha * time) ** 2
    assert abs(played.work - kinetic).max() < 1e-3 * kinetic.max()
    gained = played.energy - played.energy[0]
    missing = abs(played.work - gained - played.dissipated).max() / kinetic.max()
    assert missing < 1e-5 and played.errors["energy"] == pytest.approx(missing, rel=1e-3)
    assert played.positions(1, every=100).shape == (6, arm_nodes(played), 2)
    assert abs(played.positions(1)[:, -1] - played.tip).max() < 1e-12


def arm_nodes(played: flexlink.Simulation) -> int:
    elements = played.summary["arm"]["links"][1]["elements"]
    return int(elements) + 1


def test_gravity_is_held_by_the_torques_of_statics() -> None:
    arm = bars(gravity=[0.0, -9.81], elbow="left")
    time = np.linspace(0, 0.2, 101)
    weight = 0.4 * 0.5 * 9.81
    # Both bars along x: the weight of each at its middle.
    held = np.array([weight * (0.25 + 0.75), weight * 0.25])
    torque = np.tile(held, (time.size, 1))
    gains = [(500.0, 5.0), (500.0, 5.0)]
    reference = np.zeros((time.size, 2))
    played = flexlink.simulate(arm, time, torque=torque, feedback=gains, reference=reference)
    assert abs(played.holding_torque - held).max() < 1e-3 * held[0]
    assert abs(played.joint_angle).max() < 1e-5


def test_a_run_goes_on_from_the_state_of_another(tmp_path: Path) -> None:
    arm = bars()
    time = np.linspace(0, 0.2, 201)
    torque = np.column_stack([np.sin(10 * np.pi * time), 0.1 * np.sin(10 * np.pi * time)])
    whole = flexlink.simulate(arm, time, torque=torque, at=[0.1, 0.5])
    first = flexlink.simulate(arm, time[:101], torque=torque[:101], at=[0.1, 0.5])
    first.save_state(tmp_path / "state.json")
    for state in (first, tmp_path / "state.json"):
        rest = flexlink.simulate(arm, time[100:], torque=torque[100:], state=state)
        assert abs(rest.joint_angle - whole.joint_angle[100:]).max() < 1e-6
    with pytest.raises(flexlink.InputError, match="at must not stand beside state"):
        flexlink.simulate(arm, time, torque=torque, at=[0.1, 0.5], state=first)
    with pytest.raises(TypeError, match="state = <class 'int'>, but must be an earlier"):
        flexlink.simulate(arm, time, torque=torque, state=3)  # type: ignore[arg-type]


def test_what_cannot_be_played_is_refused_in_words() -> None:
    arm = bars()
    time = np.linspace(0, 0.2, 101)
    torque = np.zeros((101, 2))

    def refused(**keywords: object) -> str:
        given = {"torque": torque, "at": [0.0, 0.0]} | keywords
        with pytest.raises(flexlink.FlexlinkError) as caught:
            flexlink.simulate(arm, time, **given)  # type: ignore[arg-type]
        return str(caught.value)

    assert refused(torque=torque[:, 0]) == (
        "torque: shape = (101,), but must have the shape (101, 2)"
    )
    assert refused(torque=None).startswith("torque is missing")
    assert refused(at=None).startswith("at is missing: nothing states where the arm starts")
    assert refused(at=[0.1]).startswith("at = 1 directions, but must be 2 directions")
    assert refused(feedback=GAINS).startswith("one of feedback and reference")
    assert refused(reference_rate=torque).startswith("one of feedback and reference")
    pairs = [GAINS, GAINS, GAINS]
    assert refused(feedback=pairs, reference=torque).startswith("feedback = 3 pairs, but")
    assert refused(hub_angle=torque).startswith("the input must be torque or voltage alone, or hub_angle")
    assert refused(initial_tip=0.1) == "initial_tip is for one link, and the arm has several"
    assert "did you mean `torque`?" in refused(torqe=torque)
    assert refused(until=0.1).startswith("until = 0.1 s, but")
    assert refused(target=np.full((101, 2), np.nan)).startswith("target: not a number")
    assert "stands still" in refused(target=np.zeros((101, 2)))


def test_ctrl_c_ends_a_simulation() -> None:
    program = (
        "import flexlink, numpy, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"arm = flexlink.Arm.read({str(ARM)!r})\n"
        "time = numpy.arange(200_000) / 1000\n"
        "torque = numpy.zeros((time.size, 2))\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    flexlink.simulate(arm, time, torque=torque, at=[-1.5, -1.0])\n"
        "except KeyboardInterrupt:\n"
        "    sys.exit(7)\n"
    )
    words = [sys.executable, "-c", program]
    both = subprocess.PIPE
    with subprocess.Popen(words, stdout=both, stderr=both, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline() == "begun\n"
        clock.sleep(1.0)
        begun = clock.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 7
        assert clock.monotonic() - begun < 10
        assert process.stderr.read() == ""
