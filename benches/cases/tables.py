"""Tables as flexlink writes them: a small one by Python's own %, a large one by polars, or with
TEXT=numpy in the environment by arithmetic on whole columns and a look-up of four digits at a time.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

# numpy is there anyway; polars takes longer to import than this many numbers take to print.
FEW_NUMBERS = 400_000


def rolled_off(spectrum, period, cutoff_hz):
    """Angular frequencies that are solved, and the amplitudes there, by the roll-off that flexlink has:
    a raised cosine over half the cut-off."""
    cutoff = 2 * np.pi * cutoff_hz
    end = min(math.ceil(1.5 * cutoff * period / (2 * np.pi)), len(spectrum) - 1)
    omega = 2 * np.pi * np.arange(1, end) / period
    weight = 0.5 * (1 + np.cos(np.pi * np.maximum(omega / cutoff - 1, 0) / 0.5))
    return omega, weight * spectrum[1:end]


def at_rest(spectrum, period):
    """Velocity and displacement at the first sample of a motion without its mean: the tip rests there."""
    rate = 2j * np.pi * np.arange(1, len(spectrum)) / period
    velocity = spectrum[1:] / rate
    return 2 * velocity.sum().real, 2 * (velocity / rate).sum().real


def decimals(*arrays):
    """The last digit is 1e-10 of the peak."""
    peak = max(max(a.max(), -a.min()) for a in arrays)
    return 10 if peak == 0 else max(0, 10 - math.floor(math.log10(peak)))


def time_decimals(step):
    """Enough for the grid within 1e-12 s."""
    return next(d for d in range(16) if abs(round(step, d) - step) < 1e-18)


def write(path, names, columns, places):
    """Writes columns with their number of decimals, a zero without sign."""
    if sum(len(c) for c in columns) <= FEW_NUMBERS:
        table = np.column_stack([c.round(d) for c, d in zip(columns, places)]) + 0.0
        row = ",".join(f"%.{d}f" for d in places) + "\n"
        with open(path, "w") as file:
            file.write(",".join(names) + "\n")
            file.write(row * len(table) % tuple(table.ravel().tolist()))
        return
    if os.environ.get("TEXT") == "numpy" and all(abs(c).max() < 10 for c in columns):
        return write_by_look_up(path, names, columns, places)
    import polars as pl

    # Whole numbers are printed twice as fast as fractions; polars' decimals have no -0.
    frame = pl.DataFrame(dict(zip(names, columns)))
    frame = frame.with_columns(
        pl.col(name).cast(pl.Decimal(20, d)) for name, d in zip(names, places)
    )
    frame.write_csv(path)


def write_by_look_up(path, names, columns, places):
    """A number is a record of 16 bytes: separator, sign, d.ddd, then eight digits; zero bytes are
    struck out at the end. Columns with fewer decimals lose their last digits to zero bytes, too.
    """
    four = np.array([f"{k:04d}" for k in range(10_000)], dtype="S4")
    head = four.view(np.uint8).reshape(-1, 4)
    lead = np.zeros((20_000, 8), dtype=np.uint8)
    lead[:, 0] = ord(",")
    lead[10_000:, 1] = ord("-")
    lead[:, 3] = ord(".")
    lead[:, 2] = np.tile(head[:, 0], 2)
    lead[:, 4:7] = np.tile(head[:, 1:], (2, 1))
    four, lead = four.view(np.uint32), lead.view(np.uint64).ravel()
    places = np.array(places)
    scale = 10.0**places
    lift = 10 ** (11 - places)
    cut = [(k, 15 + d - 10) for k, d in enumerate(places) if d < 11]
    if min(places) < 3 or max(places) > 11:
        raise ValueError(f"decimals {set(places)}, but must be 3 to 11")
    rows, width = len(columns[0]), len(columns)
    step = max(1, 1 << 15 >> width.bit_length())

    def text(start):
        block = np.array([c[start : start + step] for c in columns]).T
        units = np.rint(block * scale).astype(np.int64)
        if cut:
            units *= lift
        negative = units < 0
        np.abs(units, out=units)
        high = units // 100_000_000
        units -= high * 100_000_000
        middle = units // 10_000
        units -= middle * 10_000
        high += negative * 10_000
        record = np.empty((*units.shape, 2), dtype=np.uint64)
        record[..., 0] = lead[high]
        halves = record.view(np.uint32)
        halves[..., 2] = four[middle]
        halves[..., 3] = four[units]
        letters = record.view(np.uint8)
        for column, end in cut:
            letters[:, column, end:] = 0
        letters[:, 0, 0] = ord("\n")
        return record.tobytes().translate(None, b"\0")

    with open(path, "wb") as file, ThreadPoolExecutor(os.cpu_count()) as pool:
        file.write(",".join(names).encode())
        for block in pool.map(text, range(0, rows, step)):
            file.write(block)
        file.write(b"\n")


def read(path):
    """The columns time and acceleration."""
    with open(path, "rb") as file:
        file.seek(0, 2)
        size = file.tell()
    if size < 1 << 19:
        with open(path) as file:
            rows = file.read().replace("\n", ",").rstrip(",").split(",")[2:]
        table = np.array(rows, dtype=float).reshape(-1, 2)
        return table[:, 0], table[:, 1]
    import polars as pl

    frame = pl.read_csv(path, schema={"time": pl.Float64, "acceleration": pl.Float64})
    return frame["time"].to_numpy(), frame["acceleration"].to_numpy()
