"""Paths with spaces and umlauts, files with either line ending, and consoles of Windows' code page change no result."""

import csv
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import printable_text


def name(text):
    """Name of a file as this system has it: the locale C knows no umlauts and keeps their bytes."""
    return os.fsdecode(text.encode())


FOLDER = name("Prüfstand 2 (größer)")
MODEL = """\
torsionnet: 1
name: Prüfstand mit Schwungrad → Ω
parameters: {k: 1000 N*m/rad}
elements:
  antrieb: {type: inertia, node: a, inertia: 1}
  welle: {type: spring, nodes: [a, b], stiffness: k, damping: 1}
  schwungrad: {type: inertia, node: b, inertia: 2}
inputs: {T: {torque: a}}
"""
STUDY = """\
torsionnet: 1
name: Steifigkeit geändert → f_1
model: {model}
vary: {{k: {{type: range, low: 500 N*m/rad, high: 2000 N*m/rad, count: 3}}}}
quantities: {{f_1: {{type: natural_frequency, mode: 1}}}}
"""
# Of two discs on a shaft, omega^2 = k (1/J_1 + 1/J_2).
FREQUENCY = (1000 * (1 / 1 + 1 / 2)) ** 0.5 / (2 * math.pi)
WINDOWS_CONSOLE = {"PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"}


@pytest.fixture(params=["\n", "\r\n"], ids=["lf", "crlf"])
def model(request, tmp_path):
    folder = tmp_path / FOLDER
    folder.mkdir()
    path = folder / name("Läufer 1.yaml")
    path.write_bytes(MODEL.replace("\n", request.param).encode())
    study = folder / "Studie k.yaml"
    study.write_bytes(STUDY.format(model="Läufer 1.yaml").replace("\n", request.param).encode())
    return path


def run(*arguments, code=0):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == code, result.output
    return result.stdout if code == 0 else result.output


def natural_frequencies(path):
    (found,) = json.loads(run("modes", path, "--json"))
    return found["undamped_natural_frequencies_Hz"]


def test_check_and_modes(model):
    run("check", model)
    assert "Prüfstand mit Schwungrad → Ω" in run("modes", model)
    assert natural_frequencies(model) == pytest.approx([0, FREQUENCY], abs=1e-6)


def test_a_fault_has_the_same_place_with_either_line_ending(model):
    model.write_bytes(model.read_bytes().replace(b"inertia: 2}", b"inertai: 2}"))
    told = run("check", model, code=1)
    assert f"{printable_text(str(model))}:7:" in told.replace("\n", "")
    assert "inertai" in told


@pytest.mark.parametrize("ending", ["html", "md", "tex"])
def test_report_into_a_folder_with_umlauts(model, ending):
    written = model.with_name(name(f"Bericht für Läufer.{ending}"))
    run("report", model, "-o", written)
    assert "Prüfstand mit Schwungrad" in written.read_text(encoding="utf-8")


@pytest.mark.skipif(name("ä") != "ä", reason="in the locale C no text can name this file")
def test_study_beside_its_model(model):
    written = model.with_name(name("Ergebnis ä.csv"))
    run("study", model.with_name("Studie k.yaml"), "--csv", written)
    lines = [line for line in written.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    (row,) = csv.DictReader(lines)
    extremes = [float(row["smallest"]), float(row["largest"])]  # k is half and twice that of the model
    assert extremes == pytest.approx([FREQUENCY * 0.5**0.5, FREQUENCY * 2**0.5], rel=1e-3)


@pytest.mark.parametrize("end", [b"\n", b"\r\n"], ids=["lf", "crlf"])
def test_import_of_a_sheet(tmp_path, end):
    folder = tmp_path / FOLDER
    folder.mkdir()
    sheet = folder / name("Blatt ö.csv")
    sheet.write_bytes(end.join([b"mass,inertia [kg m2],stiffness [N m/rad]", "Läufer,1,1000".encode(), b"Rad,2,", b""]))
    model = folder / name("Modell ü.yaml")
    run("import", sheet, "-o", model)
    assert yaml.safe_load(model.read_text(encoding="utf-8"))["torsionnet"] == 1
    assert natural_frequencies(model) == pytest.approx([0, FREQUENCY], abs=1e-6)


@pytest.mark.skipif(sys.platform in ("darwin", "win32"), reason="all names of files are text there")
def test_names_that_are_no_text(tmp_path):
    """As from the disks of others: bytes of Latin-1."""
    model = tmp_path / os.fsdecode("Läufer.yaml".encode("latin-1"))
    model.write_text(MODEL, encoding="utf-8")
    run("report", model, "-o", tmp_path / "report.md", "--section", "validity")
    assert "L\N{REPLACEMENT CHARACTER}ufer.yaml" in (tmp_path / "report.md").read_text(encoding="utf-8")
    sheet = model.with_suffix(".csv")
    sheet.write_text("mass,inertia [kg m2],stiffness [N m/rad]\na,1,1000\nb,2,\n", encoding="utf-8")
    run("import", sheet, "-o", tmp_path / "imported.yaml")
    assert natural_frequencies(tmp_path / "imported.yaml") == pytest.approx([0, FREQUENCY], abs=1e-6)


def process(folder, environment, *arguments):
    environment = {**os.environ, "PYTHONPATH": str(Path(tn.__file__).parents[1]), "NO_COLOR": "1", **environment}
    done = subprocess.run(
        [sys.executable, "-X", "dev", "-W", "ignore", "-m", "torsionnet", *arguments],
        capture_output=True, timeout=PATIENCE, check=False, cwd=folder, env=environment,
    )  # fmt: skip
    assert b"Traceback" not in done.stderr, done.stderr.decode("utf-8", "replace")
    assert done.returncode == 0, done.stderr.decode("utf-8", "replace")
    return done.stdout


@pytest.mark.slow
def test_a_console_of_windows_code_page(tmp_path):
    """What is printed shows ? for what the console has not; what is written into a file has everything."""
    (tmp_path / "model.yaml").write_bytes(MODEL.replace("\n", "\r\n").encode())
    (tmp_path / "study.yaml").write_text(STUDY.format(model="model.yaml"), encoding="utf-8")
    sheet = "mass,inertia [kg m2],stiffness [N m/rad]\nLäufer,1,1000\nRad,2,\n"
    (tmp_path / "sheet.csv").write_text(sheet, encoding="utf-8")
    title = "Prüfstand mit Schwungrad".encode("cp1252", "replace")
    process(tmp_path, WINDOWS_CONSOLE, "check", "model.yaml")
    assert title in process(tmp_path, WINDOWS_CONSOLE, "modes", "model.yaml")
    process(tmp_path, WINDOWS_CONSOLE, "report", "model.yaml", "-o", "report.html")
    assert "Prüfstand mit Schwungrad → Ω" in (tmp_path / "report.html").read_text(encoding="utf-8")
    process(tmp_path, WINDOWS_CONSOLE, "study", "study.yaml", "--csv", "study.csv")
    process(tmp_path, WINDOWS_CONSOLE, "import", "sheet.csv", "-o", "imported.yaml")
    assert "Läufer" in (tmp_path / "imported.yaml").read_text(encoding="utf-8")
