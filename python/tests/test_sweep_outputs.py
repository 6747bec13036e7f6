"""Sweeps that write the results of their cases."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, Command, files
from test_arrays import ACCELERATION, TIME, strip

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
FACTORS: list[dict[str, Any]] = [{"segments.*.EI*": 0.5}, {"segments.*.EI*": 2}]


def test_the_files_of_cases_are_those_of_the_command(command: Command, tmp_path: Path) -> None:
    varied = ("--vary", "segments.*.EI*=0.5,2", "--vary", "duration*=1,1.5")
    chosen = ("--nodes", "0,3", "--every", 10, "--stations", "0.33")
    done = command("sweep", LINK, MOTION, *varied, "--outputs", "a", *chosen, "-o", "s.csv")
    assert done.returncode == 0, done.stderr
    cases = [own | {"duration*": slower} for own in FACTORS for slower in (1, 1.5)]
    link = flexlink.Link.read(LINK)
    table = flexlink.sweep(
        link, cases, MOTION, outputs=tmp_path / "b", nodes=[0, 3], every=10, stations=[0.33]
    )
    assert table["error"] == [None] * 4
    for number in "1234":
        ours, theirs = (files(tmp_path / own / number) for own in "ab")
        assert ours == theirs and "nodal_displacements.csv" in ours


def test_moments_of_cases_are_those_of_their_solutions(tmp_path: Path) -> None:
    motion: dict[str, Any] = {"acceleration": ACCELERATION}
    flexlink.sweep(
        strip(), FACTORS, TIME, outputs=tmp_path / "s", moments=True, scale_duration=2.0, **motion
    )
    for number, case in enumerate(FACTORS, start=1):
        solution = flexlink.solve(
            strip().changed(case), TIME, moments=True, scale_duration=2.0, **motion
        )
        solution.write(tmp_path / "own")
        ours = files(tmp_path / f"s/{number}")
        assert ours == files(tmp_path / "own") and "bending_moments.csv" in ours
        run = flexlink.read(tmp_path / f"s/{number}")
        assert abs(run.moments()[:, 0] - solution.root_moment).max() < 1e-6


def test_factors_of_call_and_case_are_one_in_the_record(tmp_path: Path) -> None:
    link = flexlink.Link.read(LINK)
    slow: list[dict[str, Any]] = [{"duration*": 1.5, "distance*": 0.5}]
    flexlink.sweep(link, slow, MOTION, outputs=tmp_path / "s", every=50, scale_duration=2.0)
    recorded = json.loads((tmp_path / "s/1/summary.json").read_text())["inputs"]["arguments"]
    scaled = ["--scale-distance", "0.5", "--scale-duration", "3"]
    assert recorded == [*scaled, "--every", "50"]
    run = flexlink.read(tmp_path / "s/1")
    once = flexlink.solve(link, MOTION, scale_duration=3.0, scale_distance=0.5).results
    assert run.results["peak_torque_n_m"] == pytest.approx(once["peak_torque_n_m"], rel=1e-9)


def test_an_arms_cases_are_written(command: Command, tmp_path: Path) -> None:
    varied = ("--vary", "links.*.segments.*.EI*=1,2")
    done = command("sweep", ARM, PATH, *varied, "--outputs", "a", "--every", 50, "-o", "s.csv")
    assert done.returncode == 0, done.stderr
    cases: list[dict[str, Any]] = [{"links.*.segments.*.EI*": factor} for factor in (1, 2)]
    flexlink.sweep(flexlink.Arm.read(ARM), cases, PATH, outputs=tmp_path / "b", every=50)
    for number in "12":
        assert files(tmp_path / "a" / number) == files(tmp_path / "b" / number)
    done = command("solve", ARM, PATH, "-o", "c", "--every", 50, "--deflections")
    assert done.returncode == 0, done.stderr
    solution = flexlink.solve(flexlink.Arm.read(ARM), PATH)
    solution.write(tmp_path / "d", every=50, deflections=True)
    assert files(tmp_path / "c") == files(tmp_path / "d")


@pytest.mark.parametrize(
    "keywords",
    [
        {"nodes": [0]},
        {"stations": [0.5]},
        {"moments": True},
        {"every": 2},
        {"digits": 5},
        {"golden": True},
        {"deflections": True},
    ],
)
def test_what_shapes_files_alone_is_refused_without_files(keywords: dict[str, Any]) -> None:
    name = next(iter(keywords))
    message = f"{name} without outputs, but must come with outputs"
    with pytest.raises(flexlink.InputError, match=message) as told:
        flexlink.sweep(strip(), FACTORS, TIME, acceleration=ACCELERATION, **keywords)
    assert told.value.hint is not None and told.value.hint.startswith("outputs=FOLDER writes")
    with pytest.raises(flexlink.InputError, match=message):
        flexlink.sweep(flexlink.Arm.read(ARM), [{}], PATH, **keywords)


def test_every_other_keyword_of_a_sweep_does_what_it_says() -> None:
    link = flexlink.Link.read(LINK)
    plain = flexlink.sweep(link, [{}], MOTION)["peak_torque_n_m"][0]

    def peak(**keywords: Any) -> float:
        return float(flexlink.sweep(link, [{}], MOTION, **keywords)["peak_torque_n_m"][0])

    changed: list[dict[str, Any]] = [
        {"scale_distance": 0.5},
        {"scale_duration": 2.0},
        {"lowpass": 3.0},
        {"columns": {"acceleration": 2}, "scale": {"acceleration": 0.5}},
    ]
    for keywords in changed:
        assert peak(**keywords) != plain, keywords
        solved = flexlink.solve(link, MOTION, **keywords)
        assert peak(**keywords) == solved.results["peak_torque_n_m"], keywords
    for unknown in ("verify", "set", "report"):
        with pytest.raises(flexlink.InputError, match=f"unexpected keyword `{unknown}`"):
            peak(**{unknown: True})


def test_results_that_cannot_be_written_end_a_sweep(tmp_path: Path) -> None:
    (tmp_path / "s").write_text("a file")
    with pytest.raises(flexlink.WriteError):
        flexlink.sweep(strip(), FACTORS, TIME, acceleration=ACCELERATION, outputs=tmp_path / "s")


def test_a_node_that_a_case_has_not_is_its_error(tmp_path: Path) -> None:
    cases: list[dict[str, Any]] = [{"mesh.elements": 4}, {"mesh.elements": 12}]
    with pytest.warns(flexlink.FlexlinkWarning, match="1 of 2 cases failed"):
        table = flexlink.sweep(
            strip(), cases, TIME, acceleration=ACCELERATION, outputs=tmp_path / "s", nodes=[10]
        )
    assert "nodes = 10, but must name nodes of the mesh, 0 to 4" in table["error"][0]
    assert table["error"][1] is None and not (tmp_path / "s/1").exists()
    assert flexlink.read(tmp_path / "s/2").written_nodes == [10]


def test_a_distance_of_an_arms_path_is_that_of_the_command(
    command: Command, tmp_path: Path
) -> None:
    done = command("sweep", ARM, PATH, "--vary", "distance*=1,0.8", "-o", "s.csv")
    assert done.returncode == 0, done.stderr
    cases: list[dict[str, Any]] = [{}, {"distance*": 0.8}]
    table = flexlink.sweep(flexlink.Arm.read(ARM), cases, PATH)
    theirs = flexlink.read(tmp_path / "s.csv")
    for name in ("peak_torque1_n_m", "peak_torque2_n_m"):
        np.testing.assert_allclose(table[name], theirs[name], rtol=1e-11)


def test_a_mesh_of_a_sweep_is_measured_as_by_the_command(
    command: Command, tmp_path: Path
) -> None:
    done = command("sweep", LINK, MOTION, "--vary", "mesh.elements=6,9", "-o", "s.csv")
    assert done.returncode == 0, done.stderr
    cases: list[dict[str, Any]] = [{"mesh.elements": 6}, {"mesh.elements": 9}]
    table = flexlink.sweep(flexlink.Link.read(LINK), cases, MOTION)
    theirs = flexlink.read(tmp_path / "s.csv")
    for name in set(table) - {"warnings", "error"}:
        np.testing.assert_allclose(table[name], theirs[name], rtol=1e-11)
