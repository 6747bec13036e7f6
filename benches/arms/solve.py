#!/usr/bin/env python3
"""What `flexlink solve` does for an arm of two links, in numpy: the torques that make its tip follow a path.

    python3 solve.py ARM.toml PATH.csv LEVEL SAMPLES FIRST ROWS FOLDER

LEVEL is none (linear) or full (all second-order terms). Of the SAMPLES of the period, ROWS from row FIRST on
are written, to flexlink's tables. Prints the error of the mesh of each torque over its range (its peak where
nothing has weight) and, last, the time of the torques alone: on the given mesh, without start, reading and
writing.

For uniform links with masses on their ends and Rayleigh's beta.
"""

import sys
import time
import tomllib
from pathlib import Path

import numpy as np

from arm import Arm
from chords import band_limited, reach, returned
from link import Link
from tables import histories, write

# Largest error of the tip over its way.
TIP_TOLERANCE = 1e-6
# Error of a mesh over the change by halved elements: it falls with the fourth power of their length.
ERROR_PER_CHANGE = 16 / 15


def read(file):
    """Links and gravity."""
    arm = tomllib.loads(Path(file).read_text())
    links = []
    for own in arm["links"]:
        [segment] = own["segments"]
        end = own.get("tip") or own["payload"]
        uniform = segment["length"], segment["EI"], segment["mass_per_length"]
        links.append(Link(*uniform, end["mass"], own["damping"]["beta"], segment["elements"]))
    return links, np.array(arm["gravity"])


def solved(links, gravity, rows, step, samples, level):
    """The arm, its answer with the torques at all samples, and the chords of the rigid arm."""
    lengths = np.array([[link.length, 0, 0] for link in links])[:, :, None]
    tip = band_limited(rows, step, samples, TIP_TOLERANCE)
    rigid = reach(tip, lengths + np.zeros((1, 1, samples)))
    arm = Arm(links, gravity, returned(rigid, rows.shape[1]), step)
    answer = arm.solved(level)
    return arm, answer, arm.to_all(answer.torques), rigid


def mesh_error(arm, level, torques, rows):
    """Of each torque over its range, or over its peak where nothing has weight."""
    finer = arm.refined()
    change = finer.to_all(finer.solved(level).torques) - torques
    size = np.ptp if arm.gravity.any() else lambda own, axis: np.max(np.abs(own), axis)
    return ERROR_PER_CHANGE * np.max(np.abs(change[:, rows]), axis=1) / size(torques[:, rows], axis=1)


def main(arm, path, level, samples, first, rows, folder):
    links, gravity = read(arm)
    time_s, *path = np.loadtxt(path, delimiter=",", skiprows=1).T
    step = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    begin = time.perf_counter()
    arm, answer, torques, rigid = solved(links, gravity, np.array(path), step, int(samples), level)
    taken = time.perf_counter() - begin
    rows = int(first) + np.arange(int(rows))
    time_s, rows = time_s[0] + step * rows, rows % int(samples)
    print(*mesh_error(arm, level, torques, rows))
    write(Path(folder), time_s, rows, histories(arm, answer, torques, rigid), links)
    print(taken)


if __name__ == "__main__":
    main(*sys.argv[1:])
