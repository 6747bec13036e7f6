"""The examples in the docs."""

from __future__ import annotations

import doctest

import flexlink
from flexlink import _flexlink

from conftest import ROOT


def test_examples_in_docstrings() -> None:
    for module, least in [(flexlink, 5), (_flexlink, 20)]:
        results = doctest.testmod(module)
        assert results.failed == 0
        assert results.attempted >= least, module


def test_examples_in_the_book() -> None:
    results = doctest.testfile(str(ROOT / "docs/python.md"), module_relative=False)
    assert results.failed == 0
    assert results.attempted >= 10
