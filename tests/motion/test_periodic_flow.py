"""Periodic motions of plants drawn for it against their flow, stepped from event to event by DOP853."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians

import numpy as np
import pytest
from support.law_flow import Contact, Cubic, Flow, Slider

import torsionnet as tn
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse

CLOSES = 1e-6
"""Share of its state by which a motion may fail to come back in the flow: what harmonics may leave out of a swing."""
SHARE = 1e-5
"""Share of the swing to which its ends have to be right."""
MULTIPLIER = 1e-3
"""Error of the largest multiplier, over its size where that is above 1."""


def _agrees(
    found: PeriodicResponse, motion: FoundMotion, flow: Flow, nodes: Sequence[str], row: Sequence[float]
) -> None:
    # of friction between two nodes, the slide of its slider on the second
    slider = [motion.angles[name] - motion.angles[nodes[-1]] for name in motion.angles if name.endswith(".slider")]
    y = np.array([*(motion.angles[node] for node in nodes), *(motion.speeds[node] for node in nodes), *slider])
    end = flow.end(y, motion.periods)
    assert np.abs(end - y).max() < CLOSES * np.abs(y).max() * max(1.0, float(np.abs(motion.multipliers[0])))
    swing = found.peak_to_peak(motion)
    ends = flow.extremes(y, row, motion.periods)
    np.testing.assert_allclose((motion.lowest[0], motion.highest[0]), ends, atol=SHARE * swing, rtol=0)
    largest = flow.multipliers(y, motion.periods)[0]
    error = min(abs(motion.multipliers[0] - largest), abs(motion.multipliers[0] - largest.conjugate()))
    assert error < MULTIPLIER * max(1.0, abs(largest))


@pytest.mark.slow
def test_contact_that_damps_and_never_pulls():
    elements = [
        tn.Inertia("wheel", node="a", inertia=0.05),
        tn.Clearance("gap", nodes=("a", "b"), gap="1.2 deg", stiffness=5200, damping=1.4),
        tn.Inertia("car", node="b", inertia=0.3),
        tn.Spring("hold", nodes=("b", "ground"), stiffness=900, damping=1.1),
    ]
    found = tn.Drivetrain("damped contact", elements).periodic_response(
        "twist(gap)", frequencies=[42, 44], excitation={"a": {0: 9, 1: 13}}
    )
    assert len(found.motions_at(42)) == 3
    contact = Contact((1, -1), radians(1.2), 5200, 1.4)
    for motion in found.motions_at(42):
        flow = Flow(np.diag([0.05, 0.3]), np.diag([0, 1.1]), np.diag([0, 900]), [contact], [[9, 0], [13, 0]], 42)
        _agrees(found, motion, flow, "ab", (1, -1))


@pytest.mark.nightly
def test_contact_beside_a_delay():
    """Ends of the two motions that are met, stepped from twelve states by Runge and Kutta with 0.003 s behind."""
    elements = [
        tn.Inertia("wheel", node="a", inertia=0.05),
        tn.Clearance("gap", nodes=("a", "b"), gap="1.2 deg", stiffness=5200, damping=1.4),
        tn.Inertia("car", node="b", inertia=0.3),
        tn.Spring("hold", nodes=("b", "ground"), stiffness=900, damping=1.1),
        tn.Controller("brake", sense={"velocity": "a"}, act="a", law=-0.4, delay=0.003),
    ]
    found = tn.Drivetrain("delayed contact", elements).periodic_response(
        "twist(gap)", frequencies=[42, 44], excitation={"a": {0: 9, 1: 13}}, subharmonics=2
    )
    ends = [(one.periods, float(one.lowest[0]), float(one.highest[0])) for one in found.stable_at(42)]
    np.testing.assert_allclose(sorted(ends), [(1, -0.030434, 0.035545), (2, -0.002438, 0.017866)], atol=1e-5)


@pytest.mark.nightly
def test_teeth_with_a_ratio_and_two_harmonics():
    elements = [
        tn.Inertia("pinion", node="a", inertia=0.02),
        tn.Gear("mesh", nodes=("a", "b"), ratio=2.5, stiffness=2100, damping=0.25, backlash="0.9 deg"),
        tn.Inertia("wheel", node="b", inertia=0.9),
        tn.Spring("hold", nodes=("b", "ground"), stiffness=4000, damping=9),
    ]
    found = tn.Drivetrain("teeth", elements).periodic_response(
        "twist(mesh)", frequencies=[40, 42], excitation={"a": {0: 5, 1: 7}, "b": {2: -3j}}
    )
    contact = Contact((1, -2.5), radians(0.9), 2100, 0.25)
    loads = [[5, 0], [7, 0], [0, -3j]]
    for motion in found.motions_at(40):
        flow = Flow(np.diag([0.02, 0.9]), np.diag([0, 9]), np.diag([0, 4000]), [contact], loads, 40)
        _agrees(found, motion, flow, "ab", (1, -2.5))


@pytest.mark.nightly
def test_friction_behind_a_spring_between_two_masses():
    elements = [
        tn.Inertia("one", node="a", inertia=0.11),
        tn.Spring("first", nodes=("a", "ground"), stiffness=520, damping=0.25),
        tn.Friction("rub", nodes=("a", "b"), torque=2.5, stiffness=410),
        tn.Inertia("two", node="b", inertia=0.06),
        tn.Spring("second", nodes=("b", "ground"), stiffness=330, damping=0.2),
    ]
    found = tn.Drivetrain("rubbing", elements).periodic_response(
        "twist(rub)", frequencies=[15, 15.2], excitation={"a": {1: 4, 3: 0.8j}}
    )
    loads = [[0, 0], [4, 0], [0, 0], [0.8j, 0]]
    slider = Slider((1, -1), 410, 2.5)
    for motion in found.motions_at(15):
        flow = Flow(np.diag([0.11, 0.06]), np.diag([0.25, 0.2]), np.diag([520, 330]), [slider], loads, 15)
        _agrees(found, motion, flow, "ab", (1, -1))


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.75, 1.5])
def test_rigid_friction_that_never_sticks_is_that_of_den_hartog(share):
    """Amplitude P/k sqrt(V^2 - (F U/P)^2), J. P. Den Hartog, Transactions of the ASME 53, 1931; 4 F/pi is its order 1."""
    elements = [
        tn.Inertia("mass", node="x", inertia=0.05),
        tn.Spring("spring", nodes=("x", "ground"), stiffness=200),
        tn.Friction("rub", nodes=("x", "ground"), torque=2),
    ]
    at = share * np.sqrt(200 / 0.05) / (2 * pi)
    found = tn.Drivetrain("rubbing", elements).periodic_response(
        ["x", "torque(rub)"], frequencies=[at], excitation={"x": 5}
    )
    (motion,) = found.motions_at(at)
    V, U = 1 / (1 - share**2), np.sin(pi / share) / (share * (1 + np.cos(pi / share)))
    assert abs(float(motion.highest[0]) / (5 / 200 * np.sqrt(V**2 - (2 / 5 * U) ** 2)) - 1) < 1e-9
    assert abs(abs(motion.amplitudes[1, 1]) - 8 / pi) < 1e-7
    assert motion.is_stable


@pytest.mark.slow
@pytest.mark.parametrize("drive", [5, 3])
def test_friction_over_the_slip_comes_back_as_stepped(drive):
    """Torque of 2, 3 and 4 N m at slips of 0, 5 and 20 rad/s: 5 N m pass through rest, 3 N m stick for a while."""
    from scipy.integrate import solve_ivp

    rows = [(0, 2), (5, 3), (20, 4)]
    elements = [
        tn.Inertia("mass", node="x", inertia=0.05),
        tn.Spring("spring", nodes=("x", "ground"), stiffness=200, damping=0.15),
        tn.Friction("rub", nodes=("x", "ground"), torque_over_slip=rows),
    ]
    (motion,) = (
        tn.Drivetrain("rubbing", elements).periodic_response("x", frequencies=[10], excitation={"x": drive}).motions
    )
    start = np.array([motion.angles["x"], motion.speeds["x"]])
    y, t, tops, slips, most = start, 0.0, [], *np.array(rows, dtype=float).T

    def pushes(t: float, y: np.ndarray) -> float:
        return float(drive * np.cos(20 * pi * t) - 200 * y[0] - 0.15 * y[1])

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [y[1], (pushes(t, y) - way * np.interp(abs(y[1]), slips, most)) / 0.05]

    def rests(_: float, y: np.ndarray) -> float:
        return float(y[1])

    def lets_go(t: float, y: np.ndarray) -> float:
        return abs(pushes(t, y)) - most[0]

    while t < 0.1:
        way = np.sign(y[1]) or np.sign(pushes(t, y))
        sticks = not y[1] and abs(pushes(t, y)) < most[0]
        event = lets_go if sticks else rests
        event.terminal, event.direction = True, 1 if sticks else -way
        solution = solve_ivp(
            (lambda *_: [0.0, 0.0]) if sticks else rates,
            (t, 0.1),
            y,
            events=event,
            rtol=1e-10,
            atol=1e-12,
            max_step=1e-3,
        )
        t, y = float(solution.t[-1]), solution.y[:, -1]
        if solution.status == 1:
            y[1] = 0.0
            tops.append(y[0])
    np.testing.assert_allclose(y, start, atol=1e-7 * np.abs(start).max())
    assert abs(np.ptp(tops) - (motion.highest[0] - motion.lowest[0])) < 1e-8
    assert motion.is_stable


def _cubic_mass(damping: float) -> tn.Drivetrain:
    """Mass of Ueda, x'' + c x' + x^3."""
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=0, cubic=1, damping=damping)
    return tn.Drivetrain("cubic", [tn.Inertia("mass", node="a", inertia=1), spring])


@pytest.mark.nightly
def test_symmetric_motion_becomes_lopsided_without_a_fold():
    found = _cubic_mass(0.2).periodic_response("a", frequencies=np.array([1.1, 1.3]) / (2 * pi), excitation={"a": 5})
    (fork,) = found.turns("symmetry")
    assert any(f"at {fork.at:.8g} Hz the motion of branch 1 loses its symmetry" in note for note in found.notes)
    assert found.ways == ("from rest", f"lopsided at {fork.at:.8g} Hz")

    def flow(at: float) -> Flow:
        return Flow(np.eye(1), np.zeros((1, 1)), np.zeros((1, 1)), [Cubic((1,), 0, 1, 0.2)], [[0], [5]], at)

    # The largest multiplier of the symmetric motion passes 1 there.
    y = np.array([fork.angles["a"], fork.speeds["a"]])
    assert abs(flow(fork.at).multipliers(y)[0] - 1) < MULTIPLIER
    for W, stable in ((1.1, 1), (1.3, 0)):
        for motion in found.motions_at(W / (2 * pi)):
            _agrees(found, motion, flow(motion.at), "a", (1,))
            assert motion.is_stable is (motion.branch == stable)
            assert bool(abs(motion.amplitudes[0, 0]) > 0.1) is (motion.branch == 1)


@pytest.mark.nightly
def test_peak_between_places_far_apart_is_added():
    found = _cubic_mass(0.2).periodic_response(
        "a", frequencies=np.array([0.2, 4]) / (2 * pi), excitation={"a": {1: 0.5}}
    )
    spread = _cubic_mass(0.2).periodic_response(
        "a", frequencies=np.linspace(0.9, 1.6, 29) / (2 * pi), excitation={"a": {1: 0.5}}
    )
    largest = max(found.peaks, key=found.peak_to_peak)
    sizes = [found.peak_to_peak(one) for one in spread.motions if one.turn != "peak"]
    assert max(sizes) <= found.peak_to_peak(largest) * (1 + 1e-9)
    assert max(sizes) > 0.98 * found.peak_to_peak(largest)


@pytest.mark.nightly
def test_chaos_is_said_where_no_motion_is_stable():
    found = _cubic_mass(0.05).periodic_response("a", frequencies=np.array([0.98, 1]) / (2 * pi), excitation={"a": 7.5})
    assert not found.stable_at(1 / (2 * pi))
    assert any("or is chaotic; simulate shows it" in note for note in found.notes)
    # Y. Ueda, 1979: a strange attractor; after 100 periods, what was 1e-9 beside it is anywhere.
    chaotic = Flow(np.eye(1), np.zeros((1, 1)), np.zeros((1, 1)), [Cubic((1,), 0, 1, 0.05)], [[0], [7.5]], 1 / (2 * pi))
    beside = [chaotic.end(np.array([3.0 + off, 4.0]), 60) for off in (0, 1e-9)]
    assert np.abs(beside[1] - beside[0]).max() > 0.1


@pytest.mark.slow
def test_fan_brakes_with_the_torque_of_its_speed():
    from scipy.integrate import solve_ivp
    from scipy.optimize import newton

    elements = [
        tn.Propeller("fan", node="a", inertia=0.1, exponent=2, torque="10 N*m", speed="30 rad/s"),
        tn.Inertia("rotor", node="b", inertia=1),
        tn.Spring("spring", nodes=("a", "b"), stiffness=100, cubic=900, damping=0.1),
    ]
    order = {"type": "harmonic", "node": "b", "orders": {1: {"amplitude": "12 N*m"}}}
    found = tn.Drivetrain("fan", elements, excitations={"shaker": order}).periodic_response(
        "twist(spring)", speeds=[36.0, 37.0], speed_of="b"
    )
    (motion,) = found.motions_at(36.0)

    def rates(t: float, y: np.ndarray, drive: float) -> list[float]:
        twist, fan, rotor = y
        torque = 100 * twist + 900 * twist**3 + 0.1 * (fan - rotor)
        brake = 10 * fan * abs(fan) / 30**2
        return [fan - rotor, (-torque - brake) / 0.1, torque + 12 * np.cos(36 * t) + drive]

    def end(y: np.ndarray, drive: float) -> np.ndarray:
        period = (0, 2 * pi / 36)
        return solve_ivp(rates, period, y, args=(drive,), method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]

    y = np.array([motion.angles["a"] - motion.angles["b"], motion.speeds["a"], motion.speeds["b"]])
    # The drive holds the speed: its torque is what the fan takes on the mean.
    drive = float(newton(lambda torque: end(y, torque)[2] - y[2], 10.0, x1=20.0, tol=1e-9))
    assert np.abs(end(y, drive) - y).max() < CLOSES * np.abs(y).max()
    slopes = [(end(y + step, drive) - end(y - step, drive)) / 2e-5 for step in 1e-5 * np.eye(3)]
    sizes = sorted(np.abs(np.linalg.eigvals(np.array(slopes).T)))
    np.testing.assert_allclose(sorted(np.abs(motion.multipliers)), sizes, atol=MULTIPLIER)
