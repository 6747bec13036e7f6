#!/usr/bin/env python3
"""Read a result folder of `flexlink solve` with pandas and plot it; a table of `sweep`, too.

    python3 examples/read_results.py out -o figure.png
    python3 examples/read_results.py out --sweep stiffness.csv -o figure.png

Needs pandas and matplotlib. Every table is plain CSV with the unit in the name of the column.
"""

import argparse
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # a file, no window
import matplotlib.pyplot as plt
import pandas as pd


def read_results(folder: Path) -> tuple[dict, pd.DataFrame]:
    """The summary, and all histories in one table over time."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    names = ["torque.csv", "rigid_torque.csv", "hub_angle.csv", "tip.csv"]
    tables = [pd.read_csv(folder / name, index_col="time_s") for name in names]
    return summary, pd.concat(tables, axis="columns")


def plot_results(summary: dict, histories: pd.DataFrame, axes) -> None:
    torque, angle, tip = axes
    histories[["torque_n_m", "rigid_torque_n_m"]].plot(ax=torque, ylabel="torque [N m]")
    histories[["hub_angle_rad", "rigid_hub_angle_rad"]].plot(ax=angle, ylabel="angle [rad]")
    histories["tip_displacement_m"].plot(ax=tip, ylabel="tip [m]")
    motion, results = summary["motion"], summary["results"]
    for axis in axes:
        # The torque acts while the tip rests: before the motion and after it.
        moves_from, moves_until = motion["moves_from_s"], motion["moves_until_s"]
        axis.axvspan(moves_from - results["lead_s"], moves_from, alpha=0.15)
        axis.axvspan(moves_until, moves_until + results["lag_s"], alpha=0.15)
        axis.set_xlim(moves_from - 2 * results["lead_s"], moves_until + 2 * results["lag_s"])
        axis.set_xlabel("time [s]")
    torque.set_title(summary["title"])


def plot_sweep(table: pd.DataFrame, axis) -> None:
    if "torque_ratio" not in table:
        raise SystemExit("the sweep has no column torque_ratio: a sweep with --torque has none")
    varied = table.columns[0]
    failed = table["error"].notna()
    table[~failed].plot(x=varied, y=["torque_ratio"], ax=axis, ylabel="peak torque over rigid")
    axis.set_xscale("log")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="result folder of flexlink solve")
    parser.add_argument("--sweep", type=Path, help="table of flexlink sweep")
    parser.add_argument("-o", "--output", type=Path, default=Path("figure.png"))
    arguments = parser.parse_args()

    rows = 4 if arguments.sweep else 3
    figure, axes = plt.subplots(rows, figsize=(7, 2.6 * rows), layout="constrained")
    summary, histories = read_results(arguments.folder)
    plot_results(summary, histories, axes[:3])
    if arguments.sweep:
        plot_sweep(pd.read_csv(arguments.sweep), axes[3])
    figure.savefig(arguments.output, dpi=150)

    peak = histories["torque_n_m"].abs().max()
    print(f"{len(histories)} rows, peak torque {peak:.4g} N m, plotted in {arguments.output}")


if __name__ == "__main__":
    main()
