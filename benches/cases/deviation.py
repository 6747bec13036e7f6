"""Largest deviations of one table, or folder of tables, from another, over the peak of each column;
of the displacements of nodes, over that of all nodes: python deviation.py OURS THEIRS.

Prints two, and where each is: of the columns that follow from the torque, and of those that hold the
hub's motion, from which flexlink takes a slow tail that the scripts leave in, or peaks, which it finds
between the samples, too. Columns that only one of
the tables has are left out.
"""

import sys
from pathlib import Path

import numpy as np
import polars as pl


def deviations(ours, theirs):
    ours, theirs = (
        pl.read_csv(p, infer_schema_length=10_000, ignore_errors=True) for p in (ours, theirs)
    )
    if len(ours) != len(theirs):
        raise SystemExit(f"{len(ours)} rows and {len(theirs)}")
    names = [n for n in ours.columns if n in theirs.columns and ours[n].dtype.is_numeric()]
    peak = {n: max(abs(ours[n].max()), abs(ours[n].min())) for n in names}
    nodes = [n for n in names if n[0] == "v" and n.endswith("_m") and n[1:-2].isdigit()]
    peak |= dict.fromkeys(nodes, max((peak[n] for n in nodes), default=0))
    for name in names:
        worst = np.abs(ours[name].to_numpy() - theirs[name].to_numpy()).max()
        yield float(worst / peak[name]) if peak[name] else float(worst > 0), name


def has_tail(name):
    words = ("hub", "power", "deflection", "peak", "ratio", "lead", "lag", "rms")
    return any(word in name for word in words) or (name[0] == "v" and name[1].isdigit())


ours, theirs = map(Path, sys.argv[1:3])
if ours.is_dir():
    both = sorted({p.name for p in ours.glob("*.csv")} & {p.name for p in theirs.glob("*.csv")})
    found = [(*found, n) for n in both for found in deviations(ours / n, theirs / n)]
else:
    found = [(*found, ours.name) for found in deviations(ours, theirs)]
for tail in (False, True):
    print(*max(((0.0, "none", "none"), *(f for f in found if has_tail(f[1]) == tail))))
