"""Files that version 1.0 wrote are read by every later 1.x, and give the same numbers."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from support.file_samples import RECORDS, RESPONSES

import torsionnet as tn
from torsionnet.base import deprecation
from torsionnet.base.entries.declared import files_beside
from torsionnet.model.elements import ELEMENT_TYPES, make_element
from torsionnet.study import Workers, answer_study, load_study

SAMPLES = Path(__file__).parents[1] / "samples_1_0"
FIELDS = Path(__file__).parents[1] / "output_fields.txt"
HEAD = "# Fields of what each command prints with --json: later versions add some, none goes (docs/stability.md).\n"
NUMBERS = {
    "amt_rig": ("II", [3.409100939616709, 12.840537767365511]),
    "engine_generator_set": ("firing=normal,rubber=warm", [5.770296846803034, 57.196587160262794]),
    "front_wheel_drive_car": (
        "gear=I,clutch=closed,firing=normal",
        [2.3236261624224306, 10.472331501581674, 19.774777051375374],
    ),
    "two_stroke_ship": ("normal", [0.5809255219960842, 5.163530289369504, 23.45171249645793]),
    "wind_turbine_3mw": ("free", [1.6318481989590996, 1.6318481989591005, 1.6853833590698248]),
}
"""First natural frequencies in Hz above 0 in a configuration, as 1.0 found them."""


@pytest.mark.parametrize("form", ["", "_written"])
@pytest.mark.parametrize("name", NUMBERS)
def test_models(name, form):
    configuration, frequencies = NUMBERS[name]
    rig = tn.load(SAMPLES / f"{name}{form}.yaml").configured(configuration)
    found = rig.modes(lowest=4).natural_frequencies
    assert found[found > 0.01][: len(frequencies)] == pytest.approx(frequencies, rel=1e-6)


def test_every_element_type_of_1_0_is_read():
    elements = json.loads((SAMPLES / "elements.json").read_text(encoding="utf-8"))
    assert {*elements} <= {*ELEMENT_TYPES}
    for kind, data in elements.items():
        entries = {key: value for key, value in data.items() if key != "type"}
        with files_beside(SAMPLES.parent / "sheets"):
            made = make_element(kind, "e", entries).to_data()
        assert {key: made[key] for key in data} == data


@pytest.mark.parametrize("ending", RESPONSES)
def test_responses(ending):
    response = tn.io.read_frequency_response(SAMPLES / f"response.{ending}")
    assert (response.frequencies[6], response.values.shape) == (7, (25, 1, 1))
    single = ending == "uff"
    assert response.values[6, 0, 0] == pytest.approx(
        0.003297504418775325 - 0.022122829041891296j, rel=1e-6 if single else 1e-12
    )


@pytest.mark.parametrize("ending", RECORDS)
def test_records(ending):
    record = tn.signals.read_recording(SAMPLES / f"record.{ending}")
    assert (record.names, record.duration) == (("T_set", "M", "phi"), pytest.approx(2))
    sums = [np.abs(record[name].values).sum() for name in record.names]
    assert sums == pytest.approx([634.7758303574028, 549.7283077799401, 2.6653272073055803], rel=1e-6)


def test_benches():
    bench = tn.load_bench(SAMPLES / "rig.yaml").configured("soft")
    assert bench.plan.acquisition.rate == 100
    steps = tn.load_bench(SAMPLES / "bench.yaml")
    assert (steps.plan.acquisition.bits, [*steps.plan.channels]) == (16, ["phi"])


def test_fit():
    fit = tn.identification.load_fit(SAMPLES / "fit_result.yaml")
    assert dict(fit.values) == pytest.approx({"k": 199.98153438607474, "shaft.damping": 1.000028964044001}, rel=1e-12)
    rig = fit.configured(tn.load(SAMPLES / "rig.yaml"))
    assert rig.parameters["k"] == pytest.approx(199.98153438607474)


@pytest.mark.filterwarnings("ignore:.*is complete, and is read:torsionnet.TorsionnetWarning")
def test_study_folder(tmp_path):
    """Later versions and libraries read what is complete; nothing is calculated once more."""
    for name in ("rig.yaml", "study.yaml"):
        shutil.copy(SAMPLES / name, tmp_path)
    folder = shutil.copytree(SAMPLES / "study_folder", tmp_path / "study_folder")
    done = []
    answered = answer_study(
        load_study(tmp_path / "study.yaml"),
        folder,
        workers=Workers(),
        progress=lambda ready, _total: done.append(ready),
    )
    assert min(done) == 1, "its one chunk was there from the beginning"
    values = answered.result.values("f_1")
    assert (values.mean(), values.std(ddof=1)) == pytest.approx((14.2291, 0.340491), rel=1e-4)


def test_files_of_other_programs():
    assert tn.io.read_tors(SAMPLES / "oil_engine.json").modes().natural_frequencies.size >= 2
    turbine = tn.io.read_mass_elastic(SAMPLES / "marine_steam_turbine.csv")
    expected = tn.load("marine_steam_turbine").modes().undamped_natural_frequencies
    assert turbine.modes().undamped_natural_frequencies == pytest.approx(expected, rel=1e-5, abs=1e-4)


def test_samples_are_small():
    assert sum(path.stat().st_size for path in SAMPLES.rglob("*") if path.is_file()) < 300_000


# Exit codes and deprecations


def test_exit_codes_are_those_of_the_contract():
    page = (SAMPLES.parents[1] / "docs" / "command_line.md").read_text(encoding="utf-8")
    told = {int(code) for code in re.findall(r"^\| (\d+) \| ", page, re.MULTILINE)}
    assert told >= {0, 1, 2, 3, 4, 5, 6, 70, 74, 130, 141}
    codes = {tn.ModelError: 1, tn.UsageError: 2, tn.SolveError: 3, tn.MissingExtraError: 4}
    assert {error: error.exit_code for error in codes} == codes


def test_deprecation_warns_and_is_found_overdue(monkeypatch):
    monkeypatch.setattr(deprecation, "PENDING", [])
    old = deprecation.deprecated(since="1.1", gone="1.3", instead="use new")(lambda: 3)
    with pytest.warns(deprecation.TorsionnetDeprecationWarning, match="goes with version 1.3 .*: use new") as seen:
        assert old() == 3
    assert seen[0].filename == __file__
    (told,) = deprecation.PENDING
    assert [told.overdue(version) for version in ("1.1.0", "1.2.9", "1.3.0", "2.0.0")] == [False, False, True, True]
    with pytest.raises(ValueError, match=r"it stays until 1\.3"):
        deprecation.Deprecation("f", "1.1", "1.2", "")
