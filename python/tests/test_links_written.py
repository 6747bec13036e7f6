"""Links written to files, and their values."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexlink

from conftest import LINK, ROOT
from test_arrays import strip

SPECS = sorted((ROOT / "specs").rglob("*.toml"))
MOTION = flexlink.trajectory("sine", distance=0.1, duration=2, step=0.01)


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_values_make_the_same_link(path: Path, tmp_path: Path) -> None:
    link = flexlink.Link.read(path)
    again = flexlink.Link(**link.values)
    assert again.values == link.values
    assert again.lengths == link.lengths and repr(again) == repr(link)
    link.write(tmp_path / "same.toml")
    assert (tmp_path / "same.toml").read_bytes() == path.read_bytes()
    # Keywords have no text of their own: it is new, and reads back to the same values.
    again.write(tmp_path / "new.toml")
    new = flexlink.Link.read(tmp_path / "new.toml")
    assert new.values == link.values


def test_changes_are_written_and_comments_stay(tmp_path: Path) -> None:
    link = flexlink.Link.read(LINK).changed({"segments.*.EI*": 1 / 3})
    link.write(tmp_path / "l.toml")
    text = (tmp_path / "l.toml").read_text()
    kept = [line for line in LINK.read_text().splitlines() if line.startswith("#")]
    assert kept and all(line in text for line in kept) and text == link.text
    read = flexlink.Link.read(tmp_path / "l.toml")
    one, other = (flexlink.solve(own, **MOTION).torque for own in (link, read))
    assert (one == other).all()
    # An added key needs a new text.
    added = link.changed({"payload.mass": "50 g", "payload.inertia": 1e-4})
    added.write(tmp_path / "l.toml")
    read = flexlink.Link.read(tmp_path / "l.toml")
    assert read.values["payload"]["mass"] == "50 g"
    assert read.rigid_inertia == added.rigid_inertia
    (tmp_path / "folder").mkdir()
    with pytest.raises(flexlink.WriteError, match="folder"):
        link.write(tmp_path / "folder")


def test_a_trajectory_takes_the_link_itself(tmp_path: Path) -> None:
    link = strip().changed({"limits.torque": 2.0})
    link.write(tmp_path / "l.toml")
    ways: list[dict[str, Any]] = [
        {"distance": "40 deg"},
        {"distance": 0.5, "fit_limit": {"torque": 1.5}},
        {"distance": 0.5, "shape": "zv", "of": "held", "duration": 1.0},
    ]
    for options in ways:
        motions = [
            flexlink.trajectory("min-jerk", step=0.005, link=own, **options)
            for own in (link, tmp_path / "l.toml")
        ]
        assert motions[0].keys() == motions[1].keys()
        columns: list[Any] = [motion.values() for motion in motions]
        for own, other in zip(*columns):
            np.testing.assert_array_equal(own, other)
    by_list = flexlink.trajectory(
        "min-jerk", step=0.005, link=link, distance=0.5, fit_limit=["torque=1.5"]
    )
    by_pairs = flexlink.trajectory(
        "min-jerk", step=0.005, link=link, distance=0.5, fit_limit={"torque": 1.5}
    )
    assert by_list["time"][-1] == by_pairs["time"][-1]
    assert abs(flexlink.solve(link, **by_pairs).torque).max() <= 1.5
    with pytest.raises(flexlink.InputError, match="links, but|has several|one link is needed"):
        flexlink.trajectory(
            "sine",
            distance="1 rad",
            duration=1,
            step=0.01,
            link=flexlink.Arm.read(ROOT / "specs/arms/two_links.toml"),
        )
