"""Where periodic motions end: second frequencies, cascades, tables that are left, branches that stop, no period."""

from __future__ import annotations

from itertools import islice
from math import pi

import numpy as np
import pytest
from support.periodic_rigs import (
    duffing,
    free_clearance,
    gear_pair,
    problem,
    rubbing_mass,
    sink,
    swing,
    two_stage_rig,
)

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.motion.periodic import all_branches, periodic_response
from torsionnet.motion.periodic.all_branches import from_rest, from_simulation, without_start
from torsionnet.motion.periodic.periodic_problem import peak_to_peak
from torsionnet.motion.periodic.periodic_response import _between as between


def _multipliers_of_the_sink(W: float, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State and multipliers of the motion of the rig ``sink`` near a state (a, b, a', b'), by shooting with DOP853."""
    from scipy.integrate import solve_ivp

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        a, b, va, vb = y[:4]
        g, rate = a - b, va - vb
        link = 0.001 * g + 0.4 / 3 * g**3 + 0.02 * rate
        k = 0.001 + 0.4 * g**2
        J = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-1 - k, k, -0.02, 0.02], [10 * k, -10 * k, 0.2, -0.2]])
        return np.concatenate(
            [[va, vb, -a - link + 0.03 * np.cos(W * t), 10 * link], (J @ y[4:].reshape(4, 4)).ravel()]
        )

    for _ in range(4):
        start = np.concatenate([state, np.eye(4).ravel()])
        end = solve_ivp(rates, (0, 2 * pi / W), start, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        monodromy = end[4:].reshape(4, 4)
        state = state - np.linalg.solve(monodromy - np.eye(4), end[:4] - state)
    return state, np.linalg.eigvals(monodromy)


def test_second_frequency_sets_in_where_shooting_has_a_pair_on_the_unit_circle():
    found = sink().periodic_response(
        "twist(link)", frequencies=np.array([0.95, 1.0, 1.02]) / (2 * pi), excitation={"a": 0.03}
    )
    (onset,) = found.turns("second frequency")
    state = np.array([*(onset.angles[node] for node in "ab"), *(onset.speeds[node] for node in "ab")])
    sizes = []
    for W in onset.at * 2 * pi * np.array([1 - 1e-4, 1 + 1e-4]):
        _, multipliers = _multipliers_of_the_sink(W, state)
        pair = multipliers[np.abs(multipliers.imag) > 0.1]
        sizes.append(np.abs(pair).max() - 1)
    # The size of the pair passes one in between, straight over so short a way.
    crossing = 1e-4 * (sizes[0] + sizes[1]) / (sizes[0] - sizes[1])
    assert sizes[0] < 0 < sizes[1]
    assert abs(crossing) < 1e-5
    assert any("motions with a second frequency, which no period repeats" in note for note in found.notes)
    assert [one.stability for one in found.motions_at(1.0 / (2 * pi))] == ["unstable: a second frequency grows"]


def _repeats(W: float, after: int, start: list[float]) -> float:
    """Change of the gear pair with 0.06 after so many periods, once 400 have passed from a start, by DOP853."""
    from scipy.integrate import solve_ivp

    def rates(t: float, y: np.ndarray) -> list[float]:
        f = y[0] - np.clip(y[0], -1, 1)
        return [y[1], 0.12 + 0.6 * np.cos(W * t) - 0.06 * y[1] - f]

    times = 2 * pi / W * np.array([0, 400, 400 + after])
    found = solve_ivp(rates, (0, times[-1]), start, method="DOP853", rtol=1e-8, atol=1e-10, t_eval=times, max_step=0.3)
    return float(np.abs(found.y[:, 2] - found.y[:, 1]).max())


@pytest.mark.nightly
def test_cascade_of_doublings_is_said_and_stepped_motions_have_its_periods():
    found = gear_pair(0.06).periodic_response(
        "x", frequencies=np.array([1.75, 1.8, 1.9, 2]) / (2 * pi), excitation={"x": {0: 0.12, 1: 0.6}}, subharmonics=4
    )
    four, eight = found.turns("doubling")[1:]
    assert any("a cascade without an end, beyond about 0.28494 Hz chaos" in note for note in found.notes)
    between, start = pi * (four.at + eight.at), [eight.angles["x"], eight.speeds["x"]]
    assert _repeats(between, 4, start) < 1e-3 < _repeats(between, 2, start)


def _table_rig() -> tn.Drivetrain:
    stages = [{"stiffness": 100, "to": "0.2 rad"}, {"stiffness": 300, "to": "0.5 rad"}]
    spring = tn.Spring("disc", nodes=("a", "ground"), stages=stages, damping=1.0)
    return tn.Drivetrain("table", [tn.Inertia("mass", node="a", inertia=1), spring])


@pytest.mark.slow
def test_motions_beyond_the_table_of_a_spring_are_left_out_and_told():
    found = _table_rig().periodic_response("a", frequencies=[1.5, 2.0, 2.2, 3.0], excitation={"a": 10})
    assert max(float(one.highest[0]) for one in found.motions) < 0.5
    assert len(found.motions_at(2.0)) == 3
    assert len(found.motions_at(2.2)) == 2
    assert any("are left out: disc: the torque is given from -0.5 rad to 0.5 rad" in note for note in found.notes)
    with pytest.raises(SolveError, match=r"(?s)disc: .*beyond-table"):
        _table_rig().periodic_response("a", frequencies=[1.5, 1.6], excitation={"a": 1000})


def test_branch_that_stops_says_where_and_why(monkeypatch):
    monkeypatch.setattr(all_branches, "MOST_POINTS", 12)
    found = duffing().periodic_response("a", frequencies=np.array([0.5, 1.5]) / (2 * pi), excitation={"a": 0.18})
    stops = [note for note in found.notes if " stops at " in note]
    assert any("where spring swings by" in note and "only 12 points of it are followed" in note for note in stops)
    assert len(found.motions_at(0.5 / (2 * pi))) == 1


def test_branch_of_a_fork_that_is_one_too_many_is_told(monkeypatch):
    monkeypatch.setattr(all_branches, "MOST_FOLLOWED", 1)
    found = gear_pair(0.06).periodic_response(
        "x", frequencies=np.array([1.75, 2]) / (2 * pi), excitation={"x": {0: 0.12, 1: 0.6}}, subharmonics=2
    )
    assert {one.branch for one in found.motions} == {0}
    fork = found.turns("doubling")[0].at
    assert any(f"begins at {fork:.8g} Hz is not followed to its end" in note for note in found.notes)


@pytest.mark.slow
def test_branches_that_only_a_simulation_leads_to(monkeypatch):
    asked = {"frequencies": np.array([0.75, 0.8]) / (2 * pi), "excitation": {"x": {0: 0.1, 1: 0.032}}}
    known = gear_pair().periodic_response("x", **asked)
    large = min(known.motions_at(0.8 / (2 * pi)), key=lambda one: float(one.lowest[0]))
    # Nothing else leads anywhere.
    monkeypatch.setattr(all_branches, "from_rest", lambda *_: iter(()))
    monkeypatch.setattr(all_branches, "STARTS", ())
    with pytest.raises(SolveError, match="no-period"):
        gear_pair().periodic_response("x", **asked)
    state = tn.motion.MotionStart(angles=large.angles, speeds=large.speeds)
    found = gear_pair().periodic_response("x", **asked, initial_state=state)
    assert found.ways == ("from a simulated motion",)
    (again,) = found.motions_at(0.8 / (2 * pi))
    # The large motion of the reference, which hammers through the dead zone.
    assert abs(float(again.lowest[0]) - 0.76157005) < 1e-5
    assert abs(float(again.highest[0]) - 1.33300931) < 1e-5


def test_isolated_branches_are_found_by_starts_of_other_sizes(monkeypatch):
    # From rest the small motion alone, which within the range nothing joins to the large one.
    monkeypatch.setattr(all_branches, "from_rest", lambda *given: islice(from_rest(*given), 1))
    found = gear_pair().periodic_response(
        "x", frequencies=np.array([0.75, 0.8]) / (2 * pi), excitation={"x": {0: 0.1, 1: 0.032}}
    )
    assert "from a start of another size, joined to no other" in found.ways
    large = min(found.stable_at(0.8 / (2 * pi)), key=lambda one: float(one.lowest[0]))
    assert abs(float(large.lowest[0]) - 0.76157005) < 1e-5
    assert "there may be more" in found.notes[-1]


@pytest.mark.parametrize(
    ("rig", "loads", "at", "periods", "lowest", "highest"),
    [
        (free_clearance, {"a": [25, 40], "b": [-25, 0]}, 45.0, 2, 0.00605751, 0.02761135),
        (two_stage_rig, {"motor": [40, 60]}, 10.0, 1, None, None),
    ],
)
def test_simulation_from_rest_comes_to_the_motion_that_is_met(rig, loads, at, periods, lowest, highest):
    one = problem(rig(), loads, at)
    (motion,) = from_simulation(one, at, "rest", 2)
    found = swing(one, motion)
    assert motion.subharmonics == periods
    if lowest is None:
        assert abs(found[1] - found[0] - 0.73213888) < 1e-5
    else:
        assert np.abs(np.array(found) - [lowest, highest]).max() < 1e-6


def test_simulated_friction_behind_a_spring_gives_its_start():
    one = problem(rubbing_mass(), {"x": [0, 10]}, 10.10376)
    (motion,) = from_simulation(one, 10.10376, "rest", 1)
    low, high = peak_to_peak(one.coordinates(motion)[0][:, 0])
    assert abs((high - low) / 2 - 0.52849625) < 1e-5


def test_places_at_which_no_motion_was_found_are_told(monkeypatch):
    monkeypatch.setattr(periodic_response, "_between", lambda *given: None if given[3] > 0.2 else between(*given))
    found = duffing().periodic_response("a", frequencies=[0.1, 0.25], excitation={"a": 0.18})
    assert len(found.motions_at(0.1)) == 1
    assert "at 0.25 Hz a branch passes, but with the harmonics it needs none was found there" in found.notes


def test_no_rest_under_more_torque_than_a_softening_spring_carries():
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=-0.1, damping=0.05)
    soft = tn.Drivetrain("soft", [tn.Inertia("mass", node="a", inertia=1), spring])
    # It carries 2/3 sqrt(1/0.3) = 1.217 N m.
    text = without_start(problem(soft, {"a": [3, 0.1]}, 0.2), 0.2, "Hz")
    assert text.startswith("from rest no periodic motion was reached at 0.2 Hz: under the mean torques alone")
    grown = without_start(problem(soft, {"a": [0, 0.1]}, 0.2), 0.2, "Hz")
    assert "torques that grow reach" in grown


def _soft() -> tn.Drivetrain:
    spring = tn.Spring("spring", nodes=("x", "ground"), stiffness=1, cubic=-0.1, damping=0.05)
    return tn.Drivetrain("soft", [tn.Inertia("mass", node="x", inertia=1), spring])


def _delayed_friction() -> tn.Drivetrain:
    brake = tn.Controller("brake", sense={"velocity": "x"}, act="x", law=-0.02, delay=0.003)
    return tn.Drivetrain("delayed", [*rubbing_mass().elements.values(), brake])


@pytest.mark.parametrize(
    ("rig", "at", "load", "said"),
    [
        # k g + k_3 g^3 is zero at sqrt(10)
        (_soft, 1 / (2 * pi), 7.5, "or runs away: beyond 3.162 rad spring pushes on outward"),
        (_delayed_friction, 10, 5, "friction that sticks has no slopes for Hill's determinant"),
        (rubbing_mass, 10, 0.5, "friction sticks all along, with any mean torque that it holds"),
    ],
)
def test_what_is_met_or_not_determined_is_told(rig, at, load, said):
    found = rig().periodic_response("x", frequencies=[at], excitation={"x": load}, harmonics=3)
    assert any(said in note for note in found.notes)


def test_orders_without_a_short_period_in_common_are_refused():
    orders = {1: {"amplitude": "5 N*m"}, "0.137": {"amplitude": "1 N*m"}}
    rig = tn.Drivetrain(
        "two", list(_table_rig().elements.values()),
        excitations={"gas": {"type": "harmonic", "node": "a", "orders": orders}},
    )  # fmt: skip
    with pytest.raises(UsageError, match=r"(?s)orders 0.137, 1.* 1000 turns.*no-period"):
        rig.periodic_response("a", speeds=[9.0], speed_of="a")


@pytest.mark.parametrize(
    ("friction", "said"),
    [
        ({"torque": 2, "stick": 3}, "as it lets go"),
        ({"torque_over_slip": [(0, 3), (5, 2), (20, 2)]}, "falls with the motion"),
        ({"torque": 2, "stick": 3, "stiffness": 300}, "sticks with more than it slips"),
        ({"torque_over_slip": [(0, 2), (5, 3)], "stiffness": 300}, "changes with the slip"),
    ],
)
def test_friction_without_one_torque_is_refused(friction, said):
    mass, spring, _ = rubbing_mass().elements.values()
    rub = tn.Friction("rub", nodes=("x", "ground"), **friction)
    with pytest.raises(UsageError, match=rf"(?s)rub: .*{said}.*use simulate.*unsupported-law"):
        tn.Drivetrain("rubbing", [mass, spring, rub]).periodic_response("x", frequencies=[10], excitation={"x": 5})


def test_loads_that_follow_the_mean_speed_are_refused():
    fan = tn.Propeller("fan", node="a", inertia=0.1, exponent=2, torque="10 N*m", speed="30 rad/s")
    elements = [
        fan,
        tn.Inertia("rotor", node="b", inertia=1),
        tn.Spring("spring", nodes=("a", "b"), stiffness=100, cubic=900, damping=1),
    ]
    with pytest.raises(UsageError, match=r"(?s)fan: .*unsupported-law"):
        tn.Drivetrain("fan", elements).periodic_response("a", frequencies=[2.0], excitation={"b": 5})
