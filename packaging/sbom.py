#!/usr/bin/env python3
"""Writes the bill of materials of a release: every crate that it is built from, with its checksum.

    python3 packaging/sbom.py TARGET FOLDER
    python3 packaging/sbom.py x86_64-unknown-linux-gnu dist

writes FOLDER/flexlink-VERSION-TARGET.cdx.json (CycloneDX 1.5) by cargo-cyclonedx, and prints its
path. Same sources, same bytes: for the time SOURCE_DATE_EPOCH (default: 1980), no path of this
machine. Exit code 1 where a crate that is linked into the program is not in it.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

from archive import FIRST_TIME_OF_ZIP
from third_party import linked

ROOT = Path(__file__).resolve().parent.parent
# The name that cargo-cyclonedx gives it.
WRITTEN = ROOT / "flexlink_bin.cdx.json"


def bill(target):
    """What cargo-cyclonedx says of the program; it writes beside Cargo.toml alone."""
    command = ["cargo", "cyclonedx", "--quiet", "--format=json", "--spec-version=1.5"]
    command += ["--describe=binaries", f"--target={target}"]
    times = {"SOURCE_DATE_EPOCH": str(FIRST_TIME_OF_ZIP), **os.environ}
    subprocess.run(command, cwd=ROOT, env=times, check=True)
    text = WRITTEN.read_text(encoding="utf-8")
    WRITTEN.unlink()
    return text.replace(ROOT.as_uri(), "file://.")


def main(target, folder):
    text = bill(target)
    content = json.loads(text)
    listed = {(part["name"], part["version"]) for part in content["components"]}
    for package in linked(ROOT, target):
        if (package["name"], package["version"]) not in listed:
            sys.exit(f"{package['name']} {package['version']} is not in the bill of materials")
    version = content["metadata"]["component"]["version"]
    path = Path(folder) / f"flexlink-{version}-{target}.cdx.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    print(path.as_posix())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
