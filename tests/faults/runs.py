"""Runs that faults are injected into, what they must leave, and the checks of it."""

import contextlib
import hashlib
import json
import os
import subprocess
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
TARGET = os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target")
FLEXLINK = str(Path(os.environ.get("FLEXLINK", f"{TARGET}/debug/flexlink")).resolve())
LINK = str(REPOSITORY / "specs/bayo1987_example1.toml")
MOTION = str(REPOSITORY / "trajectories/sine_0.88s.csv")
PATIENCE_S = 100


class Wrong(Exception):
    """Something a fault must not leave behind."""


def require(holds, what):
    if not holds:
        raise Wrong(what)


def solve(kind, folder):
    changes = [["--set", "segments.*.EI*=1"], ["--set", "segments.*.EI*=2", "--moments"]][kind]
    return ["solve", LINK, MOTION, *changes, "-q", "-o", str(folder)]


def sweep(kind, place, *more):
    values = ["1:2:6", "3:4:6"][kind]
    vary = ["--vary", f"segments.*.EI*={values}", "-q", "--every", "20"]
    return ["sweep", LINK, MOTION, *vary, "-o", f"{place}/sweep.csv", "--outputs", f"{place}/cases",
            *more]


def frf(kind, file):
    return ["frf", LINK, "--from", "1", "--to", ["90", "91"][kind], "--points", "20000", "-o", str(file)]


def start(arguments, **more):
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE} | more
    return subprocess.Popen([FLEXLINK, *arguments], stdin=subprocess.DEVNULL, **pipes)


def end(run):
    """Exit code and words; a run that does not end is a fault that was not survived."""
    try:
        words = run.communicate(timeout=PATIENCE_S)[1] or b""
    except subprocess.TimeoutExpired:
        run.kill()
        raise Wrong("does not end") from None
    words = words.decode()
    require("panicked" not in words, f"a panic: {words}")
    return run.returncode, words


def done(arguments):
    code, words = end(start(arguments))
    require(code == 0, f"the next run fails with {code}: {words}")


def files_of(folder):
    """Visible files and hidden ones; none where there is no folder."""
    visible, hidden = {}, []
    with contextlib.suppress(FileNotFoundError):
        for path in sorted(Path(folder).iterdir()):
            if path.name.startswith("."):
                hidden.append(path.name)
            elif path.is_file():
                visible[path.name] = path.read_bytes()
    return visible, hidden


def tables_of(folder):
    """Files without the record of a sweep, which names the folder of its cases."""
    visible, hidden = files_of(folder)
    visible.pop("sweep.json", None)
    return visible, hidden


def check_folder(folder, references, *, hidden_too=False):
    """A folder of one run, or of a part of one without summary.json."""
    visible, hidden = files_of(folder)
    require(not (hidden_too and hidden), f"left in {folder}: {hidden}")
    kinds = [k for k, whole in enumerate(references)
             if all(whole.get(name) == content for name, content in visible.items())]
    require(kinds, f"cut short, or of two runs: {folder}: {sorted(visible)}")
    if "summary.json" in visible:
        require(any(visible == references[k] for k in kinds),
                f"summary.json without all files: {folder}: {sorted(visible)}")


def check_is(folder, whole):
    visible, hidden = files_of(folder)
    require(not hidden, f"left in {folder}: {hidden}")
    require(visible == whole, f"not that of an undisturbed run: {folder}: {sorted(visible)}")


class Solves:
    """Runs of solve into one folder."""

    name = "solve"

    def __init__(self, base):
        self.folder = base / "solved/out"
        self.references = []
        for kind in range(2):
            begun = time.monotonic()
            done(solve(kind, base / f"reference/{kind}"))
            self.duration_s = time.monotonic() - begun
            self.references.append(files_of(base / f"reference/{kind}")[0])

    def arguments(self, kind):
        return solve(kind, self.folder)

    def check(self, kind, *, hidden_too):
        check_folder(self.folder, self.references, hidden_too=hidden_too)

    def next(self, kind, again):
        """The next run, as whoever was disturbed would start it."""
        kind = kind if again else 1 - kind
        done(self.arguments(kind))
        check_is(self.folder, self.references[kind])


class Files:
    """Runs that write one file."""

    name = "frf -o"

    def __init__(self, base):
        self.folder = base / "files"
        self.references = []
        for kind in range(2):
            begun = time.monotonic()
            done(frf(kind, base / f"references/{kind}/frf.csv"))
            self.duration_s = time.monotonic() - begun
            self.references.append(files_of(base / f"references/{kind}")[0])

    def arguments(self, kind):
        return frf(kind, self.folder / "frf.csv")

    check, next = Solves.check, Solves.next


class Sweeps:
    """Sweeps with the files of every case."""

    name = "sweep"

    def __init__(self, base):
        self.folder = base / "swept"
        self.references = []
        for kind in range(2):
            place = base / f"reference/sweep-{kind}"
            begun = time.monotonic()
            done(sweep(kind, place))
            self.duration_s = time.monotonic() - begun
            cases = {path.name: files_of(path)[0] for path in (place / "cases").iterdir()}
            self.references.append((tables_of(place)[0], cases))

    def arguments(self, kind):
        return sweep(kind, self.folder)

    def check(self, kind, *, hidden_too):
        visible, hidden = tables_of(self.folder)
        require(not (hidden_too and hidden), f"left: {hidden}")
        visible.pop("sweep.csv.part", None)
        tables = [table for table, _ in self.references]
        require(not visible or visible in tables, "sweep.csv is cut short")
        for case in self.references[0][1]:
            references = [cases[case] for _, cases in self.references]
            check_folder(self.folder / "cases" / case, references, hidden_too=hidden_too)

    def next(self, kind, again):
        kind = kind if again else 1 - kind
        done(sweep(kind, self.folder, *(["--resume"] if again else [])))
        table, cases = self.references[kind]
        found, hidden = tables_of(self.folder)
        require(found == table and not hidden, f"not that of an undisturbed run: {sorted(found)}")
        record = json.loads((self.folder / "sweep.json").read_bytes())
        require(record["table"]["sha256"] == hashlib.sha256(found["sweep.csv"]).hexdigest(),
                "sweep.json is of another table")
        for case, whole in cases.items():
            check_is(self.folder / "cases" / case, whole)
