"""What texts of a file cannot do to the terminal that shows them."""

import re

import pytest
from click.testing import CliRunner

from torsionnet.app.cli.app import app

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
MODEL = r"""
torsionnet: 1
name: "title\e]0;owned\a\u202egnp"
source: "paper\e[2J\u2066x"
description: "long\e[31m\rred\u009b"
parameters:
  k: {value: 10, description: "soft\e[1m\u202e"}
elements:
  disc: {type: inertia, node: a, inertia: 1, description: "heavy\a\b"}
  s: {type: spring, nodes: [a, ground], stiffness: k}
sensors: {x: {angle: a}}
inputs: {T: {torque: a}}
configurations: {"g\e[3m": {k: 20}}
"""
COMMANDS = {
    "check": ["check"],
    "show": ["show"],
    "modes": ["modes", "-c", "all"],
    "frf": ["frf", "--output", "x", "--input", "T", "-c", "all"],
    "sensitivity": ["sensitivity"],
    "json": ["modes", "--json"],
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_names_and_descriptions_are_shown_escaped(words, tmp_path):
    (tmp_path / "m.yaml").write_text(MODEL, encoding="utf-8")
    result = CliRunner().invoke(app, [*words, str(tmp_path / "m.yaml")])
    assert result.exit_code == 0, result.stderr
    assert not STEERING.findall(result.stdout + result.stderr)
    assert words == ["check"] or "\\" in result.stdout


def test_excerpts_of_wrong_files_are_escaped_and_keep_their_mark(tmp_path):
    (tmp_path / "m.yaml").write_text(MODEL.replace("stiffness: k", "\u2066stiffnes: k"), encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(tmp_path / "m.yaml")])
    assert result.exit_code == 1
    assert not STEERING.findall(result.stdout + result.stderr)
    lines = result.stdout.splitlines()
    place = next(number for number, line in enumerate(lines) if "^" in line)
    marked = slice(lines[place].index("^"), lines[place].rindex("^") + 1)
    assert lines[place - 1][marked].endswith("stiffnes")
