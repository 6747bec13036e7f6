"""Largest deviation of one table, or folder of tables, from another, over the peak of its column;
of the displacements of nodes, over that of all nodes: python deviation.py OURS THEIRS.

Prints the worst, and where. Columns that only one of them has are left out.
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


ours, theirs = map(Path, sys.argv[1:3])
if ours.is_dir():
    names = sorted({p.name for p in ours.glob("*.csv")} & {p.name for p in theirs.glob("*.csv")})
    found = max((*max(deviations(ours / n, theirs / n)), n) for n in names)
else:
    found = (*max(deviations(ours, theirs)), ours.name)
print(*found)
