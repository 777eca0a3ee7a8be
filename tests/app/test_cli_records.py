"""The commands for records: bench, estimate, compare, spectrogram."""

import csv
import json
import re

import numpy as np
import pytest
from support.command_line import run
from support.known_damping import two_light_modes
from support.written_models import TWO_DISCS

import torsionnet as tn
from torsionnet.base.notes import warning
from torsionnet.signals import Recording, Signal, read_recording, write_recording


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.yaml").write_text(TWO_DISCS)
    return tmp_path


@pytest.fixture
def record(folder):
    run("bench", "rig.yaml", "-o", "test.npz")
    return folder / "test.npz"


def rows(path):
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


@pytest.mark.slow
def test_bench_writes_the_record_and_says_what_is_in_it(folder):
    result = run("bench", "rig.yaml", "--plot", "signals.png")
    assert (folder / "rig.npz").is_file()
    assert (folder / "signals.png").stat().st_size > 10_000
    assert re.search(r"phi +rad .*encoder of 5000 lines, in quadrature: steps of 0.018 deg", result.stdout)
    assert "15000 samples at 500 Hz, 30 s" in result.stdout
    record = read_recording(folder / "rig.npz")
    assert record.names == ("T_set", "M", "phi")
    expected = tn.load_bench("rig.yaml").run()
    assert all(np.array_equal(record[name].values, expected[name].values) for name in record.names)


def test_bench_of_all_configurations_and_seeds(folder):
    data = json.loads(run("bench", "rig.yaml", "-c", "all", "--seed", 5, "--json", "-o", "run.csv").stdout)
    assert [entry["file"] for entry in data] == ["run_soft.csv", "run_hard.csv"]
    assert data[0]["channels"][2]["name"] == "phi"
    assert all((folder / entry["file"]).is_file() for entry in data)
    soft = tn.load_bench("rig.yaml").configured("soft").run(seed=5)
    written = read_recording(folder / "run_soft.csv")
    assert np.allclose(written["M"].values, soft["M"].values, rtol=1e-6, atol=1e-9)


def test_two_tests_in_each_of_two_configurations_are_four_files(folder, monkeypatch):
    from torsionnet.app.cli.commands import bench_and_campaign

    ways, tested = ("up", "down"), bench_and_campaign._tested
    monkeypatch.setattr(
        bench_and_campaign,
        "_tested",
        lambda *args, **more: (
            {
                way: record.with_notes(warning(f"driven {way}"))
                for record in tested(*args, **more)[0].values()
                for way in ways
            },
            {},
        ),
    )
    said = run("bench", "rig.yaml", "-c", "all", "-o", "run.npz").stderr
    assert all(f"warning: driven {way}" in said for way in ways)
    assert sorted(path.name for path in folder.glob("run*.npz")) == [
        f"run_{stiff}_{way}.npz" for stiff in ("hard", "soft") for way in ("down", "up")
    ]


def test_bench_gives_the_truth_on_request(folder):
    run("bench", "rig.yaml", "--truth", "--set", "k=300", "-o", "t.npz")
    truth = tn.load_bench("rig.yaml").configured(k=300).truth
    assert np.array_equal(read_recording(folder / "t.npz")["phi"].values, truth["phi"].values)


@pytest.mark.slow
def test_estimate_finds_the_model_again(record):
    result = run("estimate", record, "--input", "T_set", "--output", "phi", "--csv", "h.csv", "--plot", "h.svg")
    assert "peak 1" in result.stdout
    found = rows(record.parent / "h.csv")
    frequencies = np.array([float(row["frequency [Hz]"]) for row in found])
    size = np.array([float(row["|phi/T_set| [rad/(N*m)]"]) for row in found])
    band = (frequencies > 2) & (frequencies < 20)
    model = tn.load("rig.yaml").frequency_response("phi", "T", frequencies[band]).magnitude[:, 0, 0]
    assert np.abs(20 * np.log10(size[band] / model)).max() < 0.9
    assert (record.parent / "h.svg").read_text(encoding="utf-8").startswith("<?xml")


def test_estimate_against_the_set_point(record):
    options = ("--input", "M", "--output", "phi", "--reference", "T_set", "--json")
    data = json.loads(run("estimate", record, *options).stdout)
    expected = tn.signals.estimate(read_recording(record), "phi", "M", "Hr", reference="T_set")
    assert data["responses"][0]["real"] == pytest.approx(expected.values[:, 0, 0].real.tolist())
    assert any(note.startswith("Hr with T_set as reference") for note in data["notes"])
    refused = run("estimate", record, *options, "--estimator", "H2", code=2)
    assert re.search("H2 .* T_set .needless-entry", refused.stderr)
    assert "No such option" in run("spectrogram", record, "--estimator", "H2", code=2).stderr


def test_estimate_in_json_with_its_settings(record):
    options = ("--estimator", "H2", "--seconds", 4, "--overlap", 0.5, "--window", "hann", "--detrend", "linear")
    result = run(
        "estimate",
        record,
        "--input",
        "M",
        "--output",
        "phi",
        *options,
        "--band",
        0,
        20,
        "--angle-unit",
        "deg",
        "--json",
    )
    data = json.loads(result.stdout)
    assert data["frequencies_Hz"][:2] == [0.25, 0.5]
    assert data["frequencies_Hz"][-1] == 20
    assert any("H2, Welch, hann 4 s, overlap 50%, detrend linear" in note for note in data["notes"])
    assert data["responses"][0]["unit"] == "deg/(N*m)"
    at = data["frequencies_Hz"].index(5.0)
    # The torque meter sits at the fixed end: theta over torque is the compliance of the shaft.
    assert data["responses"][0]["real"][at] == pytest.approx(np.degrees((1 / (400 + 2j * np.pi * 5)).real), rel=0.02)


@pytest.mark.parametrize("ending", ["uff", "mat", "npz", "csv"])
def test_estimate_writes_the_response_for_other_programs(record, ending):
    if ending == "uff":
        pytest.importorskip("pyuff")
    path = record.parent / f"frf.{ending}"
    run("estimate", record, "--input", "M", "--output", "phi", "--band", 0, 30, "-o", path)
    found = tn.io.read_frequency_response(path)
    expected = tn.signals.estimate(read_recording(record), "phi", "M").between(0, 30)
    assert np.allclose(found.values, expected.values, rtol=1e-12)
    assert np.allclose(found.coherence, expected.coherence, rtol=1e-12)
    assert np.allclose(found.frequencies, expected.frequencies)
    assert (found.outputs, found.inputs) == (expected.outputs, expected.inputs)


@pytest.mark.slow
def test_compare_shows_how_far_test_and_model_are_apart(record):
    arguments = ("compare", record, "rig.yaml", "--output", "phi", "--input", "M", "--band", 1, 25)
    data = json.loads(run(*arguments, "--json", "--plot", "c.png", "--csv", "c.csv").stdout)
    worst = {row["what"]: row["value"] for row in data["summary"]}
    assert abs(worst["largest difference in magnitude"]) < 0.3
    assert worst["FRAC"] > 0.999
    assert len(data["difference_dB"]) == len(data["test"]["frequencies_Hz"]) == len(rows(record.parent / "c.csv"))
    stiff = json.loads(run(*arguments, "-c", "hard", "--json").stdout)
    decibels = {row["what"]: row["value"] for row in stiff["summary"]}["RMS difference in magnitude"]
    assert decibels == pytest.approx(20 * np.log10(2), abs=0.2)
    assert "largest difference in phase" in run(*arguments).stdout


def test_compare_when_the_record_has_other_names(folder):
    bench = tn.load_bench("rig.yaml")
    record = bench.run()
    write_recording(
        Recording(
            (Signal("MD1", "torque", record["M"].values), Signal("Winkel", "angle", record["phi"].values)), 500.0
        ),
        folder / "other.npz",
    )
    names = ("--output", "Winkel", "--input", "MD1", "--model-output", "phi", "--model-input", "M")
    result = run("compare", "other.npz", "rig.yaml", *names, "--band", 1, 20)
    assert "Winkel/MD1" in result.stdout


def test_compare_takes_one_configuration(record):
    result = run("compare", record, "rig.yaml", "-c", "all", "--output", "phi", "--input", "M", code=2)
    assert "name one with -c" in result.stderr


@pytest.mark.slow
def test_spectrogram_follows_the_sweep(record):
    result = run(
        "spectrogram", record, "--channel", "M", "--channel", "phi", "--plot", "s.png", "--csv", "s.csv", "--up-to", 40
    )
    assert "strongest" in result.stdout
    assert {"s_M.png", "s_phi.png", "s_M.csv", "s_phi.csv"} <= {path.name for path in record.parent.iterdir()}
    found = rows(record.parent / "s_M.csv")
    for row in found[::20]:
        expected = 1 + 29 * float(row["time [s]"]) / 30
        assert float(row["strongest line [Hz]"]) == pytest.approx(expected, abs=1.1)
    data = json.loads(run("spectrogram", record, "--channel", "M", "--json").stdout)[0]
    assert np.shape(data["amplitude"]) == (len(data["frequencies_Hz"]), len(data["times_s"]))


def test_text_of_another_program(folder):
    """Semicolons, decimal commas, degrees, time stamps with jitter."""
    record = tn.load_bench("rig.yaml").run()
    time = record.time + np.random.default_rng(1).uniform(-2e-4, 2e-4, len(record))
    lines = ["Zeit [s];MD [Nm];Winkel [deg]"]
    table = zip(time, record["M"].values, np.degrees(record["phi"].values), strict=True)
    lines += [";".join(f"{value:.7f}".replace(".", ",") for value in row) for row in table]
    (folder / "mess.csv").write_text("\n".join(lines))
    arguments = ("estimate", "mess.csv", "--input", "MD", "--output", "Winkel", "--band", 0, 20)
    refused = run(*arguments, "--plot", "h.png", code=1)
    assert "resample" in refused.stderr
    assert not (folder / "h.png").exists()
    data = json.loads(run(*arguments, "--resample", "--json").stdout)
    at = int(np.abs(np.array(data["frequencies_Hz"]) - 5).argmin())
    assert data["responses"][0]["real"][at] == pytest.approx(1 / 400, rel=0.02)


def test_a_table_without_units_has_one_fault_whose_options_mend_it(folder):
    rows = np.random.default_rng(2).normal(size=(2000, 2))
    lines = ["time;M;phi", *(f"{at / 100};{one:.5f};{other:.5f}" for at, (one, other) in enumerate(rows))]
    (folder / "mess.csv").write_text("\n".join(lines))
    arguments = ("estimate", "mess.csv", "--input", "M", "--output", "phi")
    told = run(*arguments, code=1).stderr
    assert told.count("error: ") == 1
    (options,) = re.findall(r"phi, M have no unit; .*, for example (.*) \[missing-unit\]", told)
    assert options == "--quantity phi=angle --quantity M=torque"
    run(*arguments, *options.split())


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (lambda x: np.where(np.arange(len(x)) == 500, np.nan, x), "M: 1 value NaN or infinite: at 1 s"),
        (lambda x: np.clip(x, -2, 2), "M: clipped: "),
    ],
)
def test_faulty_records_are_refused_and_nothing_is_written(folder, values, message):
    record = tn.load_bench("rig.yaml").run()
    bad = record.with_signals(Signal("M", "torque", values(record["M"].values)))
    write_recording(bad, folder / "bad.npz")
    before = sorted(folder.iterdir())
    result = run("estimate", "bad.npz", "--input", "M", "--output", "phi", "--csv", "h.csv", "--plot", "h.png", code=1)
    assert message in result.stderr
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("bench", "rigg.yaml"), 2, "[missing-file]"),
        (("bench", "rig.yaml", "-o", "x.docx"), 2, ".docx"),
        (("bench", "dmf_rig"), 2, "add bench:"),
        (("bench", "rig.yaml", "-c", "sfot"), 2, 'did you mean "soft"'),
        (("estimate", "none.npz", "--input", "M", "--output", "phi"), 2, '"none.npz" [missing-file]'),
        (("estimate", "test.npz", "--input", "N", "--output", "phi"), 1, "N"),
        (("estimate", "test.npz", "--input", "M", "--output", "phi", "--window", "hanning9"), 2, "hanning9"),
        (("estimate", "test.npz", "--input", "M", "--output", "phi", "--unit", "kNm"), 2, "CHANNEL=UNIT"),
        (
            ("estimate", "test.npz", "--input", "M", "--output", "phi", "--seconds", "100"),
            1,
            "[too-short]",
        ),
        (("compare", "test.npz", "rig.yaml", "--output", "psi", "--input", "M"), 1, "psi"),
        (("compare", "test.npz", "rig.yaml", "--output", "phi", "--input", "M", "--model-input", "N"), 2, "N"),
        (("spectrogram", "test.npz", "--channel", "X"), 1, "X"),
    ],
)
@pytest.mark.usefixtures("record")
def test_wrong_questions(arguments, code, message):
    result = run(*arguments, code=code)
    assert message in result.stderr
    assert "unexpected" not in result.stderr


def test_faults_in_a_rig_are_all_told(folder):
    (folder / "bad.yaml").write_text(
        TWO_DISCS.replace("lines: 5000", "lines: 0").replace("amplitude: 5 N*m", "amplitude: 5 kg")
    )
    result = run("bench", "bad.yaml", code=1)
    assert "bad.yaml:11:" in result.stderr
    assert "bad.yaml:12:" in result.stderr
    assert "2 errors" in result.stderr
    assert not list(folder.glob("*.npz"))


def test_large_records_are_read_in_blocks(record, monkeypatch):
    from torsionnet.signals.records import recording_files as large_records

    arguments = ("estimate", record, "--input", "M", "--output", "phi", "--decimate", 2, "--json")
    whole = json.loads(run(*arguments).stdout)
    monkeypatch.setattr(large_records, "LARGE_FILE", 1000)
    monkeypatch.setattr(large_records, "BLOCK_SECONDS", 7.0)
    result = run(*arguments)
    assert "read in blocks of 7 s" in result.stderr
    blocks = json.loads(result.stdout)
    assert np.allclose(blocks["responses"][0]["real"], whole["responses"][0]["real"], rtol=1e-9, atol=1e-15)


def test_warnings_are_about_the_band_asked_for(folder):
    write_recording(two_light_modes(), folder / "modes.npz")
    arguments = ("estimate", "modes.npz", "--input", "T", "--output", "t")
    assert re.search("at the peak at 5 Hz .*, 48 Hz", run(*arguments).stderr)
    low = run(*arguments, "--band", 0, 20).stderr
    assert "at the peak at 5 Hz" in low
    assert "48 Hz" not in low
    assert "peak" not in run(*arguments, "--band", 20, 40).stderr


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("number", ["nan", "inf"])
@pytest.mark.parametrize(
    "command",
    [("spectrogram", "test.npz", "--span"), ("estimate", "test.npz", "--input", "M", "--output", "phi", "--seconds")],
)
def test_a_number_that_is_none_is_wrong_usage(command, number):
    assert "no finite number" in run(*command, number, code=2).stderr
