"""Files that repeat the version of the program."""

from __future__ import annotations

import re

import yaml

import flexlink

from conftest import ROOT


def test_every_file_has_the_version_of_the_program() -> None:
    program = re.search('(?m)^version = "(.*)"$', (ROOT / "Cargo.toml").read_text("utf-8"))
    assert program and program[1] == flexlink.__version__
    recipe = yaml.safe_load((ROOT / "packaging/conda/recipe.yaml").read_text("utf-8"))
    assert recipe["context"]["version"] == flexlink.__version__
    assert set(recipe["requirements"]) == {"build", "host", "run"} and len(recipe["tests"]) == 2
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert citation["version"] == flexlink.__version__
    assert {"cff-version", "message", "title", "authors", "license"} <= set(citation)
