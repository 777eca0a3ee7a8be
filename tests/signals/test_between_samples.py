"""What a sampled torque means between its samples, against scipy's discretisations and torques evaluated on fine grids."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.linear.between_samples import BetweenSamples, Folding
from torsionnet.signals import Recording, Signal, Welch, decimate, estimate

J, C, K = 0.1, 0.8, 1000.0
MOTIONS = ("angle", "velocity", "acceleration")
WAYS = ("held", "straight", "band_limited")
RATE, COUNT = 100.0, 400
TRUE = {"c_1": 4.0, "k_2": 194.0, "c_2": 4.2}


def oscillator(*springs, **more):
    held = springs or (tn.Spring("s", nodes=("n", "ground"), stiffness=K, damping=C),)
    elements = [tn.Inertia("i", node="n", inertia=J), *held]
    sensors = {name: {name: "n"} for name in MOTIONS}
    return tn.Drivetrain("oscillator", elements, inputs={"T": {"torque": "n"}}, sensors=sensors, **more)


def state_space():
    A, B = np.array([[0, 1], [-K / J, -C / J]]), np.array([[0], [1 / J]])
    return A, B, np.vstack([np.eye(2), A[1]]), np.array([[0], [0], [1 / J]])


def torque(time):
    """Twelve sines up to 45 Hz, which rise and fall over the record."""
    rng = np.random.default_rng(1)
    frequencies, phases = rng.uniform(1, 45, 12), rng.uniform(0, 6, 12)
    sines = np.sin(2 * np.pi * np.outer(time, frequencies) + phases).sum(axis=1)
    return np.sin(np.pi * time * RATE / (COUNT - 1)) ** 4 * sines


def stepped(system, rate, torques, way):
    """Readings (n, n_out) of a discretised state space, one sample after the other."""
    from scipy.signal import cont2discrete

    A, B, C, D, _ = cont2discrete(system, 1 / rate, "zoh" if way == "held" else "foh")
    x, found = np.zeros(len(A)), []
    for one in torques:
        found.append(C @ x + D[:, 0] * one)
        x = A @ x + B[:, 0] * one
    return np.array(found)


def true_motion(system, rate, count, torque_at, way):
    """Readings (count, n_out) under a torque, given as a function of time, with a course between samples."""
    if way != "band_limited":
        return stepped(system, rate, torque_at(np.arange(count) / rate), way)
    fine = 64
    return stepped(system, fine * rate, torque_at(np.arange((count - 1) * fine + 1) / (fine * rate)), "foh")[::fine]


@pytest.mark.parametrize("way", WAYS[:2])
@pytest.mark.parametrize("rate", [50.0, 200.0])
def test_folded_response_is_that_of_scipys_discretisation(way, rate):
    from scipy.signal import cont2discrete

    lines = np.linspace(0.2, 0.49 * rate, 700)
    A, B, C_, D, _ = cont2discrete(state_space(), 1 / rate, "zoh" if way == "held" else "foh")
    z = np.exp(2j * np.pi * lines / rate)
    right = np.array([C_ @ np.linalg.solve(one * np.eye(2) - A, B) + D for one in z])[:, :, 0]
    folding = Folding(BetweenSamples(way, rate), lines)
    s = 2j * np.pi * folding.frequencies
    found = folding.folded(np.stack([s**0, s, s**2], axis=1) / (J * s**2 + C * s + K)[:, None])
    assert np.abs(found / right - 1).max() < 2e-6


@pytest.mark.parametrize("way", WAYS)
def test_motion_of_a_linear_drivetrain(way):
    right = true_motion(state_space(), RATE, COUNT, torque, way)
    samples = torque(np.arange(COUNT) / RATE)
    record = oscillator().simulate(list(MOTIONS), {"T": samples}, RATE, between=way)
    taken = oscillator().simulate("angle", {"T": Signal("T", "torque", samples, between=way)}, RATE)
    assert np.array_equal(taken["angle"].values, record["angle"].values)
    assert record["T"].between == taken["T"].between == way
    for number, name in enumerate(MOTIONS):
        size = np.abs(right[:, number]).max()
        assert record[name].values == pytest.approx(
            right[:, number], abs=(1e-4 if way == "band_limited" else 1e-10) * size
        )


@pytest.mark.parametrize("way", WAYS)
def test_motion_by_spectrum_and_from_event_to_event(way):
    """Laws over frequency, and laws of motion, which are those of the linear spring here."""
    samples = torque(np.arange(COUNT) / RATE)
    right = true_motion(state_space(), RATE, COUNT, torque, way)[:, 0]
    table = tn.TabulatedSpring("s", nodes=("n", "ground"), table=[[1, K, 0]])
    rows = tn.Spring("s", nodes=("n", "ground"), torque_over_twist=[[0, 0], [0.01, 0.01 * K], [1, K]])
    damper = tn.Damper("d", nodes=("n", "ground"), damping=C)
    for spring in (table, rows):
        record = oscillator(spring, damper).simulate("angle", {"T": samples}, RATE, between=way)
        assert record["angle"].values == pytest.approx(right, abs=1e-3 * np.abs(right).max())
        assert record["T"].values == pytest.approx(samples, abs=1e-12)
        assert record["T"].between == way


def test_what_is_asked_of_a_simulation_has_to_make_sense():
    rig = oscillator()
    with pytest.raises(UsageError, match='"straight"'):
        rig.simulate("angle", {"T": [0.0, 1.0]}, 10.0, between="strait")
    with pytest.raises(UsageError, match="unknown-channel"):
        rig.simulate("angle", {"T": [0.0, 1.0]}, 10.0, between={"U": "held"})
    with pytest.raises(UsageError, match="band_limited"):
        Signal("T", "torque", np.zeros(2), between="linear")


def test_a_torque_that_is_read_runs_as_the_one_that_drives():
    """A torque meter without an inertia before it reads steps; behind a mass it does not."""
    elements = [
        tn.Spring("meter", nodes=("motor", "n"), stiffness=1e4),
        tn.Inertia("i", node="n", inertia=J),
        tn.Spring("s", nodes=("n", "ground"), stiffness=K, damping=C),
    ]
    sensors = {"meter": {"torque": "meter"}, "s": {"torque": "s"}}
    rig = tn.Drivetrain("rig", elements, inputs={"T": {"torque": "motor"}}, sensors=sensors)
    record = rig.simulate(["meter", "s"], {"T": [0.0, 1.0, 0.0]}, 100.0, between="held")
    assert [signal.between for signal in record] == ["held", "held", "band_limited"]


@pytest.mark.parametrize("ending", ["csv", "npz", "mat", "tdms", "uff", "h5", "parquet", "mf4"])
def test_files_keep_the_course(ending, tmp_path):
    if ending == "mf4":
        pytest.importorskip("asammdf")
    values = np.sin(np.arange(3000.0))
    signals = (
        Signal("T", "torque", values, between="held"),
        Signal("U", "torque", values, between="straight", course_rate=1e4),
        Signal("a", "angle", values),
    )
    path = tmp_path / f"record.{ending}"
    tn.io.write_recording(Recording(signals, 100.0), path)
    read = tn.io.read_recording(path)
    assert [(one.between, one.course_rate) for one in read] == [
        ("held", None),
        ("straight", 1e4),
        ("band_limited", None),
    ]
    said = tn.io.read_recording(path, between={"T": "straight", "U": "held"})
    assert [one.course(100.0) for one in said][:2] == [BetweenSamples("straight", 100.0), BetweenSamples("held", 100.0)]
    with pytest.raises(ModelError, match="no channel"):
        tn.io.read_recording(path, between={"V": "held"})


def test_a_decimated_torque_keeps_the_rate_of_its_course():
    record = Recording((Signal("T", "torque", np.zeros(4000), between="held"),), 1000.0)
    assert decimate(record, 10)["T"].course(100.0) == BetweenSamples("held", 1000.0)


def two_masses(**values):
    return tn.Drivetrain(
        "two masses",
        [
            tn.Inertia("i1", node="n1", inertia=0.23),
            tn.Inertia("i2", node="n2", inertia=0.13),
            tn.Spring("s1", nodes=("n1", "n2"), stiffness=460, damping="c_1"),
            tn.Damper("d1", nodes=("n1", "ground"), damping=0.3),
            tn.Spring("s2", nodes=("n2", "ground"), stiffness="k_2", damping="c_2"),
        ],
        parameters=values,
        inputs={"T": {"torque": "n1"}},
        sensors={"a": {"angle": "n1"}, "w": {"velocity": "n1"}, "m": {"torque": "s1"}},
    )


WRONG = two_masses(c_1=3.0, k_2=180.0, c_2=5.0)


@cache
def true_record(way, phase=-90.0):
    """Record at 200 Hz of a swept sine on the two masses, by scipy."""
    from scipy.signal import chirp

    c_1, k_2, c_2 = TRUE.values()
    M, stiff = np.diag([0.23, 0.13]), np.array([[460, -460], [-460, 460 + k_2]])
    damping = np.array([[0.3 + c_1, -c_1], [-c_1, c_1 + c_2]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, stiff), -np.linalg.solve(M, damping)]])
    B = np.array([[0], [0], [1 / 0.23], [0]])
    meter = [[460, -460, c_1, -c_1]]
    system = A, B, np.vstack([np.eye(4)[[0, 2]], meter]), np.zeros((3, 1))

    def swept(time):
        return 5 * chirp(time, 0.3, 30, 30, phi=phase) * np.sin(np.pi * np.minimum(1, (30 - time) * 2) / 2) ** 2

    motion = true_motion(system, 200.0, 6000, swept, way)
    motions = {"a": "angle", "w": "velocity", "m": "torque"}
    signals = [Signal(name, what, motion[:, i]) for i, (name, what) in enumerate(motions.items())]
    return Recording((Signal("T", "torque", swept(np.arange(6000) / 200), between=way), *signals), 200.0)


def noisy(record, seed, level=1e-3):
    rng = np.random.default_rng(seed)
    noise = {one.name: level * np.abs(one.values).max() * rng.standard_normal(len(record)) for one in record}
    return record.with_signals(
        *(replace(record[name], values=record[name].values + noise[name]) for name in ("a", "w"))
    )


def distances(fit):
    """Distances of the fitted values from the truth, in standard errors."""
    return [(fit.values[name] - value) / fit.standard_errors[name] for name, value in TRUE.items()]


@pytest.mark.few(3, 5)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("output", ["a", "w"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_fits_hold_the_truth(way, output, seed):
    """Coverage over 200 draws is in benchmarks/interval_coverage.py; here no value misses by 4 standard errors."""
    fit = tn.identify(WRONG, tn.Measurement(noisy(true_record(way), seed), output, "T", band=(0.5, 28)), list(TRUE))
    assert not fit.lack_of_fit.rejected
    assert np.abs(distances(fit)).max() < 4
    assert fit.standard_errors["k_2"] < 0.1


@pytest.mark.parametrize("way", WAYS[:2])
def test_fit_of_a_response_that_was_estimated(way, tmp_path):
    """With its record, and as a file gives it back, which keeps the course and the rate."""
    response = estimate(noisy(true_record(way), 5), "w", "T", settings=Welch("hann", 4.0, 0.75))
    assert any(f"T is {way} between samples" in note for note in response.notes)
    tn.io.write_frequency_response(response, tmp_path / "response.npz")
    stored = tn.io.read_frequency_response(tmp_path / "response.npz")
    assert stored.inputs[0].course == BetweenSamples(way, 200.0)
    for data, tolerance in ((response, 2e-3), (stored, 0.03)):
        fit = tn.identify(WRONG, tn.Measurement(data, "w", "T", band=(2, 28)), list(TRUE))
        assert fit.values == pytest.approx(TRUE, rel=tolerance)


@pytest.mark.parametrize("way", WAYS[:2])
def test_estimates_are_of_the_torque_not_of_its_samples(way):
    """The angle of two masses has few images; without the correction 6 % or a lag of half a sample would be missing."""
    record = true_record(way)
    found = estimate(record, "a", "T", band=(10, 28)).between(10, 28)
    exact = two_masses(**TRUE).frequency_response("a", "T", found.frequencies).values
    assert np.abs(found.values / exact - 1).max() < 0.012


def test_a_torque_that_is_there_at_once():
    """The sweep begins at its largest torque, before which nothing has acted."""
    fit = tn.identify(
        WRONG, tn.Measurement(noisy(true_record("held", 0.0), 3, 1e-4), "a", "T", band=(0.5, 28)), list(TRUE)
    )
    assert np.abs(distances(fit)).max() < 4
    assert fit.standard_errors["k_2"] < 0.02
    assert "5 N*m of T act from the first sample on" in " ".join(fit.notes)


def test_a_wrong_course_is_named():
    """Of another course than the data say: the ranking names the right one, the fit warns, the fit by it is right."""
    record = noisy(true_record("straight"), 1)
    record = record.with_signals(replace(record["T"], between="band_limited"))
    test = tn.Measurement(record, "w", "T", band=(0.5, 28))
    ranking = tn.identification.rank_causes(two_masses(**TRUE), test)
    best = ranking.causes[0]
    assert (best.kind, best.of, best.between, best.explains) == ("between", "T", "straight", True)
    assert ranking.verdict == "only T straight between samples explains the misfit"


@pytest.mark.slow
def test_a_fit_with_a_wrong_course_says_so():
    record = noisy(true_record("straight"), 1)
    record = record.with_signals(replace(record["T"], between="band_limited"))
    test = tn.Measurement(record, "w", "T", band=(0.5, 28))
    fit = tn.identify(WRONG, test, list(TRUE))
    assert "would be 3.2 % smaller if held and 6.3 % if straight" in " ".join(fit.notes)
    assert fit.lack_of_fit.rejected
    assert fit.lack_of_fit.explanations[0].between == "straight"
    assert "T straight between samples would explain it" in fit.verdicts[0]
    right = tn.identify(WRONG, replace(test, between="straight"), list(TRUE))
    assert np.abs(distances(right)).max() < 4


def test_a_meter_reads_what_a_held_torque_causes():
    """Images of that torque are in the meter's samples, too: the record or the measurement says what drives it."""
    record = noisy(true_record("held"), 4, 1e-5)
    test = tn.Measurement(record, "a", "m", band=(0.5, 28))
    found = tn.identify(WRONG, test, list(TRUE))
    assert np.abs(distances(found)).max() < 4
    assert "what drives m is held between samples" in " ".join(found.notes)
    alone = replace(test, data=record.select(["a", "m"]), between="held")
    assert tn.identify(WRONG, alone, list(TRUE)).values == pytest.approx(found.values, rel=1e-9)


@pytest.mark.slow
def test_the_course_of_what_drives_a_meter_is_a_cause():
    test = tn.Measurement(true_record("held").select(["a", "m"]), "a", "m", band=(0.5, 28))
    ranking = tn.identification.rank_causes(two_masses(**TRUE), test)
    assert ranking.verdict == "only what drives m held between samples explains the misfit"


def test_a_course_is_for_samples():
    response = two_masses(**TRUE).frequency_response("a", "T", np.linspace(1, 20, 40))
    with pytest.raises(UsageError, match="know their sampling rate"):
        tn.identify(WRONG, tn.Measurement(response, "a", "T", between="held"), list(TRUE))


@pytest.mark.parametrize("share", [0.1, 0.2])
def test_windows_lose_a_lag(share):
    """Noise that comes a share of the window late: |H| falls to 1 - share of plain windows, coherence to its square."""
    x = np.random.default_rng(0).standard_normal(24_000)
    late = round(400 * share)
    signals = (Signal("T", "torque", x), Signal("a", "angle", np.concatenate([np.zeros(late), x[:-late]])))
    record, settings = Recording(signals, 200.0), Welch("boxcar", 2.0, 0.5)
    found = estimate(record, "a", "T", settings=settings)
    assert np.median(found.magnitude) == pytest.approx(1 - share, abs=0.02)
    (warning,) = [note for note in found.notes if "lags" in note]
    assert f"a lags T by {late / 200:g} s" in warning
    assert str(warning).endswith("align the signals (align=True)")
    assert f"lose {100 * share:.0f} % of |a/T|, and the coherence is at most {(1 - share) ** 2:.2f}" in warning
    back = estimate(record, "a", "T", settings=settings, align=True)
    assert back.values[:, 0, 0] == pytest.approx(np.exp(-2j * np.pi * back.frequencies * late / 200), abs=0.02)
    assert not any("lags" in note for note in back.notes)
    assert f"a {5 * late:g} ms earlier where" in back.notes[-1]
    assert f"T {5 * late:g} ms later where" in estimate(record, "T", "a", settings=settings, align=True).notes[-1]
    with pytest.raises(UsageError, match="wrong-form"):
        estimate(record, ["a", "T"], "T", align=True)


def test_comparisons_align_as_they_advise(tmp_path):
    record = true_record("straight")
    late = replace(record["w"], values=np.concatenate([np.zeros(80), record["w"].values[:-80]]))
    tn.io.write_recording(record.with_signals(late), tmp_path / "late.npz")
    (tmp_path / "rig.yaml").write_text(two_masses(**TRUE).to_yaml())
    told = [
        "compare",
        tmp_path / "late.npz",
        tmp_path / "rig.yaml",
        "--output",
        "w",
        "--input",
        "T",
        "--band",
        2,
        28,
    ]
    assert "or align the signals" in run(*told).stderr
    assert "lags" not in run(*told, "--align").stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["record", "aligned response"])
def test_fits_reach_a_delay_of_many_periods(kind, tmp_path):
    """Under windows of 2 s; and of 4 s that were aligned, which a file keeps: they lost nothing."""
    record = noisy(true_record("straight"), 2)
    late = replace(record["w"], values=np.concatenate([np.zeros(80), record["w"].values[:-80]]))
    data, tolerance = record.with_signals(late), 2e-3
    if kind == "aligned response":
        data, tolerance = estimate(data, "w", "T", settings=Welch("hann", 4.0, 0.75), align=True), 0.03
        tn.io.write_frequency_response(data, tmp_path / "aligned.csv")
        data = tn.io.read_frequency_response(tmp_path / "aligned.csv")
    fit = tn.identify(WRONG, tn.Measurement(data, "w", "T", band=(2, 28), delay=True, name="test"), list(TRUE))
    assert not fit.lack_of_fit.rejected
    found = dict(fit.values)
    assert found.pop("delay[test]") == pytest.approx(0.4, abs=1e-4)
    assert found == pytest.approx(TRUE, rel=tolerance)


def test_resonances_are_no_lag():
    for way, output in (("straight", "a"), ("straight", "w")):
        found = estimate(true_record(way), output, "T", align=True)
        assert not any("lags" in note for note in found.notes)
        assert found.notes[-1] == f"no clear lag of {output}: nothing is moved"
