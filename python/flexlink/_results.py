"""Results as tables of other libraries and as pages in a notebook: methods of the results' classes."""

from __future__ import annotations

from typing import Any

from . import _flexlink
from ._files import report
from ._messages import FlexlinkError

# Histories over the time in the order of a table, and their units.
UNITS = {
    "torque": "N m",
    "force": "N",
    "rigid_torque": "N m",
    "rigid_force": "N",
    "hub_angle": "rad",
    "joint_angle": "rad",
    "carriage": "m",
    "hub_rate": "rad/s",
    "joint_rate": "rad/s",
    "carriage_velocity": "m/s",
    "hub_acceleration": "rad/s^2",
    "joint_acceleration": "rad/s^2",
    "carriage_acceleration": "m/s^2",
    "rigid_hub_angle": "rad",
    "rigid_joint_angle": "rad",
    "rigid_carriage": "m",
    "chord_angle": "rad",
    "chord_rate": "rad/s",
    "chord_acceleration": "rad/s^2",
    "chord_length": "m",
    "root_moment": "N m",
    "tip_displacement": "m",
    "tip": "m",
    "tip_velocity": "m/s",
    "tip_acceleration": "m/s^2",
    "tip_deflection": "m",
    "motor_torque": "N m",
    "motor_angle": "rad",
    "motor_rate": "rad/s",
    "motor_acceleration": "rad/s^2",
    "motor_power": "W",
    "motor_current": "A",
    "motor_voltage": "V",
    "reaction": "N",
    "energy": "J",
    "work": "J",
    "dissipated": "J",
}


def histories(result: Any) -> dict[str, Any]:
    """Arrays by name. Those that the result lacks, and joint angles of one link, which are its hub angles, are left out."""
    found: dict[str, Any] = {}
    for name in UNITS:
        array = getattr(result, name, None)
        if array is not None and name.replace("joint", "hub") not in found:
            found[name] = array
    return found


def columns(result: Any) -> dict[str, tuple[str, Any]]:
    """Units and columns by name, the time first.

    ``torque`` of several joints becomes ``torque1``, ``torque2``, …, the place of a tip ``tip_x``, ``tip_y``. Joints without
    a drive have no columns of a motor.
    """
    found = {"time": ("s", result.time)}
    for name, array in histories(result).items():
        if array.ndim == 1:
            found[name] = (UNITS[name], array)
            continue
        for link, part in enumerate(array.T if array.ndim == 2 else array.transpose(1, 2, 0), 1):
            if array.ndim == 3:
                found |= {f"{name}{link}_{axis}": (UNITS[name], own) for axis, own in zip("xy", part)}
            elif name.startswith("tip"):
                found[f"{name}_{'_xy'[link]}"] = (UNITS[name], part)
            elif not (name.startswith("motor") and part[0] != part[0]):
                found[f"{name}{link}"] = (UNITS[name], part)
    return found


def to_pandas(self: Any) -> Any:
    """The histories as a `pandas.DataFrame` over the time, those of an arm with a column for each joint: ``torque1``,
    ``torque2``."""
    import pandas

    found = {name: column for name, (_, column) in columns(self).items()}
    return pandas.DataFrame(found, index=pandas.Index(found.pop("time"), name="time"))


def to_xarray(self: Any) -> Any:
    """The histories as an `xarray.Dataset` over ``time``, ``joint`` from 1 and ``axis``, with their ``units``."""
    import xarray

    data: dict[str, Any] = {}
    coordinates: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
    for name, array in histories(self).items():
        across = ["axis"] if name.startswith("tip") else ["joint", "axis"]
        dimensions = ["time", *across[: array.ndim - 1]]
        data[name] = (dimensions, array, {"units": UNITS[name]})
        if "joint" in dimensions:
            coordinates["joint"] = range(1, array.shape[1] + 1)
        if "axis" in dimensions:
            coordinates["axis"] = ["x", "y"]
    title = self.summary.get("title", "")
    return xarray.Dataset(data, coordinates, attrs={"title": title} if title else {})


def __arrow_c_stream__(self: Any, requested_schema: object = None) -> Any:
    """The columns of ``to_pandas``, the time first, as a stream of Arrow: polars, pyarrow, DuckDB and others read it without
    a copy. The metadata of each column has its ``unit``."""
    found = columns(self).items()
    return _flexlink.arrow_stream([(name, unit, column) for name, (unit, column) in found])


def page(self: Any) -> str | None:
    """The page of ``report`` in a frame, for a notebook."""
    try:
        return framed(report(self))
    except FlexlinkError:
        return None


def framed(self: _flexlink.Page) -> str:
    """The page in a frame, for a notebook."""
    text = self.html.replace("&", "&amp;").replace('"', "&quot;")
    return f'<iframe srcdoc="{text}" width="100%" height="640" style="border: 0"></iframe>'


def add_methods() -> None:
    """Adds the methods to the classes."""
    tables = (to_pandas, to_xarray, __arrow_c_stream__)
    runs = (_flexlink.Solution, _flexlink.Simulation, _flexlink.Run)
    for of in (*runs, _flexlink.Learned, _flexlink.SetPoints):
        for method in tables:
            setattr(of, method.__name__, method)
    for shown in (*runs, _flexlink.Robustness):
        setattr(shown, "_repr_html_", page)
    setattr(_flexlink.Page, "_repr_html_", framed)
