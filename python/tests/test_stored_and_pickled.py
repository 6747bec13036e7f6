"""Runs that are read back, objects that are sent to other processes, floats of few digits."""

from __future__ import annotations

import multiprocessing
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, files
from test_arrays import ACCELERATION, TIME, strip
from test_motions import MOVED, csv

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
STIFF = strip().changed({"segments.*.EI*": 10})


def test_a_stored_run_has_the_nodes_that_were_written(tmp_path: Path) -> None:
    solution = flexlink.solve(strip(), TIME, acceleration=ACCELERATION, moments=True)
    chosen = [0, 3, 7]
    solution.write(tmp_path / "r", nodes=chosen, every=5)
    run = flexlink.read(tmp_path / "r")
    assert run.written_nodes == chosen
    assert (run.nodal_time == run.time[::5]).all()
    for name in ("displacements", "deflections", "moments"):
        own = getattr(solution, name)(chosen, every=5)
        read = getattr(run, name)()
        assert read.shape == own.shape
        assert abs(read - own).max() < 1e-9 * abs(own).max(), name
        assert (getattr(run, name)([7, 3]) == read[:, [2, 1]]).all()
    # v = xθ + w (Bayo 1987, eq 1).
    turned = solution.nodes[7] * run.hub_angle[::5]
    both = run.deflections([7])[:, 0] + turned
    assert abs(run.displacements([7])[:, 0] - both).max() < 1e-15
    missing = "nodes = 4, but must be one that was written: 0, 3, 7"
    with pytest.raises(flexlink.InputError, match=missing):
        run.displacements([4])


def test_what_a_folder_has_not_is_an_error_in_words(tmp_path: Path) -> None:
    solution = flexlink.solve(strip(), TIME, acceleration=ACCELERATION)
    solution.write(tmp_path / "r")
    run = flexlink.read(tmp_path / "r")
    with pytest.raises(flexlink.InputError, match="moments is missing: the run did not") as told:
        run.moments()
    assert told.value.hint is not None and "moments=True" in told.value.hint
    assert run.displacements().shape == (solution.time.size, solution.nodes.size)


def test_a_stored_arm_has_the_deflections_of_its_links(tmp_path: Path) -> None:
    arm = flexlink.Link.read(ARM)
    solution = flexlink.solve(arm, PATH)
    solution.write(tmp_path / "r", deflections=True, every=5)
    run = flexlink.read(tmp_path / "r")
    for link in (0, 1):
        own, read = solution.deflections(every=5, link=link), run.deflections(link=link)
        assert read.shape == own.shape == (run.nodal_time.size, run.nodes_of(link).size)
        assert abs(read - own).max() < 1e-9 * abs(own).max()
        assert (run.deflections([2, 1], link=link) == read[:, [2, 1]]).all()
        # The distance of each node from the line through both ends of its link.
        places = run.positions(link)
        chord = places[:, -1] - places[:, 0]
        chord /= np.linalg.norm(chord, axis=1, keepdims=True)
        x, y = np.moveaxis(places - places[:, :1], 2, 0)
        across = chord[:, :1] * y - chord[:, 1:] * x
        assert abs(across - read).max() < 1e-6 * abs(read).max()
    with pytest.raises(flexlink.FlexlinkError, match="link = 2, but must be below 2"):
        run.deflections(link=2)
    solution.write(tmp_path / "r")
    with pytest.raises(flexlink.InputError, match="deflections is missing: the run did") as told:
        flexlink.read(tmp_path / "r").deflections(link=1)
    assert told.value.hint is not None and "deflections=True" in told.value.hint


def test_a_stored_link_with_weight_counts_from_where_it_starts(tmp_path: Path) -> None:
    coarse = {"mesh": {"elements": 4}, "analysis": {"tolerance": 1e-4}}
    link = strip(gravity=[0.0, -9.81], start_angle="-90 deg", **coarse)
    solution = flexlink.solve(link, TIME, displacement=np.round(MOVED, 15))
    solution.write(tmp_path / "r")
    run = flexlink.read(tmp_path / "r")
    own = solution.displacements()
    assert abs(run.displacements() - own).max() < 1e-8 * abs(own).max()
    played = flexlink.simulate(link, TIME[:21], torque=0.1 * np.sin(np.pi * TIME[:21] / 0.1) ** 2)
    played.write(tmp_path / "p")
    of_play, moved = flexlink.read(tmp_path / "p").displacements(), played.displacements()
    assert abs(of_play - moved).max() < 1e-8 * abs(moved).max()


def again(own: Any) -> Any:
    return pickle.loads(pickle.dumps(own))


@pytest.mark.parametrize("name", ["acceleration", "velocity", "displacement", "angle"])
def test_a_motion_is_pickled_with_all_that_it_says(name: str, tmp_path: Path) -> None:
    link = strip()
    values = ACCELERATION if name == "acceleration" else MOVED
    given: dict[str, Any] = {name: values, "lowpass": 20.0, "scale_duration": 2.0}
    if name == "velocity":
        given["moving_ends"] = False
    motion = flexlink.Motion(TIME, link=link, **given)
    sent = again(motion)
    assert (sent.displacement == motion.displacement).all()
    assert (sent.time == motion.time).all()
    assert (flexlink.solve(link, sent).torque == flexlink.solve(link, motion).torque).all()
    if name == "angle":
        longer = link.changed({"segments.0.length": 1.6})
        with pytest.raises(flexlink.InputError, match="angles of a link of another length"):
            flexlink.solve(longer, sent)


def test_motions_and_solutions_of_files_are_pickled_with_their_files(tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_bytes(MOTION.read_bytes())
    motion = flexlink.Motion(own)
    solution = flexlink.solve(flexlink.Link.read(LINK), motion)
    sent = pickle.dumps((motion, solution))
    own.unlink()
    motion, read = pickle.loads(sent)
    solution.write(tmp_path / "a", every=10)
    read.write(tmp_path / "b", every=10)
    assert files(tmp_path / "a") == files(tmp_path / "b")
    flexlink.solve(flexlink.Link.read(LINK), motion).write(tmp_path / "c", every=10)
    assert files(tmp_path / "a") == files(tmp_path / "c")


def test_a_solution_is_pickled_with_its_keywords_and_warnings() -> None:
    link = flexlink.Link.read(LINK, {"mesh.elements": 3})
    with pytest.warns(flexlink.FlexlinkWarning):
        solution = flexlink.solve(link, TIME, acceleration=ACCELERATION, stations=[0.77])
    read = again(solution)
    assert (read.torque == solution.torque).all() and 0.77 in read.nodes.tolist()
    assert [str(own) for own in read.warnings] == [str(own) for own in solution.warnings]


def test_a_solution_of_an_arm_is_pickled() -> None:
    path = np.loadtxt(PATH, delimiter=",", skiprows=2)
    arm = again(flexlink.Arm.read(ARM))
    by_file = flexlink.solve(arm, PATH)
    by_array = flexlink.solve(arm, path[:, 0], x=path[:, 1], y=path[:, 2])
    for solution in (by_file, by_array):
        assert (again(solution).torque == solution.torque).all()


def solved(motion: flexlink.Motion) -> flexlink.Solution:
    return flexlink.solve(strip(), motion)


def test_motions_and_solutions_cross_processes() -> None:
    motion = flexlink.Motion(TIME, acceleration=ACCELERATION)
    here = solved(motion).torque
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (there,) = pool.map_async(solved, [motion]).get(timeout=120)
    assert (there.torque == here).all()


@pytest.mark.parametrize("name", ["displacement", "angle"])
def test_places_in_single_precision_count_as_a_file_of_their_decimals(
    tmp_path: Path, name: str
) -> None:
    # The next numbers of single precision are 6e-8 apart here: seven decimals.
    values = (9.0 * MOVED).astype(np.float32)
    assert 0.5 < values.max() < 1.0
    of_file = csv(tmp_path / "m.csv", name, np.round(values.astype(float), 7))
    by_file = flexlink.solve(STIFF, of_file)
    by_array = flexlink.solve(STIFF, TIME, **{name: values})  # type: ignore[call-overload]
    assert (by_array.torque == by_file.torque).all()
    exact = flexlink.solve(STIFF, TIME, **{name: 9.0 * MOVED})  # type: ignore[call-overload]
    peak = abs(exact.torque).max()
    assert abs(by_array.torque - interpolated(exact, by_array.time)).max() < 1e-2 * peak


def interpolated(solution: flexlink.Solution, time: Any) -> Any:
    return np.interp(time, solution.time, solution.torque)


def test_noise_of_single_precision_is_not_followed() -> None:
    # So fine a step that the rounding of the places would be the largest part of the torque.
    time = np.linspace(0, 1, 4001)
    share = np.clip((time - 0.1) / 0.8, 0, 1)
    moved = 0.9 * (share - np.sin(2 * np.pi * share) / (2 * np.pi))
    exact = flexlink.solve(STIFF, time, displacement=moved)
    short = flexlink.solve(STIFF, time, displacement=moved.astype(np.float32))
    taken = flexlink.solve(STIFF, time, displacement=moved.astype(np.float32).astype(float))
    peak = abs(exact.torque).max()

    def off(solution: flexlink.Solution) -> float:
        return float(abs(solution.torque - interpolated(exact, solution.time)).max() / peak)

    assert off(short) < 0.01
    assert off(short) < off(taken)
    assert [own.kind for own in short.remarks].count("few_digits") <= 1


def test_times_in_single_precision_are_those_of_their_texts() -> None:
    solution = flexlink.solve(strip(), TIME.astype(np.float32), acceleration=ACCELERATION)
    assert (solution.torque == flexlink.solve(strip(), TIME, acceleration=ACCELERATION).torque).all()


def test_a_path_in_single_precision_counts_as_its_file(tmp_path: Path) -> None:
    path = np.loadtxt(PATH, delimiter=",", skiprows=2)
    time, x, y = path[:, 0], *path[:, 1:3].T.astype(np.float32)
    decimals = [int(np.floor(-np.log10(np.spacing(abs(own).max())))) for own in (x, y)]
    rounded = [np.round(own.astype(float), d) for own, d in zip((x, y), decimals)]
    arm = flexlink.Arm.read(ARM)
    by_array = flexlink.solve(arm, time, x=x, y=y)
    by_file = flexlink.solve(arm, time, x=rounded[0], y=rounded[1])
    assert (by_array.torque == by_file.torque).all()
