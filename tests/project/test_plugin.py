"""An element type of another package is known to model files, commands, the schema and editors."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin"
MODEL = """torsionnet: 1
name: absorbed
elements:
  disc: {type: inertia, node: hub, inertia: 0.2}
  shaft: {type: spring, nodes: [hub, ground], stiffness: 5000}
  ring: {type: absorber, node: hub, inertia: 0.02, frequency: 25 Hz}
inputs: {T: {torque: hub}}
"""


@pytest.fixture
def installed(tmp_path):
    """Environment in which the example is installed: its folder on the path, and its metadata beside it."""
    site = tmp_path / "site"
    metadata = site / "torsionnet_absorber-0.1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: torsionnet-absorber\nVersion: 0.1.0\n")
    (metadata / "entry_points.txt").write_text("[torsionnet.elements]\nabsorber = torsionnet_absorber:Absorber\n")
    (tmp_path / "rig.yaml").write_text(MODEL)
    path = os.pathsep.join([str(site), str(EXAMPLE), os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": path}, tmp_path


def run(environment, folder, *arguments, code=0):
    """What a process prints with the plugin installed."""
    command = [sys.executable, *arguments]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8", check=False
    )
    assert done.returncode == code, done.stderr
    return done.stdout + done.stderr


@pytest.mark.slow
def test_commands_know_it(installed):
    said = run(*installed, "-m", "torsionnet", "check", "rig.yaml")
    assert "no errors" in said or "error" not in said
    modes = json.loads(run(*installed, "-m", "torsionnet", "modes", "rig.yaml", "--json"))
    assert len(modes[0]["modes"]) == 2
    assert "0.02 kg" in run(*installed, "-m", "torsionnet", "show", "rig.yaml")
    run(*installed, "-m", "torsionnet", "report", "rig.yaml", "-o", "rig.md")
    assert "absorber" in (installed[1] / "rig.md").read_text(encoding="utf-8")
    german = MODEL + "report: {language: de}\n"
    (installed[1] / "rig_de.yaml").write_text(german)
    run(*installed, "-m", "torsionnet", "report", "rig_de.yaml", "-o", "rig_de.md")


def test_faults_schema_and_completion_know_it(installed):
    environment, folder = installed
    (folder / "rig.yaml").write_text(MODEL.replace("frequency: 25 Hz", "frequency: 25 kg"))
    said = run(environment, folder, "-m", "torsionnet", "check", "rig.yaml", code=1)
    assert re.search("rig.yaml:6:63: error: .*wrong-unit", said)
    (folder / "rig.yaml").write_text(MODEL.replace("absorber", "absorbr"))
    assert 'did you mean "absorber"' in run(environment, folder, "-m", "torsionnet", "check", "rig.yaml", code=1)
    schema = json.loads(run(environment, folder, "-m", "torsionnet", "schema"))
    assert "absorber" in json.dumps(schema)
    script = (
        "from torsionnet.app.text.completion import completions\n"
        "text = 'torsionnet: 1\\nname: x\\nelements:\\n  ring: {type: abs'\n"
        "print([one.label for one in completions(text, len(text))])"
    )
    assert "absorber" in run(environment, folder, "-c", script)
    assert "Absorber" in run(environment, folder, "-c", "import torsionnet; print(torsionnet.Absorber)")


def test_without_unknown_types_nothing_is_looked_up(installed):
    script = "import sys, torsionnet; torsionnet.load('dmf_rig').modes(); print('torsionnet_absorber' in sys.modules)"
    assert run(*installed, "-c", script).strip() == "False"


@pytest.mark.parametrize(
    ("point", "reason"),
    [
        ("absorber = torsionnet_absorber.none:Absorber", "ModuleNotFoundError"),
        ("ring = torsionnet_absorber:Law", 'it is no type registered as "ring"'),
        ("spring = json:dumps", None),
    ],
)
def test_a_broken_plugin_is_left_out(installed, point, reason):
    environment, folder = installed
    (folder / "site" / "torsionnet_absorber-0.1.0.dist-info" / "entry_points.txt").write_text(
        f"[torsionnet.elements]\n{point}\n"
    )
    script = "import torsionnet.model.elements as e; print('spring' in e.ELEMENT_TYPES, len(e.ELEMENT_TYPES) > 30)"
    said = run(environment, folder, "-c", script)
    assert "True True" in said
    assert reason is None or ("of the package torsionnet-absorber" in said and reason in said)


def test_a_plugin_takes_no_kind_of_another_type(installed):
    environment, folder = installed
    site = folder / "site"
    (site / "springs_of_others.py").write_text(
        "from torsionnet.extend import Element, register\n\n\n@register\nclass OtherSpring(Element):\n    kind = 'spring'\n"
    )
    points = site / "torsionnet_absorber-0.1.0.dist-info" / "entry_points.txt"
    points.write_text("[torsionnet.elements]\nspring = springs_of_others:OtherSpring\n")
    script = "import torsionnet.model.elements as e; list(e.ELEMENT_TYPES); print(e.ELEMENT_TYPES['spring'].__name__)"
    said = run(environment, folder, "-c", script)
    assert said.startswith("Spring\n")
    assert '"spring" is the kind of a type that is known already' in said


def test_the_tests_of_the_example(installed):
    environment, _ = installed
    assert "100%" in run(environment, EXAMPLE, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests")
