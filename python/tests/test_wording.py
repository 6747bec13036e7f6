"""Messages and hints in words of a call."""

from __future__ import annotations

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
    ("--columns time=1,torque=2 names them", 'columns="time=1,torque=2" names them'),
]


@pytest.mark.parametrize("hint", HINTS, ids=lambda hint: hint[0])
def test_a_hint_names_what_a_call_can_do(hint: tuple[str, str]) -> None:
    assert _flexlink.wording(hint[0])[1] == hint[1]


def test_a_message_names_the_change() -> None:
    message, _ = _flexlink.wording("--set 'hub.x=1': unknown key")
    assert message == "the change 'hub.x=1': unknown key"


def test_no_text_of_the_program_keeps_an_option_in_a_call() -> None:
    texts = []
    for path in (ROOT / "src").rglob("*.rs"):
        code = re.sub(r"(?m)^\s*//.*$", "", path.read_text(encoding="utf-8"))
        texts += re.findall(r'"((?:[^"\\]|\\.)*--[a-z](?:[^"\\]|\\.)*)"', code)
    texts = [text for text in texts if " " in text and "\\\n" not in text]
    assert len(texts) > 100
    kept = [text for text in texts if re.search(r"(^|[ '`(])--[a-z]", " ".join(_flexlink.wording(text)))]
    assert not kept
