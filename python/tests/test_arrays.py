"""Arrays in and out."""

from __future__ import annotations

import gc
import multiprocessing
import pickle
import signal
import subprocess
import sys
import time as clock
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT


def strip(**keys: Any) -> flexlink.Link:
    segments = [{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}]
    given = {"segments": segments, "hub": {"inertia": 0.1}, "damping": {"ratio": 0.02}} | keys
    return flexlink.Link(**given)


TIME = np.linspace(0, 1, 201)
ACCELERATION = np.round(4000 * np.sin(2 * np.pi * TIME)) / 1000


def torque(time: Any, acceleration: Any) -> Any:
    return flexlink.solve(strip(), time, acceleration=acceleration).torque


def test_arrays_of_any_layout_give_the_same() -> None:
    plain = torque(TIME, ACCELERATION)
    pairs = np.column_stack([TIME, ACCELERATION])
    assert not pairs[:, 1].flags.c_contiguous
    assert (torque(pairs[:, 0], pairs[:, 1]) == plain).all()
    frozen = ACCELERATION.copy()
    frozen.flags.writeable = False
    assert (torque(TIME, frozen) == plain).all()
    assert (torque(TIME.tolist(), ACCELERATION.tolist()) == plain).all()
    assert (torque(TIME, ACCELERATION[::-1][::-1]) == plain).all()
    big = ACCELERATION.astype(">f8")
    assert (torque(TIME, big) == plain).all()


def test_whole_numbers_and_short_floats_are_converted() -> None:
    whole = np.round(ACCELERATION).astype(np.int32)
    assert (torque(TIME, whole) == torque(TIME, whole.astype(float))).all()
    # Of few digits the shortest text that reads back counts: 0.1 is 0.1.
    assert (torque(TIME, ACCELERATION.astype(np.float32)) == torque(TIME, ACCELERATION)).all()


def refused(time: Any, **samples: Any) -> str:
    with pytest.raises((flexlink.FlexlinkError, TypeError)) as caught:
        flexlink.solve(strip(), time, **samples)
    return str(caught.value)


def test_what_is_no_motion_is_refused_by_name_and_index() -> None:
    broken = ACCELERATION.copy()
    broken[7] = np.nan
    must = "but must be a finite number"
    assert refused(TIME, acceleration=broken) == f"motion: acceleration[7] = NaN, {must}"
    broken[7] = -np.inf
    assert refused(TIME, acceleration=broken) == f"motion: acceleration[7] = -inf, {must}"
    short = "motion: samples of acceleration = 200, but must be 201, as many as times"
    assert refused(TIME, acceleration=ACCELERATION[1:]) == short
    table = np.column_stack([ACCELERATION, ACCELERATION])
    flat = "acceleration: shape = (201, 2), but must have one dimension"
    assert refused(TIME, acceleration=table) == flat
    kind = "acceleration: dtype = complex128, but must be real numbers"
    assert refused(TIME, acceleration=ACCELERATION + 0j) == kind
    assert refused(TIME, acceleration=["a"] * 201).startswith("acceleration: dtype = <U1")
    assert refused(TIME[::-1], acceleration=ACCELERATION).startswith("motion: time[1] = 0.995 s")
    assert refused(TIME).startswith("motion: samples are missing")
    assert refused(TIME[:3], acceleration=ACCELERATION[:3]).startswith("motion: samples = 3, but")
    assert refused(TIME, acceleration=ACCELERATION, angle=TIME).startswith("angle stands beside")
    other = "unexpected keyword `nonsense`"
    assert refused(TIME, acceleration=ACCELERATION, nonsense=1).startswith(other)
    noise = "noise = -1: must be a length or an angle above 0"
    assert refused(TIME, displacement=ACCELERATION, noise=-1) == noise


def test_views_share_memory_live_on_and_cannot_be_written() -> None:
    solution = flexlink.solve(strip(), TIME, acceleration=ACCELERATION)
    first, second = solution.torque, solution.torque
    assert np.shares_memory(first, second)
    with pytest.raises(ValueError, match="read-only"):
        first[0] = 1.0
    kept = first.copy()
    del solution, second
    gc.collect()
    # Allocates over what would be free if the view did not hold it.
    others = [np.full(kept.size, 7.0) for _ in range(100)]
    assert (first == kept).all() and len(others) == 100


def test_a_link_is_pickled_with_its_changes() -> None:
    link = strip().changed({"payload.mass": 0.2})
    again = pickle.loads(pickle.dumps(link))
    assert again.rigid_inertia == link.rigid_inertia
    read = pickle.loads(pickle.dumps(flexlink.Link.read(LINK)))
    assert read.title == flexlink.Link.read(LINK).title
    error = pickle.loads(pickle.dumps(flexlink.InputError("a", "b")))
    assert (error.message, error.hint, str(error)) == ("a", "b", "a\nhint: b")


def test_an_arms_histories_are_a_column_for_each_joint(tmp_path: Path) -> None:
    arm = flexlink.Arm.read(ROOT / "specs/arms/two_links.toml")
    solution = flexlink.solve(arm, ROOT / "trajectories/arms/line_1.5s.csv")
    frame = solution.to_pandas()
    assert (frame["torque2"].to_numpy() == solution.torque[:, 1]).all()
    assert (frame["tip_y"].to_numpy() == solution.tip[:, 1]).all()
    assert (frame.index.to_numpy() == solution.time).all()
    solution.write(tmp_path)
    read = flexlink.read(tmp_path).to_pandas()
    of_joints = ["torque", "rigid_torque", "joint_angle", "joint_rate", "joint_acceleration"]
    of_joints.append("rigid_joint_angle")
    assert list(read) == [f"{name}{joint}" for name in of_joints for joint in (1, 2)] + [
        "tip_x",
        "tip_y",
    ]
    assert abs(read["torque1"] - frame["torque1"]).max() < 1e-9 * abs(frame["torque1"]).max()


def test_a_coarse_mesh_is_told_as_by_the_command() -> None:
    link = flexlink.Link.read(LINK, {"mesh.elements": 2})
    with pytest.warns(flexlink.FlexlinkWarning, match="from mode 2 on the mesh is wrong") as told:
        flexlink.modes(link, count=3)
    assert isinstance(told[0].message, flexlink.FlexlinkWarning)
    assert told[0].message.kind == "coarse_mesh"
    with pytest.warns(flexlink.FlexlinkWarning, match="Hz the mesh is wrong by more than 1 %"):
        flexlink.frf(link, start=0.1, stop=50, points=20)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        flexlink.modes(flexlink.Link.read(LINK), count=3)


def test_a_motion_has_units_and_stops() -> None:
    motion = flexlink.trajectory(
        "septic",
        distance="90 deg",
        duration="800 ms",
        step="1 ms",
        link=LINK,
        via=["10 deg", "40 deg"],
        dwell="100 ms",
    )
    assert motion["time"].size == 1001
    # Two rests of 100 ms, both ends of which are ends of moves.
    assert (motion["acceleration"] == 0.0).sum() >= 2 * 99


def peak(factor: float) -> float:
    link = strip().changed({"segments.*.EI*": factor})
    return float(abs(flexlink.solve(link, TIME, acceleration=ACCELERATION).torque).max())


def test_a_forked_child_solves_after_its_parent() -> None:
    here = [peak(factor) for factor in (1.0, 2.0)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(peak, [1.0, 2.0]).get(timeout=60) == here


def test_ctrl_c_ends_a_sweep() -> None:
    program = (
        "import flexlink, signal, sys\n"
        # A process that was started in the background ignores it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"link = flexlink.Link.read({str(LINK)!r})\n"
        "cases = [{'segments.*.EI*': 1 + k / 1e6} for k in range(1_000_000)]\n"
        "print('begun', flush=True)\n"
        "try:\n"
        f"    flexlink.sweep(link, cases, {str(MOTION)!r})\n"
        "except KeyboardInterrupt:\n"
        "    sys.exit(7)\n"
    )
    words = [sys.executable, "-c", program]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        clock.sleep(1.0)
        process.send_signal(signal.SIGINT)
        # A million cases would take half an hour.
        assert process.wait(timeout=60) == 7
