"""Motions of arrays and files, as objects of their own, and what belongs to a call with them."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, Command, files
from test_arrays import ACCELERATION, TIME, strip

SHARE = np.clip((TIME - 0.1) / 0.8, 0, 1)
MOVED = 0.1 * (SHARE - np.sin(2 * np.pi * SHARE) / (2 * np.pi))


def csv(path: Path, name: str, values: Any) -> Path:
    """A file of the shortest text of each number."""
    rows = [f"{float(t)!r},{float(x)!r}\n" for t, x in zip(TIME, values)]
    path.write_text(f"time,{name}\n" + "".join(rows))
    return path


@pytest.mark.parametrize("decimals", [4, 17])
@pytest.mark.parametrize("name", ["displacement", "angle"])
def test_an_array_counts_as_a_file_of_its_numbers(
    tmp_path: Path, name: str, decimals: int
) -> None:
    values = np.round(MOVED, decimals)
    by_file = flexlink.solve(strip(), csv(tmp_path / "m.csv", name, values))
    by_array = flexlink.solve(strip(), TIME, **{name: values})  # type: ignore[call-overload]
    assert (by_array.torque == by_file.torque).all()
    told = [[own.kind for own in solution.remarks] for solution in (by_file, by_array)]
    assert told[0] == told[1] == (["few_digits", "timing"] if decimals == 4 else [])
    exact = flexlink.solve(strip(), TIME, displacement=MOVED * (1.5 if name == "angle" else 1))
    peak = abs(exact.torque).max()
    assert abs(abs(by_array.torque).max() - peak) < 0.05 * peak


def test_a_rounded_path_counts_as_its_file(tmp_path: Path) -> None:
    arm = flexlink.Arm.read(ROOT / "specs/arms/two_links.toml")
    path = np.loadtxt(ROOT / "trajectories/arms/line_1.5s.csv", delimiter=",", skiprows=2)
    time, (x, y) = path[:, 0], np.round(path[:, 1:3].T, 5)
    rows = [f"{float(t)!r},{float(a)!r},{float(b)!r}\n" for t, a, b in zip(time, x, y)]
    (tmp_path / "p.csv").write_text("time,x,y\n" + "".join(rows))
    by_file, by_array = (
        flexlink.solve(arm, tmp_path / "p.csv"),
        flexlink.solve(arm, time, x=x, y=y),
    )
    assert (by_array.torque == by_file.torque).all()
    kinds = [own.kind for own in by_array.remarks]
    assert kinds == [own.kind for own in by_file.remarks] and kinds


def test_a_golden_folder_of_arrays_says_what_it_is(tmp_path: Path) -> None:
    flexlink.solve(strip(), TIME, acceleration=ACCELERATION).write(tmp_path / "g", golden=True)
    recorded = json.loads((tmp_path / "g/summary.json").read_text())["inputs"]
    assert recorded == {"arguments": ["--golden"]}
    with pytest.raises(flexlink.InputError, match="golden"):
        flexlink.read(tmp_path / "g")


def test_stations_of_arrays_are_read_back(command: Command, tmp_path: Path) -> None:
    solution = flexlink.solve(strip(), TIME, acceleration=ACCELERATION, stations=[0.5, "70 cm"])
    solution.write(tmp_path / "s")
    run = flexlink.read(tmp_path / "s")
    assert run.deflections().shape[1] == 2
    nodes = solution.nodes.tolist()
    assert 0.5 in nodes and 0.7 in nodes
    repeated = command("solve", "--repeat", tmp_path / "s")
    assert repeated.returncode == 3  # an input is refused
    assert "inputs.link is missing" in repeated.stderr
    assert "a program wrote this run without input files" in repeated.stderr
    with pytest.raises(flexlink.InputError, match="stations = 0.123 m, but must be a node") as told:
        solution.write(tmp_path / "t", stations=[0.123])
    assert told.value.hint == "solve with stations to have nodes there"
    with pytest.raises(flexlink.InputError, match="unexpected keyword `node`") as told:
        solution.write(tmp_path / "t", node=[1])  # type: ignore[call-arg]
    assert told.value.hint == "did you mean `nodes`?"


def test_a_sweep_names_its_values_and_tells_each_kind_once() -> None:
    link = flexlink.Link.read(LINK)
    cases: list[dict[str, Any]] = [
        {"segments.*.EI*": 2, "payload.mass": "50 g"},
        {"mesh.elements": 2},
        {"mesh.elements": 3},
        {"hub.inertia": -1.0},
    ]
    with pytest.warns(flexlink.FlexlinkWarning) as told:
        table = flexlink.sweep(link, cases, MOTION)
    assert list(table)[:4] == ["segments.*.EI*", "payload.mass", "mesh.elements", "hub.inertia"]
    assert table["segments.*.EI*"][0] == 2 and np.isnan(table["segments.*.EI*"][1:]).all()
    assert table["payload.mass"] == ["50 g", None, None, None]
    own = [warning.message for warning in told]
    kinds = [warning.kind for warning in own if isinstance(warning, flexlink.FlexlinkWarning)]
    assert kinds[0] == "failed" and len(set(kinds)) == len(kinds)
    assert "1 of 4 cases failed, the first is cases[3]: " in str(own[0])
    assert any("2 of 4 cases, the first is cases[1]: " in str(warning) for warning in own)


def test_a_motion_is_read_once_and_gives_the_same_bytes(tmp_path: Path) -> None:
    link = flexlink.Link.read(LINK)
    motion = flexlink.Motion(MOTION)
    assert repr(motion) == "Motion(samples=881, travel=0.500)"
    for factor in (1, 1, 4):
        own = link.changed({"segments.*.EI*": factor})
        flexlink.solve(own, motion).write(tmp_path / "a", every=10)
        flexlink.solve(own, MOTION).write(tmp_path / "b", every=10)
        assert files(tmp_path / "a") == files(tmp_path / "b")
    table = flexlink.sweep(link, [{}, {"duration*": 2.0}], motion)
    other = flexlink.sweep(link, [{}, {"duration*": 2.0}], MOTION)
    assert (table["peak_torque_n_m"] == other["peak_torque_n_m"]).all()
    slow = flexlink.Motion(MOTION, scale_duration=2.0, lowpass=20.0)
    by_call = flexlink.solve(link, MOTION, scale_duration=2.0, lowpass=20.0)
    assert (flexlink.solve(link, slow).torque == by_call.torque).all()
    given = flexlink.Motion(TIME, displacement=MOVED)
    assert abs(given.displacement - MOVED).max() < 1e-12
    assert (given.time == TIME).all()


def test_angles_are_arcs_of_one_link() -> None:
    link, angle = strip(), MOVED / 1.5
    with pytest.raises(flexlink.InputError, match="link is missing: angles are arcs of its length"):
        flexlink.Motion(TIME, angle=angle)
    motion = flexlink.Motion(TIME, angle=angle, link=link)
    by_call = flexlink.solve(link, TIME, angle=angle)
    assert (flexlink.solve(link, motion).torque == by_call.torque).all()
    longer = link.changed({"segments.0.length": 2.0})
    with pytest.raises(flexlink.InputError, match="of another length"):
        flexlink.solve(longer, motion)
    table = flexlink.sweep(link, [{}, {"segments.0.length": 2.0}], motion)
    assert table["error"] == [None, None]
    by_call = flexlink.solve(longer, TIME, angle=angle)
    assert table["peak_torque_n_m"][1] == by_call.results["peak_torque_n_m"]


def refused(call: Any, *given: Any, **keywords: Any) -> tuple[str, str | None]:
    with pytest.raises(flexlink.InputError) as caught:
        call(*given, **keywords)
    return caught.value.message, caught.value.hint


def test_refusals_speak_of_keywords() -> None:
    link, solve, time = strip(), flexlink.solve, TIME
    slip = refused(solve, link, time, displacment=MOVED)
    assert slip == ("unexpected keyword `displacment`", "did you mean `displacement`?")
    assert refused(solve, link, time, angle=MOVED, lowpas=3)[1] == "did you mean `lowpass`?"
    assert refused(solve, link, time, angle=MOVED, set="a=1")[0] == "unexpected keyword `set`"
    unit = refused(solve, link, time, displacement=MOVED, unit="mm")
    assert unit == (
        "unit is for files, and the motion is arrays",
        "arrays are in SI; multiply them",
    )
    both = refused(solve, link, time, angle=MOVED, periodic=True, noise=1e-3)
    assert "must not stand beside" in both[0] and "--" not in both[0]
    motion = flexlink.Motion(TIME, displacement=MOVED)
    beside = "stands beside a Motion, but must be passed to it"
    assert refused(solve, link, motion, noise=1e-3)[0] == f"noise {beside}"
    assert refused(solve, link, motion, velocity=MOVED)[0] == f"velocity {beside}"
    to_solve = refused(flexlink.Motion, time, displacement=MOVED, moments=True)[0]
    assert to_solve == "moments is passed to a Motion, but must be passed to solve"
    arm = flexlink.Arm.read(ROOT / "specs/arms/two_links.toml")
    assert refused(solve, arm, motion)[1] == "pass time, x and y"
    profile = refused(flexlink.trajectory, "septik", distance=1, duration=1, step=0.01)
    assert profile[0].startswith('profile = "septik", but must be one of ')
    assert profile[1] == "did you mean `septic`?"
    change = refused(link.changed, {"payload.mas": 1})
    assert change[0].startswith("the change 'payload.mas=1'") and "--" not in str(change)
    stray = refused(flexlink.simulate, link, TIME, torque=ACCELERATION, untill=2)
    assert stray == ("unexpected keyword `untill`", "did you mean `until`?")


def test_hints_speak_of_keywords() -> None:
    solution = flexlink.solve(strip(), TIME, displacement=np.round(MOVED, 4))
    remark, *_ = solution.remarks
    assert remark.hint == (
        "write the displacement with more decimals, or give noise if these are exact"
    )
    assert str(remark).count(remark.hint) == 1


def test_a_simulation_is_compared_with_its_target() -> None:
    viscous = strip(damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002})
    motion = flexlink.Motion(TIME, acceleration=ACCELERATION)
    solution = flexlink.solve(viscous, motion)
    played = flexlink.simulate(viscous, solution.time, torque=solution.torque, target=motion)
    assert played.tip_error is not None and played.tip_error["share"] < 1e-3
    peak = played.results["peak_torque_n_m"]
    assert peak == pytest.approx(abs(solution.torque).max(), rel=1e-6)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        alone = flexlink.simulate(viscous, solution.time, torque=solution.torque)
    assert alone.tip_error is None


def test_threads_share_a_motion_and_a_folder(tmp_path: Path) -> None:
    link = flexlink.Link.read(LINK)
    stiffer = [link.changed({"segments.*.EI*": 1 + k / 8}) for k in range(8)]
    time = np.linspace(0, 0.88, 8801)  # a period of several blocks, whose images threads compute together
    acceleration = np.sin(2 * np.pi * time / 0.88)
    alone = [flexlink.solve(own, time, acceleration=acceleration).torque for own in stiffer]
    found: dict[int, Any] = {}

    def work(case: int, motion: flexlink.Motion, writes: bool) -> None:
        solution = flexlink.solve(stiffer[case], motion)
        if writes:
            solution.write(tmp_path / "shared", every=100)
        found[case] = solution.torque

    for tried in range(10):
        motion = flexlink.Motion(time, acceleration=acceleration)
        found.clear()
        # Daemons: this test ends, were they to wait for one another.
        calls = [(case, motion, tried == 0) for case in range(len(stiffer))]
        threads = [Thread(target=work, args=call, daemon=True) for call in calls]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(timeout=120)
            assert not thread.is_alive()
        assert all((found[case] == own).all() for case, own in enumerate(alone))
    peak = np.abs(flexlink.read(tmp_path / "shared").torque).max()
    assert any(abs(peak - np.abs(own).max()) < 1e-9 for own in alone)


def test_notes_and_warnings_of_a_motion_reach_python(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.warns(flexlink.FlexlinkWarning, match="limits.torque") as caught:
        flexlink.trajectory(
            "min-jerk",
            distance=0.5,
            duration=0.88,
            step=0.002,
            shape="zv",
            of="free",
            link=LINK,
            set="limits.torque=0.1",
        )
    assert len(caught) == 1
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith("note: zv for free mode 1, 1.900 Hz")
    assert second.startswith("note: the torque starts 0.284 s before the motion")


def test_a_quiet_duration_takes_intervals_as_a_list_or_a_dictionary(
    capsys: pytest.CaptureFixture[str],
) -> None:
    link = strip(damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002})
    intervals: list[Any] = [
        ["segments.*.EI*=±5%", "hub.inertia=0.098..0.102"],
        {"segments.*.EI*": "±5%", "hub.inertia": (0.098, 0.102)},
        "segments.*.EI*=±5%",
        None,
    ]
    notes = []
    for uncertain in intervals:
        flexlink.trajectory(
            "min-jerk",
            link=link,
            distance=0.5,
            step=0.005,
            quiet_at="free",
            fit_limit={"torque": 2},
            uncertain=uncertain,
        )
        notes.append(capsys.readouterr().err)
    assert notes[0] == notes[1]
    assert ["in the intervals" in note for note in notes] == [True, True, True, False]
