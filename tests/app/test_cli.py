"""The command line: what it prints where, what it writes, and how it fails."""

import csv
import json
import math
import os
import re
import shlex
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from support import campaigns
from support.command_line import process, run, runner
from support.patience import PATIENCE
from support.written_models import CLUTCH

import torsionnet as tn
from torsionnet.app.cli.app import COMMANDS, app
from torsionnet.app.cli.options import OutputFile

ROOT = Path(__file__).parents[2]

BROKEN = """\
torsionnet: 1
name: broken
elements:
  gearbox: {type: inertia, node: a, inertia: 0.012 kg*m}
  shaft: {type: spring, nodes: [a, b], stiffnes: 12}
  wheel: {type: inertia, node: b, inertia: 1}
"""

AXES = """\
torsionnet: 1
name: two axes
parameters: {k: 1000 N*m/rad}
elements:
  motor: {type: inertia, node: a, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: k, damping: 1}
  load: {type: inertia, node: b, inertia: 2}
inputs: {T: {torque: a}}
configurations: {stiffness: {soft: {k: 500}, hard: {k: 2000}}, clutch: {open: {off: [shaft]}, shut: {on: [shaft]}}}
"""


def read_csv(path):
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


@pytest.fixture
def broken(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text(BROKEN, encoding="utf-8")
    return path


@pytest.fixture
def axes(tmp_path):
    path = tmp_path / "axes.yaml"
    path.write_text(AXES, encoding="utf-8")
    return path


# The group of commands


def test_help_lists_every_command_and_each_has_help():
    text = run("--help").stdout
    for name, what in COMMANDS.items():
        assert f"{name} " in text
        assert what in " ".join(text.split())
        assert run(name, "--help").stdout.startswith(f"Usage: torsionnet {name}".replace("torsionnet", "app"))


def test_unknown_command_is_usage_error_with_hint():
    assert 'did you mean "check"?' in run("chek", "dmf_rig", code=2).stderr


def test_version():
    assert tn.__version__ in run("--version").stdout


# library and schema


def test_library_lists_every_model_with_its_source():
    listed = json.loads(run("library", "--json").stdout)
    assert {entry["name"] for entry in listed if entry["kind"] == "model"} == set(tn.library_models())
    for kind, folder in [("study", "studies/*.yaml"), ("part", "parts/*.yaml"), ("catalogue", "catalogues/*.csv")]:
        shipped = {path.stem for path in (ROOT / "library").glob(folder)}
        assert {entry["name"] for entry in listed if entry["kind"] == kind} == shipped
    assert all(entry["what"] and entry["source"] and Path(entry["file"]).is_file() for entry in listed)
    text = run("library").stdout
    assert {row[:3] for row in unfolded(text)} == {(entry["name"], entry["kind"], entry["what"]) for entry in listed}


def test_a_part_or_catalogue_of_the_library_is_no_model_and_told_how_to_use_it():
    told = run("show", "planetary_stage", code=2).stderr
    assert "use: {NAME: {part: planetary_stage, at: {carrier: ..., out: ..., housing: ...}}}" in " ".join(told.split())
    told = run("show", "example_couplings", code=2).stderr
    assert "catalogue: example_couplings and size:" in " ".join(told.split())


def test_schema_on_stdout_and_in_a_file(tmp_path):
    text = run("schema").stdout
    assert json.loads(text)["required"] == ["torsionnet"]
    result = run("schema", "-o", tmp_path / "schema.json")
    assert result.stdout == ""
    assert "wrote: " in result.stderr
    assert (tmp_path / "schema.json").read_text(encoding="utf-8") == text


# check


def test_check_of_sound_models():
    assert run("check", "dmf_rig", "amt_rig").stdout.splitlines() == ["dmf_rig: no errors", "amt_rig: no errors"]


def test_check_shows_every_fault_with_its_place(broken):
    lines = run("check", broken, code=1).stdout.splitlines()
    assert lines[0].startswith(f"{broken}:4:46: error: ")
    assert "kg*m^2" in lines[0]
    assert lines[1] == "    4 |   gearbox: {type: inertia, node: a, inertia: 0.012 kg*m}"
    assert lines[2] == "      | " + " " * 45 + "^" * len("0.012 kg*m")
    assert any(line.startswith(f"{broken}:5:40: error: ") and 'did you mean "stiffness"?' in line for line in lines)
    assert lines[-1].startswith(f"{broken}: ")
    assert "errors" in lines[-1]


def test_check_as_json(broken):
    reports = json.loads(run("check", "--json", broken, "dmf_rig", code=1).stdout)
    assert [report["errors"] > 0 for report in reports] == [True, False]
    first = reports[0]["faults"][0]
    assert (first["severity"], first["position"]["line"], first["position"]["column"]) == ("error", 4, 46)
    assert first["path"] == ["elements", "gearbox", "inertia"]
    assert reports[0]["faults"][1]["meant"] == "stiffness"


def test_check_counts_notes_without_failing(axes):
    assert run("check", axes).stdout.splitlines()[-1] == f"{axes}: no errors, 1 note"


def test_check_of_a_missing_model_still_checks_the_others():
    result = run("check", "dmf_rog", "amt_rig", code=2)
    assert 'did you mean "dmf_rig"?' in result.stderr
    assert result.stdout == "amt_rig: no errors\n"


# show


def test_show_gives_values_as_written_and_in_si():
    text = run("show", "amt_rig").stdout
    assert "stiffness k_1 = 460 N*m/rad; damping c_1 = 4 N*m*s/rad" in text
    assert "0.46 kN*m/rad" in text
    assert "I_1 - I_MT" in text
    assert "tau = 3.26; c_O = 360 N*m*s/rad" in text
    assert "positive when it drives" in text
    assert "Operating point" in text


def test_show_follows_configuration_and_set():
    text = run("show", "amt_rig", "-c", "V", "--set", "k_1=1 kN*m/rad").stdout
    assert "ratio tau = 3.26" in text
    assert "stiffness k_1 = 1000 N*m/rad" in text


def test_show_equations():
    text = run("show", "amt_rig", "--equations").stdout
    assert "(k_1 + k_2/tau**2) theta_input_shaft = 0" in text
    assert "I_1 theta_motor''" in text
    assert "theta_output_shaft = (1/tau) theta_input_shaft" in text
    assert "theta_hub = 0" in text


class TestEquations:
    def test_without_a_transfer_function_the_motion(self):
        assert run("equations", "amt_rig").stdout == run("show", "amt_rig", "--equations").stdout

    def test_forms_are_those_of_the_library(self):
        found = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        texts = {
            "polynomial": str(found.polynomial),
            "normalised": str(found.normalised),
            "program": str(found.program),
        }
        for form, text in texts.items():
            assert run("equations", "dmf_rig", "--tf", "theta_1/T_T", "--form", form).stdout.endswith(f"{text}\n")

    def test_code_can_be_run_as_it_is_printed(self):
        """Against the response in numbers."""
        names = {}
        exec(run("equations", "dmf_rig", "--tf", "theta_1/T_T", "--form", "python").stdout, names)
        response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [8.0])
        assert names["transfer_function"]([8.0])[0] == pytest.approx(response.values.item(), rel=1e-12)

    def test_simplified_says_what_is_left_out_and_the_error(self):
        text = run(
            "equations", "dmf_rig", "--tf", "theta_1/T_M", "--simplify", "1%", "--band", "0.5", "20", "--latex"
        ).stdout
        title, left_out, error, formula = text.splitlines()
        assert (title, left_out) == ("% DMF test rig: theta_1/T_M", "% left out: torque_meter rigid")
        assert error.startswith("% error 0.5 to 20 Hz: omega_n 0.17 %")
        assert r"\left(I_{1} + I_{2}\right)" in formula

    @pytest.mark.parametrize(
        ("options", "text"),
        [
            (["--form", "python"], "say which by --tf"),
            (["--simplify", "1%"], "say which by --tf"),
            (["--tf", "theta_1/T_T", "--band", "1", "2"], "--band has no effect without --simplify"),
            (["--tf", "theta_1/T_T", "--simplify", "1"], "must be less than 1 (100 %)"),
            (["--tf", "theta_1/T_T", "--form", "python", "--latex"], "two ways of writing"),
            (["--tf", "theta_1"], "written OUTPUT/INPUT"),
        ],
    )
    def test_no_option_is_ignored(self, options, text):
        assert text in run("equations", "dmf_rig", *options, code=2).stderr


def test_show_matrices_are_those_of_the_paper():
    data = json.loads(run("show", "dmf_rig", "--matrices", "--json").stdout)[0]["matrices"]
    assert data["coordinates"] == ["motor", "primary"]
    assert data["M"] == [[0.078, 0], [0, 0.152]]
    assert data["K"] == [[13300, -13300], [-13300, 13760]]
    assert data["C"][1][1] == pytest.approx(4.4)
    lines = run("show", "dmf_rig", "--matrices").stdout.splitlines()
    assert "primary  -13300    13760" in lines


def test_show_json_holds_the_model():
    data = json.loads(run("show", "amt_rig", "-c", "V", "--json", "--equations").stdout)[0]
    assert data["parameters"]["tau"] == {"value": 3.26, "unit": ""}
    assert data["parameters"]["k_1"] == {"value": 460, "unit": "N*m/rad"}
    assert data["model"]["elements"]["brake"] == {"type": "lock", "node": "hub"}
    assert data["equations"]["K"][0] == ["k_1", "-k_1"]


def test_show_csv_is_the_table_of_elements(tmp_path):
    run("show", "dmf_rig", "--csv", tmp_path / "elements.csv")
    rows = read_csv(tmp_path / "elements.csv")
    assert [row["element"] for row in rows] == list(tn.load("dmf_rig").elements)


@pytest.mark.parametrize("chosen", [("II",), ("II", "V")])
def test_a_table_of_several_configurations_is_headed_by_the_model_and_names_each(tmp_path, chosen):
    run("show", "amt_rig", *(word for name in chosen for word in ("-c", name)), "--csv", tmp_path / "elements.csv")
    model, text = tn.load("amt_rig"), (tmp_path / "elements.csv").read_text(encoding="utf-8")
    heading = text.splitlines()[0]
    assert (heading == f"# {model.name}") == (len(chosen) > 1)
    rows = read_csv(tmp_path / "elements.csv")
    assert [(row["configuration"], row["element"]) for row in rows] == [
        (name, element) for name in chosen for element in model.configured(name).elements
    ]


# modes


def test_modes_table():
    result = run("modes", "dmf_rig")
    assert result.stderr == ""
    row = next(line for line in result.stdout.splitlines() if line.lstrip().startswith("1 "))
    assert row.split()[:4] == ["1", "7.10526", "6.92688", "0.222666"]


def test_modes_json():
    first, second = json.loads(run("modes", "dmf_rig", "--json").stdout)[0]["modes"]
    assert first["natural_frequency_Hz"] == pytest.approx(7.10526, abs=5e-6)
    assert first["damping_ratio"] == pytest.approx(0.222666, abs=5e-7)
    assert first["shape"]["motor"] == [1, 0]
    assert sum(share["strain"] for share in first["energy_shares"].values()) == pytest.approx(1)
    assert second["eigenvalue_rad_per_s"] == pytest.approx([-7.09716, 508.784], rel=1e-5)


def test_modes_of_the_cut_system():
    text = run("modes", "dmf_rig", "--measured-input", "T_T").stdout
    assert "8.75543" in text
    assert "cut at T_T" in text


def test_modes_lowest():
    assert len(json.loads(run("modes", "dmf_rig", "--lowest", "1", "--json").stdout)[0]["modes"]) == 1


@pytest.mark.parametrize("count", ["1", "3"])
def test_the_lowest_are_counted_among_vibrations_in_every_command(count):
    # The set turns freely as a whole, and its damper ring alone: two rigid bodies, and an overdamped film at 94 Hz.
    modes = run("modes", "engine_generator_set", "--lowest", count, "--json").stdout
    kinds = [one["kind"] for one in json.loads(modes)[0]["modes"]]
    assert (kinds.count("oscillatory"), kinds.count("rigid body")) == (int(count), 2)
    criticals = run("critical-speeds", "engine_generator_set", "-c", "normal", "--lowest", count, "--json").stdout
    assert [one["mode"] for one in json.loads(criticals)[0]["modes"]] == list(range(1, int(count) + 1))


def test_modes_in_rpm():
    assert "426.316" in run("modes", "dmf_rig", "--frequency-unit", "rpm").stdout


def test_modes_shapes_and_energies_on_demand():
    plain, full = run("modes", "dmf_rig").stdout, run("modes", "dmf_rig", "--shapes", "--energies").stdout
    assert "mode shapes" not in plain
    assert "energy shares" not in plain
    assert "0.989253" in full
    assert "86.83" in full


def test_modes_without_damping_ratio_are_null_in_json(axes):
    mode = json.loads(run("modes", axes, "--json").stdout)[0]["modes"][0]
    assert mode["kind"] == "rigid body"
    assert mode["damping_ratio"] is None


# configurations and parameters


def test_configuration_is_repeatable_and_goes_into_one_csv(tmp_path):
    path = tmp_path / "modes.csv"
    result = run("modes", "amt_rig", "-c", "V", "--configuration", "II", "--csv", path)
    assert result.stdout.index("AMT test rig (V)") < result.stdout.index("AMT test rig (II)")
    assert f"wrote: {path}" in result.stderr
    rows = read_csv(path)
    assert [row["configuration"] for row in rows] == ["V", "V", "II", "II"]
    assert float(rows[0]["natural frequency |lambda|/2pi [Hz]"]) == pytest.approx(5.91200, abs=5e-6)
    assert float(rows[2]["damping ratio [1]"]) == pytest.approx(0.229278, abs=5e-7)


def test_all_configurations():
    reports = json.loads(run("modes", "amt_rig", "-c", "all", "--json").stdout)
    assert tuple(report["configuration"] for report in reports) == tn.load("amt_rig").configurations


def test_all_configurations_of_several_axes(axes):
    result = run("modes", axes, "-c", "all", "--json")
    names = [report["configuration"] for report in json.loads(result.stdout)]
    assert names == list(tn.load(axes).configurations)
    assert "stiffness=soft,clutch=open" in names
    assert "2 rigid-body modes" in result.stderr


def test_all_of_a_model_without_configurations():
    result = run("modes", "dmf_rig", "-c", "all")
    assert "7.10526" in result.stdout
    assert "no configurations" in result.stderr


def test_configurations_that_were_not_chosen_are_mentioned():
    result = run("modes", "amt_rig")
    assert "configurations: II, III, IV, V, V_c_O_360" in result.stderr
    assert "configurations" not in result.stdout


@pytest.mark.parametrize("value", ["360", "360 N*m*s/rad", "0.36 kN*m*s/rad", "2*c_1 + 352"])
def test_set_reads_units_and_expressions(value):
    text = run("modes", "amt_rig", "-c", "V", "--set", f"c_O={value}").stdout
    assert "0.27687" in text
    assert "45.0771" not in text
    assert "overdamped" in text


def test_set_is_repeatable():
    text = run("modes", "amt_rig", "--set", "tau=3.26", "--set", "c_O=360").stdout
    assert "0.27687" in text


@pytest.mark.parametrize(
    ("setting", "code", "words"),
    [
        ("c_O", 2, "expected NAME=VALUE"),
        ("=3", 2, "expected NAME=VALUE"),
        ("c_O=3,5", 2, "decimal comma"),
        ("c_O=3 furlongs", 2, "furlongs"),
        ("c_X=3", 2, '"c_X"'),
        ("I_2=-1", 1, "[out-of-range]"),
        ("I_2=3 N*m", 1, "kg*m^2"),
    ],
)
def test_wrong_settings(setting, code, words):
    result = run("modes", "amt_rig", "--set", setting, code=code)
    assert words in result.stderr
    assert result.stdout == ""


def test_unknown_configuration():
    result = run("modes", "amt_rig", "-c", "VI", code=2)
    assert "II, III, IV, V, V_c_O_360" in result.stderr


# frf


def test_frf_gives_static_value_and_peak():
    result = run("frf", "dmf_rig", "--output", "theta_1", "--input", "T_T", "--angle-unit", "deg")
    static, peak = (line.split() for line in result.stdout.splitlines() if line.startswith("theta_1/T_T"))
    assert static == ["theta_1/T_T", "deg/(N*m)", "static", "0", "0.128864", "0"]
    assert peak[:4] == ["theta_1/T_T", "deg/(N*m)", "peak", "1"]
    assert [float(cell) for cell in peak[4:]] == pytest.approx([8.116, 0.2519, -72.6], rel=1e-3)


def test_frf_of_a_torque_over_itself_has_no_peaks():
    """It is 1 but for rounding, which differs from one processor to another."""
    text = run("frf", "amt_rig", "--output", "T_T", "--input", "T_T").stdout
    assert [line.split()[2] for line in text.splitlines() if line.startswith("T_T/T_T")] == ["static"]


def test_frf_peak_does_not_depend_on_the_grid():
    arguments = ("frf", "dmf_rig", "--output", "theta_1", "--input", "T_T", "--json")
    coarse, fine = (
        json.loads(run(*arguments, "--band", "1", "40", "--points", points).stdout)[0]["responses"][0]["peaks"]
        for points in (30, 3000)
    )
    assert len(coarse) == len(fine) == 1
    assert coarse[0]["frequency_Hz"] == pytest.approx(fine[0]["frequency_Hz"], abs=2e-4)


def test_frf_csv_of_all_gears_over_given_frequencies(tmp_path):
    path = tmp_path / "gears.csv"
    run(
        "frf",
        "amt_rig",
        "-c",
        "all",
        "--output",
        "theta_1",
        "--input",
        "T_T",
        "--frequencies",
        "0:1:0.5",
        "--csv",
        path,
    )
    rows = read_csv(path)
    assert [float(row["frequency [Hz]"]) for row in rows] == [0, 0.5, 1] * 5
    assert {row["configuration"] for row in rows} == set(tn.load("amt_rig").configurations)
    stiffness = 1 / (1 / 460 + 3.26**2 / 12300)
    row = next(row for row in rows if row["configuration"] == "V")
    assert float(row["|theta_1/T_T| [rad/(N*m)]"]) == pytest.approx(1 / stiffness)
    assert any("lag is a negative phase" in line for line in path.read_text(encoding="utf-8").splitlines())


def test_frf_json_is_complex_and_equal_to_python():
    arguments = ("frf", "dmf_rig", "--output", "theta_1", "--output", "T_T", "--input", "T_M", "--json")
    data = json.loads(run(*arguments, "--frequencies", "5,10").stdout)[0]
    expected = tn.load("dmf_rig").frequency_response(["theta_1", "T_T"], "T_M", [5, 10]).values
    assert data["frequencies_Hz"] == [5, 10]
    for index, response in enumerate(data["responses"]):
        assert response["real"] == pytest.approx(expected[:, index, 0].real)
        assert response["imag"] == pytest.approx(expected[:, index, 0].imag)
    assert [response["unit"] for response in data["responses"]] == ["rad/(N*m)", "1"]


def test_frf_quantities_and_decibels():
    base = ("frf", "dmf_rig", "--output", "theta_1", "--input", "T_M", "--frequencies", "10", "--full")
    value = abs(tn.load("dmf_rig").frequency_response("theta_1", "T_M", [10]).values[0, 0, 0])
    omega = 20 * math.pi
    shown = {
        "receptance": value,
        "mobility": omega * value,
        "accelerance": omega**2 * value,
        "dynamic_stiffness": 1 / value,
    }
    for quantity, expected in shown.items():
        row = run(*base, "--kind", quantity).stdout.splitlines()
        assert float(next(line for line in row if line.lstrip().startswith("10 ")).split()[1]) == pytest.approx(
            expected, rel=1e-5
        )
    text = run(*base, "--db").stdout
    assert "[dB re 1 rad/(N*m)]" in text
    assert f"{20 * math.log10(value):.6g}" in text


def test_frf_frequencies_in_rpm_are_taken_and_shown_in_rpm():
    base = ("frf", "dmf_rig", "--output", "theta_1", "--input", "T_T")
    text = run(*base, "--frequency-unit", "rpm", "--band", "60", "1200").stdout
    assert "from 60 to 1200 rpm" in text
    assert float(next(line for line in text.splitlines() if "peak" in line).split()[4]) == pytest.approx(
        486.97, abs=0.1
    )


def test_frf_infinite_at_zero_is_a_warning_on_stderr(axes):
    result = run("frf", axes, "--output", "b", "--input", "T")
    assert "warning: the response is infinite at 0 Hz" in result.stderr
    assert ".py" not in result.stderr
    assert "inf" in result.stdout
    data = json.loads(run("frf", axes, "--output", "b", "--input", "T", "--json").stdout)
    assert data[0]["responses"][0]["static"][0] is None
    result = run("frf", axes, "--output", "b", "--input", "T", "--frequencies", "0,1", "--json")
    warned = [line for line in result.stderr.splitlines() if line.startswith("warning")]
    assert warned == ["warning: the response is infinite at 0 Hz: the drivetrain turns freely"]
    assert json.loads(result.stdout)[0]["responses"][0]["real"][0] is None


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        (["--frequencies", "1,a"], "start:stop:step"),
        (["--frequencies", "1:2"], "start:stop:step"),
        (["--frequencies", "2:1:0.1"], "start:stop:step"),
        (["--frequencies", "-1"], "must not be negative"),
        (["--frequencies", "0:1e9:0.001"], "at most"),
        (["--frequencies", "1,2", "--band", "3", "4"], "not both"),
        (["--band", "5", "2"], "[unordered-rows]"),
        (["--band", "0", "2", "--log"], "cannot begin at 0"),
        (["--points", "1"], "--points"),
        (["--output", "theta_2"], 'did you mean "theta_1"?'),
        (["--kind", "compliance"], "--kind"),
        (["--driven-by", "T_X"], "T_X"),
        (["--output", "T_T", "--plot", "unlike.svg"], "--output and --input [wrong-unit]"),
    ],
)
def test_wrong_questions(extra, words):
    result = run("frf", "dmf_rig", "--output", "theta_1", "--input", "T_T", *extra, code=2)
    assert words in result.stderr
    assert result.stdout == ""


def test_missing_output_is_named():
    assert "--output" in run("frf", "dmf_rig", "--input", "T_M", code=2).stderr


# files


@pytest.mark.parametrize("command", [("modes",), ("show",), ("frf", "--output", "theta_1", "--input", "T_M")])
def test_plot_with_unknown_ending_is_refused_before_anything_is_read(command, tmp_path):
    result = run(command[0], "no_such_model", *command[1:], "--plot", tmp_path / "a.jpg", code=2)
    assert ".svg, .png, .pdf" in result.stderr
    assert "no_such_model" not in result.stderr


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (
            ["frf", "amt_rig", "-c", "all", "--output", "theta_1", "--input", "T_T", "--db", "--plot", "x.svg"],
            ["x.svg"],
        ),
        (
            ["frf", "dmf_rig", "--output", "theta_1", "--input", "T_M", "--angle-unit", "deg", "--plot", "x.png"],
            ["x.png"],
        ),
        (["modes", "dmf_rig", "--plot", "x.pdf"], ["x.pdf"]),
        (["modes", "amt_rig", "-c", "II", "-c", "V", "--plot", "x.png"], ["x_II.png", "x_V.png"]),
        (["show", "amt_rig", "--plot", "x.svg"], ["x.svg"]),
    ],
)
def test_plots(arguments, names, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    starts = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    for name in names:
        assert (tmp_path / name).read_bytes().startswith(starts[Path(name).suffix])
        assert f"wrote: {name}" in result.stderr


def test_missing_folder_and_folder_as_file(tmp_path):
    assert "no folder" in run("modes", "dmf_rig", "--csv", tmp_path / "a" / "b.csv", code=2).stderr
    assert "is a folder" in run("modes", "dmf_rig", "--csv", tmp_path, code=2).stderr


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "modes.csv"
    path.write_text("old", encoding="utf-8")

    def fail(*_):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(Path, "replace", fail)
    result = run("modes", "dmf_rig", "--csv", path, code=74)
    assert "No space left on device" in result.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["modes.csv"]
    assert path.read_text(encoding="utf-8") == "old"


# how it fails


def test_broken_model_in_any_command(broken):
    for command in (["modes"], ["show"], ["frf", "--output", "a", "--input", "b"]):
        result = run(command[0], broken, *command[1:], code=1)
        assert f"{broken}:4:46: error: " in result.stderr
        assert "Nothing was calculated." in result.stderr
        assert result.stdout == ""


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (tn.SolveError("it does not settle"), 3, "error: it does not settle"),
        (tn.MissingExtraError("pip install torsionnet[units]"), 4, "pip install torsionnet[units]"),
        (RuntimeError("two\nlines"), 70, "unexpected RuntimeError: two (a bug; set TORSIONNET_DEBUG=1"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_exit_codes(error, code, words, monkeypatch):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(tn.Drivetrain, "modes", fail)
    result = run("modes", "dmf_rig", code=code)
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert len(result.stderr.splitlines()) == bool(words)


def test_debug_shows_where(monkeypatch):
    def fail(*_, **__):
        raise RuntimeError("here")

    monkeypatch.setattr(tn.Drivetrain, "modes", fail)
    monkeypatch.setenv("TORSIONNET_DEBUG", "1")
    assert "Traceback" in run("modes", "dmf_rig", code=70).stderr


def test_each_warning_is_shown_once_and_without_the_place_in_the_program(monkeypatch):
    real = tn.Drivetrain.modes

    def warn(self, **options):
        for _ in range(3):
            warnings.warn("the table is not passive", tn.TorsionnetWarning, stacklevel=1)
        return real(self, **options)

    monkeypatch.setattr(tn.Drivetrain, "modes", warn)
    assert run("modes", "dmf_rig").stderr == "warning: the table is not passive\n"


def test_configurations_without_what_is_asked_for_are_left_out(tmp_path):
    path = tmp_path / "clutch.yaml"
    path.write_text(CLUTCH, encoding="utf-8")
    shown = run("frf", path, "-c", "all", "--output", "T_c", "--input", "T")
    assert "closed" in shown.stdout
    assert "configuration open is left out: " in shown.stderr
    wrong = run("frf", path, "-c", "all", "--output", "T_q", "--input", "T", code=2)
    assert "left out" not in wrong.stderr
    assert 'did you mean "T_c"?' in wrong.stderr


# documentation


def documented():
    text = (ROOT / "docs" / "command_line.md").read_text(encoding="utf-8")
    return re.findall(r"```console\n\$ torsionnet (.*)\n((?:.*\n)*?)```", text)


def test_documented_output_is_real_output(tmp_path, monkeypatch):
    (tmp_path / "broken.yaml").write_text(BROKEN, encoding="utf-8")
    page = (ROOT / "docs" / "command_line.md").read_text(encoding="utf-8")
    for name, text in re.findall(r"```yaml\n# (\w+\.yaml)\n(.*?)```", page, re.DOTALL):
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    blocks = documented()
    # A server does not end; what runs has pages of its own, with models of their own.
    servers = {"explore", "language-server"}
    elsewhere = {
        "schema",
        "campaign",
        "clocks",
        "orders",
        "critical-speeds",
        "damper",
        "static",
        "limits",
        "margins",
        "loops",
    }
    assert {command.split()[0] for command, _ in blocks} == set(COMMANDS) - elsewhere - servers
    for command, output in blocks:
        # A short report is told in the same words as a long one.
        shorter = ["--section", "validity"] if not campaigns.many and command.startswith("report") else []
        shown = runner().invoke(app, [*shlex.split(command), *shorter]).stdout
        if command == "library":  # which grows: its lines, whatever the widths of the columns
            assert unfolded(output) <= unfolded(shown)
        elif command.split()[0] in FITTED:  # the last digits are the machine's
            assert alike(shown, output), command
        else:
            assert shown == output, command


def unfolded(text):
    """Rows of a table whose texts may stand on several lines, as tuples of whole cells."""
    _, rule, *lines = text.rstrip().splitlines()
    edges = [found.span() for found in re.finditer("-+", rule)]
    rows = []
    for line in lines:
        cells = [line[start:stop].split() for start, stop in edges]
        if cells[0]:
            rows.append(cells)
        else:
            rows[-1] = [above + cell for above, cell in zip(rows[-1], cells, strict=True)]
    return {tuple(map(" ".join, row)) for row in rows}


FITTED = (
    "fit", "identify-modes", "estimate", "compare", "spectrogram", "bench", "sensitivity", "calibrate-wheel", "angle",
    "track", "damping", "periodic",
)  # fmt: skip


def alike(shown, output):
    """The same words, and numbers within a per mille."""
    if len(shown.split()) != len(output.split()):
        return False
    for one, other in zip(shown.split(), output.split(), strict=True):
        try:
            numbers = float(one.removesuffix("j")), float(other.removesuffix("j"))
        except ValueError:
            numbers = None
        if one != other and (numbers is None or abs(numbers[0] - numbers[1]) > 1e-3 * abs(numbers[1])):
            return False
    return True


# processes


def test_streams_are_apart_and_exit_codes_reach_the_shell(broken, tmp_path):
    good = process("modes", "amt_rig", directory=tmp_path)
    assert (good.returncode, good.stdout.splitlines()[0]) == (0, "AMT test rig")
    assert good.stderr.startswith("note: ")
    bad = process("modes", broken.name, directory=tmp_path)
    assert (bad.returncode, bad.stdout) == (1, "")
    assert "broken.yaml:4:46: error:" in bad.stderr
    unknown = process("modes", "amt_rigg", directory=tmp_path)
    assert (unknown.returncode, unknown.stdout) == (2, "")
    assert 'did you mean "amt_rig"?' in unknown.stderr
    assert unknown.stderr.startswith("error: ")


@pytest.mark.skipif(os.name == "nt", reason="needs a shell with head")
@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_reader_that_goes_away_is_no_error(tmp_path, encoding):
    command = (
        f'"{sys.executable}" -m torsionnet frf dmf_rig --output theta_1 --input T_M --points 20000 --full | head -1'
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(tn.__file__).parents[1]), "PYTHONIOENCODING": encoding}
    done = subprocess.run(
        command,
        shell=True,
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=environment,
        timeout=PATIENCE,
        check=False,
    )
    assert done.stdout == "DMF test rig\n"
    assert done.stderr == ""


@pytest.mark.slow
def test_a_console_without_the_characters_still_shows_the_rest(tmp_path):
    path = tmp_path / "arrow.yaml"
    path.write_text(AXES.replace("two axes", "torque → Ω"), encoding="utf-8")
    console = {"PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0"}
    done = process("modes", path, directory=tmp_path, env=console, encoding="cp1252")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "torque ? ?"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="needs a pseudo terminal")
@pytest.mark.parametrize(
    ("environment", "styled", "frame"),
    [
        ({}, True, "─"),
        pytest.param({"NO_COLOR": "1"}, False, "─", marks=pytest.mark.slow),
        ({"PYTHONIOENCODING": "ascii", "NO_COLOR": "1"}, False, "+--"),
    ],
)
def test_on_a_terminal(environment, styled, frame):
    text = on_terminal("modes", "dmf_rig", env=environment)
    assert ("\x1b[" in text) == styled
    assert frame in text
    assert "7.10526" in text


def on_terminal(*arguments, env):
    import pty

    master, slave = pty.openpty()
    environment = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "PYTHONIOENCODING")}
    environment |= {"PYTHONPATH": str(Path(tn.__file__).parents[1]), "TERM": "xterm", "COLUMNS": "120", **env}
    child = subprocess.Popen([sys.executable, "-m", "torsionnet", *arguments], stdout=slave, env=environment)
    os.close(slave)
    chunks = []
    try:
        while chunk := os.read(master, 65536):
            chunks.append(chunk)
    except OSError:  # Linux ends a pseudo terminal so
        pass
    os.close(master)
    assert child.wait(PATIENCE) == 0
    return b"".join(chunks).decode("utf-8")


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="pipes of a shell")
@pytest.mark.parametrize("ending", ["| head -2", pytest.param(">&-", marks=pytest.mark.slow)])
def test_files_are_written_though_nobody_reads_what_is_printed(tmp_path, ending):
    words = "frf dmf_rig --output theta_1 --input T_T --full --points 2500 --csv all.csv --plot all.svg"
    shell = f"set -o pipefail; {shlex.quote(sys.executable)} -m torsionnet {words} {ending}"
    done = subprocess.run(["bash", "-c", shell], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert len((tmp_path / "all.csv").read_text().splitlines()) > 2500
    assert (tmp_path / "all.svg").exists()


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "words",
    [
        "frf dmf_rig --output theta_1 --input T_T",
        "modes dmf_rig",
        "sensitivity dmf_rig",
        "show dmf_rig",
    ],
)
def test_files_are_written_before_anything_is_printed(words, tmp_path, monkeypatch):
    command, *rest = words.split()

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("click.echo", interrupted)
    monkeypatch.setattr("torsionnet.app.cli.command.print_file_written", lambda _: None)
    files = [tmp_path / "table.csv", tmp_path / "picture.svg"]
    run(command, *rest, "--csv", files[0], "--plot", files[1], code=130)
    assert all(file.stat().st_size for file in files)


OUTPUT_OPTIONS = {("-o", "--write"), ("--csv",), ("--plot",), ("--json",)}
OUTPUT_WORDS = {word for words in OUTPUT_OPTIONS for word in words}
OWN_FILES = {
    ("fit", ("--write-model",)),
    ("loops", ("--write-model",)),
    ("study", ("-o", "--write")),
    ("study", ("--variants",)),
}


def test_one_vocabulary_of_output():
    for name in COMMANDS:
        command = app.get_command(None, name)
        for option in command.params:
            spelt = tuple(option.opts)
            is_output = isinstance(option.type, OutputFile) or not OUTPUT_WORDS.isdisjoint(spelt)
            assert not is_output or spelt in OUTPUT_OPTIONS or (name, spelt) in OWN_FILES


def test_sensitivity_shows_the_ten_largest():
    short, full = run("sensitivity", "amt_rig", "-c", "V"), run("sensitivity", "amt_rig", "-c", "V", "--full")
    effects = [[line.split() for line in shown.stdout.splitlines() if line.startswith("V ")] for shown in (short, full)]
    assert [len(rows) for rows in effects] == [10, 18]
    moves = [math.hypot(float(row[5]), float(row[3]) * float(row[6])) for row in effects[1]]
    assert sorted(moves)[-10:] == sorted(math.hypot(float(row[5]), float(row[3]) * float(row[6])) for row in effects[0])
    assert "the 10 largest of 18 effects" in short.stdout
    assert "largest of" not in full.stdout
    assert "largest of" not in run("sensitivity", "amt_rig", "-c", "V", "--mode", "1").stdout


def test_sensitivity_of_a_mode_there_is_not():
    said = run("sensitivity", "amt_rig", "--mode", "99", code=2).stderr
    assert re.search(r"99.* 1, 2 \[unknown-mode\]$", said.strip())


def test_screens_are_120_columns_wide():
    shown = run("modes", "six_cylinder_diesel", "--energies", "--shapes").stdout
    assert max(map(len, shown.splitlines())) <= 120
    modes = tn.load("six_cylinder_diesel").modes()
    assert re.findall(r"\|shape (\d+)\|", shown) == [str(number) for number in modes.numbers if number]
    shares = [cell for line in shown.splitlines() if re.match(r"crank_1 .* - ", line) for cell in line.split()[1:]]
    expected = [100 * share for index in range(len(modes)) for share in modes.energy_shares(index)["crank_1"]]
    assert [0 if cell == "-" else float(cell) for cell in shares] == pytest.approx(expected, abs=0.006)


def test_a_model_from_standard_input():
    text = (ROOT / "library" / "dmf_rig.yaml").read_bytes()
    shown = runner().invoke(app, ["modes", "-"], input=text)
    assert shown.exit_code == 0, shown.output
    assert shown.stdout == run("modes", "dmf_rig").stdout
    broken = runner().invoke(app, ["check", "-"], input=BROKEN)
    assert broken.exit_code == 1
    assert '<stdin>:4:46: error: "0.012 kg*m"' in broken.stdout
