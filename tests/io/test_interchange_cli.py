"""``torsionnet export`` and ``torsionnet import``."""

import json
import re
import zipfile

import pytest
from support.command_line import run
from support.modelica_reader import Model
from support.tors_models import THRUSTER

import torsionnet as tn
from torsionnet.io.fmu.c_source import this_machine
from torsionnet.signals.formats import extras


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("model", "name"),
    [
        ("oil_engine", "x.tors"),
        ("oil_engine", "x.json"),
        ("dmf_rig", "x.m"),
        ("dmf_rig", "x.mat"),
        ("dmf_rig", "x.mo"),
        ("dmf_rig", "x.fmu"),
    ],
)
def test_format_by_the_ending(tmp_path, model, name):
    result = run("export", model, "-o", tmp_path / name)
    assert result.stdout == ""
    assert result.stderr.splitlines()[-1] == f"wrote: {tmp_path / name}"
    assert (tmp_path / name).stat().st_size > 100


def test_configuration_and_parameter(tmp_path):
    run("export", "amt_rig", "-c", "V", "--set", "c_O=360 N*m*s/rad", "-o", tmp_path / "x.mo")
    values = Model((tmp_path / "x.mo").read_text(encoding="utf-8")).values
    assert (values["tau"], values["c_O"]) == (3.26, 360)


def test_every_configuration_in_a_file_of_its_own(tmp_path):
    run("export", "amt_rig", "-c", "all", "-o", tmp_path / "x.m")
    assert {path.name for path in tmp_path.iterdir()} == {
        "x_II.m", "x_III.m", "x_IV.m", "x_V.m", "x_V_c_O_360.m",
    }  # fmt: skip


CUBIC = """
torsionnet: 1
name: cubic
parameters: {k: 1 kN*m/rad}
elements:
  motor: {type: inertia, node: a, inertia: 2}
  pump: {type: inertia, node: b, inertia: 3}
  shaft: {type: spring, nodes: [a, b], stiffness: k, cubic: 10 kN*m/rad^3}
  spare: {type: damper, nodes: [a, b], damping: 1, enabled: false}
inputs: {drive: {torque: a}}
sensors: {twist_of_shaft: {twist: shaft}}
speeds: {of: a, range: 100..300 rpm, step: 10 rpm}
operating_point: {torque: {a: 500, b: -500}}
"""
HELD = {"tors": (), "csv": (), "m": ("drive", "twist_of_shaft"), "mat": ("drive", "twist_of_shaft"),
        "mo": ("drive", "twist_of_shaft", "k")}  # fmt: skip


def notes_in(path):
    """Texts of a file that are notes to its readers."""
    if path.suffix == ".mat":
        import scipy.io

        return [str(note) for note in scipy.io.loadmat(path, simplify_cells=True)["notes"]]
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".tors":
        return json.loads(text)["notes"]
    marks = {".csv": "# ", ".m": "notes = {", ".mo": "// "}
    return [line.strip() for line in text.splitlines() if line.strip().startswith(marks[path.suffix])]


@pytest.mark.parametrize("ending", HELD)
def test_what_a_file_leaves_out_is_on_the_console_and_in_the_file(tmp_path, ending):
    (tmp_path / "cubic.yaml").write_text(CUBIC, encoding="utf-8")
    target = tmp_path / f"model.{ending}"
    said = run("export", tmp_path / "cubic.yaml", "-o", target).stderr
    notes = " ".join(notes_in(target))
    lines = [line.removeprefix("note: ") for line in said.splitlines() if line.startswith("note: ")]
    missing = next(line for line in lines if line.startswith("not in this file"))
    for name in ("drive", "twist_of_shaft"):
        assert (name in missing) == (name not in HELD[ending])
    assert "operating point; speeds" in missing
    assert "elements switched off spare" in missing
    assert ("parameters are numbers here: k" in said) == ("k" not in HELD[ending])
    assert "linear about the operating point, by tangents: shaft" in said
    for line in (*lines[lines.index(missing) :],):
        assert line in notes


def test_a_sheet_with_such_notes_is_read_back(tmp_path):
    (tmp_path / "cubic.yaml").write_text(CUBIC, encoding="utf-8")
    model = tn.load(tmp_path / "cubic.yaml")
    tn.io.write_mass_elastic(model, tmp_path / "x.csv")
    back = tn.io.read_mass_elastic(tmp_path / "x.csv")
    # The tangent of 1000 x + 10 000 x^3 where it gives 500 N m: x = 0.282376 by Newton's method, 3392.09 N m/rad.
    x = 0.25
    for _ in range(20):
        x -= (1e3 * x + 1e4 * x**3 - 500) / (1e3 + 3e4 * x**2)
    assert float(back.elements["a_to_b"].stiffness.value) == pytest.approx(1e3 + 3e4 * x**2, rel=1e-9)


@pytest.mark.slow
def test_description_of_an_fmu_lists_what_it_leaves_out(tmp_path):
    (tmp_path / "cubic.yaml").write_text(CUBIC, encoding="utf-8")
    run("export", tmp_path / "cubic.yaml", "-o", tmp_path / "x.fmu")
    with zipfile.ZipFile(tmp_path / "x.fmu") as archive:
        about = archive.read("modelDescription.xml").decode()
    assert "not in this file: operating point; speeds; elements switched off spare" in about
    assert "linear about the operating point, by tangents: shaft" in about


def test_another_ending_with_a_format(tmp_path):
    run("export", "dmf_rig", "--format", "modelica", "-o", tmp_path / "x.txt")
    assert Model((tmp_path / "x.txt").read_text(encoding="utf-8")).name == "DMF_test_rig"


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["-o", "x.zip"], '".zip" tells no format'),
        (["-o", "x.m", "--format", "fmu"], "contradicting-entries"),
        (["-o", "x.bin", "--format", "fmu"], "wrong-file"),
        (["-o", "x.m", "--step", "0.1"], "--step applies only to an FMU"),
        (["-o", "x.m", "--fmi", "3.0"], "--fmi applies only to an FMU"),
        (["-o", "x.fmu", "--step", "-1"], "positive time in s"),
        (["-o", "x.tors"], "clamp (lock)"),
        ([], "Missing option"),
    ],
)
def test_wrong_usage(tmp_path, monkeypatch, arguments, text):
    monkeypatch.chdir(tmp_path)
    assert text in run("export", "dmf_rig", *arguments, code=2).stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_an_fmu_says_what_it_runs_on(tmp_path, monkeypatch):
    monkeypatch.setitem(extras.EXTRA_PACKAGES, "fmu", ("no_such_module", "ziglang", "FMU"))
    result = run("export", "dmf_rig", "-o", tmp_path / "x.fmu", "--fmi", "3.0")
    assert result.stderr.startswith(f"note: binaries for {this_machine().name}; pip install")
    with zipfile.ZipFile(tmp_path / "x.fmu") as archive:
        assert 'fmiVersion="3.0"' in archive.read("modelDescription.xml").decode()


def test_missing_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(extras.EXTRA_PACKAGES, "fmu", ("no_such_module", "ziglang", "FMU"))
    monkeypatch.setenv("PATH", str(tmp_path))
    result = run("export", "dmf_rig", "-o", tmp_path / "x.fmu", code=4)
    assert 'pip install "torsionnet[fmu]"' in result.stderr


def test_import_writes_a_model_file(tmp_path):
    (tmp_path / "t.tors").write_text(json.dumps(THRUSTER), encoding="utf-8")
    result = run("import", tmp_path / "t.tors", "-o", tmp_path / "t.yaml")
    assert result.stderr == f"wrote: {tmp_path / 't.yaml'}\n"
    assert tn.load(tmp_path / "t.yaml").name == "thruster"
    assert run("import", tmp_path / "t.tors").stdout == (tmp_path / "t.yaml").read_text(encoding="utf-8")


def test_import_of_a_faulty_file(tmp_path):
    (tmp_path / "t.tors").write_text('{"components": [{"name": "a", "elements": [{"name": "d", "type": "Disc"}]}]}')
    result = run("import", tmp_path / "t.tors", "-o", tmp_path / "t.yaml", code=1)
    assert re.search('"Disc"; .*"Disk"', result.stderr)
    assert "t.tors:1:" in result.stderr
    assert not (tmp_path / "t.yaml").exists()


def test_import_of_no_file(tmp_path):
    assert "there is no file" in run("import", tmp_path / "t.tors", code=2).stderr
