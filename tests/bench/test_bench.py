"""Virtual test benches: exciter, sensors and acquisition against what each is said to do; their files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.bench.plan import Acquisition, Encoder, Exciter, Plan, Transducer
from torsionnet.bench.recorded_signal import exciter_output, recorded_signal
from torsionnet.model.files.library import library_benches, library_folder
from torsionnet.model.files.model_schema import json_schema
from torsionnet.signals import PAPER, BurstRandom, LinearChirp, Recording, Signal, difference, estimate
from torsionnet.signals.excitation import LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.order_tracking import sweep_harmonics
from torsionnet.signals.uncertainty import resolution, step_of

RATE = 2000.0
CHIRP = LinearChirp(start=1, stop=50, duration=40, amplitude=15)
TORQUE = LinearChirp(start=0.1, stop=80, duration=100, amplitude=15)
KINDS = {"N*m": "torque", "rad": "angle"}


def fit(values, frequency, rate, start=0.0):
    """Complex amplitude of a sine, ``Im(a exp(j 2 pi f t))``, by least squares after ``start`` s."""
    time = np.arange(len(values)) / rate
    late = time >= start
    angle = 2 * np.pi * frequency * time[late]
    basis = np.column_stack([np.sin(angle), np.cos(angle), np.ones_like(angle)])
    sine, cosine, _ = np.linalg.lstsq(basis, values[late], rcond=None)[0]
    return sine + 1j * cosine


def a_signal(values, quantity="torque"):
    return Signal("x", quantity, np.asarray(values, dtype=float))


def recorded(values, part, acquisition=None, seed=0, quantity="torque"):
    acquisition = acquisition or Acquisition(rate=RATE)
    return recorded_signal(a_signal(values, quantity), part, acquisition, np.random.default_rng(seed))


# Exciter


def test_ideal_exciter_delivers_its_set_point():
    given = exciter_output(CHIRP, Exciter(), RATE)
    assert np.array_equal(given.torque, CHIRP.samples(RATE))
    assert np.array_equal(given.set_point, given.torque)


@pytest.mark.parametrize("frequency", [5.0, 60.0, 120.0])
def test_bandwidth_is_where_the_torque_is_3_db_down(frequency):
    sine = SteppedSine(frequencies=(frequency,), hold=2, amplitude=10)
    torque = exciter_output(sine, Exciter(bandwidth=60), 50_000).torque
    found = fit(torque, frequency, 50_000, start=1)
    expected = 10 / (1 + 1j * frequency / 60)
    held = np.exp(-1j * np.pi * frequency / 50_000)  # the analog output holds each value for a sample
    assert found == pytest.approx(expected * held, rel=2e-4)


def test_compensated_set_point_flattens_the_torque():
    given = exciter_output(CHIRP, Exciter(bandwidth=20, compensated=True), RATE)
    wanted = CHIRP.samples(RATE)
    assert np.abs(given.torque - wanted).max() < 1e-9
    assert np.abs(given.set_point[-2000:]).max() == pytest.approx(15 * np.hypot(1, 50 / 20), rel=0.02)


def test_harmonics_have_their_shares_and_leave_the_fundamental_alone():
    given = exciter_output(replace(CHIRP, mean=20), Exciter(harmonics={2: 0.02, 3: "1.3 %"}), RATE)
    record = Recording((Signal("T", "torque", given.torque),), RATE)
    found = sweep_harmonics(record, "T", CHIRP.frequency(record.time), orders=(1, 2, 3, 4))
    assert np.abs(found.amplitude - 15 * np.array([1, 0.02, 0.013, 0])).max() < 0.01
    assert given.torque.mean() == pytest.approx(20 + CHIRP.samples(RATE).mean(), abs=1e-3)


def test_silence_stays_silent():
    burst = BurstRandom(start=1, stop=40, period=4, periods=2, amplitude=10)
    torque = exciter_output(burst, Exciter(harmonics={3: 0.1}), RATE).torque
    assert np.abs(torque[5000:7000]).max() < 1e-12


def test_set_point_is_clipped_at_the_rated_torque_and_says_so():
    given = exciter_output(replace(CHIRP, amplitude=150), Exciter(limit=110), RATE)
    assert np.abs(given.torque).max() == 110
    (note,) = given.notes
    assert "clipped at the rated torque of 110 N*m 48 % of the time; it asks for 150 N*m" in note
    assert exciter_output(replace(CHIRP, amplitude=110), Exciter(limit=110), RATE).notes == ()


def test_analog_output_has_so_many_levels():
    given = exciter_output(CHIRP, Exciter(bits=8, full_scale=16), RATE)
    assert step_of(given.set_point) == pytest.approx(32 / 256)
    assert np.abs(given.set_point - CHIRP.samples(RATE)).max() <= 0.0625 + 1e-12


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"bits": 13}, r"bits: .*missing-entry"),
        ({"compensated": True}, "nothing to compensate"),
        ({"bandwidth": 0}, "greater than 0"),
        ({"bandwidth": "60 N*m"}, r"bandwidth: .*wrong-unit"),
        ({"harmonics": {1: 0.1}}, "from 2 to 20"),
        ({"harmonics": {2: "1 Hz"}}, "plain number"),
        ({"limit": "k_1"}, r"limit: .*expression-not-allowed"),
    ],
)
def test_impossible_exciters_are_refused(entries, message):
    with pytest.raises(ModelError, match=message):
        Exciter(**entries)


# Sensors and acquisition


def test_encoder_counts_whole_steps_from_zero():
    angle = 0.3 * np.sin(np.arange(100_000) / 500)
    signal = recorded(angle, Encoder(lines=1024, quadrature=True), quantity="angle")
    step = 2 * np.pi / 4096
    counts = signal.values / step
    assert np.abs(counts - np.rint(counts)).max() < 1e-9
    assert signal.values[0] == 0
    error = signal.values - angle
    assert np.ptp(error) <= step
    assert error.std() == pytest.approx(step / np.sqrt(12), rel=0.02)


def test_where_an_encoder_starts_is_a_matter_of_chance():
    angle = np.full(50, 0.0)
    angle[25:] = 0.4 * 2 * np.pi / 100
    seen = {float(recorded(angle, Encoder(lines=100), seed=n, quantity="angle").values[-1]) for n in range(40)}
    assert len(seen) == 2


def test_transducer_reads_gain_offset_and_noise():
    signal = recorded(np.full(200_000, 50.0), Transducer(gain=1.02, offset="0.5 N*m", noise="0.23 N*m"))
    assert signal.values.mean() == pytest.approx(51.5, abs=0.003)
    assert signal.values.std() == pytest.approx(0.23, rel=0.01)


def test_transducer_clips_at_its_range_and_says_so():
    signal = recorded([0, 300, -300, 100], Transducer(range=230))
    assert signal.values.tolist() == [0, 230, -230, 100]
    assert "clipped at its range of 230 N*m in 2 samples" in signal.notes[-1]


def test_analog_input_divides_the_range():
    signal = recorded(np.linspace(-200, 200, 5000), Transducer(range=256), Acquisition(rate=RATE, bits=9))
    assert step_of(signal.values) == pytest.approx(1.0)


def test_anti_alias_filter_is_3_db_down_at_its_cut_off():
    rate, cut_off = 20_000, 400.0
    sine = np.sin(2 * np.pi * cut_off * np.arange(40_000) / rate)
    signal = recorded(5 + sine, Transducer(), Acquisition(rate=rate, anti_alias=cut_off))
    assert abs(fit(signal.values, cut_off, rate, start=0.5)) == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert signal.values[0] == pytest.approx(5)


@pytest.mark.parametrize("delay", [0.0, 1e-3, 0.37e-3])
def test_channel_delay_is_a_phase(delay):
    sine = np.sin(2 * np.pi * 30 * np.arange(20_000) / RATE)
    for part in (Transducer(delay=delay), Encoder(lines=10_000_000, delay=f"{1000 * delay} ms")):
        signal = recorded(sine, part, quantity="angle")
        assert fit(signal.values, 30, RATE, start=1) == pytest.approx(np.exp(-2j * np.pi * 30 * delay), abs=1e-4)


def test_cut_off_above_half_the_rate_is_refused():
    with pytest.raises(ModelError, match=r"anti_alias: .*1000.*out-of-range"):
        Acquisition(rate=2000, anti_alias=1000)


# The whole bench


def plan(**changes):
    channels = {"T_T": Transducer(noise=0.23), "theta_1": Encoder(lines=1024, quadrature=True)}
    entries = {"excitation": CHIRP, "channels": channels, "acquisition": Acquisition(rate=RATE), **changes}
    return Plan(**entries)


def test_seeds_repeat_a_test_and_tell_runs_apart():
    bench = tn.Bench(tn.load("dmf_rig"), plan(seed=3))
    first, again, other = bench.run(), bench.run(), bench.run(seed=4)
    assert all(np.array_equal(first[name].values, again[name].values) for name in first.names)
    assert np.array_equal(first["T_M_set"].values, other["T_M_set"].values)
    difference_of_noise = other["T_T"].values - first["T_T"].values
    assert difference_of_noise.std() == pytest.approx(0.23 * np.sqrt(2), rel=0.02)


def test_truth_is_the_simulation():
    rig = tn.load("amt_rig").configured("III")
    bench = tn.Bench(rig, plan(channels={"T_T": Transducer(), "w": Transducer(sensor="velocity(motor)")}))
    moved = rig.simulate(["T_T", "velocity(motor)"], {"T_M": CHIRP.samples(RATE)}, RATE)
    for name, other in (("T_T", "T_T"), ("w", "velocity(motor)"), ("T_M", "T_M")):
        assert np.allclose(bench.truth[name].values, moved[other].values, rtol=0, atol=1e-12)
    assert bench.run().names == ("T_M_set", "T_T", "w")
    assert bench.run()["w"].quantity == "velocity"


def test_a_mean_torque_begins_in_its_equilibrium():
    rig = tn.load("dmf_rig")
    bench = tn.Bench(
        rig,
        plan(
            excitation=replace(CHIRP, mean=30), channels={"T_T": Transducer(), "a": Transducer(sensor="angle(motor)")}
        ),
    )
    static = 30 * (1 / 13300 + 1 / 460)
    assert bench.truth["a"].values[0] == pytest.approx(static)
    assert bench.truth["T_T"].values[0] == pytest.approx(30)
    without = tn.Bench(rig, plan(channels={"a": Transducer(sensor="angle(motor)")})).truth["a"].values
    assert np.allclose(bench.truth["a"].values - without, static)


def test_a_free_drivetrain_cannot_bear_a_mean_torque():
    free = tn.Drivetrain("free", [tn.Inertia("rotor", node="a", inertia=1)], inputs={"T": {"torque": "a"}})
    bench = tn.Bench(free, plan(excitation=replace(CHIRP, mean=5), channels={"a": Transducer(sensor="angle(a)")}))
    with pytest.raises(UsageError, match="free to turn"):
        bench.run()


def test_another_configuration_of_the_same_bench():
    bench = tn.load_bench("amt_bench")
    assert bench.configured("V", c_O=360).drivetrain.parameters["c_O"] == 360
    assert bench.configured("V").plan is bench.plan


# The encoder's limit


@pytest.mark.few(1)
@pytest.mark.parametrize("amplitude", [10, 15, 20])
def test_with_1024_steps_the_coherence_collapses_between_18_and_26_hz(amplitude):
    bench = tn.load_bench("dmf_bench")
    bench = replace(bench, plan=replace(bench.plan, excitation=replace(TORQUE, amplitude=amplitude)))
    H = estimate(bench.run(), "theta_1", "T_T", settings=PAPER)
    lost = H.frequencies[(H.coherence[:, 0, 0] < 0.8) & (H.frequencies > 12)][0]
    assert 18 <= lost <= 26
    model = bench.drivetrain.frequency_response("theta_1", "T_T", H.frequencies)
    before = (H.frequencies > lost - 8) & (H.frequencies < lost - 1.5)
    bias = np.abs(difference(H, model).decibels[before]).max()
    assert 1.4 < bias < 2.6
    assert H.usable_up_to < lost - 8


@pytest.mark.parametrize("lines", [512, 1024, 4096])
def test_usable_up_to_where_the_model_moves_by_four_steps(lines):
    rig = tn.load("dmf_rig")
    channels = {"T_T": Transducer(), "theta_1": Encoder(lines=lines)}
    bench = tn.Bench(rig, plan(excitation=TORQUE, channels=channels))
    H = estimate(bench.run(), "theta_1", "T_T", settings=replace(PAPER, decimation=10))
    frequencies = np.linspace(5, 60, 5000)
    amplitude = 15 * rig.frequency_response("theta_1", "T_M", frequencies).magnitude[:, 0, 0]
    expected = frequencies[amplitude < 4 * 2 * np.pi / lines][0]
    assert H.usable_up_to == pytest.approx(expected, rel=0.08)
    (note,) = [note for note in H.notes if "steps of" in note]
    assert f"less than 4 steps of {360 / lines:.4g} deg" in note


def test_no_limit_without_steps_or_without_a_sweep():
    rig = tn.load("dmf_rig")
    noise = BurstRandom(start=1, stop=50, period=10, periods=4, amplitude=50)
    for excitation, part in ((CHIRP, Transducer(noise="0.1 mrad")), (noise, Encoder(lines=1024))):
        record = tn.Bench(rig, plan(excitation=excitation, channels={"T_T": Transducer(), "theta_1": part})).run()
        assert resolution(record, "theta_1", "T_T") is None
        assert estimate(record, "theta_1", "T_T").usable_up_to is None


# Files

BENCH = """\
torsionnet: 1
name: two discs
elements:
  rotor: {type: inertia, node: a, inertia: 0.1}
  shaft: {type: spring, nodes: [a, ground], stiffness: 400, damping: 1}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}, M: {torque: shaft}}
bench:
  excitation: {type: stepped sine, frequencies: {from: 1 Hz, to: 20 Hz, count: 5}, hold: 1 s, amplitude: 5 N*m}
  exciter: {bandwidth: 80 Hz, harmonics: {2: 2 %}}
  channels:
    M: {type: transducer, range: 20 N*m, noise: 0.01 N*m}
    phi: {type: encoder, lines: 500, quadrature: true, delay: 0.2 ms}
    omega: {type: transducer, sensor: velocity(a), noise: 2 rpm}
  acquisition: {rate: 1 kHz, bits: 12, anti_alias: 300 Hz}
  seed: 5
"""


def test_a_bench_in_a_model_file_comes_back(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text(BENCH.replace("bits: 12, ", ""))
    bench = tn.load_bench(path)
    assert bench.plan.excitation.frequencies[0] == 1.0
    assert float(bench.plan.channels["omega"].noise.value) == pytest.approx(2 * 2 * np.pi / 60)
    again = tn.loads(bench.drivetrain.to_yaml()).definition.bench
    assert again.to_data() == bench.plan.to_data()
    assert tn.load(path).modes().natural_frequencies[0] > 0
    first, second = bench.run(), tn.Bench(bench.drivetrain, again).run()
    assert all(np.array_equal(first[name].values, second[name].values) for name in first.names)


@pytest.mark.parametrize("name", list(library_benches()))
def test_benches_of_the_library_fit_the_schema_and_run(name):
    jsonschema = pytest.importorskip("jsonschema")
    from torsionnet.model.files.located_yaml import compose

    text = library_benches()[name].read_text(encoding="utf-8")
    assert text.splitlines()[0] == "# yaml-language-server: $schema=../torsionnet.schema.json"
    jsonschema.Draft202012Validator(json_schema()).validate(as_json(compose(text, name).data))
    bench = tn.load_bench(name)
    if bench.plan.motion is not None:
        return  # tests/bench/test_turning_bench.py runs it
    record = bench.run()
    if name == "dmf_component_bench":
        return  # tests/bench/test_component_bench.py looks into it
    assert record.sampling_rate == 10e3
    assert record.duration == 100
    assert step_of(record["theta_1"].values) == pytest.approx(2 * np.pi / 1024)


def as_json(data):
    return json.loads(json.dumps(data, default=lambda value: int(value) if value == int(value) else float(value)))


def test_the_bench_of_a_file_fits_the_schema():
    jsonschema = pytest.importorskip("jsonschema")
    from torsionnet.model.files.located_yaml import compose

    schema = jsonschema.Draft202012Validator(json_schema())
    schema.validate(as_json(compose(BENCH, "x").data))
    for good, bad in (
        ("hold: 1 s", "hlod: 1 s"),
        ("stepped sine", "stepped"),
        ("acquisition:", "acq:"),
        (", lines: 500", ""),
    ):
        assert not schema.is_valid(as_json(compose(BENCH.replace(good, bad), "x").data)), bad


FAULTS = [  # what is exchanged, for what, line, kind of fault
    ("bench:\n", "bench: 3\nold:\n", 8, "wrong-form"),
    (
        "type: stepped sine",
        "type: steped sine",
        9,
        "unknown-word",
    ),
    (", hold: 1 s", "", 9, "missing-entry"),
    (", amplitude: 5 N*m", "", 9, "missing-entry"),
    ("hold: 1 s", "hlod: 1 s", 9, "unknown-entry"),
    ("hold: 1 s", "hold: 1 Hz", 9, "wrong-unit"),
    ("to: 20 Hz", "to: 0.5 Hz", 9, "out-of-range"),
    ("count: 5", "cuont: 5", 9, "wrong-form"),
    ("bandwidth: 80 Hz", "bandwith: 80 Hz", 10, "unknown-entry"),
    ("{2: 2 %}", "{2: 2 %, x: 1}", 10, "out-of-range"),
    ("range: 20 N*m", "range: 20 kg", 12, "wrong-unit"),
    ("range: 20 N*m, ", "", 12, "missing-entry"),
    ("range: 20 N*m", "range: 0", 12, "out-of-range"),
    ("    M: {", "    N: {", 12, "unknown-channel"),
    ("phi: {type: encoder", "M2: {type: encoder, sensor: M", 13, "unfit-channel"),
    ("lines: 500", "lines: 0", 13, "out-of-range"),
    ("lines: 500, ", "", 13, "missing-entry"),
    ("type: encoder", "type: encdoer", 13, "unknown-word"),
    ("quadrature: true", "quadrature: 4", 13, "wrong-form"),
    ("sensor: velocity(a)", "sensor: speed(a)", 14, "unknown-channel"),
    ("noise: 2 rpm", "noise: 2 deg", 14, "wrong-unit"),
    ("rate: 1 kHz", "rate: 500 Hz", 15, "out-of-range"),
    ("rate: 1 kHz, ", "", 15, "missing-entry"),
    (
        "  acquisition: {rate: 1 kHz, bits: 12, anti_alias: 300 Hz}\n",
        "",
        8,
        "missing-entry",
    ),
    ("seed: 5", "seed: -5", 16, "out-of-range"),
    ("  seed: 5", "  drive: T_M", 16, "unknown-channel"),
]
GOOD = BENCH.replace("noise: 2 rpm", "noise: 2 rpm, range: 100 rad/s")


@pytest.mark.parametrize(("good", "bad", "line", "kind"), FAULTS)
def test_faults_of_a_bench_are_located(good, bad, line, kind):
    assert GOOD.count(good) == 1
    with pytest.raises(ModelError) as caught:
        tn.loads(GOOD.replace(good, bad), "rig.yaml")
    assert (line, kind) in [(fault.position.line, fault.kind) for fault in caught.value.faults], caught.value


def test_all_faults_at_once():
    text = GOOD
    for good, bad in (("hold: 1 s", "hold: 1 Hz"), ("20 N*m", "20 kg"), ("seed: 5", "seed: x")):
        text = text.replace(good, bad)
    with pytest.raises(ModelError) as caught:
        tn.loads(text, "rig.yaml")
    assert len(caught.value.faults) >= 2  # units of channels are looked at once the rest can be read
    assert tn.loads(GOOD).definition.bench is not None


OWN = """\
torsionnet: 1
model: drive.yaml
bench:
  excitation: {type: linear chirp, start: 1 Hz, stop: 20 Hz, duration: 5 s, amplitude: 5 N*m}
  channels: {phi: {type: encoder, lines: 500}}
  acquisition: {rate: 1 kHz}
"""


@pytest.fixture
def own(tmp_path):
    (tmp_path / "drive.yaml").write_text(BENCH[: BENCH.index("bench:")])

    def write(text):
        path = tmp_path / "test.yaml"
        path.write_text(text)
        return path

    return write


def test_a_bench_of_its_own_names_the_model_from_its_folder(own):
    assert tn.load_bench(own(OWN)).run().names == ("T_set", "phi")


@pytest.mark.parametrize(
    ("good", "bad", "line", "kind"),
    [
        ("drive.yaml", "drvie.yaml", 2, "missing-file"),
        ("drive.yaml", "dmf_rigg", 2, "missing-file"),
        ("drive.yaml", "[a]", 2, "wrong-form"),
        ("bench:", "configuration: soft\nbench:", 3, "unknown-configuration"),
        ("bench:", "beench:", 3, "unknown-entry"),
        ("phi:", "psi:", 5, "unknown-channel"),
        ("torsionnet: 1", "torsionnet: 2", 1, "wrong-version"),
    ],
)
def test_faults_of_a_bench_file_are_located(own, good, bad, line, kind):
    with pytest.raises(ModelError) as caught:
        tn.load_bench(own(OWN.replace(good, bad)))
    assert (line, kind) in [(fault.position.line, fault.kind) for fault in caught.value.faults], caught.value


def test_faults_of_the_model_keep_their_own_places(own, tmp_path):
    path = own(OWN)
    (tmp_path / "drive.yaml").write_text(BENCH[: BENCH.index("bench:")].replace("inertia: 0.1", "inertia: 0.1 kg"))
    with pytest.raises(ModelError) as caught:
        tn.load_bench(path)
    assert {Path(fault.position.file).name for fault in caught.value.faults} == {"drive.yaml", "test.yaml"}


def test_a_model_without_a_bench_says_where_there_are_some():
    with pytest.raises(UsageError, match="missing-entry"):
        tn.load_bench("dmf_rig")
    with pytest.raises(UsageError, match='did you mean "amt_bench"'):
        tn.load_bench("amt_bnech")


@pytest.mark.parametrize(
    "excitation",
    [
        CHIRP,
        LogarithmicSweep(start=1, stop=20, duration=5, amplitude=3, mean=1),
        SteppedSine(frequencies=(1.0, 2.0), hold=1, amplitude=2),
        Multisine(start=1, stop=20, period=4, periods=3, seed=9, amplitude=2),
        BurstRandom(start=1, stop=20, period=4, share=0.3, amplitude=2),
    ],
)
def test_every_excitation_is_written_and_read(excitation):
    from torsionnet.bench.plan.plan import Plan

    written = plan(excitation=excitation).to_data()
    again, faults = Plan.read(written)
    assert faults == []
    assert again.excitation == excitation


def test_schema_file_is_up_to_date():
    from torsionnet.model.files.model_schema import schema_text

    assert (library_folder() / "torsionnet.schema.json").read_text(encoding="utf-8") == schema_text()
