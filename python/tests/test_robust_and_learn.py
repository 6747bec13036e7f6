"""`robust` and `learn`: the files of the command, and the steps on a rig that is not its model."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import flexlink

from conftest import LINK, MOTION, ROOT, Command, files

ARM = ROOT / "specs/arms/two_links.toml"
PATH = ROOT / "trajectories/arms/line_1.5s.csv"
SHEET = ROOT / "specs/carriages/sheet.toml"
KNOWN = {"segments.*.EI*": "±5%", "payload.mass": "0..0.02"}
Floats = npt.NDArray[np.float64]


def as_options(intervals: dict[str, str]) -> list[str]:
    """The intervals for the command."""
    return [word for key, own in intervals.items() for word in ("--uncertain", f"{key}={own}")]


def test_a_study_writes_the_files_of_the_command(command: Command, tmp_path: Path) -> None:
    own = ("--runs", 60, "--seed", 3, "--band", "2 %", "--distribution", "normal")
    # A normal mass may be negative: the draw is repeated.
    done = command("robust", LINK, MOTION, *as_options(KNOWN), *own, "-o", "a")
    assert done.returncode == 0, done.stderr
    found = flexlink.robust(
        flexlink.Link.read(LINK),
        MOTION,
        uncertain=KNOWN,
        runs=60,
        seed=3,
        band="2 %",
        distribution="normal",
    )
    found.write(tmp_path / "b")
    theirs = files(tmp_path / "a")
    assert theirs == files(tmp_path / "b")
    assert sorted(theirs) == ["envelope.csv", "robust.csv", "summary.json"]
    assert found.summary == json.loads(theirs["summary.json"])
    with (tmp_path / "a/robust.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(found.plants)
    assert [row["kind"] for row in rows] == found.plants["kind"]
    for name in list(found.plants)[1:]:
        texts = [row[name] for row in rows]
        numbers = [float(text) if text else np.nan for text in texts]
        np.testing.assert_allclose(found.plants[name], numbers, rtol=1e-9, atol=1e-12)
    assert found.envelope["time_s"].size == found.envelope["lowest_error_m"].size


@pytest.mark.parametrize(
    ("link", "motion", "words", "options"),
    [
        (SHEET, "min-jerk", ["--play", "position"], {"play": "position"}),
        (SHEET, "min-jerk", ["--command", "zv"], {"command": "zv"}),
        (ARM, PATH, ["--feedback", "50,1"], {"feedback": (50, 1)}),
    ],
)
def test_carriages_arms_and_other_commands(
    command: Command,
    tmp_path: Path,
    link: Path,
    motion: Any,
    words: list[str],
    options: dict[str, Any],
) -> None:
    key = "links.*.segments.*.EI*" if link == ARM else "segments.*.E*"
    if motion == "min-jerk":
        motion = tmp_path / "motion.csv"
        times = ("--distance", 0.2, "--duration", 0.44, "--step", 0.002)
        assert command("trajectory", "min-jerk", *times, "-o", motion).returncode == 0
    changes = [] if link == ARM else ["--set", "gravity=[0, 0]"]
    intervals = as_options({key: "±5%"})
    done = command("robust", link, motion, *changes, *words, *intervals, "--runs", 3, "-o", "a")
    assert done.returncode == 0, done.stderr
    read = flexlink.Link.read(link, None if link == ARM else {"gravity": [0, 0]})
    # A list of texts is the same as a dictionary.
    found = flexlink.robust(read, motion, uncertain=[f"{key}=±5%"], runs=3, **options)
    found.write(tmp_path / "b")
    assert files(tmp_path / "a") == files(tmp_path / "b")


def test_the_worst_link_has_its_error_in_a_simulation() -> None:
    viscous = {"damping": {"model": "rayleigh", "alpha": 0.1, "beta": 0.001}}
    link = flexlink.Link.read(LINK, viscous)
    motion: Any = flexlink.trajectory("min-jerk", distance=0.5, duration=1, step=0.002)
    found = flexlink.robust(link, **motion, uncertain=KNOWN, runs=0)
    assert found.quantiles is None
    worst = found.worst["tip_error"]
    assert worst["kind"] == "corner"
    solution = flexlink.solve(link, **motion)
    plant = link.changed(worst["values"])
    # A period after the motion; with payload the lowest mode is slower than the nominal one.
    until = 1 + 1.2 * found.summary["nominal"]["period_s"]
    end = max(until, solution.time[-1])
    played = flexlink.simulate(plant, solution.time, torque=solution.torque, until=end)
    wanted = np.interp(played.time, solution.time, solution.tip_displacement)
    error = abs(played.tip_displacement - wanted)[played.time <= until].max()
    assert error == pytest.approx(worst["size_m"], rel=0.02)
    assert sum(found.shares.values()) == pytest.approx(1)
    # Its damping is the same in time, so that the error of the play alone is left.
    nominal = found.nominal["tip_error_m"]
    assert nominal is not None and nominal < 1e-6
    assert found.summary["errors"]["common_m"] == 0
    assert {"--play position"} <= {own["what"] for own in found.helps}


def test_a_study_has_the_same_bytes_on_any_number_of_threads(tmp_path: Path) -> None:
    script = f"""
import flexlink
link = flexlink.Link.read({str(LINK)!r})
found = flexlink.robust(link, {str(MOTION)!r}, uncertain={KNOWN!r}, runs=300)
found.write("threads")
"""
    written = []
    for threads in ("1", "3"):
        folder = tmp_path / threads
        folder.mkdir()
        words = [sys.executable, "-c", script]
        environment = {**os.environ, "RAYON_NUM_THREADS": threads}
        subprocess.run(words, cwd=folder, env=environment, check=True)
        written.append(files(folder / "threads"))
    link = flexlink.Link.read(LINK)
    # Without Python's lock two calls run side by side.
    with ThreadPoolExecutor(2) as pool:
        calls = [
            pool.submit(flexlink.robust, link, MOTION, uncertain=KNOWN, runs=300) for _ in range(2)
        ]
        for number, call in enumerate(calls):
            call.result().write(tmp_path / f"side{number}")
            written.append(files(tmp_path / f"side{number}"))
    assert all(own == written[0] for own in written)


def model() -> flexlink.Link:
    damping = {"model": "rayleigh", "alpha": 0.1, "beta": 0.002}
    return flexlink.Link.read(LINK, {"payload.mass": 0.1, "damping": damping})


def rig_of(link: flexlink.Link) -> flexlink.Link:
    """A link with 10 % less stiffness, 20 % more payload, and friction."""
    return link.changed(
        {"segments.*.EI*": 0.9, "payload.mass*": 1.2, "hub.viscous_friction": 0.05}
    )


def measured(rig: flexlink.Link, play: Any, until: float = 6.0) -> dict[str, Floats]:
    """The tip under a torque, as long in every step."""
    end = max(until, play.time[-1])
    played = flexlink.simulate(rig, play.time, torque=play.torque, until=end)
    rows = played.time <= until
    return {"time": played.time[rows], "tip": played.tip_displacement[rows]}


SLOW: Any = {"distance": 0.5, "duration": 3, "step": 0.005, "rest_before": 0.5, "rest_after": 2}
OFF = ["segments.*.EI*=±10%", "payload.mass=±20%", "hub.viscous_friction=0..0.06"]
# 0.1 % of the travel.
NOISE = 5e-4


def test_the_error_shrinks_on_a_rig_as_expected() -> None:
    link = model()
    rig = rig_of(link)
    motion: Any = flexlink.trajectory("min-jerk", **SLOW)
    wanted = flexlink.Motion(**motion).displacement
    random = np.random.default_rng(2)
    play: Any = flexlink.solve(link, **motion)
    steps: list[flexlink.Learned] = []
    for _ in range(4):
        applied = steps[-1] if steps else None
        tip = measured(rig, play)
        if not steps:
            # Before any noise the largest error is known.
            largest = abs(tip["tip"] - np.interp(tip["time"], motion["time"], wanted)).max()
        tip["tip"] += NOISE * random.standard_normal(tip["time"].size)
        play = flexlink.learn(link, **motion, measured=tip, applied=applied, uncertain=OFF)
        steps.append(play)
    assert steps[0].peak == pytest.approx(largest, abs=4 * NOISE)
    assert steps[0].rms > 50 * NOISE
    for before, after in zip(steps, steps[1:]):
        assert after.rms**2 < before.predicted_rms**2 + (1.1 * NOISE) ** 2
    assert steps[0].weighted_contraction < steps[0].contraction < 1
    assert steps[-1].rms < 1.1 * NOISE


def test_a_step_writes_the_table_of_the_command(command: Command, tmp_path: Path) -> None:
    words = [word for key, own in SLOW.items() for word in (f"--{key.replace('_', '-')}", own)]
    assert command("trajectory", "min-jerk", *words, "-o", "m.csv").returncode == 0
    link, motion = model(), tmp_path / "m.csv"
    first = flexlink.solve(link, motion)
    first.write(tmp_path / "first")
    tip = measured(rig_of(link), first)
    # In mm, to the last digit; 1000 times a decimal is not always the double of its millimetres.
    columns = np.column_stack([tip["time"], 1e3 * tip["tip"]])
    np.savetxt(tmp_path / "camera.csv", columns, "%.17g", ",", header="time,tip", comments="")
    sets = ["--set", "payload.mass=0.1", "--set"]
    sets += ['damping={"model" = "rayleigh", "alpha" = 0.1, "beta" = 0.002}']
    uncertain = [word for own in OFF for word in ("--uncertain", own)]
    own = [LINK, "m.csv", "camera.csv", *sets, *uncertain, "--unit", "measured:mm"]
    applied = tmp_path / "first/torque.csv"
    for extra, table in [([], None), (["--applied", applied], applied)]:
        done = command("learn", *own, *extra, "-o", "a.csv", "--json")
        assert done.returncode == 0, done.stderr
        step = flexlink.learn(
            link, motion, tmp_path / "camera.csv", applied=table, uncertain=OFF, unit="measured:mm"
        )
        step.write(tmp_path / "b.csv")
        assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
        assert json.loads(done.stdout) == step.summary
    # Arrays in place of each file, and the motion read before.
    of_arrays = flexlink.learn(
        link,
        flexlink.Motion(motion),
        measured=tip,
        applied={"time": first.time, "torque": first.torque},
        uncertain=OFF,
    )
    assert of_arrays.rms == pytest.approx(step.rms, rel=1e-9)
    np.testing.assert_allclose(of_arrays.torque, step.torque, atol=1e-8)
    assert of_arrays.to_pandas()["torque"].size == of_arrays.time.size


def test_a_carriage_learns_its_motion_and_an_arm_its_torques() -> None:
    sheet = flexlink.Link.read(SHEET, {"gravity": [0, 0], "damping": {"ratio": 0.02}})
    motion: Any = flexlink.trajectory(
        "min-jerk", distance=0.2, duration=1.5, step=0.005, rest_before=0.5, rest_after=1
    )
    rig = sheet.changed({"segments.*.E*": 0.95})
    first: Any = flexlink.solve(sheet, **motion)
    rms = []
    for applied in (False, True):
        end = max(3.0, first.time[-1])
        played = flexlink.simulate(
            rig,
            first.time,
            carriage=first.carriage,
            carriage_velocity=first.carriage_velocity,
            until=end,
        )
        rows = played.time <= 3
        tip = {"time": played.time[rows], "tip": played.tip_displacement[rows]}
        first = flexlink.learn(
            sheet,
            **motion,
            measured=tip,
            applied=first if applied else None,
            play="position",
            uncertain="segments.*.E*=±8%",
        )
        rms.append(first.rms)
    assert rms[1] < 0.3 * rms[0]
    assert first.force is None
    with pytest.raises(AttributeError, match="hub_angle is for a hub"):
        _ = first.hub_angle

    arm = flexlink.Arm.read(ARM)
    solved = flexlink.solve(arm, PATH)
    at_rest = np.arange(1, 400) * (solved.time[1] - solved.time[0])
    place = solved.tip + 1e-4 * np.sin(np.linspace(0, np.pi, solved.time.size))[:, None] ** 2
    tip = {
        "time": np.concatenate([solved.time, solved.time[-1] + at_rest]),
        "x": np.concatenate([place[:, 0], np.full(399, place[-1, 0])]),
        "y": np.concatenate([place[:, 1], np.full(399, place[-1, 1])]),
    }
    step = flexlink.learn(arm, PATH, tip, uncertain="links.*.segments.*.EI*=±2%")
    assert step.torque.shape == (step.time.size, 2)
    assert step.rms == pytest.approx(1e-4 * np.sqrt(2 * 3 / 8), rel=0.6)


def test_the_covariance_of_a_fit_is_an_object_or_a_file(command: Command, tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(
        '[[frequency]]\nmode = 1\nvalue = "1.8 Hz"\nuncertainty = "0.02 Hz"\n'
        '[[frequency]]\nmode = 2\nvalue = "5.3 Hz"\nuncertainty = "0.05 Hz"\n'
    )
    unfitted = flexlink.Link.read(LINK)
    fit = flexlink.fit(unfitted, tmp_path / "m.toml", ["segments.*.EI"])
    fit.write(tmp_path / "fitted.toml")
    fitted = flexlink.Link.read(tmp_path / "fitted.toml")
    done = command(
        "robust", "fitted.toml", MOTION, "--from", "fitted.json", "--runs", 20, "-o", "a"
    )
    assert done.returncode == 0, done.stderr
    of_file = flexlink.robust(fitted, MOTION, fit=tmp_path / "fitted.json", runs=20)
    of_file.write(tmp_path / "b")
    assert files(tmp_path / "a") == files(tmp_path / "b")
    of_object = flexlink.robust(fitted, MOTION, fit=fit, runs=20)
    assert of_object.worst == of_file.worst
    with pytest.raises(flexlink.InputError, match="is the link before this fit"):
        flexlink.robust(unfitted, MOTION, fit=fit, runs=20)


def test_refusals_name_the_keyword() -> None:
    link = flexlink.Link.read(LINK)

    def refused(**options: Any) -> str:
        with pytest.raises((flexlink.InputError, TypeError)) as caught:
            flexlink.robust(link, MOTION, **{"uncertain": KNOWN, "runs": 0, **options})
        return str(caught.value)

    assert refused(uncertain=None).startswith("nothing is uncertain: uncertain is missing")
    assert 'uncertain="segments.*.EI*=±5%"' in refused(uncertain=None)
    assert refused(uncertain={"payload.mass": "5%"}).startswith('uncertain="payload.mass=5%": "5%"')
    assert refused(uncertain=5).startswith("uncertain = 5, but must be a text, a list")
    assert "did you mean `runs`?" in refused(rnus=5)
    assert refused(moments=True).startswith("unexpected keyword `moments`")
    assert refused(play="angle").startswith('play = "angle", but must be one of position')
    assert refused(fit=4).startswith("fit = <class 'int'>, but must be a Fit, or the path")
    with pytest.warns(flexlink.FlexlinkWarning, match="allow is") as caught:
        found = flexlink.robust(link, MOTION, uncertain=KNOWN, runs=0, allow="1 mm")
    assert [own.kind for own in found.warnings] == ["not_robust"]
    assert len(caught) == 1
    with pytest.raises(TypeError, match="measured = <class 'int'>, but must be the path"):
        flexlink.learn(link, MOTION, 5, uncertain=KNOWN)  # type: ignore[arg-type]
    uneven = {"time": [0.0, 1.0], "tip": [0.0]}
    with pytest.raises(flexlink.InputError, match="tip has 1 rows, but must have 2, as time"):
        flexlink.learn(link, MOTION, uneven, uncertain=KNOWN)


MOTOR = {"torque_constant": 0.1, "resistance": 2.0, "rotor_inertia": 0.01, "gear_ratio": 5}


def test_a_voltage_plays_as_with_the_command(command: Command, tmp_path: Path) -> None:
    text = LINK.read_text() + "\n[drive]\n" + "".join(f"{k} = {v}\n" for k, v in MOTOR.items())
    (tmp_path / "geared.toml").write_text(text)
    link = flexlink.Link.read(tmp_path / "geared.toml")
    solution = flexlink.solve(link, MOTION)
    solution.write(tmp_path / "out")
    done = command("simulate", "geared.toml", "out/motor.csv", "--input", "voltage", "-o", "a")
    assert done.returncode == 0, done.stderr
    motor = np.genfromtxt(tmp_path / "out/motor.csv", delimiter=",", names=True, comments="#")
    played = flexlink.simulate(link, motor["time_s"], voltage=motor["motor_voltage_v"])
    played.write(tmp_path / "b")
    ours, theirs = files(tmp_path / "b"), files(tmp_path / "a")
    ours.pop("summary.json"), theirs.pop("summary.json")
    assert ours == theirs
    end = abs(played.tip_displacement - 0.493).min()
    assert end < 0.02
    with pytest.raises(flexlink.InputError, match="drive.torque_constant"):
        flexlink.simulate(flexlink.Link.read(LINK), solution.time, voltage=solution.torque)
    with pytest.raises(flexlink.InputError, match="feedback stands beside voltage"):
        flexlink.simulate(
            link,
            solution.time,
            voltage=solution.torque,
            feedback=(1, 1),
            reference=solution.hub_angle,
        )
