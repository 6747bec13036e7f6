"""The examples in the docs under mypy --strict, as a user would run it."""

from __future__ import annotations

import doctest
import subprocess
import sys
from pathlib import Path

import pytest

import flexlink
from flexlink import _files, _flexlink


def test_examples_in_docstrings_pass_strict(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    finder, sources = doctest.DocTestFinder(), []
    for module in (flexlink, _flexlink, _files):
        sources += [own.docstring or "" for own in finder.find(module) if own.examples]
    # One module of functions: each docstring has its own names.
    lines = ["from __future__ import annotations"]
    for number, source in enumerate(sources):
        lines.append(f"def example_{number}() -> None:")
        for example in doctest.DocTestParser().get_examples(source):
            lines += ["    " + line for line in example.source.splitlines()]
    path = tmp_path / "examples.py"
    path.write_text("\n".join(lines) + "\n")
    words = [sys.executable, "-m", "mypy", "--strict", str(path)]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len(sources) >= 12, done.stdout + done.stderr
