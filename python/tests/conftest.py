"""The repository's files, and the command that was installed with the module."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LINK = ROOT / "specs/bayo1987_example1.toml"
MOTION = ROOT / "trajectories/sine_0.88s.csv"

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def command(tmp_path: Path) -> Command:
    """Runs the command in the folder of the test."""
    script = Path(sys.executable).with_name("flexlink")

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        words = [str(script), *map(str, arguments)]
        return subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)

    return run


def files(folder: Path) -> dict[str, bytes]:
    """Bytes of all files of a folder by name."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}
