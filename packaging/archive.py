#!/usr/bin/env python3
"""Packs what a release holds, from a program that is already built.

    python3 packaging/archive.py BINARY TARGET FOLDER
    python3 packaging/archive.py target/release/flexlink x86_64-unknown-linux-gnu dist

writes FOLDER/flexlink-VERSION-TARGET.tar.gz, or .zip for Windows, and prints its path. Manual
pages, completions and the version come from the program itself, so it must run here; licences of
what is linked into it come from cargo. Same files, same bytes: names in order, owner 0, and for
every time SOURCE_DATE_EPOCH (default: 1980).
"""

import gzip
import io
import os
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
from pathlib import Path

from third_party import licences

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
]
PATTERNS = [
    "docs/*.md",
    "docs/*.svg",
    "specs/*.toml",
    "specs/arms/*.toml",
    "specs/carriages/*.toml",
    "measurements/*.toml",
    "trajectories/*.csv",
    "trajectories/arms/*.csv",
    "examples/*",
]
COMPLETIONS = {
    "bash": "flexlink.bash",
    "elvish": "flexlink.elv",
    "fish": "flexlink.fish",
    "powershell": "_flexlink.ps1",
    "zsh": "_flexlink",
}
FIRST_TIME_OF_ZIP = 315532800  # 1980-01-01


def printed(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout


def contents(binary, target):
    """Bytes by name, in order."""
    files = {binary.name: binary.read_bytes()}
    for name in DOCUMENTS:
        files[name] = (ROOT / name).read_bytes()
    for pattern in PATTERNS:
        for path in ROOT.glob(pattern):
            files[path.relative_to(ROOT).as_posix()] = path.read_bytes()
    files["LICENSES-THIRD-PARTY"] = licences(ROOT, target)
    for shell, name in COMPLETIONS.items():
        files[f"completions/{name}"] = printed(binary, "completions", shell)
    with tempfile.TemporaryDirectory() as folder:
        printed(binary, "man", "-o", f"{folder}/man1")
        for path in Path(folder, "man1").iterdir():
            files[f"man/man1/{path.name}"] = path.read_bytes()
    return dict(sorted(files.items()))


def write_tar(path, files, seconds):
    # gzip.open and tarfile's own "w:gz" would write the time of day and the file's name.
    with open(path, "wb") as file, gzip.GzipFile("", "wb", 9, file, seconds) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.USTAR_FORMAT) as archive:
            for name, (content, mode) in files.items():
                entry = tarfile.TarInfo(name)
                entry.size, entry.mode, entry.mtime = len(content), mode, seconds
                archive.addfile(entry, io.BytesIO(content))


def write_zip(path, files, seconds):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, (content, mode) in files.items():
            entry = zipfile.ZipInfo(name, time.gmtime(seconds)[:6])
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, mode << 16
            entry.create_system = 3  # Unix, whose mode stands above
            archive.writestr(entry, content)


def main(binary, target, folder):
    binary, folder = Path(binary).resolve(), Path(folder)
    version = printed(binary, "--version").decode().split()[1]
    name = f"flexlink-{version}-{target}"
    files = {
        f"{name}/{inner}": (content, 0o755 if inner == binary.name else 0o644)
        for inner, content in contents(binary, target).items()
    }
    seconds = max(int(os.environ.get("SOURCE_DATE_EPOCH", FIRST_TIME_OF_ZIP)), FIRST_TIME_OF_ZIP)
    folder.mkdir(parents=True, exist_ok=True)
    if "windows" in target:
        write_zip(path := folder / f"{name}.zip", files, seconds)
    else:
        write_tar(path := folder / f"{name}.tar.gz", files, seconds)
    print(path.as_posix())


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
