"""Messages and hints in words of a call."""

from __future__ import annotations

import ast
import re

import pytest

from flexlink import _flexlink

from conftest import ROOT

HINTS = [
    ("--skip N leaves out lines above the names", "skip=N leaves out lines above the names"),
    ("use --decimal point if so", 'use decimal="point" if so'),
    ("write it like --via 0.5,0.2", "write it like via=(0.5, 0.2)"),
    ("--play feedback needs --feedback KP,KD", 'play="feedback" needs feedback=(KP, KD)'),
    ("add it: --set start_angle=0", 'add it: link.changed({"start_angle": 0})'),
    (
        "--set 'gravity=[0, 0]' is a horizontal plane",
        'link.changed({"gravity": [0, 0]}) is a horizontal plane',
    ),
    ("--set 'a={b = 1, c=\"x\"}'", 'link.changed({"a": {"b": 1, "c": "x"}})'),
    ("start elsewhere with --set", "start elsewhere with link.changed"),
    ("use --at '30 deg,75 deg', or", "use at=[0.52, 1.31], or"),
    ("say --uncertain 'segments.*.EI*=±5%'", 'say uncertain="segments.*.EI*=±5%"'),
    ("or let --drop-outliers replace it", "or let drop_outliers=True replace it"),
    ("lower --to, or --from 0.5 --to 3", "lower to, or start=0.5 to=3"),
    ("compute them with modes --at ANGLE", "compute them with modes(link, at=ANGLE)"),
    ("`flexlink help files` and `flexlink modes`", "`flexlink help files` and `flexlink.modes`"),
    (
        "use --with position,velocity, or --form halstreamer",
        'use quantities=["position", "velocity"], or form="halstreamer"',
    ),
    ("use finer counts or a shorter --cycle TIME", "use finer counts or a shorter cycle=TIME"),
    (
        "LINK, a TOML file, comes before MOTION or TORQUE",
        "the link, a TOML file, comes first",
    ),
    ("--columns time=1,torque=2 names them", 'columns="time=1,torque=2" names them'),
]


@pytest.mark.parametrize("hint", HINTS, ids=lambda hint: hint[0])
def test_a_hint_names_what_a_call_can_do(hint: tuple[str, str]) -> None:
    assert _flexlink.wording(hint[0])[1] == hint[1]


def test_a_message_names_the_change() -> None:
    message, _ = _flexlink.wording("--set 'hub.x=1': unknown key")
    assert message == "the change 'hub.x=1': unknown key"


def test_a_word_for_an_argument_is_renamed_but_no_name_of_a_file() -> None:
    texts = [
        ("peak: 1 in EXPECTED, 2 in ACTUAL", "peak: 1 in expected, 2 in actual"),
        ("tolerances.toml of EXPECTED.", "tolerances.toml of expected."),
        ("PROFILE = best, but needs --link", "profile = best, but needs link"),
    ]
    for text, expected in texts:
        assert _flexlink.wording(text)[0] == expected
    names = ["ACTUAL.csv", "runs/EXPECTED/torque.csv", "C:\\ACTUAL", "PROFILE_2", "MY-PROFILE"]
    for name in [*names, "ACTUAL"]:
        assert _flexlink.wording(f"{name}: cannot read")[0] == f"{name}: cannot read"


# Options that no call has: their commands have other forms in Python.
OF_THE_COMMAND = {"json", "output", "repeat", "shard", "vary"}


def keywords() -> set[str]:
    """All keywords and methods in the hints of the module's types."""
    names: set[str] = set()
    for file in ("_flexlink.pyi", "_files.py"):
        text = (ROOT / "python/flexlink" / file).read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                names.add(node.target.id)
            elif isinstance(node, ast.FunctionDef):
                names |= {node.name, *(own.arg for own in node.args.args + node.args.kwonlyargs)}
    return names


def test_options_in_refusals_are_keywords_of_a_call() -> None:
    known, named = keywords(), 0
    for path in (ROOT / "tests/refusals").glob("*.t*"):
        for line in path.read_text(encoding="utf-8").splitlines():
            message = re.match("(error|hint|warning|remark|note|>>>):? (.*)", line)
            if not message:
                continue
            kind, text = message.groups()
            worded = _flexlink.wording(text)[kind == "hint"]
            assert not re.search(r"(^|[ '`(])--[a-z]", worded), worded
            for option in re.findall(r"(?:^|[ `(])--([a-z][a-z-]*)", text):
                named += 1
                keyword = option.replace("-", "_")
                keyword = {"from": "start", "with": "quantities"}.get(keyword, keyword)
                assert keyword in known | OF_THE_COMMAND, (option, line)
                assert keyword == "set" or re.search(rf"\b{keyword}\b", worded), worded
    assert named > 300
