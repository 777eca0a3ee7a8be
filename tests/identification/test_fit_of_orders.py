"""Fits to measured orders against dense matrices: parameters, misfire, gas torque by order, reference angle."""

from dataclasses import replace

import numpy as np
import pytest
from support import campaigns
from support.order_fits import HARMONICS, K_COUPLING, SPEEDS, dense_orders, engine_model, tracked

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.identification import Measurement, Unknown, identify, load_fit, rank_causes
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.identification.fit_problem import make_problem
from torsionnet.identification.orders.order_lines import order_faults
from torsionnet.identification.orders.parametric_orders import ParametricOrders
from torsionnet.identification.plan.fit_entries import read_unknowns
from torsionnet.io import read_frequency_response
from torsionnet.io.tracked_order_tables import read_tracked_orders, write_tracked_orders
from torsionnet.linear.sensitivity.parametric import ParametricResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

SIGMA = 2.0
ENGINE = "engine.misfire_share.4"


def measurement(values, seed=0, **given):
    return Measurement(tracked(values, SIGMA, seed), **given)


def test_orders_of_the_model_are_those_of_dense_matrices():
    orders = np.repeat(list(HARMONICS), len(SPEEDS))
    rig = engine_model()
    names = ["k_cpl", ENGINE, "engine.gas.correction.3.imag", "engine.gas.harmonics.0.5.amplitude"]
    asked = ParametricOrders.of(rig, "T_crank", orders, np.tile(SPEEDS, len(HARMONICS)), names)
    found = asked.evaluation([5.5e3, 0.3, 0.2, 5.2e5]).values[:, 0, 0]
    exact = dense_orders("T_crank", {4: 0.3}, {3.0: 1 + 0.2j}, k_cpl=5.5e3).ravel()
    assert np.abs(found - exact).max() < 1e-9 * np.abs(exact).max()


def test_derivatives_of_orders_are_differences_of_dense_matrices():
    orders = np.repeat(list(HARMONICS), len(SPEEDS))
    asked = ParametricOrders.of(engine_model(), "T_cpl", orders, np.tile(SPEEDS, len(HARMONICS)), ["k_cpl", ENGINE])
    slopes = asked.evaluation([K_COUPLING, 0.3]).jacobian[:, 0, 0]
    h = 1e-5 * K_COUPLING
    ends = [dense_orders(misfire={4: 0.3}, k_cpl=K_COUPLING + sign * h).ravel() for sign in (1, -1)]
    by_stiffness = (ends[0] - ends[1]) / (2 * h)
    assert np.abs(slopes[:, 0] - by_stiffness).max() < 1e-5 * np.abs(by_stiffness).max()
    by_share = dense_orders(misfire={4: 1.0}).ravel() - dense_orders().ravel()
    assert np.abs(slopes[:, 1] - by_share).max() < 1e-8 * np.abs(by_share).max()


def test_several_measurements_of_one_engine_are_calculated_together(monkeypatch):
    outputs, speeds = ("T_cpl", "T_crank", "T_cpl"), (SPEEDS, SPEEDS[2:7], SPEEDS + 1.0)
    tests = [
        Measurement(tracked(dense_orders(output, speeds=at), SIGMA, 0, output, speeds=at), name=f"{number}")
        for number, (output, at) in enumerate(zip(outputs, speeds, strict=True))
    ]
    problem = make_problem(engine_model(), tests, read_unknowns(["k_cpl", ENGINE]), "complex")
    calls, at = [], ParametricResponse.evaluation
    monkeypatch.setattr(ParametricResponse, "evaluation", lambda self, values: calls.append(1) or at(self, values))
    values = np.array([5.5e3, 0.3])
    problem.residuals(values)
    assert len(calls) == 1
    for block, output, rpm in zip(problem.blocks, outputs, speeds, strict=True):
        exact = dense_orders(output, {4: 0.3}, k_cpl=5.5e3, speeds=rpm).ravel()
        assert np.abs(block.predicted(values)[0] - exact).max() < 1e-9 * np.abs(exact).max()


def test_measurements_with_values_of_their_own_are_calculated_apart():
    tests = [
        Measurement(tracked(dense_orders(k_cpl=k), SIGMA, 0), name=name) for name, k in (("a", 5.5e3), ("b", 6.5e3))
    ]
    fit = identify(engine_model(), tests, {"k_cpl": Unknown(per_configuration=True)})
    for name, true in (("k_cpl[a]", 5.5e3), ("k_cpl[b]", 6.5e3)):
        assert abs(fit.values[name] - true) < 4 * fit.standard_errors[name] < 0.1 * true


def test_stiffness_and_misfire_of_cylinder_4_are_found_within_their_intervals(tmp_path):
    test = measurement(dense_orders(misfire={4: 0.3}, k_cpl=5.6e3))
    fit = identify(engine_model(), test, ["k_cpl", ENGINE])
    for name, true in (("k_cpl", 5.6e3), (ENGINE, 0.3)):
        low, high = fit.intervals()[name]
        assert low < true < high
        assert high - low < 0.2 * true
    assert not fit.lack_of_fit.rejected
    changed = fit.configured(engine_model())
    assert changed.definition.excitations["engine"].misfire_share == {"4": fit.values[ENGINE]}
    assert changed.parameters["k_cpl"] == fit.values["k_cpl"]
    changed.to_yaml(tmp_path / "fitted.yaml")
    again = tn.load(tmp_path / "fitted.yaml").definition.excitations["engine"].misfire_share["4"]
    assert again == pytest.approx(fit.values[ENGINE], rel=1e-12)


@pytest.mark.parametrize("gain", [1.0, 1.5])
@pytest.mark.slow
def test_a_noisy_channel_beside_a_precise_one_is_no_contradiction_but_a_false_one_is(gain):
    sharp = Measurement(tracked(dense_orders(), SIGMA / 10, 0), name="sharp")
    rough = Measurement(tracked(gain * dense_orders(), SIGMA, 1), name="rough")
    odd = [one for one in identify(engine_model(), [sharp, rough], ["k_cpl"]).verdicts if "the others" in one]
    assert [one.startswith("rough does not fit the others") for one in odd] == ([] if gain == 1 else [True])


def test_gas_torque_of_an_order_is_found_as_a_complex_factor():
    names = ["engine.gas.correction.3.real", "engine.gas.correction.3.imag"]
    fit = identify(engine_model(), measurement(dense_orders(corrections={3.0: 1.1 - 0.15j})), names)
    for name, true in zip(names, (1.1, -0.15), strict=True):
        low, high = fit.intervals()[name]
        assert low < true < high
        assert high - low < 0.1


@pytest.mark.slow
def test_a_misfiring_cylinder_is_found_among_six():
    test = measurement(dense_orders(misfire={4: 0.3}))
    fit = identify(engine_model(), test, ["k_cpl"])
    assert fit.lack_of_fit.rejected
    assert np.isinf(fit.standard_errors["k_cpl"])
    best = fit.lack_of_fit.explanations[0]
    assert (best.kind, best.of) == ("misfire", "cylinder 4 of engine")
    assert abs(best.values[ENGINE] - 0.3) < 0.03
    assert "a misfire of cylinder 4 of engine (3" in fit.verdicts[0]


@pytest.mark.slow
def test_ranking_of_causes_names_the_cylinder():
    ranking = rank_causes(engine_model(), measurement(dense_orders(misfire={4: 0.3})))
    assert ranking.causes[0].unknown == ENGINE
    assert [one.unknown for one in ranking.causes if one.explains] == [ENGINE]
    assert "a misfire of cylinder 4 of engine" in ranking.verdict


@pytest.mark.slow
def test_a_wrong_damping_is_told_as_lack_of_fit():
    fit = identify(engine_model(), measurement(dense_orders("T_cpl", c_throw=4000.0)), ["k_cpl"])
    assert fit.lack_of_fit.rejected


@pytest.mark.slow
def test_reference_angle_is_found_when_asked():
    turned = tracked(dense_orders(misfire={4: 0.3}), SIGMA, 0, turned=-2.5)
    fit = identify(engine_model(), Measurement(turned, reference_angle=True), ["k_cpl", ENGINE])
    low, high = fit.intervals()["reference_angle[measurement]"]
    assert low < -2.5 < high
    assert high - low < 0.05
    assert abs(fit.values[ENGINE] - 0.3) < 0.03
    assert fit.units["reference_angle[measurement]"] == "rad"


@pytest.mark.slow
def test_reference_angle_is_blamed_when_it_is_not_asked_for():
    turned = tracked(dense_orders(misfire={4: 0.3}), SIGMA, 0, turned=0.4)
    fit = identify(engine_model(), Measurement(turned), ["k_cpl", ENGINE])
    best = fit.lack_of_fit.explanations[0]
    assert best.kind == "reference_angle"
    assert abs(np.mean([value for name, value in best.values.items() if name.startswith("reference")]) - 0.4) < 0.05
    assert "a reference angle of 2" in fit.verdicts[0]


def test_amplitudes_alone_are_compared_where_phases_have_no_reference():
    test = Measurement(tracked(dense_orders(misfire={4: 0.3}), SIGMA, 0, reference=""))
    fit = identify(engine_model(), test, [ENGINE])
    assert abs(fit.values[ENGINE] - 0.3) < 3 * fit.standard_errors[ENGINE]
    assert "measurement has phases without a reference, so amplitudes are compared" in fit.notes
    assert not fit.comparisons[0].has_phase


def test_orders_of_undecided_sign_count_by_their_amplitudes():
    halves = tuple(order for order in HARMONICS if order % 1)
    data = replace(tracked(dense_orders(misfire={4: 0.3}), SIGMA, 0), undecided=halves)
    fit = identify(engine_model(), Measurement(data, name="run"), [ENGINE])
    assert [one.name for one in fit.comparisons] == ["run", "run (amplitudes)"]
    assert [one.has_phase for one in fit.comparisons] == [True, False]
    assert abs(fit.values[ENGINE] - 0.3) < 3 * fit.standard_errors[ENGINE]


def test_single_orders_without_intervals_take_their_noise_from_the_scatter():
    values = tracked(dense_orders(k_cpl=5.6e3), SIGMA, 0).values
    orders = [MeasuredOrder(o, SPEEDS, np.abs(v), v) for o, v in zip(HARMONICS, values, strict=True)]
    fit = identify(engine_model(), Measurement(orders, "T_cpl"), ["k_cpl"])
    assert abs(fit.values["k_cpl"] / 5.6e3 - 1) < 0.02
    assert any("has no intervals: its noise is taken from the scatter over speed" in note for note in fit.notes)


@pytest.mark.parametrize(("blind", "lacking"), [((), []), ((0.5, 1.5), []), (tuple(HARMONICS), ["delay"])])
def test_a_delay_needs_the_phase_of_one_order(blind, lacking):
    """Orders without phases beside others are compared by their amplitudes, which no delay changes."""
    late = dense_orders() * np.exp(-1j * np.outer(list(HARMONICS), SPEEDS) * 1e-4)
    orders = [
        MeasuredOrder(o, SPEEDS, np.abs(v), None if o in blind else v) for o, v in zip(HARMONICS, late, strict=True)
    ]
    test = Measurement(orders, "T_cpl", name="run", delay=True)
    assert [fault.path[0] for fault in order_faults(test, list(HARMONICS))] == lacking
    if not lacking:
        assert identify(engine_model(), test, ["k_cpl"]).values["delay[run]"] == pytest.approx(1e-4, rel=1e-3)


@pytest.mark.slow
def test_intervals_cover_the_true_values():
    values, rig, errors = dense_orders(misfire={4: 0.3}, k_cpl=5.6e3), engine_model(), {"k_cpl": [], ENGINE: []}
    for seed in range(campaigns.examples(25, 100)):
        fit = identify(rig, measurement(values, seed), list(errors))
        for name, true in (("k_cpl", 5.6e3), (ENGINE, 0.3)):
            low, high = fit.intervals()[name]
            errors[name].append((fit.values[name] - true) / (high - low))
    for name, those in errors.items():
        assert np.mean(np.abs(those) < 0.5) >= 0.9, name
        assert np.std(those) == pytest.approx(0.5 / 1.96, rel=0.25), name


def test_faults_of_orders_are_named():
    test = tracked(dense_orders(), SIGMA, 0)
    rig = engine_model()
    for given, names, kind in (
        ({"orders_used": (0.5, 7.0)}, ["k_cpl"], "unknown-order"),
        ({"speeds": (1.0, 2.0)}, ["k_cpl"], "missing-data"),
        ({"output": "phi"}, ["k_cpl"], "wrong-unit"),
        ({}, ["engine.misfire_share.7"], "unknown-name"),
        ({"input": "T"}, ["k_cpl"], "needless-entry"),
    ):
        with pytest.raises(UsageError, match=kind):
            identify(rig, Measurement(test, **given), names)
    odd = replace(test, orders=test.orders + 0.25)
    with pytest.raises(UsageError, match="unknown-order"):
        identify(rig, Measurement(odd), ["k_cpl"])
    blind = Measurement(replace(test, reference=""), name="run")
    with pytest.raises(UsageError, match="missing-data"):
        identify(rig, blind, ["engine.gas.harmonics.3.phase"])
    with pytest.raises(UsageError, match="missing-data"):
        identify(rig, replace(blind, reference_angle=True), ["k_cpl"])


def test_fit_file_of_orders_tells_all_faults_with_their_place(tmp_path):
    engine_model().to_yaml(tmp_path / "engine.yaml")
    write_tracked_orders([tracked(dense_orders(), SIGMA, 0)], tmp_path / "run.csv")
    text = (
        "torsionnet: 1\nmodel: engine.yaml\nparameters: [k_cpl, engine.misfire_shares.4]\nmeasurements:\n"
        "  a: {orders: run.csv, output: T_cp}\n"
        "  b: {orders: run.csv, output: T_cpl, orders_used: [3, 7], speeds: 100..200 rpm}\n"
        "  c: {orders: run.csv, output: T_cpl, input: T, settling: 2 s}\n"
        "  d: {record: run.csv, output: T_cpl, input: T, orders_used: [3]}\n"
    )
    (tmp_path / "fit.yaml").write_text(text)
    with pytest.raises(ModelError) as caught:
        load_fit_plan(tmp_path / "fit.yaml", read_frequency_response)
    assert sorted((fault.position.line, fault.kind) for fault in caught.value.faults) == [
        (3, "unknown-name"), (5, "unknown-channel"), (6, "missing-data"), (6, "unknown-order"),
        (7, "needless-entry"), (7, "needless-entry"), (8, "needless-entry"),
    ]  # fmt: skip


def test_fit_file_of_orders_is_fitted_and_saved(tmp_path):
    from torsionnet.plot import fit as draw_fit

    engine_model().to_yaml(tmp_path / "engine.yaml")
    values = dense_orders(misfire={4: 0.3})
    write_tracked_orders([tracked(values, SIGMA, 0)], tmp_path / "run.csv")
    (tmp_path / "fit.yaml").write_text(
        "{torsionnet: 1, model: engine.yaml, parameters: [engine.misfire_share.4], measurements: "
        "{run: {orders: run.csv, output: T_cpl, orders_used: [0.5, 1, 1.5, 3], speeds: 1000..1900 rpm}}}"
    )
    plan = load_fit_plan(tmp_path / "fit.yaml", read_frequency_response)
    fit = identify(plan.model, plan.measurements, plan.parameters)
    assert abs(fit.values[ENGINE] - 0.3) < 0.02
    assert sorted(set(fit.comparisons[0].orders.tolist())) == [0.5, 1.0, 1.5, 3.0]
    fit.to_yaml(tmp_path / "result.yaml")
    again = load_fit(tmp_path / "result.yaml")
    assert np.array_equal(again.comparisons[0].speeds, fit.comparisons[0].speeds)
    assert [axes.get_xlabel() for axes in draw_fit(again).axes][2] == "speed [rpm]"


def test_a_measurement_without_configuration_is_a_remark():
    rig = tn.load("engine_generator_set")
    response = rig.configured(k_cpl=7e4).frequency_response("T_cpl", "T_G", np.linspace(2, 10, 8))
    said = "cold rig names no configuration, so the model as written is compared; there are firing=normal"
    plain = identify(rig, Measurement(response, "T_cpl", "T_G", name="cold rig"), ["k_cpl"])
    assert any(said in note for note in plain.notes)
    named = Measurement(response, "T_cpl", "T_G", name="cold rig", configuration="normal,cold")
    assert not any("names no configuration" in note for note in identify(rig, named, ["k_cpl"]).notes)


def test_library_model_misfire_of_cylinder_4_at_30_percent():
    rig = tn.load("engine_generator_set").configured("normal,warm")
    true = rig.with_excitation_numbers({ENGINE: 0.3})
    speeds = np.linspace(870, 990, 7) * np.pi / 30
    run = true.order_response("T_cpl", speeds=speeds)
    kept = [place for place, line in enumerate(run.lines) if float(line.relative) <= 6]
    values = run.values[:, kept, 0].T
    rng, sigma = np.random.default_rng(0), 20.0
    noise = sigma * (rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape))
    orders = [
        MeasuredOrder(float(run.lines[place].relative), speeds, np.abs(one), one, np.full(len(speeds), 1.96 * sigma))
        for place, one in zip(kept, values + noise, strict=True)
    ]
    fit = identify(rig, Measurement(orders, "T_cpl"), [ENGINE, "engine.misfire_share.2"])
    low, high = fit.intervals()[ENGINE]
    assert low < 0.3 < high
    assert high - low < 0.03
    assert fit.values["engine.misfire_share.2"] < 0.02


def close_points(seed, sigma=2.0, related=()):
    """Orders along a slow run-up, whose noise is white noise averaged over five times (a triangle of correlation)."""
    speeds = np.linspace(900, 2000, 60) * np.pi / 30
    exact = dense_orders(misfire={4: 0.3}, k_cpl=5.6e3, speeds=speeds)
    rng = np.random.default_rng(seed)
    white = rng.normal(size=(2, len(HARMONICS), len(speeds) + 4)) * sigma * np.sqrt(5)
    real, imag = np.lib.stride_tricks.sliding_window_view(white, 5, axis=2).mean(axis=-1)
    test = tracked(exact, 0.0, 0, speeds=speeds)
    widths = np.full(exact.shape, 1.959964 * sigma)
    return replace(test, values=exact + real + 1j * imag, half_widths=widths, related_within=related)


def test_close_points_of_a_filter_count_as_fewer(tmp_path):
    write_tracked_orders([close_points(0, related=(5.0,) * len(HARMONICS))], tmp_path / "run.csv")
    test = Measurement(read_tracked_orders(tmp_path / "run.csv")[0])
    fit = identify(engine_model(), test, ["k_cpl", ENGINE])
    squares = 60 + 2 * sum((60 - k) * (1 - k / 5) ** 2 for k in range(1, 5))
    independent = 2 * len(HARMONICS) * 60**2 / squares
    assert abs(fit.degrees_of_freedom - (independent - 2)) <= 1
    assert not fit.lack_of_fit.rejected


@pytest.mark.nightly
def test_intervals_from_close_points_cover_the_true_values():
    rig, inside, seeds = engine_model(), {"k_cpl": 0, ENGINE: 0}, campaigns.examples(12, 40)
    for seed in range(seeds):
        fit = identify(rig, Measurement(close_points(seed, related=(5.0,) * len(HARMONICS))), list(inside))
        for name, true in (("k_cpl", 5.6e3), (ENGINE, 0.3)):
            low, high = fit.intervals()[name]
            inside[name] += low < true < high
    for name, count in inside.items():
        assert 0.87 * seeds <= count, name
