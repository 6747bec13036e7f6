"""Data frames."""

from __future__ import annotations

from typing import Any


def frame(result: Any, names: str) -> Any:
    """Histories of a result as a `pandas.DataFrame` over its time.

    ``torque`` of several joints becomes ``torque1``, ``torque2``, …, the place of a tip ``tip_x``, ``tip_y``. Names that
    the result lacks are left out.
    """
    import pandas

    columns: dict[str, Any] = {}
    for name in names.split():
        array = getattr(result, name, None)
        if array is None:
            continue
        if array.ndim == 1:
            columns[name] = array
            continue
        numbers = "_x _y".split() if name == "tip" else map(str, range(1, array.shape[1] + 1))
        columns |= {f"{name}{number}": column for number, column in zip(numbers, array.T)}
    return pandas.DataFrame(columns, index=pandas.Index(result.time, name="time"))
