"""``torsionnet report``, and the ``report:`` section of model files."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import run, runner
from support.patience import PATIENCE
from support.written_models import CLUTCH

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.entries.scalars import parse_band
from torsionnet.model.channels import Pair
from torsionnet.model.files.model_schema import json_schema
from torsionnet.report.plan.report_plan import ReportPlan

MODEL = """\
torsionnet: 1
name: two masses
elements:
  motor: {type: inertia, node: a, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 1000, damping: 1}
  load: {type: inertia, node: b, inertia: 2}
inputs: {T_M: {torque: a}}
sensors: {T_S: {torque: shaft}, theta_1: {angle: a}}
configurations: {load: {light: {}, heavy: {}}}
"""
DATE = ("--date", "2025-03-31")


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """The file of a test on the bench of the DMF rig."""
    path = tmp_path_factory.mktemp("record") / "test.npz"
    run("bench", "dmf_bench", "-o", path)
    return str(path)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def response_of(record, seconds, band):
    """What the command compares: of a record, between two frequencies."""
    from torsionnet.app.cli.commands.report_command import _measured
    from torsionnet.app.cli.record_options import Averaging, RecordReading

    how = RecordReading(), Averaging(seconds=seconds)
    return _measured(record, tn.load("dmf_rig"), ("theta_1", "T_T"), how, band).response


class TestCommand:
    def test_default_file_is_named_after_the_model(self, folder):
        result = run("report", "dmf_rig", "--section", "validity", *DATE)
        assert result.stdout == ""
        assert result.stderr == "wrote: dmf_rig.html\n"
        assert "2025-03-31" in (folder / "dmf_rig.html").read_text(encoding="utf-8")

    @pytest.mark.few(1)
    @pytest.mark.parametrize("ending", ["html", "md", pytest.param("tex", marks=pytest.mark.slow)])
    def test_by_the_ending(self, folder, ending):
        run("report", "dmf_rig", "-o", f"r.{ending}", "--section", "summary", "--section", "responses", *DATE)
        text = (folder / f"r.{ending}").read_text(encoding="utf-8")
        assert {"html": "<!doctype html>", "md": "# Torsional", "tex": r"\documentclass"}[ending] in text
        assert (folder / "r_figures").is_dir() == (ending != "html")

    def test_options_reach_the_report(self, folder):
        arguments = [
            "--tf",
            "theta_1/T_M",
            "--band",
            "1",
            "30",
            "--author",
            "A. B.",
            "--title",
            "C",
            "--angle-unit",
            "rad",
        ]
        run("report", "dmf_rig", "-o", "r.md", "--section", "summary", "--set", "c_2=8", *arguments, *DATE)
        text = (folder / "r.md").read_text(encoding="utf-8")
        assert text.startswith("# C\n")
        assert "| Author | A. B. |" in text
        assert "| Changed | c\\_2 = 8 |" in text
        assert "between 1 and 30 Hz" in text
        assert "rad/(N·m)" in text
        assert "T_{T}" not in text.partition("## 1")[2]

    def test_configurations(self, folder):
        run("report", "amt_rig", "-c", "V", "-c", "II", "-o", "r.md", "--section", "summary", *DATE)
        text = (folder / "r.md").read_text(encoding="utf-8")
        assert "| Configurations | V, II (of 5) |" in text
        run("report", "amt_rig", "-c", "all", "-o", "s.md", "--section", "summary", *DATE)
        assert "II, III, IV, V, V\\_c\\_O\\_360 |" in (folder / "s.md").read_text(encoding="utf-8")

    def test_without_date(self, folder):
        run("report", "dmf_rig", "-o", "r.md", "--section", "validity", "--date", "none")
        assert "| Date |" not in (folder / "r.md").read_text(encoding="utf-8")

    @pytest.mark.parametrize(
        ("arguments", "code", "message"),
        [
            (["dmf_rig", "--section", "mods"], 2, 'no section is named "mods"; did you mean "modes"?'),
            (["dmf_rig", "--tf", "theta_1"], 2, "OUTPUT/INPUT"),
            (["dmf_rig", "--tf", "theta_2/T_T"], 2, 'did you mean "theta_1"?'),
            (["dmf_rig", "--date", "31.3.25"], 2, "year-month-day"),
            (["dmf_rig", "--band", "9", "1"], 2, "LOW < HIGH"),
            (["dmf_rig", "-o", "r.doc"], 2, "does not end in"),
            (["amt_rig", "-c", "VI"], 2, "VI"),
            (["no_rig"], 2, "no library model"),
            (["dmf_rig", "--fit", "none.yaml"], 2, "none.yaml"),
            (["dmf_rig", "--record", "none.npz", "--output", "theta_1", "--input", "T_T"], 2, "none.npz"),
            (["amt_rig", "--record", "VI=none.npz"], 2, "VI"),
        ],
    )
    def test_wrong_usage(self, folder, arguments, code, message):
        result = run("report", *arguments, code=code)
        assert message in result.stderr
        assert "Traceback" not in result.stderr
        assert list(folder.iterdir()) == []

    def test_wrong_model(self, folder):
        (folder / "m.yaml").write_text(MODEL.replace("stiffness", "stiffnes"), encoding="utf-8")
        assert 'did you mean "stiffness"' in run("report", "m.yaml", code=1).stderr

    def test_no_browser(self, folder, monkeypatch):
        monkeypatch.setenv("TORSIONNET_BROWSER", "/no/such")
        assert "/no/such" in run("report", "dmf_rig", "-o", "r.pdf", "--section", "validity", code=4).stderr
        assert list(folder.iterdir()) == []

    @pytest.mark.slow
    def test_measured_response_over_the_model(self, folder):
        run("frf", "amt_rig", "--output", "theta_1", "--input", "T_T", "--set", "tau=3.26", "--csv", "V.csv")
        result = run("report", "amt_rig", "--record", "V=V.csv", "-o", "r.md", "--section", "validity", *DATE)
        assert "wrote: r.md" in result.stderr
        assert "test and model, configuration V" in (folder / "r.md").read_text(encoding="utf-8")

    @pytest.mark.slow
    def test_record_and_fit(self, folder, record):
        response = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [1, 2, 4, 8, 12, 16])
        tn.identify(tn.load("dmf_rig"), tn.Measurement(response, "theta_1", "T_T"), ["c_2"]).to_yaml("fit.yaml")
        names = ["--output", "theta_1", "--input", "T_T", "--preset", "paper"]
        run(
            "report",
            "dmf_rig",
            "--record",
            record,
            *names,
            "--fit",
            "fit.yaml",
            "-o",
            "r.md",
            "--section",
            "test",
            *DATE,
        )
        text = (folder / "r.md").read_text(encoding="utf-8")
        assert "Test and model" in text
        assert "Fitted parameters" in text

    @pytest.mark.slow
    def test_a_test_is_compared_in_its_band_with_segments_of_its_length(self, folder, record):
        names = ["--record", record, "--output", "theta_1", "--input", "T_T", "--section", "validity", *DATE]
        run("report", "dmf_rig", *names, "--seconds", "4", "--record-band", "2", "9", "-o", "r.md")
        assert "Test and model" in (folder / "r.md").read_text(encoding="utf-8")
        found = response_of(record, 4.0, (2.0, 9.0))
        assert (found.frequencies.min(), found.frequencies.max()) == (2.0, 9.0)
        assert found.frequencies[1] - found.frequencies[0] == pytest.approx(0.25)
        refused = run("report", "dmf_rig", *names, "--record-band", "2e4", "3e4", "-o", "s.md", code=2)
        assert re.search("20000 .* 30000 Hz", refused.stderr)
        assert "LOW < HIGH" in run("report", "dmf_rig", *names, "--record-band", "9", "2", code=2).stderr

    @pytest.mark.slow
    def test_the_summary_has_the_modes_of_the_fit(self, folder):
        rig = tn.load("dmf_rig")
        response = rig.configured(k_2=20e3).frequency_response("theta_1", "T_T", [1, 2, 4, 8, 12, 16])
        tn.identify(rig, tn.Measurement(response, "theta_1", "T_T"), ["k_2"]).to_yaml("fit.yaml")
        run("report", "dmf_rig", "--fit", "fit.yaml", "-o", "r.md", "--section", "summary", *DATE)
        summary = (folder / "r.md").read_text(encoding="utf-8").partition("Fitted parameters")[0]
        rows = summary.partition("of the fitted model")[2]
        assert f"{rig.configured(k_2=20e3).modes().natural_frequencies[0]:.2f}" in rows
        assert f"{rig.modes().natural_frequencies[0]:.2f}" not in rows

    def test_a_model_from_standard_input(self, folder):
        arguments = ["report", "-", "-o", "r.md", "--section", "validity", *DATE]
        assert runner().invoke(app, arguments, input=MODEL).exit_code == 0
        assert "two masses" in (folder / "r.md").read_text(encoding="utf-8")

    @pytest.mark.slow
    def test_a_model_from_standard_input_is_explored(self):
        program = [sys.executable, "-m", "torsionnet", "explore", "-", "--port", "0", "--no-browser"]
        environment = {**os.environ, "PYTHONPATH": str(Path(tn.__file__).parents[1])}
        with subprocess.Popen(
            program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
        ) as running:
            running.stdin.write(MODEL)
            running.stdin.close()
            assert running.stdout.readline().startswith("http://127.0.0.1")
            running.terminate()
            assert running.wait(PATIENCE) in (0, -15, 143)

    @pytest.mark.slow
    def test_time_and_size(self, folder):
        """Under 3 s on an idle machine; told here from user time, with room for a slower one."""
        program = "import resource, torsionnet as tn; tn.write_report('amt_rig', 'r.html', date=None); print(resource.getrusage(resource.RUSAGE_SELF).ru_utime)"
        environment = {**os.environ, "PYTHONPATH": str(Path(tn.__file__).parents[1])}
        done = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment
        )
        assert float(done.stdout) < 6
        assert (folder / "r.html").stat().st_size < 1_500_000


class TestSection:
    def faults(self, section):
        with pytest.raises(tn.ModelError) as caught:
            tn.loads(MODEL + section, "m.yaml")
        return str(caught.value)

    def test_is_read(self):
        rig = tn.loads(MODEL + "report: {title: T, transfer_functions: [theta_1/T_S], band: 0.3..40 Hz, angle: deg}\n")
        assert rig.definition.report == ReportPlan(
            title="T", transfer_functions=(Pair("theta_1", "T_S"),), band=(0.3, 40.0), angle="deg"
        )

    def test_reads_back_what_it_writes(self):
        section = (
            "report: {title: T, author: A, notes: N, sections: [modes, validity], configurations: [heavy], band: [1 Hz, 1e3], "
            "transfer_functions: [theta_1/T_S, {output: b, input: T_S, excitation: T_M}]}\n"
        )
        rig = tn.loads(MODEL + section)
        assert tn.loads(rig.to_yaml()).definition.report == rig.definition.report

    def test_every_fault_at_once_with_its_place(self):
        text = self.faults(
            "report:\n  titel: T\n  sections: [mods, modes]\n  transfer_functions: [theta_1, theta_1/T_S]\n"
            "  band: 40..0.3 Hz\n  angle: grad\n  author: 3\n"
        )
        for place, what in (
            (r"11:3", '"titel".*"title".*unknown-entry'),
            (r"12:14", '"mods".*"modes".*unknown-word'),
            (r"13:24", "OUTPUT/INPUT.*wrong-form"),
            (r"14:9", "unordered-rows"),
            (r"15:10", "rad or deg.*unknown-word"),
            (r"16:11", "3.*wrong-form"),
        ):
            assert re.search(rf"m\.yaml:{place}: error: .*{what}", text), (place, text)

    def test_names_are_those_of_the_model(self):
        text = self.faults("report: {transfer_functions: [theta_2/T_S, theta_1/T_X], configurations: [heavi]}\n")
        assert re.search(r'm\.yaml:10:31: error: .*"theta_2".*"theta_1".*unknown-channel', text)
        assert re.search(r'm\.yaml:10:44: error: .*"T_X".*unknown-channel', text)
        assert re.search(r'm\.yaml:10:75: error: .*"heavi".*"heavy".*unknown-configuration', text)
        assert text.count("m.yaml:10:") == 3

    def test_not_a_mapping(self):
        assert "[wrong-form]" in self.faults("report: 3\n")

    @pytest.mark.parametrize(
        ("raw", "band"),
        [
            ("0.3..40 Hz", (0.3, 40.0)),
            ("0.3 .. 40", (0.3, 40.0)),
            ("18..2400 cpm", (0.3, 40.0)),
            ("0.3 Hz .. 2400 cpm", (0.3, 40.0)),
            (["0.3 Hz", 40], (0.3, 40.0)),
            ("1e-1..1e2 Hz", (0.1, 100.0)),
        ],
    )
    def test_bands(self, raw, band):
        assert parse_band(raw) == pytest.approx(band)

    @pytest.mark.parametrize("raw", ["0.3-40 Hz", "0.3..", "..40", "1..2 N*m", [1], 3, "a..b", [0, 1], ["k", 2]])
    def test_wrong_bands(self, raw):
        with pytest.raises(ValueError, match=r"band|frequency|expected"):
            parse_band(raw)

    def test_schema(self):
        jsonschema = pytest.importorskip("jsonschema")
        validator = jsonschema.Draft202012Validator(json_schema())
        data = tn.load("amt_rig").definition.to_data()
        assert "report" in data
        assert list(validator.iter_errors(json.loads(json.dumps(data)))) == []
        data["report"]["sections"] = ["mods"]
        assert list(validator.iter_errors(data)) != []

    def test_it_decides_what_is_written(self, tmp_path):
        rig = tn.loads(MODEL + "report: {sections: [modes], configurations: [heavy], author: A. B.}\n")
        tn.write_report(rig, tmp_path / "r.md", date=None)
        text = (tmp_path / "r.md").read_text(encoding="utf-8")
        assert "| Configurations | heavy (of 2) |" in text
        assert re.findall(r"^## (.*)$", text, re.MULTILINE) == ["1 Modes"]


@pytest.mark.slow
def test_configurations_without_a_transfer_function_are_left_out_of_it(folder):
    (folder / "clutch.yaml").write_text(CLUTCH, encoding="utf-8")
    run("report", "clutch.yaml", "--tf", "T_c/T", "--tf", "a/T", "-o", "clutch.md", *DATE)
    text = (folder / "clutch.md").read_text(encoding="utf-8")
    assert text.count("Not in configuration open: element") == 1
    # Free to turn: s^2 above and below has gone, the load of the closed clutch is half of all.
    assert r"\frac{b_{0}}{a_{0} + a_{2} s^{2}}" in text
    refused = run("report", "clutch.yaml", "--tf", "T_q/T", code=2)
    assert re.search(r'(?s)T_q/T: .*"T_q".*unknown-channel', refused.stderr)


def test_operating_point_of_the_configuration_reported(folder):
    run("report", "wind_turbine_5mw", "-c", "cut_in", "--section", "parameters", "-o", "wind.md", *DATE)
    text = (folder / "wind.md").read_text(encoding="utf-8")
    speeds = tn.load("wind_turbine_5mw").configured("cut_in").mean_speeds
    slowest = min(abs(speed) for speed in speeds.values() if speed) * 30 / 3.141592653589793
    assert f"{slowest:.3g}" in text
    run("report", "wind_turbine_5mw", "--section", "parameters", "-o", "both.md", *DATE)
    both = (folder / "both.md").read_text(encoding="utf-8")
    assert both.count("Operating point, configuration") == 2
