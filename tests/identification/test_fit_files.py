"""What a fit file becomes, entry by entry, and what is said where an entry is wrong."""

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.base.entries.scalars import Band, Bands
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.identification.plan.fit_entries import FitFile
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.model_schema import file_schema
from torsionnet.signals import Recording, Signal, Welch, write_recording

RIG = """\
torsionnet: 1
name: disc
elements:
  rotor: {type: inertia, node: a, inertia: J}
  shaft: {type: spring, nodes: [a, ground], stiffness: k, damping: c}
parameters: {J: 0.1, k: 400 N*m/rad, c: 1}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}}
configurations: {soft: {k: 200 N*m/rad}, hard: {k: 800 N*m/rad}}
"""
FIT = """\
torsionnet: 1
model: rig.yaml
parameters:
  k: {start: 0.3 kN*m/rad, bounds: [50, 2 kN*m/rad], per_configuration: true}
  c: {prior: [1, 0.5 N*m*s/rad]}
  J: 0.2 kg*m^2
measurements:
  soft: {record: run.npz, output: phi, input: T, band: [1 Hz, 25 Hz], excluded: [[5 Hz, 6 Hz], [0.01 kHz, 11 Hz]]}
  other: {response: frf.csv, output: phi, input: T, configuration: hard, excluded: [7 Hz, 8 Hz], delay: true}
  third: {record: run.npz, output: phi, input: T_set, model_output: phi, model_input: T, excitation: T, gain: true, settling: 500 ms}
settings: {window: hann, seconds: 4 s, overlap: 50 %, detrend: linear, decimation: 2}
residual: log
loss: huber
starts: 3
true: {k: 0.2 kN*m/rad, c: 1}
"""
UNITS = (Channel("phi", "rad"),), (Channel("T", "N*m"),)
RESPONSE = FrequencyResponse(np.array([1.0, 2.0]), np.ones((2, 1, 1), dtype=complex), *UNITS)


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "rig.yaml").write_text(RIG)
    (tmp_path / "frf.csv").write_text("not read by a test")
    values = np.random.default_rng(1).normal(size=(3, 50))
    signals = (
        Signal("phi", "angle", values[0]),
        Signal("T", "torque", values[1]),
        Signal("T_set", "torque", values[2]),
    )
    write_recording(Recording(signals, 100.0), tmp_path / "run.npz")

    def read(text):
        path = tmp_path / "fit.yaml"
        path.write_text(text)
        return load_fit_plan(path, lambda _: RESPONSE)

    return read


class TestPlan:
    def test_model_and_options(self, plan):
        found = plan(FIT)
        assert found.model.parameters["k"] == 400
        assert found.options == {"residual": "log", "loss": "huber", "starts": 3}
        assert found.true == {"k": 200, "c": 1}

    def test_parameters(self, plan):
        assert plan(FIT).parameters == {
            "k": tn.Unknown(300, (50, 2000), per_configuration=True),
            "c": tn.Unknown(prior=(1, 0.5)),
            "J": tn.Unknown(0.2),
        }

    def test_parameters_by_name_alone(self, plan):
        text = FIT[: FIT.index("parameters:")] + "parameters: [k, c]\n" + FIT[FIT.index("measurements:") :]
        assert plan(text).parameters == {"k": tn.Unknown(), "c": tn.Unknown()}

    def test_measurements(self, plan):
        soft, other, third = plan(FIT).measurements
        assert (soft.label, soft.configuration, soft.band) == ("soft", "soft", (1, 25))
        assert soft.excluded == ((5, 6), (10, 11))
        assert (soft.delay, soft.gain, soft.settling, soft.model_output) == (False, False, 0, "")
        assert soft.data.names == ("phi", "T", "T_set")
        assert soft.data.sampling_rate == 100
        assert (other.label, other.configuration, other.band) == ("other", "hard", None)
        assert (other.excluded, other.delay, other.gain) == (((7, 8),), True, False)
        assert other.data is RESPONSE
        assert (third.label, third.configuration) == ("third", "")
        assert (third.output, third.input, third.excitation) == ("phi", "T_set", "T")
        assert (third.model_output, third.model_input, third.gain, third.settling) == ("phi", "T", True, 0.5)

    def test_name_of_one_alternative_means_it_beside_another_choice(self, plan, tmp_path):
        plan(FIT)
        alternatives = "configurations: {stiffness: {soft: {k: 200 N*m/rad}, hard: {k: 800 N*m/rad}}, rotor: {light: {J: 0.1}, heavy: {J: 0.2}}}"
        (tmp_path / "rig.yaml").write_text(RIG[: RIG.index("configurations:")] + alternatives)
        soft, _, third = load_fit_plan(tmp_path / "fit.yaml", lambda _: RESPONSE).measurements
        assert soft.configuration == "stiffness=soft"
        assert third.configuration == ""

    def test_settings(self, plan):
        soft, other, third = plan(FIT).measurements
        assert soft.settings == third.settings == Welch("hann", 4, 0.5, "linear", 2)
        assert other.settings is None

    def test_settings_of_the_paper_with_one_changed(self, plan):
        text = FIT.replace("window: hann, seconds: 4 s, overlap: 50 %, detrend: linear,", "preset: paper,")
        settings = plan(text).measurements[0].settings
        assert settings == Welch("hamming", 2, 0.8, decimation=2, estimator="H2")

    def test_without_what_is_optional(self, plan):
        found = plan(FIT[: FIT.index("settings:")])
        assert (found.options, found.true) == ({}, {})
        assert found.measurements[0].settings == Welch("hamming", 2, 0.8)


FAULTS = [
    ("torsionnet: 1", "torsionnet: 2", "wrong-version"),
    ("per_configuration: true", "per_configuration: 1", "wrong-form"),
    ("bounds: [50, ", "bounds: [1, 50, ", "wrong-form"),
    ("bounds: [50, ", "bounds: [3000, ", "unordered-rows"),
    ("[1, 0.5 N*m*s/rad]", "[1, 0]", "out-of-range"),
    ("[1, 0.5 N*m*s/rad]", "[1, k]", "not-a-number"),
    ("prior:", "pror:", "unknown-entry"),
    ("gain: true", "gian: true", "unknown-entry"),
    ("decimation: 2", "decimaton: 2", "unknown-entry"),
    ("decimation: 2", "band: 2", "unknown-entry"),
    ("decimation: 2", "to: 40", "unknown-entry"),
    ("decimation: 2", "preset: papre", "unknown-word"),
    ("overlap: 50 %", "overlap: 1", "out-of-range"),
    ("excluded: [7 Hz, 8 Hz]", "excluded: [8 Hz, 7 Hz]", "unordered-rows"),
    ("excluded: [7 Hz, 8 Hz]", "excluded: [7 Hz, 7 Hz]", "unordered-rows"),
    ("excluded: [7 Hz, 8 Hz]", "excluded: 7 Hz", "wrong-form"),
    ("response: frf.csv", "response: frf.cvs", "missing-file"),
    ("soft: {record: run.npz,", "soft: {record: run.npz, response: frf.csv,", "missing-entry"),
]  # fmt: skip


@pytest.mark.parametrize(("good", "bad", "kind"), FAULTS)
def test_one_fault(plan, good, bad, kind):
    text = FIT.replace(good, bad, 1)
    line = next(
        at for at, (one, other) in enumerate(zip(text.splitlines(), FIT.splitlines(), strict=True), 1) if one != other
    )
    with pytest.raises(ModelError) as caught:
        plan(text)
    assert [(fault.position.line, fault.severity, fault.kind) for fault in caught.value.faults] == [
        (line, "error", kind)
    ]


def test_all_faults_at_once(plan):
    text = FIT.replace("hann", "[1]").replace("third: {", "third: 3 # {").replace("bounds:", "bonds:")
    with pytest.raises(ModelError) as caught:
        plan(text)
    assert [fault.position.line for fault in caught.value.faults] == [4, 10, 11]


@pytest.mark.parametrize("key", ["model", "parameters", "measurements"])
def test_missing(plan, key):
    lines = [line for line in FIT.splitlines() if not line.startswith("  ")]
    text = "\n".join(line for line in lines if not line.startswith(f"{key}:"))
    with pytest.raises(ModelError, match=f"a fit needs {key}:"):
        plan(text)


def test_searches_begin_at_a_thousand_places_at_most(plan):
    assert plan(FIT.replace("starts: 3", "starts: 1000")).options["starts"] == 1000
    with pytest.raises(ModelError, match=r":14:9: .*1000.*1001.*out-of-range"):
        plan(FIT.replace("starts: 3", "starts: 1001"))


def test_no_file(tmp_path):
    with pytest.raises(UsageError, match="missing-file"):
        load_fit_plan(tmp_path / "none.yaml", lambda _: RESPONSE)


def test_the_schema_of_fit_files_takes_what_is_read():
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(file_schema(FitFile))
    sound = compose(FIT, "fit.yaml").data
    assert [error.message for error in validator.iter_errors(sound)] == []
    assert [error.message for error in validator.iter_errors({**sound, "parameters": ["k", "c"]})] == []
    assert [
        error.message for error in validator.iter_errors({**sound, "parameters": {"k": None, "c": "3 N*m*s/rad"}})
    ] == []
    for wrong in (
        {**sound, "model": 3},
        {**sound, "parameters": []},
        {**sound, "settings": {"secnds": 1}},
        {"torsionnet": 1},
    ):
        assert list(validator.iter_errors(wrong)) != []


@pytest.mark.parametrize(
    ("raw", "found"),
    [
        (["0 Hz", "20 Hz"], ((0, 20),)),
        ("0..20 Hz", ((0, 20),)),
        ("60..1200 cpm", ((1, 20),)),
        ([["1 Hz", "2 Hz"], [3, 4]], ((1, 2), (3, 4))),
        (["1..2 Hz", "3..4 Hz"], ((1, 2), (3, 4))),
        ([], ()),
    ],
)
def test_bands_in_every_way_of_writing(raw, found):
    assert Bands("").coerce(raw) == found
    if len(found) == 1:
        assert Band("", from_zero=True).coerce(raw) == found[0]
    assert Bands("").coerce(Bands("").plain(found)) == found


def test_a_plot_over_decades_does_not_begin_at_zero():
    with pytest.raises(EntryError, match="both above 0"):
        Band("").coerce(["0 Hz", "20 Hz"])


class TestReading:
    """What the file of a record does not tell, said in a fit file; and what a message advises there."""

    @pytest.fixture
    def bare(self, plan, tmp_path):
        np.savez(tmp_path / "bare.npz", **{name: np.arange(50.0) for name in ("phi", "T")})

        def read(reading=""):
            measurement = f"measurements:\n  soft: {{record: bare.npz, output: phi, input: T{reading}}}\n"
            return plan(f"torsionnet: 1\nmodel: rig.yaml\nparameters: [k]\n{measurement}")

        return read

    def test_rate_quantities_and_units_are_taken(self, bare):
        told = "quantities: {phi: angle, T: torque}, units: {T: kN*m}"
        record = bare(f", reading: {{rate: 0.1 kHz, {told}}}").measurements[0].data
        assert (record.sampling_rate, record["T"].values[2], record["phi"].quantity) == (100, 2000, "angle")

    def test_the_command_advises_these_entries(self, bare, tmp_path):
        with pytest.raises(ModelError, match="sampling_rate="):
            bare(", reading: {quantities: {phi: angle, T: torque}}")
        (tmp_path / "fit.yaml").write_text(
            "torsionnet: 1\nmodel: rig.yaml\nparameters: [k]\nmeasurements:\n"
            "  soft: {record: bare.npz, output: phi, input: T, reading: {quantities: {phi: angle, T: torque}}}\n"
        )
        said = run("fit", tmp_path / "fit.yaml", code=1).stderr
        assert "reading: {rate: ...}" in said
        assert "--sampling-rate" not in said

    def test_a_fault_in_it_has_its_place(self, bare):
        with pytest.raises(ModelError, match=r':5:61: .*"rate".*unknown-entry'):
            bare(", reading: {rat: 1 kHz}")
