"""The licence texts of what is linked into the program: they ask to go where the program goes.

    python3 packaging/third_party.py TARGET

prints those of the Python module.
"""

import json
import subprocess
import sys
from pathlib import Path

HEAD = """\
flexlink is under MIT or Apache-2.0, at your choice. Linked into it are the crates below, each with
its licence as it came, and the standard library of Rust (MIT or Apache-2.0, The Rust Project
contributors).
"""
# On Linux alone the program is linked with it statically.
LIBC = """\
So is the GNU C library (LGPL-2.1 or later); the sources of flexlink with their Cargo.lock are what
it takes to link with another version of it.
"""
# Inside the program for `flexlink report --png`.
FONT_LICENCE = "src/page/font/LICENSE"


def linked(root, target, manifest="Cargo.toml"):
    """Packages that are compiled for the target and end up in the program, by name and version."""
    command = ["cargo", "metadata", "--locked", "--format-version=1", "--filter-platform", target]
    command += ["--manifest-path", manifest]
    answer = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, check=True).stdout
    metadata = json.loads(answer)
    packages = {package["id"]: package for package in metadata["packages"]}
    uses = {node["id"]: node["deps"] for node in metadata["resolve"]["nodes"]}
    found, waiting = {}, [metadata["resolve"]["root"]]
    while waiting:
        for dependency in uses[waiting.pop()]:
            package = packages[dependency["pkg"]]
            normal = any(kind["kind"] is None for kind in dependency["dep_kinds"])
            macro = any("proc-macro" in kind for kind in (t["kind"] for t in package["targets"]))
            if normal and not macro and package["id"] not in found:
                found[package["id"]] = package
                waiting.append(package["id"])
    # The module is linked with flexlink itself, which has no source elsewhere.
    others = [package for package in found.values() if package["source"]]
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def texts(package):
    """Licence files that lie in the package."""
    words = ("license", "licence", "copying", "notice")
    folder = Path(package["manifest_path"]).parent
    files = [path for path in sorted(folder.iterdir()) if path.name.lower().startswith(words)]
    return [path.read_text("utf-8").strip() for path in files if path.is_file()]


def licences(root, target, manifest="Cargo.toml"):
    """Every crate by name, then every text once, with the crates that it came with."""
    packages = linked(root, target, manifest)
    is_static = manifest == "Cargo.toml" and "linux-gnu" in target
    lines = [HEAD + (LIBC if is_static else "")]
    users = {}
    for package in packages:
        name = f"{package['name']} {package['version']}"
        lines.append(f"{name}: {package['license']}")
        for text in texts(package):
            users.setdefault(text, []).append(name)
    font = "DejaVu Sans 2.37, the letters of figures"
    lines.append(font)
    users.setdefault((root / FONT_LICENCE).read_text(encoding="utf-8").strip(), []).append(font)
    for text, names in users.items():
        lines += ["", "=" * 80, ", ".join(names), "=" * 80, "", text]
    return "\n".join(lines).encode() + b"\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    root = Path(__file__).resolve().parent.parent
    sys.stdout.buffer.write(licences(root, sys.argv[1], "python/Cargo.toml"))
