"""Fits of models with many resonances, where a peak that is a little off is a minimum of its own: right, or a warning."""

from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.identification.fit_problem import make_problem
from torsionnet.identification.fit_search import NO_SCATTER, local_optimum
from torsionnet.identification.plan.fit_entries import Unknown

TRUE = 640.0
STRING = """\
torsionnet: 1
name: drill string
parameters: {L: 640 m}
elements:
  drive: {type: inertia, node: a, inertia: 2000}
  pipe:  {type: continuous_shaft, nodes: [a, b], length: L, outer_diameter: 127 mm, inner_diameter: 108.6 mm,
          shear_modulus: 79.6 GPa, density: 7850 kg/m^3}
  bit:   {type: inertia, node: b, inertia: 400}
  drag:  {type: damper, nodes: [b, ground], damping: 50}
inputs: {T: {torque: a}}
sensors: {w: {velocity: a}}
"""


def string(length=TRUE):
    return tn.loads(STRING).configured(L=length)


def measured(lines=60, top=5.0, noise=0.0, **more):
    response = string().frequency_response("w", "T", np.linspace(0.05, top, lines))
    rng = np.random.default_rng(4)
    error = noise * (rng.normal(size=response.values.shape) + 1j * rng.normal(size=response.values.shape))
    return tn.Measurement(replace(response, values=response.values * (1 + error)), "w", "T", **more)


@pytest.mark.few(1)
@pytest.mark.parametrize("begin", [598.0, 630.0, 700.0])
@pytest.mark.parametrize("residual", ["complex", "log"])
def test_length_of_a_continuous_shaft(begin, residual):
    """The plain search stays where the next peaks come together: 599 m, 629 m, 679 m."""
    fit = tn.identify(string(begin), measured(), ["L"], residual=residual)
    assert fit.values["L"] == pytest.approx(TRUE, rel=1e-9)
    assert fit.verdicts == (NO_SCATTER,)
    problem = make_problem(string(begin), [measured()], {"L": Unknown()}, residual)
    assert abs(local_optimum(problem, problem.start, "linear").x[0] - TRUE) > 5


def test_with_noise_the_interval_holds_the_length():
    fit = tn.identify(string(620.0), measured(100, noise=0.05), ["L"])
    low, high = fit.intervals()["L"]
    assert low < TRUE < high < low + 10


def test_derivatives_are_those_of_the_response():
    problem = make_problem(string(620.0), [measured()], {"L": Unknown()}, "complex")
    step = 1e-4
    ends = [problem.residuals(np.array([620.0 + sign * step])) for sign in (-1, 1)]
    np.testing.assert_allclose(
        problem.jacobian(np.array([620.0]))[:, 0], (ends[1] - ends[0]) / (2 * step), rtol=1e-4, atol=1e-7
    )


@pytest.mark.few(1)
@pytest.mark.parametrize(("begin", "lines", "top"), [(300.0, 40, 10.0), (1000.0, 100, 10.0), (2000.0, 60, 5.0)])
def test_what_is_far_is_found_or_told(begin, lines, top):
    fit = tn.identify(string(begin), measured(lines, top), ["L"])
    found = fit.values["L"] == pytest.approx(TRUE, rel=1e-6)
    assert found or any("the model does not fit" in one or "it may have other peaks" in one for one in fit.verdicts)


@pytest.mark.slow
def test_stated_noise_is_no_reason_to_doubt():
    fit = tn.identify(string(620.0), measured(noise=0.15, error=0.2), ["L"])
    assert not any("other peaks" in one for one in fit.verdicts)


@pytest.mark.slow
def test_what_is_worse_is_left():
    """Low lines that are wrong lead away: the plain optimum stays."""
    test = measured(noise=0.01)
    values = test.data.values.copy()
    values[:4] *= 3
    fit = tn.identify(string(642.0), replace(test, data=replace(test.data, values=values)), ["L"], loss="soft_l1")
    assert fit.values["L"] == pytest.approx(TRUE, rel=0.01)
