#!/usr/bin/env python3
"""Installs a wheel in an empty environment and uses it as its reader would.

    python3 packaging/check_wheel.py WHEEL

The wheel must hold the licence texts of its crates and of the font. pip may take wheels alone, so that nothing is
compiled. The command and the module must solve one motion to the same torque. Prints the seconds of the installation.
"""

import os
import subprocess
import sys
import tempfile
import time
import venv
import zipfile
from pathlib import Path

SOLVE = """
import csv, flexlink
solution = flexlink.solve(flexlink.Link.read("link/link.toml"), "link/motion.csv")
rows = list(csv.DictReader(open("out/torque.csv")))
peak = max(abs(float(row["torque_n_m"])) for row in rows)
assert abs(max(abs(solution.torque)) / peak - 1) < 1e-9, peak
print(f"peak {peak:.4g} N m")
"""


def holds_licences(wheel):
    """The texts of flexlink, of linked crates, and of the letters in figures."""
    with zipfile.ZipFile(wheel) as archive:
        texts = {name.rsplit("/", 1)[-1]: name for name in archive.namelist() if ".dist-info/" in name}
        for name in ("LICENSE-MIT", "LICENSE-APACHE", "LICENSES-THIRD-PARTY"):
            if name not in texts:
                sys.exit(f"{name} is not in {wheel.name}")
        others = archive.read(texts["LICENSES-THIRD-PARTY"]).decode()
    for word in ("\npyo3 ", "\nclap ", "DejaVu", "Permission is hereby granted"):
        if word not in others:
            sys.exit(f"LICENSES-THIRD-PARTY in {wheel.name} lacks {word.strip()!r}")


def main(wheel):
    wheel = Path(wheel).resolve()
    holds_licences(wheel)
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        venv.create(Path(folder) / "venv", with_pip=True)
        made = time.monotonic()
        binaries = Path(folder) / "venv" / ("Scripts" if os.name == "nt" else "bin")

        def run(program, *arguments):
            command = [binaries / program, *arguments]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8")
            if done.returncode != 0:
                sys.exit(f"{program} {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
            return done.stdout

        run("python", "-m", "pip", "install", "--quiet", "--only-binary", ":all:", wheel)
        installed = time.monotonic()
        version = run("flexlink", "--version").split()[1]
        if not wheel.name.startswith(f"flexlink-{version}-"):
            sys.exit(f"{wheel.name} holds version {version}")
        run("flexlink", "init", "link")
        run("flexlink", "solve", "link/link.toml", "link/motion.csv", "-o", "out", "--quiet")
        peak = run("python", "-c", SOLVE).strip()
        seconds = f"{made - begun:.1f} s for the environment, {installed - made:.1f} s for the wheel and NumPy"
        print(f"{wheel.name}: installed ({seconds}), the command and the module solve: {peak}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
