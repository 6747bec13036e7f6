"""`report` and `compare`: commands that read results from files and folders, here also from objects."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from . import _flexlink
from ._messages import FlexlinkError

# Results with a folder, with the keywords of their `write`, and results with a file.
FOLDERS = {
    _flexlink.Solution: {"nodes", "stations", "every", "deflections", "digits", "golden"},
    _flexlink.Simulation: {"nodes", "stations", "every", "digits"},
    _flexlink.Robustness: {"digits"},
}
TABLES = (_flexlink.Learned, _flexlink.SetPoints)


def report(result: Any, *beside: Any) -> _flexlink.Page:
    """The page of a result with all figures, warnings and numbers, as ``flexlink report``.

    ``result`` is a result of :func:`solve`, :func:`simulate`, :func:`robust`, :func:`sweep` or :func:`read`, or the path of
    a folder or of the table of a sweep. Other runs, or other studies of :func:`robust`, may stand ``beside`` it. The page
    has ``html``, ``figures`` as SVG by name, ``png(name)`` and ``write(path)``, and a notebook shows it. Lines of limits
    need the path of the table: the dictionary of a sweep has no limits.

    >>> import flexlink
    >>> strip = {"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}
    >>> link = flexlink.Link(segments=[strip], hub={"inertia": 0.1}, damping={"ratio": 0.02})
    >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.004)
    >>> page = flexlink.report(flexlink.solve(link, **motion))
    >>> page.html.startswith("<!DOCTYPE html>"), page.figures["torque"].startswith("<svg")
    (True, True)
    """
    with _folder() as folder:
        paths = []
        for number, own in enumerate((result, *beside)):
            if isinstance(own, TABLES):
                must = "must be a run, a sweep, or the path of a result"
                raise TypeError(f"result = {type(own)}, but {must}")
            name = "sweep.csv" if isinstance(own, Mapping) else type(own).__name__.lower()
            paths.append(_placed(own, folder / (f"{name} {number + 1}" if beside else name), {}))
        return _flexlink.page_of_files(paths)


def compare(
    expected: Any,
    actual: Any,
    *,
    rtol: float | None = None,
    atol: float | None = None,
    tolerances: str | os.PathLike[str] | None = None,
    common_rows: bool = False,
    bless: bool = False,
) -> _flexlink.Comparison:
    """Compares two results column by column, as ``flexlink compare``.

    Each is the path of a folder or of a CSV file, a dictionary of columns, or a result of :func:`solve`, :func:`simulate`,
    :func:`robust`, :func:`learn`, :func:`read` or of ``table``. A number may differ by ``atol`` and ``rtol`` times the peak
    of its column in ``expected``. An object beside a folder counts as the tables that its ``write`` makes with the options
    of the folder's run. ``bless`` makes the files ``expected`` like ``actual``.

    >>> import flexlink, numpy
    >>> time = numpy.linspace(0, 1, 101)
    >>> wave = {"time_s": time, "x_m": numpy.sin(time)}
    >>> flexlink.compare(wave, wave).is_equal
    True
    >>> found = flexlink.compare(wave, wave | {"x_m": 1.001 * numpy.sin(time)})
    >>> [column["column"] for column in found.files[0]["table"]["columns"] if column["outcome"] == "beyond"]
    ['x_m']
    """
    if bless and not isinstance(expected, str | os.PathLike):
        raise TypeError(f"expected = {type(expected)}, but must be a path with bless")
    keywords: dict[str, Any] = {"rtol": rtol, "atol": atol, "tolerances": tolerances}
    with _folder() as folder:
        paths = []
        for side, own, other in (("expected", expected, actual), ("actual", actual, expected)):
            place = folder / side / _name(other)
            place.parent.mkdir()
            path = Path(_placed(own, place, _options(other)))
            # A table of a run against a file of this name.
            inner = path / place.name
            is_object = not isinstance(own, str | os.PathLike)
            paths.append(inner if is_object and inner.is_file() else path)
        return _flexlink.compare_files(*paths, common_rows=common_rows, bless=bless, **keywords)


@contextmanager
def _folder() -> Iterator[Path]:
    """A folder for the files of objects, which errors do not name."""
    with tempfile.TemporaryDirectory(prefix="flexlink-") as folder:
        try:
            yield Path(folder)
        except FlexlinkError as error:
            message = error.message.replace(folder + os.sep, "")
            if message == error.message:
                raise
            raise type(error)(message, error.hint) from None


def _placed(value: Any, path: Path, options: dict[str, Any]) -> str:
    """The path of a result; an object is written to ``path`` with those of the ``options`` that its class has."""
    if isinstance(value, str | os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, _flexlink.Run):
        return str(value.folder)
    if isinstance(value, Mapping):
        _write(value, path)
    elif isinstance(value, TABLES):
        value.write(path, digits="full")
    elif type(value) in FOLDERS:
        known = FOLDERS[type(value)]
        value.write(path, **{name: own for name, own in options.items() if name in known})
    else:
        must = "must be a result of flexlink, or the path of a file or a folder"
        raise TypeError(f"result = {type(value)}, but {must}")
    return str(path)


def _write(columns: Mapping[str, Any], path: Path) -> None:
    """Writes columns as a CSV file with all digits, those of a sweep as in its table."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        table.writerows(map(_field, row) for row in zip(*columns.values(), strict=True))


def _field(value: Any) -> str:
    """A field of a table: a number, a word, the kinds of warnings, or nothing."""
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        return ";".join(value)
    return "" if value is None or value != value else repr(float(value))


def _name(other: Any) -> str:
    """A name for an object, that of the file which is compared with it."""
    if isinstance(other, str | os.PathLike) and not Path(other).is_dir():
        return Path(other).name
    return "table.csv" if isinstance(other, (Mapping, *TABLES)) else "result"


def _options(other: Any) -> dict[str, Any]:
    """The options with which a run was written; all digits beside another object."""
    folder = other.folder if isinstance(other, _flexlink.Run) else other
    if not isinstance(folder, str | os.PathLike):
        return {"digits": "full"}
    folder = Path(folder) if Path(folder).is_dir() else Path(folder).parent
    try:
        record = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    words = iter([*record.get("inputs", {}).get("arguments", []), "--"])
    options: dict[str, Any] = {}
    name = ""
    for word in words:
        if word.startswith("--"):
            name, _, value = word[2:].partition("=")
            options[name.replace("-", "_")] = value or True
        else:
            options[name.replace("-", "_")] = word
    return options
