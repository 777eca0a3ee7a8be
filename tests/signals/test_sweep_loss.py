"""Loss of a resonance peak in a run-up: closed form of the modal amplitude against the full equation of motion."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy
from support.command_line import run

import torsionnet as tn
from torsionnet.io.tracked_order_tables import write_tracked_orders
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.sweep_loss import MOST_DAMPED, sweep_loss, sweep_remarks

NATURAL, RATIO = 20.0, 0.02
PLANT = """torsionnet: 1
name: rotor on a shaft
elements:
  rotor: {type: inertia, node: a, inertia: 1 kg*m^2}
  shaft: {type: spring, nodes: [a, ground], stiffness: 15791.367, damping: 5.0265}
speeds: {of: a, range: 60..2400 rpm, step: 20 rpm}
excitations: {fan: {type: harmonic, node: a, orders: {1: {amplitude: 1 N*m}}}}
"""


def full_equation(rate):
    """Loss and shift of the largest amplitude of y'' + 2 zeta w y' + w^2 y = w^2 exp(j phi) with a rising frequency."""
    omega = 2 * np.pi * NATURAL
    first, last = (12.0, 32.0) if rate > 0 else (32.0, 12.0)
    start = 1 / (1 - (first / NATURAL) ** 2 + 2j * RATIO * first / NATURAL)

    def motion(t, y):
        drive = np.exp(2j * np.pi * (first * t + rate * t**2 / 2))
        return [y[1], omega**2 * (drive - y[0]) - 2 * RATIO * omega * y[1]]

    found = scipy.integrate.solve_ivp(motion, (0, (last - first) / rate), [start, 2j * np.pi * first * start], method="DOP853",
                      rtol=1e-7, atol=1e-8, max_step=0.01)  # fmt: skip
    size = np.abs(found.y[0])
    at = size.argmax()
    steady = 1 / (2 * RATIO * np.sqrt(1 - RATIO**2))
    return 1 - size[at] / steady, (first + rate * found.t[at]) / (NATURAL * np.sqrt(1 - 2 * RATIO**2)) - 1


@pytest.mark.parametrize("rate", [10.0, -10.0])
def test_ten_hertz_a_second_lose_44_percent_of_the_peak(rate):
    loss, shift = full_equation(rate)
    if rate > 0:
        assert (loss, shift) == (pytest.approx(0.44, abs=0.005), pytest.approx(0.11, abs=0.005))
    found = sweep_loss(rate, NATURAL, RATIO)
    assert found.loss == pytest.approx(loss, abs=0.01)
    assert found.shift == pytest.approx(shift, abs=0.003)


@pytest.mark.slow
def test_one_hertz_a_second_loses_10_percent_of_the_peak():
    loss, shift = full_equation(1.0)
    assert (loss, shift) == (pytest.approx(0.10, abs=0.005), pytest.approx(0.025, abs=0.001))
    found = sweep_loss(1.0, NATURAL, RATIO)
    assert (found.loss, found.shift) == (pytest.approx(loss, abs=0.005), pytest.approx(shift, abs=0.0005))


def test_remark_names_the_mode_the_rate_and_the_loss():
    modes = tn.loads(PLANT).modes()
    times = np.linspace(0, 3, 61)
    fast = sweep_remarks(times, 2 * np.pi * (10 + 10 * times), [1.0, 30.0], modes)
    (text,) = fast
    assert text.startswith(
        "order 1 passed 20 Hz (damping ratio 0.02, 1200 rpm) at 10 Hz/s: the model's steady peak loses 43 %"
    )
    assert sweep_remarks(times, 2 * np.pi * (19 + 0.01 * times), [1.0], modes) == ()


def test_a_sample_right_on_the_mode_is_passed_like_others():
    """And a run-up that begins or ends there has passed nothing."""
    times = np.linspace(0, 3, 61)
    frequency = 10 + 10 * times
    modes = SimpleNamespace(damped_frequencies=frequency[[20]], damping_ratios=np.array([0.02]))
    (text,) = sweep_remarks(times, 2 * np.pi * frequency, [1.0], modes)
    assert "order 1 passed 20 Hz" in text
    ends = SimpleNamespace(damped_frequencies=frequency[[0, -1]], damping_ratios=np.array([0.02, 0.02]))
    assert sweep_remarks(times, 2 * np.pi * frequency, [1.0], ends) == ()


@pytest.mark.parametrize(("ratio", "told"), [(0.0, 0), (0.299, 1), (MOST_DAMPED, 0)])
def test_a_mode_without_damping_or_without_a_peak_has_no_remark(ratio, told):
    """Through 20 Hz within hundredths of a second, so fast that even a mode with 30 % of critical damping loses its peak."""
    times = np.linspace(0, 0.05, 61)
    modes = SimpleNamespace(damped_frequencies=np.array([NATURAL]), damping_ratios=np.array([ratio]))
    assert len(sweep_remarks(times, 2 * np.pi * (10.3 + 1000 * times), [1.0], modes)) == told


def test_orders_measured_in_a_fast_run_up_say_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.yaml").write_text(PLANT)
    times = np.linspace(0, 2.5, 51)
    one = TrackedOrders(
        "a", "angle", np.array([1.0]), times, 2 * np.pi * (10 + 10 * times), np.full((1, 51), 1e-3 + 0j),
        np.full((1, 51), 1e-4), reference="a pulse",
    )  # fmt: skip
    write_tracked_orders([one], "tracked.csv")
    text = run("orders", "plant.yaml", "--output", "a", "--measured", "tracked.csv").stdout
    assert "at 10 Hz/s: the model's steady peak loses 43 %" in " ".join(text.split())
