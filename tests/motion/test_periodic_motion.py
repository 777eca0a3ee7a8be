"""Periodic motions against shooting with exponentials between located corners, and describing functions in closed form."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from support.periodic_rigs import branch_over, duffing, gear_pair, problem, swing, two_stage_rig

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import FLOAT
from torsionnet.identification.residuals.laws_over_time import slider_torque
from torsionnet.model.channels import Input
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.motion_laws.describing_functions import describing_function, slider_describing_function
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.law_forces import SliderForce

SWING = 1e-5
"""Share of a swing to which the harmonics chosen have to give it."""


def _close(found: float, wanted: float, share: float = SWING) -> None:
    assert abs(found - wanted) <= share * abs(wanted), (found, wanted)


def test_mass_on_a_cubic_spring_folds_twice_and_has_three_motions_between():
    one = problem(duffing(), {"a": [0, 0.18]}, 0.5, hertz=False)
    branch = branch_over(one, 0.5, 1.8, harmonics=9)
    upper, lower = branch.folds()
    assert (upper.kind, lower.kind) == ("maximum", "minimum")
    for fold, frequency, first, largest in (
        (upper, 1.26960196, 2.82501671, 2.87157483),
        (lower, 1.11570025, 1.08187032, 1.08503583),
    ):
        _close(fold.motion.parameter, frequency)
        _close(abs(fold.motion.x[1, 0]), first)
        _close(swing(one, fold.motion)[1], largest)
    amplitudes = [swing(one, motion)[1] for motion in branch.at(1.2)]
    for found, wanted in zip(amplitudes, (2.54557670, 2.28664818, 0.41767295), strict=True):
        _close(found, wanted, 1e-8)  # what is printed: 24 harmonics of a cubic spring leave out nothing


def test_torques_of_high_harmonics_move_what_they_move():
    """Teeth that stay pressed together are linear: harmonic 40 of F has F/|1 - (40 w)^2 + 40 j c w|."""
    one = problem(gear_pair(), {"x": [0.5, 0.01, *[0] * 38, 100]}, 0.8, hertz=False)
    motion = one.solve(0.8, one.balance(0.8, 20).driven)
    _close(abs(motion.x[40, 0]), 100 / abs(1 - 32**2 + 3.2j))
    assert one.driven_to == 40
    fewer = one.solve(0.8, motion.x, harmonics=20)
    _close(fewer.left_out * np.ptp(swing(one, fewer)), abs(motion.x[40, 0]))


def test_few_harmonics_miss_a_swing_by_what_is_known():
    one = problem(two_stage_rig(), {"motor": [40, 60]}, 25)
    branch = branch_over(one, 25, 3.5, harmonics=1)
    for frequency, swings in (
        (10, [0.72260077]),
        (11, [0.27537588, 0.46142452, 1.04428993]),
        (15, [0.07938990]),
    ):
        near = [motion.x for motion in branch.at(frequency)]
        found = [one.solve(frequency, x, harmonics=1) for x in near]
        sizes = sorted(2 * abs(motion.x[1, 0]) for motion in found if motion is not None)
        for ours, wanted in zip(sizes, swings, strict=True):
            _close(ours, wanted, 1e-7)
        if frequency == 10:
            _close(float(found[0].x[0, 0].real), 0.03135998, 1e-6)


def _curve(element: tn.Spring):
    (law,) = [part for part in element.whole_parts(Values({}, FLOAT)) if isinstance(part, MotionLaw)]
    return law.curve


def _stages(*given: tuple[float, float | None]):
    rows = [{"stiffness": k, **({} if end is None else {"to": f"{end} rad"})} for k, end in given]
    return _curve(tn.Spring("s", nodes=("a", "b"), stages=rows))


def test_describing_functions_in_closed_form():
    two = _stages((460, 0.12), (1500, None))
    three = _stages((120, 0.05), (600, 0.2), (2400, None))
    for curve, amplitude, mean, stiffness, torque in (
        (two, 0.2, 0.0, 756.1472591, 0.0),
        (two, 0.5, 0.0, 1185.2772129, 0.0),
        (two, 0.1, 0.087, 765.5450886, 57.7836733),
        (three, 0.3, 0.12, 1105.3469777, 171.7108936),
    ):
        found = describing_function(curve, amplitude, mean)
        _close(found.stiffness.real, stiffness, 1e-9)
        assert abs(found.mean_torque - torque) < 1e-7
        assert found.stiffness.imag == 0


def test_describing_functions_of_a_slider():
    for amplitude, elastic, loss in ((0.02, 212.4625783, 84.8826363), (0.05, 64.2230947, 74.6967200)):
        found = slider_describing_function(300, 4, amplitude)
        _close(found.real, elastic, 1e-9)
        _close(found.imag, loss, 1e-9)


def test_describing_functions_of_steps_clearances_and_cubic_springs():
    # 4 P/(pi a), k (1 - N(b/a)), k + 3/4 k_3 a^2, and 4 M/(pi a) a quarter of a period ahead
    preload = _curve(tn.Spring("s", nodes=("a", "b"), stages=[{"stiffness": 100, "preload": "5 N*m"}]))
    _close(describing_function(preload, 0.2).stiffness.real, 100 + 4 * 5 / (pi * 0.2), 1e-12)
    (gap,) = tn.Clearance("c", nodes=("a", "b"), gap="1 deg", stiffness=8000).whole_parts(Values({}, FLOAT))
    for amplitude, stiffness in ((0.01, 427.9307), (0.02, 3700.9119), (0.05, 6231.2896)):
        _close(describing_function(gap.curve, amplitude).stiffness.real, stiffness, 1e-6)
    cubic = _curve(tn.Spring("s", nodes=("a", "b"), stiffness=140, cubic=2600))
    _close(describing_function(cubic, 0.3).stiffness.real, 140 + 0.75 * 2600 * 0.09, 1e-12)
    (rub,) = tn.Friction("f", nodes=("a", "b"), torque=6).whole_parts(Values({}, FLOAT))
    _close(describing_function(rub.curve, 0.2, omega=30.0).stiffness.imag, 4 * 6 / (pi * 0.2), 1e-12)


def test_mean_torques_have_to_balance_on_what_turns_freely():
    free = tn.Drivetrain(
        "free",
        [
            tn.Inertia("one", node="a", inertia=1),
            tn.Inertia("two", node="b", inertia=2),
            tn.Clearance("gap", nodes=("a", "b"), gap="2 deg", stiffness=8000),
        ],
    )
    plant = CondensedPlant(free, [Input("torque", "a"), Input("torque", "b")])
    plant.require_balance(np.array([25.0, -25.0]))
    with pytest.raises(UsageError, match="unbalanced-torques"):
        plant.require_balance(np.array([25.0, -20.0]))


def test_a_resonance_without_damping_is_named():
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=0.1)
    rig = tn.Drivetrain("undamped", [tn.Inertia("disc", node="a", inertia=1), spring])
    with pytest.raises(tn.SolveError, match=r"(?s)0\.159155 Hz.*no-solution"):
        rig.periodic_response("angle(a)", frequencies=[1 / (2 * pi)], excitation={"a": {1: 0.1}})


@pytest.mark.parametrize("third", [0.0, 0.003, 0.003j, -0.003j])
def test_friction_behind_a_spring_is_that_of_a_course_whichever_sample_is_the_top(third):
    """Of two samples at one height beside the top, and of a top that comes after the bottom in the period."""
    phi = 2 * np.pi * (np.arange(256) + 0.5) / 256
    twist = (0.1 * np.exp(1j * phi) + third * np.exp(3j * phi)).real
    course = slider_torque(400.0, 3.0, np.tile(twist, 2))
    np.testing.assert_allclose(SliderForce(400.0, 3.0).answer_to(twist, None).torque, course[256:], atol=1e-9)
