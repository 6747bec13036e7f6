#!/usr/bin/env python3
"""Times 1000 solves of the paper's example in a loop from Python, `pip install .` first: benches/loop.py

From arrays each time and with a flexlink.Motion, in alternating rounds.
"""

import statistics
import time

import numpy as np

import flexlink
import inputs

SOLVES, ROUNDS = 1000, 5


def taken(link, motion, **columns):
    start = time.perf_counter()
    for _ in range(SOLVES):
        flexlink.solve(link, motion, **columns)
    return time.perf_counter() - start


def main():
    link = flexlink.Link.read(inputs.ROOT / "specs/bayo1987_example1.toml")
    time_s = np.linspace(0, 0.88, 881)
    acceleration = np.pi / 0.88**2 * np.sin(2 * np.pi * time_s / 0.88)
    motion = flexlink.Motion(time_s, acceleration=acceleration)
    rounds = [
        (taken(link, time_s, acceleration=acceleration), taken(link, motion)) for _ in range(ROUNDS)
    ]
    arrays, read_once = map(statistics.median, zip(*rounds))
    name, cores = inputs.machine()
    print(f"{name}, {cores} cores, median of {ROUNDS}: {SOLVES} solves from arrays {inputs.seconds(arrays)}, ", end="")
    print(f"with a Motion {inputs.seconds(read_once)}")


if __name__ == "__main__":
    main()
