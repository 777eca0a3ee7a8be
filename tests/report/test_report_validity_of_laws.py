"""The section on validity of a report on a plant with laws of motion says what its elements describe."""

import pytest

from torsionnet.report import make_report

PAIR = """torsionnet: 1
name: pair
elements:
  engine: {type: inertia, node: crank, inertia: 0.15 kg*m^2}
  mesh: {type: gear, nodes: [crank, wheel], ratio: 4, stiffness: 20 kN*m/rad, backlash: 0.5 deg}
  second: {type: gear, nodes: [wheel, hub], ratio: 2, stiffness: 90 kN*m/rad}
  vehicle: {type: inertia, node: hub, inertia: 24 kg*m^2}
operating_point: {torque: {crank: 20 N*m, hub: -160 N*m}}
"""


def said(folder, text, language=""):
    path = folder / "pair.yaml"
    path.write_text(text)
    options = {"language": language} if language else {}
    (section,) = make_report(path, sections=["validity"], date=None, **options).sections
    return ["".join(part for part in item if isinstance(part, str)) if isinstance(item, tuple) else item
            for block in section.blocks for item in block.items]  # fmt: skip


def test_gaps_and_stages_that_are_in_the_model_are_not_said_to_be_missing(tmp_path):
    found = said(tmp_path, PAIR)
    assert found[0] == "Linear: small torsional vibrations about the operating point."
    assert found[1].startswith("Laws of motion (mesh) are linear about the operating point")
    assert any(one.startswith("Gears (second) transmit without play") for one in found)
    assert any(one.startswith("Gears with backlash (mesh)") for one in found)


def test_a_linear_plant_has_its_sentence(tmp_path):
    found = said(tmp_path, PAIR.replace(", backlash: 0.5 deg", ""))
    assert found[0].startswith("Linear: small torsional vibrations about the operating point. Backlash, clearances,")
    assert any(one.startswith("Gears (mesh, second) transmit without play") for one in found)


@pytest.mark.parametrize("word", ["Bewegungsgesetze (mesh)", "Getriebe mit Flankenspiel (mesh)", "Getriebe (second)"])
def test_in_german(tmp_path, word):
    assert any(one.startswith(word) for one in said(tmp_path, PAIR, "de"))
