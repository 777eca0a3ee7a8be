"""Motion over time with delayed controllers, against the method of steps on paper and against spectra."""

import math

import numpy as np
import pytest
from support.controlled_plants import Plant

import torsionnet as tn


def lag(a, tau, sampling_rate, count):
    """c theta' = T - a c theta(t - tau), c = 2, under a unit step."""
    elements = [
        tn.Damper("drag", nodes=("a", "ground"), damping=2),
        tn.Controller("hold", sense={"angle": "a"}, act="a", law=-2 * a, delay=tau),
    ]
    rig = tn.Drivetrain("lag", elements)
    record = rig.simulate(["angle(a)", "torque(hold)"], {"a": np.ones(count)}, sampling_rate)
    return record["angle(a)"].values, record["torque(hold)"].values


def by_steps(a, tau, t):
    """Polynomials piece by piece: sum of (-a)^k (t - k tau)^(k+1)/(k+1)! over c."""
    terms = (
        (-a) ** k * np.maximum(t - k * tau, 0) ** (k + 1) / math.factorial(k + 1) for k in range(int(t[-1] / tau) + 1)
    )
    return sum(terms) / 2


@pytest.mark.parametrize(("a", "tau", "rate"), [(1.0, 0.5, 40), (3.0, 0.37, 50), (5.0, 0.4, 30), (2.0, 0.0071, 100)])
def test_polynomials_of_the_method_of_steps(a, tau, rate):
    """a tau below and above pi/2: dying away and growing."""
    t = np.arange(int(3 * rate)) / rate if tau > 0.1 else np.arange(8) / rate
    angle, torque = lag(a, tau, rate, len(t))
    expected = by_steps(a, tau, t)
    assert angle == pytest.approx(expected, abs=2e-6 * np.abs(expected).max())
    late = -2 * a * np.interp(t - tau, np.linspace(0, t[-1], 200_001), by_steps(a, tau, np.linspace(0, t[-1], 200_001)))
    late[t < tau] = 0
    assert torque == pytest.approx(late, abs=1e-5 * np.abs(late).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", [1, 3])
def test_is_the_inverse_transform_of_the_frequency_response(seed):
    """Of a torque that begins and ends smoothly, over so long that all has died away."""
    plant = Plant(seed, delay=True, forms=("polynomials", "roots"))
    poles = plant.rig.modes().eigenvalues
    shift = 1.5 + max(0.0, float(poles.real.max()))
    rate, n = 100.0, 600
    t = np.arange(n) / rate
    torque = np.where(t < 2, np.sin(np.pi * t / 2) ** 4, 0.0)
    record = plant.rig.simulate(["n0", "n1"], {"n1": torque}, rate)
    # Damped by e^(-shift t), even what grows has a spectrum; the contour lies to the right of all poles.
    m = 1 << 15
    fine = np.arange(m) / (rate * 8)
    drive = np.where(fine < 2, np.sin(np.pi * fine / 2) ** 4, 0.0) * np.exp(-shift * fine)
    s = shift + 2j * np.pi * np.fft.rfftfreq(m, 1 / (rate * 8))
    answer = np.array([np.linalg.inv(plant.dynamic_stiffness(one))[:2, 1] for one in s])
    motion = np.fft.irfft(np.fft.rfft(drive)[:, None] * answer, m, axis=0) * np.exp(shift * fine)[:, None]
    for place, name in enumerate(("n0", "n1")):
        expected = motion[: 8 * n : 8, place]
        assert record[name].values == pytest.approx(expected, abs=3e-5 * np.abs(expected).max())


def test_what_cannot_be_followed_is_told():
    elements = [
        tn.Inertia("one", node="a", inertia=1),
        tn.Controller("c", sense={"acceleration": "a"}, act="a", law=-0.3, delay=0.1),
    ]
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        tn.Drivetrain("x", elements).simulate("angle(a)", {"a": np.ones(5)}, 10)
    short = tn.Controller("c", sense={"velocity": "a"}, act="a", law=-0.3, delay="1 us")
    with pytest.raises(tn.UsageError, match="too-large"):
        tn.Drivetrain("x", [elements[0], short]).simulate("angle(a)", {"a": np.ones(500)}, 100)
