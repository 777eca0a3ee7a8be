"""March of motions in contact states: samples seldom and often, compiled loops, steps of stiff and of massless parts."""

import sys

import numpy as np
import pytest
import scipy
from support import campaigns
from support.random_motion_plants import moving_plant

import torsionnet as tn
from torsionnet.motion import contact_states, piece_system
from torsionnet.motion.contact_states import MotionStart


def simulated(seed=3, rate=1000.0, seconds=0.2, most=3):
    plant = moving_plant(seed, most)
    nodes = [node for node in plant.drivetrain.nodes if node.startswith("n")]
    times = np.arange(round(seconds * rate) + 1) / rate
    outputs = [f"{what}({node})" for what in ("angle", "velocity", "acceleration") for node in nodes]
    start = MotionStart(speeds=plant.speeds)
    record = plant.drivetrain.simulate(outputs, plant.samples(times), rate, initial_state=start)
    return np.array([record[name].values for name in outputs]), record


@pytest.mark.parametrize("seed", [3, 6])
def test_samples_seldom_and_often_read_one_motion(seed):
    """20 Hz take more steps to a sample than a block has, 125 Hz some, 4 kHz one."""
    often, record = simulated(seed, 4000.0)
    assert len(record.events) > 5
    for rate, each in ((20.0, 200), (125.0, 32)):
        seldom, _ = simulated(seed, rate)
        size = np.abs(often).max(axis=1, keepdims=True)
        assert (np.abs(seldom - often[:, ::each]) < 1e-10 * size).all()


def test_little_memory_changes_nothing(monkeypatch):
    """Full lists are read on the way, and tables of contact states left behind are made again."""
    plain, record = simulated()
    monkeypatch.setattr(contact_states, "MOST_BYTES", 1)
    monkeypatch.setattr(piece_system, "LISTED", 8)
    monkeypatch.setattr(piece_system, "MOST_BYTES_KEPT", 1)
    monkeypatch.setattr(piece_system, "_compiled_march", lambda: piece_system.marching.march)
    cleared = []
    clear = contact_states.ContactStates.clear
    monkeypatch.setattr(contact_states.ContactStates, "clear", lambda states: (cleared.append(1), clear(states)))
    slow, same = simulated()
    assert len(cleared) > 2
    assert slow == pytest.approx(plain, rel=1e-12, abs=1e-12 * np.abs(plain).max())
    assert same.energy.supplied == pytest.approx(record.energy.supplied, rel=1e-12)
    assert [event.what for event in same.events] == [event.what for event in record.events]


@pytest.mark.slow
@pytest.mark.parametrize("seed", campaigns.by_day([2, 3], 2))
def test_compiled_loops_march_as_numpy_does(monkeypatch, seed):
    pytest.importorskip("numba")
    plain, record = simulated(seed, seconds=0.5, most=20)
    compiled = piece_system._compiled_march()
    assert compiled is not piece_system.marching.march
    marched = []
    monkeypatch.setattr(piece_system, "STEPS_WORTH_COMPILING", 0)
    monkeypatch.setattr(
        piece_system, "_compiled_march", lambda: lambda *given: (marched.append(1), compiled(*given))[1]
    )
    fast, same = simulated(seed, seconds=0.5, most=20)
    assert marched
    assert [event.what for event in same.events] == [event.what for event in record.events]
    assert np.abs(fast - plain).max() < 1e-9 * np.abs(plain).max()


@pytest.mark.parametrize("broken", [None, "another module"])
def test_motions_need_no_numba(monkeypatch, broken):
    plain, _ = simulated()
    monkeypatch.setattr(piece_system, "STEPS_WORTH_COMPILING", 0)
    monkeypatch.setitem(sys.modules, "numba", broken)
    monkeypatch.delitem(sys.modules, "torsionnet.motion.compiled_march", raising=False)
    assert piece_system._compiled_march() is piece_system.marching.march
    assert np.array_equal(simulated()[0], plain)


def test_one_thread_of_blas(monkeypatch):
    """Threads that wait for each other in small products cost four times the processor time."""
    threadpoolctl = pytest.importorskip("threadpoolctl")
    seen = []

    def counted():
        return {one["num_threads"] for one in threadpoolctl.threadpool_info() if one["user_api"] == "blas"}

    whole = piece_system.PieceMotion.whole
    monkeypatch.setattr(piece_system.PieceMotion, "whole", lambda *given: (seen.append(counted()), whole(*given))[1])
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        simulated()
    assert seen
    assert set().union(*seen) <= {1}


def test_contacts_that_close_and_open_between_two_grid_points_are_all_found():
    """A rotor on a spring touches the stops for a quarter of a radian, at all phases of the steps of a radian."""
    reach, touch, omega = 0.1, 0.0992, 20.0
    stops = tn.Clearance("stops", nodes=("a", "ground"), gap=2 * touch, stiffness=1e-3)  # which hardly moves it
    elements = [tn.Inertia("J", node="a", inertia=1), tn.Spring("k", nodes=("a", "ground"), stiffness=omega**2)]
    plant = tn.Drivetrain("grazing", [*elements, stops])
    start = MotionStart(speeds={"a": reach * omega})
    record = plant.simulate("a", {"a": np.zeros(1401)}, omega / 0.97, initial_state=start)
    half = np.arange(int(1400 * 0.97 / np.pi)) * np.pi
    closings, openings = ([event.time for event in record.events if event.what == what] for what in ("closes", "opens"))
    width = np.arcsin(touch / reach)
    assert np.array(closings) == pytest.approx((half + width) / omega, abs=1e-5)
    assert np.array(openings) == pytest.approx((half + np.pi - width) / omega, abs=1e-5)


def test_events_of_two_parts_within_a_step_come_in_their_order():
    """Bodies that fly freely reach their stops a microsecond apart."""
    elements = [tn.Inertia("A", node="a", inertia=1), tn.Inertia("B", node="b", inertia=2)]
    stops = [tn.Clearance(f"stop_{node}", nodes=(node, "ground"), gap=0.2, stiffness=100) for node in "ab"]
    shaft = tn.Clearance("shaft", nodes=("a", "b"), gap=100, stiffness=1)
    plant = tn.Drivetrain("two", [*elements, *stops, shaft])
    for late in "ab":
        speeds = {"a": 0.1 / 0.5153, "b": 0.1 / 0.5153}
        speeds[late] = 0.1 / 0.515301
        record = plant.simulate("a", {"a": np.zeros(101)}, 100.0, initial_state=MotionStart(speeds=speeds))
        first, second = record.events[:2]
        assert (first.element, second.element) == (f"stop_{'b' if late == 'a' else 'a'}", f"stop_{late}")
        assert (first.time, second.time) == (pytest.approx(0.5153, abs=1e-13), pytest.approx(0.515301, abs=1e-13))


def test_massless_node_that_rubs_follows_the_torque_with_play():
    """Its rate is that of the torque over the stiffness, so that friction reverses at corners of the torque."""
    stiffness, rubs = 50.0, 3.0
    spring = tn.Spring("k", nodes=("m", "ground"), stiffness=stiffness)
    elements = [tn.Inertia("J", node="a", inertia=1), spring, tn.Friction("rub", nodes=("m", "ground"), torque=rubs)]
    corners = [0.0, 11.0, 1.0, 8.0, -9.0, -9.0, 2.0]
    torque = np.interp(np.arange(601) / 100, np.arange(7), corners)
    apart = tn.Clearance("apart", nodes=("a", "m"), gap=100, stiffness=1)
    record = tn.Drivetrain("play", [*elements, apart]).simulate(
        ["m", "velocity(m)", "torque(rub)"], {"m": torque}, 100.0
    )
    borne, expected = 0.0, []
    for one in torque:
        borne = min(max(borne, one - rubs), one + rubs)
        expected.append(borne / stiffness)
    assert record["m"].values == pytest.approx(np.array(expected), abs=1e-12)
    assert record["torque(rub)"].values == pytest.approx(torque - stiffness * np.array(expected), abs=1e-10)
    assert [event.what for event in record.events] == ["slips", *4 * ["sticks", "slips"]]


def test_massless_node_with_a_contact_is_damped_in_contact_and_static_in_the_gap():
    inertia, k, gap, k_c, c = 0.5, 900.0, 0.02, 400.0, 15.0
    mesh = tn.Clearance("mesh", nodes=("m", "ground"), gap=2 * gap, stiffness=k_c, damping=c)
    elements = [tn.Inertia("J", node="a", inertia=inertia), tn.Spring("k", nodes=("a", "m"), stiffness=k), mesh]
    record = tn.Drivetrain("rim", elements).simulate(
        ["a", "m"], {"a": np.zeros(301)}, 1e3, initial_state=MotionStart(speeds={"a": 1.0, "m": 1.0})
    )

    def pressed(_, y):
        torque = k * (y[0] - y[2])
        return [y[1], -torque / inertia, (torque - k_c * (y[2] - gap)) / c]

    def parts(_, y):
        return y[0] - y[2]

    parts.terminal, parts.direction = True, -1
    contact = scipy.integrate.solve_ivp(
        pressed, (0, 1), [gap, 1.0, gap - 1e-15], "DOP853", rtol=1e-12, atol=1e-14, events=parts, dense_output=True
    )
    times = np.arange(301) / 1e3
    inside = (times > gap) & (times < gap + contact.t[-1])
    assert inside.sum() > 40
    expected = contact.sol(times[inside] - gap)
    assert record["a"].values[inside] == pytest.approx(expected[0], abs=1e-10)
    assert record["m"].values[inside] == pytest.approx(expected[2], abs=1e-10)
    free = times < gap
    assert record["m"].values[free] == pytest.approx(times[free], abs=1e-14)


def test_parts_stick_one_after_the_other():
    """Each of two rotors stands while the other one turns."""
    elements = [tn.Inertia("A", node="a", inertia=0.5), tn.Inertia("B", node="b", inertia=2)]
    rubs = [tn.Friction(f"rub_{node}", nodes=(node, "ground"), torque=torque) for node, torque in (("a", 3), ("b", 5))]
    shaft = tn.Clearance("shaft", nodes=("a", "b"), gap=100, stiffness=1)
    times = np.arange(3001) / 1e3
    torques = {"a": np.where(times < 1, 8.0, 0.0), "b": np.where(times < 1, 0.0, 11.0)}
    record = tn.Drivetrain("two", [*elements, *rubs, shaft]).simulate(["velocity(a)", "velocity(b)"], torques, 1e3)
    # the torques run straight from 8 to 0, and from 0 to 11, between the samples 999 and 1000
    a, b = record["velocity(a)"].values, record["velocity(b)"].values
    assert a[:1000] == pytest.approx(10 * times[:1000], abs=1e-11)
    assert (b[:1000] == 0).all()
    assert np.diff(b)[1000:] == pytest.approx(3e-3, abs=1e-12)
    stops = next(event for event in record.events if (event.element, event.what) == ("rub_a", "sticks"))
    assert stops.time == pytest.approx(1 + a[1000] / 6, abs=1e-12)
