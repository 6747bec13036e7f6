"""The hints of the types: every name, and the examples in the docs under mypy --strict, as a user would run it."""

from __future__ import annotations

import ast
import doctest
import subprocess
import sys
from pathlib import Path

import flexlink
from flexlink import _files, _flexlink

from conftest import ROOT


def test_examples_in_docstrings_pass_strict(tmp_path: Path) -> None:
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


def test_hints_and_classes_have_the_same_names() -> None:
    stub = ast.parse((ROOT / "python/flexlink/_flexlink.pyi").read_text(encoding="utf-8"))
    classes = [own for own in stub.body if isinstance(own, ast.ClassDef) and own.decorator_list]
    assert len(classes) >= 13
    for hinted in classes:
        names = {own.name for own in hinted.body if isinstance(own, ast.FunctionDef)}
        there = set(vars(getattr(flexlink, hinted.name)))
        public = [{name for name in both if not name.startswith("_")} for both in (names, there)]
        assert public[0] == public[1], hinted.name
