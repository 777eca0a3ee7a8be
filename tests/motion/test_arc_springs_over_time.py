"""Arc springs in simulate: a chain of segments from reversal to reversal, beside the closed form of slow loops."""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.arc_spring.slow_loop import ArcSprings, loop_from_top

RIG = """torsionnet: 1
elements:
  flywheel: {type: inertia, node: primary, inertia: 0.152}
  ARCS
inputs: {T: {torque: primary}}
"""
VALUES = (
    "stiffness: 700, arc_angle: 2.6, friction_coefficient: 0.12, spring_mass: 0.9, spring_radius: 0.11, torque: 276, "
    "damping: 4, swing: 2 deg"
)
ARCS = f"dmf: {{type: arc_spring, nodes: [primary, ground], {VALUES}, speed: 3000 rpm}}"
RATE = 100.0


def springs(rpm):
    return ArcSprings(700.0, 2.6, 0.12, 0.9, 0.11, rpm * math.pi / 30)


def simulated(rig, mean, amplitude, frequency=0.2, cycles=3.25):
    """Record of a slow sine of torque about a mean, from the operating point."""
    time = np.arange(0, cycles / frequency, 1 / RATE)
    torque = mean + amplitude * np.sin(2 * math.pi * frequency * time)
    return rig.simulate(["twist(dmf)", "torque(dmf)"], {"T": torque}, RATE, initial_state="operating_point")


def last_cycle(record, frequency=0.2):
    """Half swing in rad, torques at both tips, and loss in J of the last whole cycle from top to top."""
    _, twist, torque = (one.values[-round(RATE / frequency) - 1 :] for one in record.signals)
    top, low = twist.argmax(), twist.argmin()
    loss = np.trapezoid(np.r_[torque, torque[0]], np.r_[twist, twist[0]])
    return np.ptp(twist) / 2, torque[top], torque[low], float(loss)


@pytest.mark.parametrize(("rpm", "mean", "amplitude"), [(3000, 276.0, 90.0), (0, 276.0, 60.0)])
def test_a_slow_cycle_is_the_closed_loop(rpm, mean, amplitude):
    record = simulated(tn.loads(RIG.replace("ARCS", ARCS.replace("3000", str(rpm)))), mean, amplitude)
    swing, top, low, loss = last_cycle(record)
    loop = loop_from_top(springs(rpm), swing, top)
    assert (top - low) / (2 * swing) == pytest.approx(loop.secant_stiffness, rel=5e-3)
    # Viscous damping of 4 N m s/rad beside it: pi c omega a^2.
    assert loss - math.pi * 4 * 2 * math.pi * 0.2 * swing**2 == pytest.approx(loop.loss, rel=0.02)


def test_torque_passes_zero_where_the_flange_goes_to_the_other_end():
    """At standstill springs have no scale: loading k e/(1 - exp(-e)) on both sides, to the same torque."""
    record = simulated(tn.loads(RIG.replace("ARCS", ARCS.replace("3000", "0"))), 0.0, 80.0)
    swing, top, low, _ = last_cycle(record)
    e = 0.12 * 2.6
    assert top == pytest.approx(-low, rel=1e-3)
    assert top / swing == pytest.approx(700 * e / -math.expm1(-e), rel=2e-3)


def test_energy_is_stored_or_lost():
    """What a further cycle loses is the area of the loop; all that is supplied is stored or lost."""
    rig = tn.loads(RIG.replace("ARCS", ARCS))
    short, long = (simulated(rig, 276.0, 90.0, cycles=cycles) for cycles in (2.25, 3.25))
    assert abs(long.energy.left_over) < 1e-6 * long.energy.supplied
    lost = long.energy.dissipated["dmf"] - short.energy.dissipated["dmf"]
    assert lost == pytest.approx(last_cycle(long)[3], rel=2e-3)


def test_a_flywheel_and_springs_quoted_at_another_shaft_are_the_same():
    arcs = simulated(tn.loads(RIG.replace("ARCS", ARCS)), 276.0, 90.0, cycles=1.25)
    dmf = ARCS.replace("arc_spring", "dual_mass_flywheel, primary_inertia: 0.05, secondary_inertia: 0.02")
    light = RIG.replace("inertia: 0.152", "inertia: 0.102")
    whole = simulated(tn.loads(light.replace("ARCS", dmf)), 276.0, 90.0, cycles=1.25)
    np.testing.assert_allclose(whole.signals[1].values, arcs.signals[1].values, rtol=1e-9, atol=1e-12)


def test_beside_friction_and_a_contact():
    """Friction of 8 N m beside the springs: the loss grows by 4 M a."""
    rig = RIG.replace("ARCS", ARCS + "\n  rub: {type: friction, nodes: [primary, ground], torque: 8}")
    record = simulated(tn.loads(rig), 276.0, 90.0)
    swing, top, _, loss = last_cycle(record)
    loop = loop_from_top(springs(3000), swing, top)
    assert loss - math.pi * 4 * 2 * math.pi * 0.2 * swing**2 == pytest.approx(loop.loss, rel=0.02)
    assert abs(record.energy.left_over) < 1e-6 * record.energy.supplied
    assert record.energy.dissipated["rub"] > 3 * 4 * 8 * swing * 0.9


def test_beside_a_law_that_is_no_straight_line():
    """A cubic spring, whose motion goes by a Runge-Kutta method: the same loop, and energy is stored or lost."""
    rig = RIG.replace("ARCS", ARCS + "\n  hard: {type: spring, nodes: [primary, ground], stiffness: 100, cubic: 400}")
    record = simulated(tn.loads(rig), 276.0, 60.0, cycles=1.25)
    swing, _, _, loss = last_cycle(record)
    torque = record["torque(dmf)"].values
    loop = loop_from_top(springs(3000), swing, torque[-round(RATE / 0.2) - 1 :].max())
    assert loss - math.pi * 4 * 2 * math.pi * 0.2 * swing**2 == pytest.approx(loop.loss, rel=0.03)
    assert abs(record.energy.left_over) < 1e-5 * record.energy.supplied


def test_from_rest_alone_results_are_linear_and_say_so():
    record = tn.loads(RIG.replace("ARCS", ARCS)).simulate("twist(dmf)", {"T": [0.0] + [10.0] * 200}, RATE)
    assert any("its law acts in full beside other laws" in note for note in record.notes)
