"""Parameters found from records and responses whose truth is known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy
from support.campaigns import examples

import torsionnet as tn
from torsionnet import plot
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.bench.plan import Acquisition, Encoder, Plan, Transducer
from torsionnet.identification import Candidate, choose_model, load_fit
from torsionnet.identification.fit_search import NO_SCATTER, _combinations
from torsionnet.signals import LinearChirp, Recording, Signal, Welch, estimate

F = np.linspace(0.5, 25, 120)
GEARS = ("II", "III", "IV")
FINE = Encoder(lines=1024, quadrature=True)
FAST = Welch("hamming", 2.0, 0.8)
DECIMATED = Welch("hamming", 2.0, 0.8, decimation=10)


def response(rig, configuration="", noise=0.0, seed=0, f=F):
    """theta_1/T_T of a rig, with relative noise."""
    found = (rig.configured(configuration) if configuration else rig).frequency_response("theta_1", "T_T", f)
    rng = np.random.default_rng(seed)
    scatter = rng.standard_normal((2, *found.values.shape)) * noise / np.sqrt(2)
    return replace(found, values=found.values * (1 + scatter[0] + 1j * scatter[1]))


def measured(data, configuration="", **more):
    return tn.Measurement(data, "theta_1", "T_T", configuration, **more)


ROUTES = pytest.mark.parametrize("route", ["response", pytest.param("record", marks=pytest.mark.slow)])
"""Fits of responses take tenths of a second, of records many seconds."""


def observed(route, truth, configuration="", **more):
    """A test of the rig that there is: its response with noise, or a record of a quick bench."""
    if route == "response":
        return measured(response(truth, noise=0.01, f=F[:: examples(3, 1)]), configuration, **more)
    return measured(tn.Bench(truth, quick("dmf_rig").plan).run(), configuration, settings=FAST, **more)


@pytest.fixture(scope="module")
def amt():
    """The rig, and a record of each gear by a quick bench with a fine encoder."""
    return tn.load("amt_rig"), {gear: quick("amt_rig", gear).run() for gear in GEARS}


def quick(rig, configuration="", **changes):
    """40 s at 500 Hz."""
    plan = Plan(
        excitation=LinearChirp(start=0.2, stop=30, duration=40, amplitude=15),
        channels={"T_T": Transducer(noise="0.05 N*m"), "theta_1": FINE},
        acquisition=Acquisition(rate="500 Hz"),
    )
    return tn.Bench(tn.load(rig).configured(configuration, **changes), plan)


# Known optima, to eight digits from two starts


@pytest.mark.few(1, 4)
@pytest.mark.parametrize("factor", [0.3, 2.5])
@pytest.mark.parametrize(
    ("rig", "gears", "parameters"),
    [
        ("dmf_rig", ("",), ["c_2"]),
        ("dmf_rig", ("",), ["c_2", "k_2", "I_2"]),
        ("amt_rig", GEARS, ["c_O", "c_B"]),
        ("amt_rig", GEARS, ["c_O", "c_B", "k_1", "k_2", "c_1", "I_2"]),
        ("amt_rig", ("V",), ["k_1", "c_1", "c_O"]),
    ],
)
def test_optimum_to_eight_digits_from_two_starts(rig, gears, parameters, factor):
    truth = tn.load(rig)
    tests = [measured(response(truth, gear), gear) for gear in gears]
    start = {name: factor * truth.parameters[name] for name in parameters}
    for residual in ("complex", "log"):
        fit = tn.identify(truth, tests, start, residual=residual)
        for name in parameters:
            assert fit.values[name] == pytest.approx(truth.parameters[name], rel=1e-8), (name, residual)


@pytest.mark.parametrize("start", [3.0, 5.0])
def test_ratio_and_inertia(start):
    truth = tn.load("amt_rig").configured("IV")
    fit = tn.identify(truth, measured(response(truth)), {"tau": start, "I_2": 0.3})
    assert fit.values["tau"] == pytest.approx(4.14, rel=1e-8)
    assert fit.values["I_2"] == pytest.approx(0.13, rel=1e-8)


def test_delay_and_gain_of_a_channel_along_with_the_parameters():
    truth = tn.load("dmf_rig")
    data = response(truth)
    late = replace(data, values=1.03 * data.values * np.exp(-2j * np.pi * data.frequencies * 1.2e-3)[:, None, None])
    fit = tn.identify(truth, measured(late, delay=True, gain=True, name="run"), {"c_2": 10, "k_2": 300})
    assert fit.values["c_2"] == pytest.approx(4, rel=1e-8)
    assert fit.values["delay[run]"] == pytest.approx(1.2e-3, rel=1e-8)
    assert fit.values["gain[run]"] == pytest.approx(1.03, rel=1e-8)
    assert fit.units["delay[run]"] == "s"


def test_loss_factor_of_a_hysteretic_spring():
    truth = hysteretic(0.4)
    fit = tn.identify(truth.configured(eta=0.1), measured(response(truth)), ["eta", "k_2"])
    assert fit.values["eta"] == pytest.approx(0.4, rel=1e-8)


def hysteretic(eta, viscous=0.0):
    """The DMF rig with a hysteretic spring in its flywheel, and a viscous damper if wanted."""
    rig = tn.load("dmf_rig")
    elements = [element for name, element in rig.definition.elements.items() if name != "dmf"]
    elements.append(tn.HystereticSpring("dmf", nodes=("primary", "secondary"), stiffness="k_2", loss_factor="eta"))
    elements.append(tn.Damper("oil", nodes=("primary", "secondary"), damping="c_2"))
    parameters = {name: float(value) for name, value in rig.parameters.items()} | {"eta": eta, "c_2": viscous}
    return tn.Drivetrain(
        "hysteretic DMF rig",
        elements,
        parameters=parameters,
        inputs={"T_M": {"torque": "motor"}},
        sensors={"theta_1": {"angle": "motor"}, "T_T": {"torque": "torque_meter"}},
    )


# Records


@pytest.mark.slow
def test_drag_of_three_gears_at_once(amt):
    rig, records = amt
    tests = [measured(records[gear], gear, settings=FAST) for gear in GEARS]
    fit = tn.identify(rig, tests, {"c_O": 80, "c_B": 4})
    for name, true in (("c_O", 170), ("c_B", 1.5)):
        low, high = fit.intervals()[name]
        assert low < true < high
        assert high - low < 0.03 * true
    assert fit.configured(rig).parameters["c_O"] == fit.values["c_O"]
    assert fit.verdicts == ()
    assert "c_O" in fit.table(true={"c_O": 170}).to_text()


def one_mass(zeta):
    """8 Hz, with so much damping; a chirp of 80 s shakes it."""
    omega, inertia = 2 * np.pi * 8, 0.1
    rig = tn.Drivetrain(
        "one mass",
        [
            tn.Inertia("rotor", node="a", inertia=inertia),
            tn.Spring("spring", nodes=("a", "ground"), stiffness=inertia * omega**2, damping="c"),
        ],
        parameters={"c": 2 * zeta * inertia * omega},
        inputs={"T": {"torque": "a"}},
        sensors={"phi": {"angle": "a"}},
    )
    plan = Plan(
        excitation=LinearChirp(start=1, stop=20, duration=80, amplitude=5),
        channels={"T_in": Transducer(sensor="acceleration(a)"), "phi": Transducer(noise="1e-5 rad")},
        acquisition=Acquisition(rate="2 kHz"),
    )
    return rig, tn.Bench(rig, plan)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("zeta", "plain"),
    [
        (0.005, 0.5),
        *(pytest.param(*pair, marks=pytest.mark.slow) for pair in ((0.01, 0.2), (0.03, 0.04))),
        (0.1, 0.002),
    ],
)
def test_same_estimator_route_has_no_leakage_bias(zeta, plain):
    """Light damping reads too high by far in a plain fit of 2 s windows."""
    rig, bench = one_mass(zeta)
    record = bench.run()
    torque = Signal("T", "torque", bench.exciter_output.torque)
    record = record.with_signals(torque)
    test = tn.Measurement(record, "phi", "T", settings=DECIMATED, band=(2, 18))
    same = tn.identify(rig.configured(c=0.5), test, ["c"]).values["c"]
    H = replace(estimate(record, "phi", "T", "H1", DECIMATED), estimation=None)
    simple = tn.identify(rig.configured(c=0.5), tn.Measurement(H, "phi", "T", band=(2, 18)), ["c"]).values["c"]
    true = rig.parameters["c"]
    assert same == pytest.approx(true, rel=0.01)
    assert simple / true - 1 > plain


@pytest.mark.slow
def test_a_record_that_begins_in_motion_needs_settling():
    rig, bench = one_mass(0.03)
    record = bench.run().with_signals(Signal("T", "torque", bench.exciter_output.torque))
    begun = Recording(tuple(replace(s, values=s.values[56000:]) for s in record), record.sampling_rate)
    values = [
        tn.identify(
            rig.configured(c=0.5),
            tn.Measurement(begun, "phi", "T", settings=DECIMATED, band=(7, 15), settling=settling),
            ["c"],
        ).values["c"]
        for settling in (0.0, 4.0)
    ]
    true = rig.parameters["c"]
    assert 5 * abs(values[1] / true - 1) < abs(values[0] / true - 1)


@pytest.mark.slow
@pytest.mark.parametrize("route", ["record", pytest.param("file", marks=pytest.mark.nightly)])
def test_intervals_hold_the_truth(route):
    """benchmarks/interval_coverage.py does it for more rigs, sensors, windows and seeds."""
    from benchmarks.interval_coverage import WINDOWS, Case, benches, measured

    (bench,) = benches(Case("DMF", "encoder, 1024 steps")).values()
    inside = 0
    for seed in range(20):
        test = measured(bench.run(seed), "", WINDOWS["Hamming 2 s"], route)
        low, high = tn.identify(tn.load("dmf_rig"), test, {"c_2": 6.0}).intervals()["c_2"]
        inside += low <= 4 <= high and high - low < 0.4
    # By chance 95 % give fewer than 16 of 20 once in 400 times.
    assert inside >= 16


@pytest.fixture
def stepped():
    """A fit of a record of seed 0, 1, ..., by an encoder with coarse steps and little noise."""
    rig, coarse = tn.load("dmf_rig"), Encoder(lines=1024)

    def fitted(seed):
        bench = quick("dmf_rig")
        plan = replace(bench.plan, channels={"T_T": Transducer(), "theta_1": coarse}, seed=seed)
        test = measured(replace(bench, plan=plan).run(), settings=FAST, band=(2, 8))
        return tn.identify(rig, test, ["c_2"])

    return fitted


def test_steps_of_an_encoder_widen_the_errors(stepped):
    fit = stepped(0)
    backward = np.eye(2 * len(fit.comparisons[0].frequencies))
    assert np.trace(fit.problem.shared_covariance(backward, np.array(list(fit.values.values())))) > 0.02 * np.trace(
        fit.problem.noise_covariance(backward)
    )


@pytest.mark.nightly
def test_errors_from_steps_are_the_scatter(stepped):
    """Where noise is small, fits scatter by where in a step the rig stands, and their errors say so."""
    fits = [stepped(seed) for seed in range(examples(15, 40))]
    scatter = np.std([fit.values["c_2"] for fit in fits])
    error = np.median([fit.standard_errors["c_2"] for fit in fits])
    assert 0.6 * scatter < error < 1.7 * scatter


# What a fit says about itself


def test_two_drags_cannot_be_told_apart_in_one_gear(amt):
    rig, records = amt
    fit = tn.identify(rig, measured(records["II"], "II", settings=FAST), {"c_O": 100, "c_B": 3})
    (verdict,) = [text for text in fit.verdicts if "told apart" in text]
    assert verdict.startswith("c_O and c_B cannot be told apart in II alone")
    assert fit.standard_errors == {"c_O": np.inf, "c_B": np.inf}
    assert abs(fit.correlation[0, 1]) > 0.999
    together = fit.values["c_B"] + fit.values["c_O"] / 7.96**2
    assert together == pytest.approx(1.5 + 170 / 7.96**2, rel=0.01)


def test_a_thousandth_of_a_combination_is_named():
    problem = SimpleNamespace(names=("a", "b", "c"), blocks=[SimpleNamespace(measurement=SimpleNamespace(label="run"))])
    (text,) = _combinations(problem, np.array([[1.0, -1.5e-3, 0.5e-3]]), ())
    assert text.startswith("a and b cannot be told apart in run alone")


def test_nearly_indistinguishable_parameters_are_named_with_their_correlation():
    rig = tn.load("amt_rig")
    tests = [measured(response(rig, gear, noise=0.01, seed=n), gear) for n, gear in enumerate(("IV", "V"))]
    fit = tn.identify(rig, tests, ["c_O", "c_B"])
    (verdict,) = [text for text in fit.verdicts if "indistinguishable" in text]
    assert verdict == "c_O and c_B are indistinguishable in IV, V: correlation -0.98"
    axes = plot.correlation(fit).axes[0]
    (shown,) = axes.images
    assert np.array_equal(shown.get_array(), fit.correlation)
    # Numbers are read on pale and on dark fields, and stand in their own.
    faint = plot.correlation(replace(fit, correlation=np.array([[1.0, 0.5], [-0.5, 1.0]]))).axes[0]
    for (diagonal, low), texts in (((1.0, -0.98), axes.texts), ((1.0, 0.5), faint.texts)):
        assert [float(text.get_text()) for text in texts[:2]] == [diagonal, low]
        assert [text.get_position() for text in texts] == [(0, 0), (1, 0), (0, 1), (1, 1)]
        assert (texts[0].get_color() == texts[1].get_color()) == (abs(low) > 0.9)


@pytest.mark.slow
@pytest.mark.parametrize("route", ["response", pytest.param("record", marks=pytest.mark.nightly)])
def test_fifth_gear_with_more_drag_is_found_and_named(route):
    rig = tn.load("amt_rig")
    odd = observed(route, rig.configured("V", c_O=360), "V")
    alone = tn.identify(rig, odd, ["c_O"])
    assert alone.values["c_O"] == pytest.approx(360, rel=0.01)
    tests = [*(observed(route, rig.configured(gear), gear) for gear in GEARS), odd]
    joint = tn.identify(rig, tests, ["c_O", "c_B"])
    assert any(text.startswith("V does not fit the others") for text in joint.verdicts), joint.verdicts
    free = tn.identify(rig, tests, {"c_O": tn.Unknown(per_configuration=True), "c_B": tn.Unknown(prior=(1.5, 0.05))})
    assert free.values["c_O[V]"] == pytest.approx(360, rel=0.03)
    assert free.values["c_O[II]"] == pytest.approx(170, rel=0.05)
    assert not any("does not fit" in text for text in free.verdicts)


@pytest.mark.slow
@pytest.mark.parametrize("route", ["response", pytest.param("record", marks=pytest.mark.nightly)])
def test_hysteretic_damping_is_recognised(route):
    test = observed(route, hysteretic(0.4), name="sweep", band=(0.5, 20))
    start = hysteretic(0.2, 2.0)
    candidates = {
        "viscous": Candidate(start.configured(eta=0), ["c_2", "k_2"]),
        "hysteretic": Candidate(start.configured(c_2=0), ["eta", "k_2"]),
        "both": Candidate(start, ["c_2", "eta", "k_2"]),
    }
    choice = choose_model(candidates, test)
    assert choice.best == "hysteretic" or (choice.best == "both" and choice.differences["hysteretic"] < 4)
    assert choice.differences["viscous"] > 100
    assert choice.fits["hysteretic"].values["eta"] == pytest.approx(0.4, rel=0.02)
    assert "is preferred" in choice.verdict
    low = choice.fits["viscous"].comparisons[0]
    lag = np.degrees(np.angle(low.measured / low.fitted))[low.frequencies < 2]
    assert np.all(lag < -5)  # the viscous model cannot lag at low frequency


@pytest.mark.slow
@pytest.mark.parametrize("route", ["response", pytest.param("record", marks=pytest.mark.nightly)])
def test_viscous_damping_is_recognised_too(route):
    test = observed(route, tn.load("dmf_rig"), name="sweep", band=(0.5, 20))
    start = hysteretic(0.2, 2.0)
    candidates = {
        "viscous": Candidate(start.configured(eta=0), ["c_2", "k_2"]),
        "hysteretic": Candidate(start.configured(c_2=0), ["eta", "k_2"]),
    }
    choice = choose_model(candidates, test)
    assert choice.best == "viscous"
    assert choice.verdict.startswith("viscous is preferred: hysteretic is ")
    assert choice.verdict.endswith("worse in AICc (clearly)")


@pytest.mark.slow
def test_value_at_a_bound_and_vague_value_are_told():
    rig = tn.load("dmf_rig")
    test = measured(response(rig, noise=0.02))
    fit = tn.identify(rig, test, {"c_2": tn.Unknown(start=6, bounds=(5, 9)), "c_B": 0.3})
    assert fit.values["c_2"] == pytest.approx(5, rel=1e-3)
    assert any("c_2 stands at its bound 5" in text for text in fit.verdicts)
    vague = tn.identify(rig, measured(response(rig, noise=0.1, f=F[:20])), ["c_2", "k_1"])
    assert any(text.startswith("k_1 is hardly determined") for text in vague.verdicts), vague.verdicts


def test_profile_agrees_with_standard_errors_where_the_problem_is_straight():
    rig = tn.load("dmf_rig")
    fit = tn.identify(rig, measured(response(rig, noise=0.01)), ["c_2", "k_2"])
    for name in ("c_2", "k_2"):
        assert fit.profile(name) == pytest.approx(fit.intervals()[name], rel=3e-3)
    with pytest.raises(UsageError, match='did you mean "c_2"'):
        fit.profile("c2")


def test_profile_is_lopsided_where_the_problem_is():
    rig = tn.load("dmf_rig")
    fit = tn.identify(rig, measured(response(rig, noise=0.05, f=np.linspace(2, 12, 60))), ["k_1"])
    low, high = fit.profile("k_1")
    assert high - fit.values["k_1"] > 1.2 * (fit.values["k_1"] - low)


def test_a_response_without_noise_gives_no_interval():
    """Nothing but rounding is left, which says nothing of errors; a stated error stands though chi squared is 0."""
    rig = tn.load("dmf_rig")
    fit = tn.identify(
        rig.configured(k_2=430, c_2=3.7), measured(response(rig, f=np.linspace(1, 30, 40))), ["k_2", "c_2", "c_B"]
    )
    for name in ("c_2", "c_B"):
        assert fit.intervals()[name] == fit.profile(name) == (-np.inf, np.inf)
    assert NO_SCATTER in fit.verdicts
    f = np.array([1.0, 2.0, 4.0, 7.0])
    disc = tn.Drivetrain(
        "disc",
        [tn.Inertia("disc", node="a", inertia="J")],
        {"J": 2.0},
        inputs={"T": {"torque": "a"}},
        sensors={"phi": {"angle": "a"}},
    )
    data = disc.frequency_response("phi", "T", f)
    stated = tn.identify(disc.configured(J=1.5), tn.Measurement(data, "phi", "T", error=0.05), "J", residual="log")
    assert stated.standard_errors["J"] == pytest.approx(2 * 0.05 / np.sqrt(len(f)), rel=1e-6)
    low, high = stated.profile("J")
    assert np.log(high / low) / 2 == pytest.approx(scipy.stats.t.ppf(0.975, 7) * 0.05 / np.sqrt(len(f)), rel=2e-3)


@pytest.mark.parametrize("runs", [50, pytest.param(150, marks=pytest.mark.nightly)])
@pytest.mark.slow
def test_standard_errors_are_the_scatter(runs):
    rig = tn.load("dmf_rig")
    fits = [tn.identify(rig, measured(response(rig, noise=0.02, seed=seed)), ["c_2", "k_2"]) for seed in range(runs)]
    for name in ("c_2", "k_2"):
        scatter = np.std([fit.values[name] for fit in fits])
        assert np.median([fit.standard_errors[name] for fit in fits]) == pytest.approx(
            scatter, rel=2.6 / np.sqrt(2 * runs)
        )
        inside = np.mean([fit.intervals()[name][0] < rig.parameters[name] < fit.intervals()[name][1] for fit in fits])
        assert 0.9 < inside < 0.99


@pytest.mark.slow
def test_a_prior_counts_like_a_measurement():
    rig = tn.load("dmf_rig")
    data = response(rig, noise=0.02)
    coherent = replace(data, coherence=np.full(data.values.shape, 1 / (1 + 2 * 0.0002)))
    free = tn.identify(rig, measured(coherent), ["c_2"])
    held = tn.identify(rig, measured(coherent), {"c_2": tn.Unknown(prior=(5.0, 1e-6))})
    assert held.values["c_2"] == pytest.approx(5, abs=1e-4)
    assert free.values["c_2"] == pytest.approx(4, abs=0.1)


@pytest.mark.slow
def test_robust_loss_ignores_lines_that_are_far_off():
    rig = tn.load("dmf_rig")
    data = response(rig, noise=0.001)
    values = data.values.copy()
    values[[20, 47, 80]] *= 3
    spoilt = replace(data, values=values, coherence=np.full(values.shape, 0.999999))
    plain = tn.identify(rig.configured(c_2=8), measured(spoilt), ["c_2"]).values["c_2"]
    robust = tn.identify(rig.configured(c_2=8), measured(spoilt), ["c_2"], loss="cauchy").values["c_2"]
    assert abs(robust - 4) < 0.02 < abs(plain - 4)


def test_excluded_lines_and_bands_do_not_count():
    rig = tn.load("dmf_rig")
    data = response(rig)
    values = data.values.copy()
    values[(F > 9) & (F < 11)] *= 5
    spoilt = replace(data, values=values)
    fit = tn.identify(rig.configured(c_2=8), measured(spoilt, excluded=((9, 11),)), ["c_2"])
    assert fit.values["c_2"] == pytest.approx(4, rel=1e-8)
    fit = tn.identify(rig.configured(c_2=8), measured(spoilt, band=(1, 8.9)), ["c_2"])
    assert fit.values["c_2"] == pytest.approx(4, rel=1e-8)
    assert fit.comparisons[0].frequencies.max() < 8.9


@pytest.mark.slow
def test_several_starts_find_the_best_of_several_optima():
    rig = tn.load("amt_rig").configured("V")
    data = response(rig, f=np.linspace(3, 12, 60))
    fit = tn.identify(rig, measured(data), {"k_1": 5000, "k_2": 200, "I_2": 3.0}, starts=12, seed=1)
    assert fit.values["k_1"] == pytest.approx(460, rel=1e-5)


def test_saved_and_read_again(tmp_path):
    rig = tn.load("dmf_rig")
    fit = tn.identify(rig, measured(response(rig, noise=0.01), name='run "1"'), ["c_2", "k_2"])
    path = tmp_path / "fit.yaml"
    fit.to_yaml(path)
    again = load_fit(path)
    assert again.values == fit.values
    assert again.standard_errors == fit.standard_errors
    assert np.array_equal(again.comparisons[0].measured, fit.comparisons[0].measured)
    assert again.comparisons[0].name == 'run "1"'
    assert again.intervals() == fit.intervals()
    assert (again.verdicts, again.notes) == (fit.verdicts, fit.notes)
    with pytest.raises(UsageError, match="fit again"):
        again.profile("c_2")
    (tmp_path / "other.yaml").write_text("torsionnet: 1")
    with pytest.raises(ModelError, match=r":1:1: .*wrong-file"):
        load_fit(tmp_path / "other.yaml")


SAVED = """torsionnet_fit: 1
title: rig
parameters:
  k_1: {value: 460.0, standard_error: .inf, steps: [[0.5, 1.0e-05], [.nan, 2.0]], unit: N*m/rad}
  c_2: {value: 1.0e-05, standard_error: 0.25}
correlation:
  - [1.0, 0.5]
  - [0.5, 1.0]
chi_squared: 12.5
degrees_of_freedom: -3
verdicts:
  - "k_1 is vague: hold it"
notes: []
measurements:
  - name: run
    unit: rad/(N*m)
    misfit: 1.0
    has_phase: false
    frequencies: [1.0, 2.0]
    measured_real: [1.0, 2.0]
    measured_imag: [0.0, -1.0]
    fitted_real: [1.0, 2.0]
    fitted_imag: [0.0, -1.0]
    deviation: [0.1, .inf]
"""


def test_a_saved_fit_is_written_again_as_it_was(tmp_path):
    path = tmp_path / "fit.yaml"
    path.write_text(SAVED)
    assert load_fit(path).to_yaml() == SAVED


def test_faults_of_a_saved_fit_are_told_at_once_with_their_lines(tmp_path):
    path = tmp_path / "fit.yaml"
    bad = SAVED.replace("0.25}", "low}").replace("title: rig", "titel: rig").replace("[0.1, .inf]", "[0.1, 2.0, 3.0]")
    path.write_text(bad.replace("misfit: 1.0", "misfit: [1.0]"))
    with pytest.raises(ModelError) as raised:
        load_fit(path)
    told = str(raised.value)
    for line, words in (
        (2, 'unknown key "titel"'),
        (5, "'low'"),
        (17, "expected a number, got [1.0]"),
    ):
        assert f"fit.yaml:{line}:" in told
        assert words in told
    path.write_text(SAVED.replace("[0.1, .inf]", "[0.1, 2.0, 3.0]"))
    with pytest.raises(ModelError, match=r":24:16: .*wrong-count"):
        load_fit(path)
    path.write_text(SAVED.replace("  - [0.5, 1.0]\n", ""))
    with pytest.raises(ModelError, match=r":6:1: .*wrong-count"):
        load_fit(path)


# What cannot be fitted


@pytest.mark.parametrize(
    ("change", "parameters", "message"),
    [
        ({}, ["c_M"], "c_M does not act on theta_1/T_T; leave it out"),
        ({}, ["c_M", "I_1"], "c_M, I_1 do not act on theta_1/T_T; leave them out"),
        ({}, ["c_3"], '"c_3".*unknown-parameter'),
        ({}, [], "missing-entry"),
        ({"band": (90, 95)}, ["c_2"], "has nothing from 90 to 95 Hz to compare; its lines go from 0.5 to 25 Hz"),
        ({"band": (5, 5.3)}, ["c_2", "k_2", "I_2", "c_B", "k_1"], "5 .* 2 .*too-short"),
        ({"model_output": "theta_9"}, ["c_2"], '"theta_9"; did you mean "theta_1".*unknown-channel'),
        ({"model_output": "velocity(motor)"}, ["c_2"], "theta_1 .* rad .* rad/s .*wrong-unit"),
        ({"configuration": "II"}, ["c_2"], "II"),
        ({"band": (5, 2)}, ["c_2"], "a band goes from"),
        ({}, {"c_2": tn.Unknown(start=9, bounds=(1, 5))}, "c_2 begins at 9, outside its bounds 1 to 5"),
        ({}, {"c_2": "four"}, "expected a start value"),
    ],
)
def test_impossible_fits_are_refused_with_a_reason(change, parameters, message):
    rig = tn.load("dmf_rig")
    with pytest.raises(UsageError, match=f"(?s){message}"):
        tn.identify(rig, measured(response(rig), **{"name": "run", **change}), parameters)


def test_unknown_words_and_double_names():
    rig = tn.load("dmf_rig")
    test = measured(response(rig))
    with pytest.raises(UsageError, match='did you mean "huber"'):
        tn.identify(rig, test, ["c_2"], loss="hubert")
    with pytest.raises(UsageError, match="repeated-name"):
        tn.identify(rig, [test, test], ["c_2"])
    with pytest.raises(UsageError, match="nothing measured"):
        tn.identify(rig, [], ["c_2"])


def test_no_line_of_a_record_in_the_band(amt):
    rig, records = amt
    with pytest.raises(UsageError, match=r"(?s)7\.1.*7\.2.*missing-data"):
        tn.identify(rig, measured(records["II"], "II", settings=FAST, band=(7.1, 7.2)), ["c_O"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"times": np.cumsum(np.ones(20_000))}, "sampling is not uniform"),
        ({}, "not-finite"),
    ],
)
def test_records_that_cannot_be_processed(amt, change, message):
    rig, records = amt
    record = records["II"]
    if not change:
        values = record["theta_1"].values.copy()
        values[70] = np.nan
        record = record.with_signals(replace(record["theta_1"], values=values))
    with pytest.raises(UsageError, match=message):
        tn.identify(rig, measured(replace(record, **change), "II", settings=FAST, band=(1, 10)), ["c_O"])
