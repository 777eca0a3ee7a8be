"""Noise of records: what it is shared out to, what steps of a sensor do, and how far an interval then reaches."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.bench.plan import Acquisition, Encoder, Plan, Transducer
from torsionnet.identification.fit import load_fit
from torsionnet.identification.fit_result import interval_half_width
from torsionnet.identification.residuals.noise import sensor_noise_powers, weighted_mean
from torsionnet.identification.residuals.sampled_response import REST_POSITIONS, SensorSteps, unexcited_windows
from torsionnet.signals import LinearChirp, Welch, decimate
from torsionnet.signals.excitation import Multisine

SETTINGS = Welch("hamming", 2.0, 0.8, decimation=10)
METER = 0.5
"""N m, noise of the torque meter."""
CHIRP = LinearChirp(start=0.2, stop=40, duration=60, amplitude=15)


@cache
def record(angle, excitation=CHIRP):
    plan = Plan(
        drive="T_M",
        excitation=excitation,
        channels={"T_T": Transducer(noise=f"{METER} N*m"), "theta_1": angle},
        acquisition=Acquisition(rate="1 kHz"),
    )
    return tn.Bench(tn.load("dmf_rig"), plan).run(3)


ENCODER, ANGLE = Encoder(lines=1024, quadrature=True), Transducer(noise="0.02 deg")


def fit_of(test, **start):
    measured = tn.Measurement(test, "theta_1", "T_T", settings=SETTINGS, band=(1.0, 30.0))
    return tn.identify(tn.load("dmf_rig"), measured, start or {"c_2": 4.6})


def test_noise_of_the_torque_is_found_within_a_few_percent():
    """One in ten samples is left of it, and with it a tenth of its power."""
    on_output, on_input = fit_of(record(ANGLE)).problem.blocks[0].sources
    assert on_input == pytest.approx(METER**2 / 10, rel=0.1)
    assert on_output == pytest.approx(np.radians(0.02) ** 2 / 10, rel=0.5)


@pytest.mark.few(1)
@pytest.mark.parametrize("wrong", [{"I_2": 0.2}, {"k_2": 200.0}, {"k_2": 2000.0, "c_2": 20.0}])
def test_noise_of_the_torque_is_not_taken_for_more_by_a_wrong_model(wrong):
    """Where quiet windows are asked, not the lines compared."""
    block = fit_of(record(ANGLE)).problem.blocks[0]
    wrong = tn.load("dmf_rig").configured(**wrong).frequency_response("theta_1", "T_T", block.windowed.fine)
    level, error = unexcited_windows(block.windowed, wrong.values[:, 0, 0]).input_noise(1e-8)
    assert level == pytest.approx(METER**2 / 10, abs=4 * error)
    assert error < 0.1 * level


def test_under_stationary_excitation_no_window_is_quiet():
    test = record(ANGLE, Multisine(start=0.5, stop=40, period=4, periods=15, amplitude=15))
    block = fit_of(test).problem.blocks[0]
    found = unexcited_windows(block.windowed, np.ones(len(block.windowed.fine), dtype=complex))
    assert found.input_noise(1e-8) is None
    assert np.isinf(found.floor()).all()


def test_the_floor_is_the_noise_of_the_sensor_whatever_the_model():
    block = fit_of(record(ANGLE)).problem.blocks[0]
    for model in ({}, {"I_2": 0.3}):
        response = tn.load("dmf_rig").configured(**model).frequency_response("theta_1", "T_T", block.windowed.fine)
        found = unexcited_windows(block.windowed, response.values[:, 0, 0])
        expected = np.radians(0.02) ** 2 / 10 + METER**2 / 10 * found.squared
        assert np.median(found.floor() / expected) == pytest.approx(1, abs=0.5)


def test_shares_of_noise():
    gain, rest = np.linspace(0, 4, 50), np.linspace(0, 1, 50)
    noise = np.random.default_rng(1).chisquare(2, 50) / 2
    exact = 3.0 + 2.0 * gain + rest
    assert sensor_noise_powers(exact, gain, rest) == pytest.approx((3, 2), rel=1e-6)
    seen = sensor_noise_powers(exact * noise, gain, rest, seen=(2.0, 0.01))
    assert seen[1] == pytest.approx(2.0, rel=0.01)
    assert seen[0] == pytest.approx(3.0, rel=0.5)
    far = sensor_noise_powers(exact * noise, gain, rest, seen=(40.0, 0.01))  # contradicts the lines: they decide
    assert far == sensor_noise_powers(exact * noise, gain, rest)


def test_means_weigh_by_errors():
    assert weighted_mean([None]) is None
    value, error = weighted_mean([(1.0, 0.1), None, (2.0, 0.2)])
    assert value == pytest.approx((1 / 0.01 + 2 / 0.04) / (1 / 0.01 + 1 / 0.04))
    assert error == pytest.approx((1 / 0.01 + 1 / 0.04) ** -0.5)


@pytest.mark.few(1)
@pytest.mark.parametrize("amplitude", [1.3, 4.3, 12.0])
def test_steps_change_a_sine_as_the_describing_function_says(amplitude):
    """Sum over k of 2 (-1)^k J_1(2 pi k A) / (pi k A) cos(2 pi k o), Gelb and Vander Velde (1968), for A steps."""
    from scipy.special import j1

    block = fit_of(record(ENCODER)).problem.blocks[0]
    rows, step = block.windowed.rows, 0.01
    rows = replace(rows, weights=np.ones_like(rows.weights))
    line = 2
    f = block.windowed.frequencies[line]
    rate = block.windowed.record.sampling_rate
    motion = amplitude * step * np.sin(2 * np.pi * f * np.arange(rows.count) / rate)
    found = (SensorSteps(step, 10).errors(motion, rows) / rows.apply(motion))[:, line]
    k, o = np.arange(1, 200)[:, None], (np.arange(REST_POSITIONS) + 0.5) / REST_POSITIONS
    terms = 2 * (-1.0) ** k * j1(2 * np.pi * k * amplitude) / (np.pi * k * amplitude) * np.cos(2 * np.pi * k * o)
    assert found.real == pytest.approx(terms.sum(axis=0), abs=0.03 / amplitude)


def test_steps_are_read_at_the_rate_of_the_sensor():
    """Errors by steps of a motion that is given after decimation, against a sensor that read before it."""
    block = fit_of(record(ENCODER)).problem.blocks[0]
    rows, rate, step = block.windowed.rows, 1000.0, 0.004
    time = np.arange(10 * rows.count) / rate
    fine = 0.05 * np.sin(2 * np.pi * (0.5 + 0.1 * time) * time) * np.minimum(1, (time[-1] - time) / 2)
    place = 0.5 / REST_POSITIONS * step
    read = step * np.rint((fine + place) / step) - fine - place
    template = block.windowed.record.select(["theta_1"])
    signal = replace(template["theta_1"], values=read)
    exact = decimate(replace(template, signals=(signal,), sampling_rate=rate), 10)["theta_1"].values
    found = SensorSteps(step, 10).errors(fine[::10], rows)[0]
    expected = rows.apply(exact[: rows.count])
    assert np.linalg.norm(found - expected) < 0.05 * np.linalg.norm(expected)


def test_an_interval_holds_what_noise_and_steps_do():
    """Against drawn errors: noise and a cosine of unknown phase, of two tests."""
    rng, count = np.random.default_rng(2), 200_000
    phases = 2 * np.pi * (np.arange(REST_POSITIONS) + 0.5) / REST_POSITIONS
    for noise, sizes in ((1.0, [0.5]), (0.1, [1.0]), (0.3, [1.0, 0.6])):
        drawn = noise * scipy.stats.t.rvs(30, size=count, random_state=rng)
        drawn += sum(size * np.cos(rng.uniform(0, 2 * np.pi, count)) for size in sizes)
        error = np.sqrt(noise**2 + sum(size**2 for size in sizes) / 2)
        half = interval_half_width(0.95, error, [(size * np.cos(phases)).tolist() for size in sizes], 30)
        assert np.mean(np.abs(drawn) < half) == pytest.approx(0.95, abs=0.012)


@pytest.mark.slow
def test_steps_of_a_fit_survive_a_file(tmp_path):
    fit = fit_of(record(Encoder(lines=1024)))
    assert len(fit.steps["c_2"]) == 1
    fit.to_yaml(tmp_path / "fit.yaml")
    again = load_fit(tmp_path / "fit.yaml")
    assert again.intervals()["c_2"] == pytest.approx(fit.intervals()["c_2"], rel=1e-12)
    usual = scipy.stats.t.ppf(0.975, fit.degrees_of_freedom) * fit.standard_errors["c_2"]
    assert fit.intervals()["c_2"][1] - fit.values["c_2"] < 0.999 * usual
    assert fit.degrees_of_freedom > 50  # steps that all lines share do not make the noise less certain
