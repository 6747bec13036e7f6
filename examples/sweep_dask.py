#!/usr/bin/env python3
"""A sweep on a Dask cluster: how the stiffness of a link changes torque, lead and lag.

    python3 examples/sweep_dask.py specs/bayo1987_example1.toml trajectories/sine_0.88s.csv
    python3 examples/sweep_dask.py link.toml move.csv --scheduler tcp://host:8786 -o stiffness.csv

Without --scheduler the cluster is this machine. Needs flexlink for Python, pandas and dask[distributed]; every worker
needs flexlink, but no files: the link goes there with its content, the motion as an array.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from dask.distributed import Client, LocalCluster

import flexlink


def part(link, cases, time, acceleration, threads):
    """The rows of some cases; runs on a worker."""
    return flexlink.sweep(link, cases, time, acceleration=acceleration, threads=threads)


def sweep(client, link, cases, motion, size):
    """The rows of all cases in their order, so many of them a task."""
    time, acceleration = motion["time"].to_numpy(), motion["acceleration"].to_numpy()
    pieces = [cases[k : k + size] for k in range(0, len(cases), size)]
    # A worker has its own threads, and gives each task one of them.
    tasks = [client.submit(part, link, piece, time, acceleration, 1) for piece in pieces]
    return pd.concat([pd.DataFrame(rows) for rows in client.gather(tasks)], ignore_index=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("link", type=Path)
    parser.add_argument("motion", type=Path, help="a table of time and acceleration, in SI")
    parser.add_argument("--scheduler", help="address of a cluster")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("-o", "--output", type=Path, default=Path("stiffness.csv"))
    arguments = parser.parse_args()

    factors = np.geomspace(0.5, 32, arguments.cases)
    cases = [{"segments.*.EI*": factor} for factor in factors]
    link, motion = flexlink.Link.read(arguments.link), pd.read_csv(arguments.motion, comment="#")
    cluster = arguments.scheduler or LocalCluster(dashboard_address=None)
    with Client(cluster) as client:
        table = sweep(client, link, cases, motion, size=10)
    table.to_csv(arguments.output, index=False)
    print(f"{len(table)} cases, {table['error'].notna().sum()} failed, in {arguments.output}")


if __name__ == "__main__":
    main()
