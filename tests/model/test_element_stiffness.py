"""Describing functions of elements against closed forms and reference numbers of a component bench."""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.motion_laws.element_stiffness import element_stiffness

NODES = {"nodes": ("a", "b")}
TWO = [{"stiffness": 460, "to": "0.12 rad"}, {"stiffness": 1500}]


def stiffness(element, amplitude, mean=0.0, torque=0.0, omega=1.0):
    return element_stiffness(element, {}, amplitude, mean, torque, omega)


@pytest.mark.parametrize(
    ("amplitude", "real", "eta"),
    [(0.02, 412.462578, 0.205795), (0.05, 264.223095, 0.282703), (0.2, 208.589165, 0.113942)],
)
def test_a_slider_beside_a_spring(amplitude, real, eta):
    ring = stiffness(tn.Friction("ring", **NODES, torque=4, stiffness=300), amplitude).stiffness
    both = ring + stiffness(tn.Spring("shaft", **NODES, stiffness=200), amplitude).stiffness
    assert both.real == pytest.approx(real, rel=1e-8)
    assert both.imag / both.real == pytest.approx(eta, abs=6e-7)


def test_a_slider_loses_most_at_twice_its_twist():
    """k'' = kt/pi at a = 2 T/kt; below T/kt it does not slip."""
    ring = tn.Friction("ring", **NODES, torque=4, stiffness=300)
    assert stiffness(ring, 8 / 300).stiffness.imag == pytest.approx(300 / math.pi, rel=1e-12)
    assert max(stiffness(ring, a).stiffness.imag for a in np.linspace(0.01, 0.1, 200)) <= 300 / math.pi
    assert stiffness(ring, 4 / 300).stiffness == 300


def test_stages_with_friction():
    """460, .12, 1500 with M 6 at .2 rad."""
    both = stiffness(tn.Spring("disc", **NODES, stages=TWO), 0.2).stiffness
    both += stiffness(tn.Friction("ring", **NODES, torque=6), 0.2).stiffness
    assert both.real == pytest.approx(756.147259, rel=1e-9)
    assert both.imag / both.real == pytest.approx(0.0505155, rel=2e-6)


def test_stages_of_a_flywheel_with_its_friction_are_the_same():
    flywheel = tn.DualMassFlywheel("dmf", **NODES, primary_inertia=1, secondary_inertia=1, stages=TWO, friction=6)
    assert stiffness(flywheel, 0.2).stiffness == pytest.approx(complex(756.147259, 756.147259 * 0.0505155), rel=1e-6)


@pytest.mark.parametrize(("amplitude", "real"), [(0.01, 427.9307), (0.02, 3700.9119), (0.05, 6231.2896)])
def test_a_gap(amplitude, real):
    """Half width .0087266463 rad, 8000 in contact."""
    gap = tn.Clearance("mesh", **NODES, gap=2 * 0.0087266463, stiffness=8000)
    assert stiffness(gap, amplitude).stiffness == pytest.approx(real, rel=2e-7)


def test_a_preload_at_zero_and_dry_friction():
    """4 P/(pi a) in phase; 4 M/(pi a) behind it."""
    preloaded = tn.Spring("disc", **NODES, stages=[{"stiffness": 460, "preload": 7}])
    assert stiffness(preloaded, 0.1).stiffness == pytest.approx(460 + 4 * 7 / (math.pi * 0.1), rel=1e-12)
    assert stiffness(tn.Friction("ring", **NODES, torque=3), 0.1, omega=9.0).stiffness == pytest.approx(
        4j * 3 / (math.pi * 0.1), rel=1e-12
    )


def test_a_cubic_spring_with_damping():
    """k + 3/4 k_3 a^2 + 3 k_3 m^2, and j w c."""
    found = stiffness(tn.Spring("s", **NODES, stiffness=140, cubic=2600, damping=2), 0.2, mean=0.1, omega=5.0)
    assert found.stiffness == pytest.approx(complex(140 + 0.75 * 2600 * 0.04 + 3 * 2600 * 0.01, 10), rel=1e-12)
    assert found.mean_torque == pytest.approx(140 * 0.1 + 2600 * (0.001 + 1.5 * 0.1 * 0.04), rel=1e-12)


def test_stages_about_a_mean_twist():
    """460 to .12, 1500: about .087 with amplitude .1, and 120, 600, 2400 about .12 with .3."""
    found = stiffness(tn.Spring("disc", **NODES, stages=TWO), 0.1, mean=0.087)
    assert (found.stiffness.real, found.mean_torque) == pytest.approx((765.5450886, 57.7836733), rel=1e-9)
    three = [{"stiffness": 120, "to": "0.05 rad"}, {"stiffness": 600, "to": "0.2 rad"}, {"stiffness": 2400}]
    found = stiffness(tn.Spring("disc", **NODES, stages=three), 0.3, mean=0.12)
    assert (found.stiffness.real, found.mean_torque) == pytest.approx((1105.3469777, 171.7108936), rel=1e-9)


def test_arc_springs_at_another_swing_than_their_own():
    arcs = tn.ArcSpring(
        "arcs", **NODES, stiffness=700, arc_angle=2.6, friction_coefficient=0.12, spring_mass=0.9, spring_radius=0.11,
        speed="3000 rpm", torque=1, swing=1, damping=2,
    )  # fmt: skip
    found = stiffness(arcs, math.radians(2), torque=276.2278014, omega=3.0)
    assert found.stiffness == pytest.approx(complex(2490.3706, 2490.3706 / 2 + 6), rel=1e-6)


def test_friction_over_slip_speed_behind_a_spring_is_refused():
    ring = tn.Friction("ring", **NODES, torque_over_slip=[[0, 4], [10, 3]], stiffness=300)
    with pytest.raises(tn.UsageError, match=r"(?s)ring.*unsupported-law"):
        stiffness(ring, 0.1)
