#!/usr/bin/env python3
"""Unpacks a release archive somewhere else and uses it as its reader would.

    python3 packaging/check.py ARCHIVE [--dynamic]

It must hold what it promises and solve an example; on Linux `man` must show every page, and the
program run in an empty root, unless it is said to be --dynamic. Exit code 1 and a line that says what
is wrong, at the first thing that is.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

LINK, MOTION = "specs/bayo1987_example1.toml", "trajectories/sine_0.88s.csv"
NEEDED = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "docs/files.md",
    "docs/growth.svg",
    "docs/torque.svg",
    "docs/waves.svg",
]
NEEDED += ["LICENSES-THIRD-PARTY", "examples/stiffness_sweep.sh", "examples/read_results.py"]
NEEDED += [LINK, MOTION, "man/man1/flexlink.1", "man/man1/flexlink-solve.1"]
COMPLETIONS = ["_flexlink", "_flexlink.ps1", "flexlink.bash", "flexlink.elv", "flexlink.fish"]
NEEDED += [f"completions/{name}" for name in COMPLETIONS]


def run(*command, **options):
    """What the command prints; it must succeed."""
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", **options)
    if done.returncode != 0:
        shown = " ".join(map(str, command))
        sys.exit(f"{shown}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def holds(folder, program):
    """Everything that was promised, nothing empty, a page for every command."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*")}
    for name in [*NEEDED, program.name]:
        if name not in files:
            sys.exit(f"{name} is not in the archive")
    for name, path in files.items():
        if path.is_file() and path.stat().st_size == 0:
            sys.exit(f"{name} is empty")
        mode, wanted = path.stat().st_mode & 0o777, 0o755 if path == program else 0o644
        if os.name == "posix" and path.is_file() and mode != wanted:
            sys.exit(f"{name} has mode {mode:o}, but must have {wanted:o}")
    listed = run(program, "--help").stdout.split("Commands:\n")[1].split("\n\n")[0]
    # Two spaces before a command; more before a line that goes on.
    for command in re.findall(r"^  (\S+)", listed, re.MULTILINE):
        if command != "help" and f"man/man1/flexlink-{command}.1" not in files:
            sys.exit(f"flexlink {command} has no manual page in the archive")


def solves(folder, program):
    run(program, "solve", LINK, MOTION, "-o", "out", "--quiet", cwd=folder)
    torque = (folder / "out" / "torque.csv").read_text()
    if not torque.startswith("time_s,torque_n_m\n"):
        sys.exit("torque.csv has no torque")
    return torque


def pages_are_rendered(folder):
    """By `man` itself, with every warning of its formatter taken for an error."""
    words = {**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80", "MANPAGER": "cat"}
    for page in sorted(folder.glob("man/man1/*.1")):
        shown = run("man", "--warnings", "-l", page, env=words)
        if shown.stderr or "SYNOPSIS" not in shown.stdout:
            sys.exit(f"{page.name}: {shown.stderr or 'no synopsis is shown'}")
    found = run("man", "-M", folder / "man", "flexlink", "solve", env=words).stdout
    if "flexlink-solve" not in found:
        sys.exit("man flexlink solve does not find its page in the archive's folder")


def runs_in_an_empty_root(folder, program, expected):
    """Alone with its two input files: no loader, no libc, no /proc, no /tmp."""
    root = folder / "root"
    root.mkdir()
    for path in [program, folder / LINK, folder / MOTION]:
        shutil.copy(path, root)
    # Only root may enter another root; what is written there stays the caller's.
    enter = ["chroot", f"--userspec={os.geteuid()}:{os.getegid()}", root]
    if os.geteuid() != 0:
        enter.insert(0, "sudo")
    inputs = [f"/{Path(LINK).name}", f"/{Path(MOTION).name}"]
    run(*enter, "/flexlink", "solve", *inputs, "-o", "/out", "--quiet")
    if (root / "out" / "torque.csv").read_text() != expected:
        sys.exit("in an empty root the torque is another")


def main(archive, dynamic):
    with tempfile.TemporaryDirectory() as scratch:
        os.umask(0o022)
        shutil.unpack_archive(archive, scratch)
        [folder] = Path(scratch).iterdir()
        if not Path(archive).name.startswith(f"{folder.name}."):
            sys.exit(f"{archive} unpacks into {folder.name}")
        program = folder / ("flexlink.exe" if "windows" in folder.name else "flexlink")
        version = run(program, "--version").stdout.split()[1]
        if not folder.name.startswith(f"flexlink-{version}-"):
            sys.exit(f"{archive} holds version {version}")
        holds(folder, program)
        torque = solves(folder, program)
        shown = ["unpacks", "is complete", "solves"]
        if sys.platform == "linux":
            pages_are_rendered(folder)
            shown += ["its manual pages are rendered"]
        if sys.platform == "linux" and not dynamic:
            runs_in_an_empty_root(folder, program, torque)
            shown += ["runs in an empty root"]
        print(f"{archive}: {', '.join(shown)}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--dynamic"]):
        sys.exit(__doc__)
    main(sys.argv[1], dynamic=len(sys.argv) == 3)
