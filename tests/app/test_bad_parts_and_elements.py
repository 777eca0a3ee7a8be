"""Wrong parts, catalogues, sheets and elements: each is told with its place and kind, and where it is used."""

import pytest
from support.faults import told_places

from torsionnet.app.cli import main

THROW = """  throw:
    ports: [front, rear]
    parameters: {J: 1}
    elements:
      mass: {type: inertia, node: front, inertia: J}
      shaft: {type: spring, nodes: [front, rear], stiffness: 40}
"""
FLY = "elements: {fly: {type: inertia, node: a, inertia: 3}}\n"
ENDS = "  e: {type: inertia, node: a, inertia: 3}\n  w: {type: inertia, node: b, inertia: 3}\n"
CLUTCH = "c: {type: clutch, nodes: [a, b], friction: [[0 rad/s, 0.36], [10 rad/s, 0.34]], clamp_torque: 800"
FILES = {
    "couplings.csv": "size;stiffness [kN*m/rad]\nA350;11,2\nA630;20,2\n",
    "mixed.csv": "mass;J [kg*m^2];k [kN*m/rad]\na;1;40\nb;2;36 N*m/rad\nc;3;\n",
    "bare.csv": "mass;J;k [N*m/rad]\na;1;40\nb;2;\n",
    "throw.yaml": "torsionnet: 1\nports: [front]\nelements: {mass: {type: inertia, node: front, inertia: 1}}\n",
}
BROKEN = {
    "a part that contains itself": (
        f"parts:\n{THROW}    use: {{again: {{part: throw, at: {{front: front, rear: rear}}}}}}\n{FLY}"
        "use: {cyl: {part: throw, at: {front: a, rear: b}}}\n",
        ["model.yaml:9:25 circular-definition", "model.yaml:11:7 used here"],
    ),
    "an unconnected port": (
        f"parts:\n{THROW}{FLY}use:\n  cyl: {{part: throw, at: {{rear: a}}}}\n",
        ["model.yaml:11:22 missing-entry", "model.yaml:4:5 defined here"],
    ),
    "a port that is no node of the part": (
        f"parts:\n{THROW.replace('rear]', 'rearr]', 1)}{FLY}use:\n  cyl: {{part: throw, at: {{front: b, rearr: a}}}}\n",
        ["model.yaml:4:20 unknown-node", "model.yaml:11:3 used here"],
    ),
    "a port that the part does not have": (
        f"parts:\n{THROW}{FLY}use:\n  cyl: {{part: throw, at: {{front: b, rear: a, flange: a}}}}\n",
        ["model.yaml:11:46 unknown-port", "model.yaml:4:5 defined here"],
    ),
    "an unconnected port of a part in a part": (
        f"parts:\n{THROW}  row:\n    ports: [p]\n    use: {{one: {{part: throw, at: {{front: p}}}}}}\n{FLY}"
        "use:\n  cyl: {part: row, at: {p: a}}\n",
        ["model.yaml:11:30 missing-entry", "model.yaml:14:3 used here", "model.yaml:4:5 defined here"],
    ),
    "two parts of one name": (
        f"parts:\n{THROW}{THROW}{FLY}use: {{cyl: {{part: throw, at: {{front: b, rear: a}}}}}}\n",
        ["model.yaml:9:3 repeated-name"],
    ),
    "two parts of one name in two files": (
        f"include: [throw.yaml]\nparts:\n{THROW}{FLY}use: {{cyl: {{part: throw, at: {{front: b, rear: a}}}}}}\n",
        ["throw.yaml:1:1 repeated-name"],
    ),
    "an index out of range": (
        f"parts:\n{THROW}{FLY}use:\n  cyl: {{part: throw, repeat: 3, chain: [front, rear], at: {{front: c, rear: a}}}}\n"
        "sensors: {T: {torque: cyl4.shaft}}\n",
        ["model.yaml:12:23 unknown-element"],
    ),
    "a list that is too short": (
        f"parts:\n{THROW}{FLY}use:\n  cyl: {{part: throw, repeat: 3, chain: [front, rear], at: {{front: c, rear: a}}, "
        "parameters: {J: [1, 2]}}\n",
        ["model.yaml:11:96 wrong-count"],
    ),
    "an include outside the folder": (
        f"include: [../throw.yaml]\n{FLY}",
        ["model.yaml:2:11 forbidden-file"],
    ),
    "a size that the catalogue does not have": (
        f"elements:\n{ENDS}  c: {{type: spring, nodes: [a, b], catalogue: couplings.csv, size: A351}}\n",
        ["model.yaml:5:68 unknown-name"],
    ),
    "a sheet with mixed units": (
        "elements: {engine: {type: mass_elastic, table: mixed.csv}}\n",
        ["model.yaml:2:48 unreadable-file", "mixed.csv:3:5 wrong-unit"],
    ),
    "a sheet without units": (
        "elements: {engine: {type: mass_elastic, table: bare.csv}}\n",
        ["bare.csv:1:6 missing-unit", "model.yaml:2:48 unreadable-file"],
    ),
    "a ratio set without the engaged gear": (
        f"elements:\n{ENDS}  box: {{type: gearbox, input: a, output: b, ratios: {{I: 3, II: 2}}}}\n",
        ["model.yaml:5:3 missing-entry"],
    ),
    "a gear that is not in the set": (
        f"elements:\n{ENDS}  box: {{type: gearbox, input: a, output: b, engaged: I, ratios: {{I: 3, II: 2}}}}\n"
        "configurations: {gear: {six: {box.engaged: VI}}}\n",
        ["model.yaml:6:44 unknown-name"],
    ),
    "a slipping clutch at slip 0": (
        f"elements:\n{ENDS}  {CLUTCH}, state: slipping, slip_speed: 0}}\n",
        ["model.yaml:5:131 contradicting-values"],
    ),
    "a clutch in a part that slips in a configuration": (
        f"parts:\n  side:\n    ports: [a, b]\n    elements:\n      {CLUTCH}}}\nelements:\n{ENDS}"
        "use: {left: {part: side, at: {a: a, b: b}}}\nconfigurations: {x: {slip: {left.c.state: slipping, left.c.slip_speed: 0}}}\n",
        ["model.yaml:11:72 contradicting-values"],
    ),
}
UNSTABLE = """torsionnet: 1
parts:
  governed:
    ports: [a, b]
    elements:
      s: {type: spring, nodes: [a, b], stiffness: 100}
      g: {type: controller, sense: {velocity: a}, act: a, law: 4, delay: 10 ms}
elements:
  e: {type: inertia, node: a, inertia: 3}
  w: {type: inertia, node: b, inertia: 3}
use: {unit: {part: governed, at: {a: a, b: b}}}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def checked(folder, text, capsys):
    (folder / "model.yaml").write_text(text, encoding="utf-8")
    code = main(["check", "model.yaml"])
    out = capsys.readouterr().out
    return code, out


@pytest.mark.parametrize("case", BROKEN)
def test_it_is_told_with_its_place_and_where_it_is_used(folder, capsys, case):
    text, places = BROKEN[case]
    code, out = checked(folder, f"torsionnet: 1\n{text}", capsys)
    assert code == 1
    assert told_places(out) == places


def test_a_controller_that_drives_a_mode_is_named_where_it_stands_and_where_it_is_used(folder, capsys):
    """It is a warning: the model can be calculated, and its modes tell how fast what grows."""
    code, out = checked(folder, UNSTABLE, capsys)
    assert code == 0
    assert "model.yaml:7:7: warning: g makes the mode at 1.2" in out
    assert "model.yaml:11:7: used here" in out


def test_stages_that_are_no_list_are_told_how_to_write_them(folder, capsys):
    flywheel = (
        "{type: dual_mass_flywheel, nodes: [a, b], "
        "primary_inertia: 1, secondary_inertia: 1, torque: 9, stages: {0 deg: 5, 9 deg: 8}}"
    )
    code, out = checked(folder, f"torsionnet: 1\nelements:\n{ENDS}  dmf: {flywheel}\n", capsys)
    assert code == 1
    assert "stages as [{stiffness:" in out


def test_a_list_of_stages_is_shown_in_words(folder, capsys):
    flywheel = "{type: dual_mass_flywheel, nodes: [a, b], primary_inertia: 1, secondary_inertia: 1, torque: 9, stages: [{stiffness: 5, to: 4 deg}, {stiffness: 8}]}"
    (folder / "model.yaml").write_text(f"torsionnet: 1\nelements:\n{ENDS}  dmf: {flywheel}\n", encoding="utf-8")
    assert main(["show", "model.yaml"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "'stiffness'" not in shown
    assert "stages 1.stiffness 5 N*m/rad; stages 1.to 4 deg" in shown
