"""Elimination on the graph against LAPACK, and against 60 digits where LAPACK is not good enough."""

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns
from support.doubts import in_doubt

import torsionnet as tn
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import Rows, RowSystem
from torsionnet.linear.dynamic_stiffness import dense, quotient, response_problem, tape
from torsionnet.linear.dynamic_stiffness.graph_plan import make_plan
from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem
from torsionnet.linear.dynamic_stiffness.row_algebra import combine_rows, common_motion, equivalent_links, normalised

DIGITS = 60

both_ways = pytest.mark.parametrize(
    "respond", [response_problem.eliminate, quotient.respond_compiled], ids=["numpy", "compiled"]
)


def system_of(n, laws):
    """Row system from (row, J, c, k)."""
    rows = np.zeros((len(laws), n))
    for number, (row, *_) in enumerate(laws):
        for j, a in row.items():
            rows[number, j] = a
    J, c, k = (np.array([law[place] for law in laws], dtype=float) for place in (1, 2, 3))
    return RowSystem(Rows.of(rows), J, c, k)


def stiffness(system, frequencies):
    omega = 2 * np.pi * np.asarray(frequencies, dtype=float)
    return (system.stiffness[:, None] - system.inertia[:, None] * omega**2 + 1j * system.damping[:, None] * omega).T


def unit_load(n, at=0):
    return np.eye(n)[:, [at]]


def sampled_stiffness(kappa):
    """From values (n_f, n_laws) alone."""
    nothing = np.zeros((1, kappa.shape[1]))
    return LawStiffness(nothing, nothing, nothing, np.zeros(len(kappa))).with_sampled_stiffness(kappa.T.astype(complex))


def problem_of(system, loads, rows):
    """Motion of rows (n_rows, n_q) under loads (n_q, n_exc)."""
    excitations = tuple(Loading(load=load) for load in Rows.of(loads.T).maps)
    return ResponseProblem(system.sparse_rows, system.n_coordinates, excitations, Rows.of(rows).maps)


def solved(respond, system, kappa, loads, rows):
    """(n_points, n_rows, n_exc) for dynamic stiffnesses (n_points, n_laws)."""
    return np.moveaxis(respond(problem_of(system, loads, rows), sampled_stiffness(kappa)), 2, 0)


def plan_of(rows, outputs, loads):
    n = 1 + max(j for row in rows for j in row)
    return make_plan(rows, n, loads, [{} for _ in loads], outputs, ())


def exact(system, kappa, load):
    """D^-1 f in 60 digits from the same numbers kappa (n_laws,)."""
    n = system.n_coordinates
    with mpmath.workdps(DIGITS):
        D = mpmath.matrix(n, n)
        for row, value in zip(system.rows, kappa, strict=True):
            for i in np.flatnonzero(row):
                for j in np.flatnonzero(row):
                    D[int(i), int(j)] += mpmath.mpmathify(complex(value)) * mpmath.mpf(row[i]) * mpmath.mpf(row[j])
        q = mpmath.lu_solve(D, mpmath.matrix([mpmath.mpmathify(complex(f)) for f in load]))
        return np.array([complex(value) for value in q])


def random_system(rng, n, loops=0, zeta=1e-3, ratios=(1.0, 2.0, -3.3, 0.4), tree=True, grounded=False):
    """Random tree of geared springs; loops agree with the ratios along the tree, so that it still turns freely."""
    speed, laws = np.ones(n), []
    for i in range(1, n):
        parent = int(rng.integers(0, i)) if tree else i - 1
        ratio = float(rng.choice(ratios))
        speed[i] = speed[parent] / ratio
        k = 10 ** rng.uniform(2, 6)
        laws.append(({parent: 1.0, i: -ratio}, 0.0, 2 * zeta * k / 500, k))
    for _ in range(loops):
        i, j = rng.choice(n, 2, replace=False)
        laws.append(({int(i): 1.0, int(j): -speed[i] / speed[j]}, 0.0, 1.0, 10 ** rng.uniform(2, 6)))
    laws += [({i: 1.0}, 10 ** rng.uniform(-2, 1), 0.0, 0.0) for i in range(n)]
    if grounded:
        laws.append(({n - 1: 1.0}, 0.0, 5.0, 1e3))
    return system_of(n, laws)


# --- exactness ------------------------------------------------------------------------------------------------------


@cache
def free_drivetrain(seed, n, loops):
    """A system, its stiffnesses and its exact motion, worked out once for both ways of solving it."""
    system = random_system(np.random.default_rng(seed), n, loops if n > 4 else 0)
    kappa = stiffness(system, np.array([0.1, 1.0, 13.0, 97.0, 400.0, 2500.0]) / (2 * np.pi))
    return system, kappa, np.array([exact(system, at, unit_load(n)[:, 0]) for at in kappa])


@pytest.mark.few(1, 6)
@both_ways
@pytest.mark.parametrize("loops", [0, 3])
@pytest.mark.parametrize("n", [2, 8, 30])
@pytest.mark.parametrize("seed", range(3))
def test_free_drivetrains_down_to_a_tenth_of_a_radian(respond, seed, n, loops):
    system, kappa, reference = free_drivetrain(seed, n, loops)
    found = solved(respond, system, kappa, unit_load(n), np.eye(n))[:, :, 0]
    assert np.abs(found / reference - 1).max() <= 1e-12


def test_lapack_is_not_good_enough_for_that():
    """The test above says something: the assembled matrix loses k/(J omega^2) of its digits."""
    system = random_system(np.random.default_rng(1), 30)
    kappa = stiffness(system, [0.1 / (2 * np.pi)])
    reference = exact(system, kappa[0], unit_load(30)[:, 0])
    assert (
        np.abs(solved(dense.respond, system, kappa, unit_load(30), np.eye(30))[0, :, 0] / reference - 1).max() > 1e-11
    )


@both_ways
@pytest.mark.parametrize("loops", [0, 3])
def test_twists_of_a_free_drivetrain(respond, loops):
    """The twist of a spring is no difference of two large angles."""
    system = random_system(np.random.default_rng(4), 20, loops, ratios=(1.0,))
    kappa = stiffness(system, [0.01])
    springs = system.rows[:19]
    found = solved(respond, system, kappa, unit_load(20, 7), springs)[0, :, 0]
    with mpmath.workdps(DIGITS):
        n = system.n_coordinates
        D = mpmath.matrix(n, n)
        for row, value in zip(system.rows, kappa[0], strict=True):
            for i in np.flatnonzero(row):
                for j in np.flatnonzero(row):
                    D[int(i), int(j)] += mpmath.mpmathify(complex(value)) * row[i] * row[j]
        q = mpmath.lu_solve(D, mpmath.matrix([1.0 if i == 7 else 0.0 for i in range(n)]))
        twist = [sum(mpmath.mpf(a) * q[j] for j, a in enumerate(row.tolist())) for row in springs]
        reference = np.array([complex(value) for value in twist])
    assert np.abs(found - reference).max() <= 1e-12 * np.abs(reference).max()
    assert np.abs(found / reference - 1).max() <= 1e-11


@both_ways
def test_planetary_with_compliant_mesh_turning_freely(respond):
    laws = [({0: 1.0, 1: 2.4, 2: -3.4}, 0, 3.0, 2e7), ({2: 1.0, 3: -1.0}, 0, 1.0, 1e5)]
    laws += [({i: 1.0}, J, 0, 0) for i, J in enumerate((0.01, 0.3, 1.2, 5.0))]
    system = system_of(4, laws)
    kappa = stiffness(system, [0.01, 1.0, 50.0])
    found = solved(respond, system, kappa, unit_load(4), np.eye(4))[:, :, 0]
    reference = np.array([exact(system, at, unit_load(4)[:, 0]) for at in kappa])
    assert np.abs(found / reference - 1).max() <= 1e-12


@cache
def undamped_drivetrain():
    """A system, its stiffnesses, its exact motions, and how far those move with the last digits of the stiffnesses."""
    system = random_system(np.random.default_rng(2), 12, zeta=0.0, ratios=(1.0,))
    kappa = stiffness(system, np.linspace(1, 300, campaigns.examples(25, 97)))
    signs = np.random.default_rng(3).choice([-1, 1], (2, kappa.shape[1]))
    exactly, changes = [], []
    for at in kappa:
        exactly.append(exact(system, at, unit_load(12)[:, 0]))
        moved = [exact(system, at * (1 + 1e-9 * sign), unit_load(12)[:, 0]) for sign in signs]
        changes.append(np.abs(np.array(moved) - exactly[-1]).max())
    return system, kappa, exactly, changes


@pytest.mark.few(1)
@both_ways
def test_undamped_antiresonance_is_as_good_as_its_condition(respond):
    system, kappa, exactly, changes = undamped_drivetrain()
    found = solved(respond, system, kappa, unit_load(12), np.eye(12))[:, :, 0]
    for value, reference, change in zip(found, exactly, changes, strict=True):
        assert np.abs(value - reference).max() <= 1e-15 * change / 1e-9 * 40 + 1e-14 * np.abs(reference).max()


# --- against LAPACK -------------------------------------------------------------------------------------------------


@st.composite
def row_systems(draw):
    """Anything: rows of one to four coordinates with any ratios, every coordinate held to ground."""
    n = draw(st.integers(1, campaigns.examples(5, 9)))
    coefficient = st.sampled_from([1.0, -1.0, 2.0, -0.5, 3.3, -1.7])
    laws = [({i: 1.0}, draw(st.floats(0.1, 2)), draw(st.floats(1, 20)), draw(st.floats(10, 1e3))) for i in range(n)]
    for _ in range(draw(st.integers(0, n))):
        touched = draw(st.lists(st.integers(0, n - 1), min_size=1, max_size=4, unique=True))
        row = {j: draw(coefficient) for j in touched}
        laws.append((row, draw(st.sampled_from([0.0, 0.1])), draw(st.floats(0, 5)), draw(st.floats(0, 1e4))))
    return system_of(n, laws)


@both_ways
@settings(max_examples=campaigns.examples(10, 40), deadline=None)
@given(row_systems(), st.integers(1, 6))
def test_any_rows_as_lapack(respond, system, n_exc):
    n = system.n_coordinates
    rng = np.random.default_rng(n_exc)
    kappa = stiffness(system, [0.0, 1.0, 7.3, 30.0])
    loads = rng.normal(size=(n, n_exc))
    rows = np.vstack([np.eye(n), system.rows, np.zeros((1, n))])
    found, reference = (solved(solve, system, kappa, loads, rows) for solve in (respond, dense.respond))
    assert found.shape == (4, len(rows), n_exc)
    assert np.abs(found - reference).max() <= 1e-9 * np.abs(reference).max()


@both_ways
@settings(max_examples=campaigns.examples(20, 60), deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 25), st.integers(0, 6), st.booleans())
def test_trees_and_loops_as_lapack(respond, seed, n, loops, tree):
    rng = np.random.default_rng(seed)
    system = random_system(rng, n, loops, zeta=0.02, tree=tree, grounded=True)
    kappa = stiffness(system, rng.uniform(1, 500, 5))
    rows, load = np.eye(n), unit_load(n, int(rng.integers(n)))
    found, reference = (solved(solve, system, kappa, load, rows) for solve in (respond, dense.respond))
    scale = np.abs(reference).max(axis=(1, 2), keepdims=True)
    assert np.abs((found - reference) / scale).max() <= 1e-8


@pytest.mark.parametrize("sensor", ["theta_1", "T_T"])
def test_model_of_the_library_with_both_methods(sensor):
    rig = tn.load("amt_rig").configured("V")
    f = np.linspace(0, 60, 301)
    graph, lapack = (rig.frequency_response(sensor, "T_M", f, method=m).values for m in ("graph", "dense"))
    assert graph == pytest.approx(lapack, rel=1e-9)


def test_unknown_method_is_refused():
    with pytest.raises(tn.UsageError, match="unknown-word"):
        tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1.0], method="lu")


# --- hard cases -----------------------------------------------------------------------------------------------------


@pytest.mark.few(1)
@both_ways
def test_chain_of_a_thousand_in_its_pass_band_and_far_below(respond):
    n = 1000
    laws = [({i: 1.0, i + 1: -1.0}, 0, 0.01, 1e6) for i in range(n - 1)] + [({i: 1.0}, 1.0, 0, 0) for i in range(n)]
    system = system_of(n, laws)
    frequencies = [1e-4, 20.0, 250.0]
    ends = np.eye(n)[[0, n - 1]]
    found = solved(respond, system, stiffness(system, frequencies), unit_load(n), ends)[:, :, 0]
    with mpmath.workdps(DIGITS):
        for kappa, value in zip(stiffness(system, frequencies), found, strict=True):
            link, mass = mpmath.mpmathify(complex(kappa[0])), mpmath.mpmathify(complex(kappa[n]))
            motion, torque = mpmath.mpc(1), mpmath.mpc(0)  # at the far end
            for _ in range(n - 1):
                torque += mass * motion
                motion += torque / link
            torque += mass * motion
            assert complex(motion / torque) == pytest.approx(value[0], rel=1e-12)
            assert complex(1 / torque) == pytest.approx(value[1], rel=1e-11)


@both_ways
def test_stop_band_of_a_long_chain_decays_to_nothing_without_noise(respond):
    n = 400
    laws = [({i: 1.0, i + 1: -1.0}, 0, 0, 1e4) for i in range(n - 1)] + [({i: 1.0}, 1.0, 0.1, 0) for i in range(n)]
    system = system_of(n, laws)
    found = np.abs(solved(respond, system, stiffness(system, [100.0]), unit_load(n), np.eye(n))[0, :, 0])
    assert np.isfinite(found).all()
    assert (np.diff(found[found > 0]) < 0).all()
    assert 1e-200 < found[100] < 1e-100


@both_ways
def test_lanes_that_lose_digits_are_in_doubt(respond):
    """A resonance met exactly, a leaf at its own frequency, a sum that all but vanishes; the others are not."""
    laws = [({0: 1.0}, 1, 0, 0), ({1: 1.0}, 1, 0, 0), ({0: 1.0, 1: -1.0}, 0, 0, 2.0)]
    system = system_of(2, laws)
    calm = [-4.0, -4.0, 3.0]
    kappa = np.array([[-4.0, -4.0, 2.0], [-4.0, -4.0, 4.0], [-1.0, 2.0, 2 * (1 + 1e-9)], calm, calm, calm])
    doubts = in_doubt(respond, problem_of(system, unit_load(2), np.eye(2)), sampled_stiffness(kappa))
    assert doubts.tolist() == [True, True, True, True, False, False]  # also next to them


@both_ways
def test_a_law_whose_stiffness_and_inertia_all_but_cancel_is_in_doubt(respond):
    problem = ResponseProblem([{0: 1.0}], 1, (Loading(load={0: 1.0}),), ({0: 1.0},))
    omega = np.array([1.0, 1.0, 2.0, 2.0 * (1 + 1e-6)])
    kappa = LawStiffness(*(np.array([[value]]) for value in (1.0, 0.0, 4.0)), omega=omega)
    assert in_doubt(respond, problem, kappa).tolist() == [False, True, True, True]
    assert respond(problem, kappa)[0, 0, 0] == pytest.approx(1 / 3)


def test_exact_undamped_resonance_is_large_and_leaf_at_its_own_frequency_holds_its_neighbour():
    f, k = 1.0, (2 * np.pi) ** 2
    elements = [tn.Inertia("J", node="a", inertia=1), tn.Inertia("leaf", node="b", inertia=1)]
    rig = tn.Drivetrain("two masses", [*elements, tn.Spring("k", nodes=("a", "b"), stiffness=k / 2)])
    assert np.abs(rig.frequency_response(["a", "b"], "a", [f]).values).min() > 1e10
    rig = tn.Drivetrain("two masses", [*elements, tn.Spring("k", nodes=("a", "b"), stiffness=k)])
    still, leaf = rig.frequency_response(["a", "b"], "a", [f]).values[0, :, 0]
    assert abs(still) < 1e-15
    assert leaf == pytest.approx(-1 / k, rel=1e-12)


def test_pivot_near_zero_in_a_loop_is_given_its_digits_back():
    """S of node n1, with four neighbours in loops, is 1e-9 of its terms, which costs 9 digits of the rest."""
    pairs, omega = [(i, j) for i in range(5) for j in range(i)], 2 * np.pi
    k = np.random.default_rng(0).uniform(1, 3, len(pairs))
    around = sum(value for value, pair in zip(k, pairs, strict=True) if 1 in pair)
    J = [1.0] * 5
    J[1] = around * (1 - 1e-9) / omega**2
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=J[i]) for i in range(5)]
    links = zip(pairs, k.tolist(), strict=True)
    elements += [tn.Spring(f"k{i}{j}", nodes=(f"n{i}", f"n{j}"), stiffness=value) for (i, j), value in links]
    rig = tn.Drivetrain("mesh", elements)
    found = rig.frequency_response([f"n{i}" for i in range(5)], "n0", [1.0]).values[0, :, 0]
    with mpmath.workdps(DIGITS):
        D = mpmath.diag([-mpmath.mpf(value) * (2 * mpmath.pi) ** 2 for value in J])
        for (i, j), value in zip(pairs, k.tolist(), strict=True):
            for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                D[a, b] += sign * mpmath.mpf(value)
        reference = mpmath.lu_solve(D, mpmath.matrix([1, 0, 0, 0, 0]))
        assert found == pytest.approx(np.array([complex(value) for value in reference]), rel=1e-9)


@both_ways
def test_parts_without_load_stand_still(respond):
    laws = [({i: 1.0}, 1.0, 0.1, 0) for i in range(4)] + [
        ({0: 1.0, 1: -1.0}, 0, 0, 9.0),
        ({2: 1.0, 3: -1.0}, 0, 0, 9.0),
    ]
    system = system_of(4, laws)
    found = solved(respond, system, stiffness(system, [1.0]), unit_load(4), np.eye(4))[0, :, 0]
    assert found[2] == found[3] == 0
    assert (found[:2] != 0).all()


# --- plan -----------------------------------------------------------------------------------------------------------


def test_tree_has_no_fill():
    rng = np.random.default_rng(0)
    rows = [{i: 1.0} for i in range(200)] + [{i: 1.0, int(rng.integers(i)): -1.0} for i in range(1, 200)]
    plan = plan_of(rows, [{150: 1.0}], [{3: 1.0}])
    assert plan.n_slots == len(rows)
    assert sum(len(step.pairs) for step in plan.steps) == 199
    assert plan.steps[-1].coordinate == 3


def test_only_the_path_is_walked_back():
    rows = [{i: 1.0} for i in range(50)] + [{i: 1.0, i + 1: -1.0} for i in range(49)]
    assert sum(len(step.motions) for step in plan_of(rows, [{10: 1.0}], [{0: 1.0}]).steps) == 11


def test_dense_ratios_do_not_multiply():
    rng = np.random.default_rng(0)
    rows = [{i: 1.0} for i in range(15)]
    rows += [dict(zip(rng.choice(15, 2, replace=False).tolist(), rng.normal(size=2), strict=True)) for _ in range(60)]
    assert plan_of(rows, [{1: 1.0}], [{0: 1.0}]).n_slots < 15 * 15 * 4


def test_few_readings_go_forward_and_give_the_same_as_those_that_come_back(monkeypatch):
    system = random_system(np.random.default_rng(3), 12, loops=3, grounded=True)
    kappa = sampled_stiffness(stiffness(system, np.linspace(1, 300, 50)))
    forward = problem_of(system, unit_load(12, 2), np.eye(12)[[0, 7]])
    found = response_problem.eliminate(forward, kappa)
    monkeypatch.setattr(tape, "MOST_FORWARD_READINGS", 0)
    monkeypatch.setattr(response_problem, "recent_plan", response_problem.recent_plan.__wrapped__)
    back = problem_of(system, unit_load(12, 2), np.eye(12)[[0, 7]])
    assert not np.array_equal(back.planned[1].operations, forward.planned[1].operations)
    assert response_problem.eliminate(back, kappa) == pytest.approx(found, rel=1e-12)


def test_a_plan_is_made_once_for_equal_rows():
    systems = (random_system(np.random.default_rng(seed), 9) for seed in (3, 3, 4))
    first, again, other = (problem_of(system, unit_load(9, 2), np.eye(9)[[0]]) for system in systems)
    assert first.planned is again.planned
    assert len({id(problem.planned[1]) for problem in (first, other, first.in_other_order)}) == 3


def test_registers_of_a_walk_forward_do_not_grow_with_the_drivetrain():
    def registers(n):
        rows = [{i: 1.0} for i in range(n)] + [{i: 1.0, i + 1: -1.0} for i in range(n - 1)]
        return tape.make_tape(plan_of(rows, [{n - 1: 1.0}], [{0: 1.0}])).n_registers

    assert registers(400) == registers(20) < 16


@pytest.mark.parametrize("broken", [ImportError("no numba"), RuntimeError("its cache cannot be written")])
def test_large_work_is_compiled_where_that_works(monkeypatch, broken):
    system = random_system(np.random.default_rng(0), 5, grounded=True)
    problem, kappa = problem_of(system, unit_load(5), np.eye(5)), sampled_stiffness(stiffness(system, [3.0, 5.0]))
    expected, asked = response_problem.eliminate(problem, kappa), []

    def compiled(*arguments):
        asked.append(arguments)
        raise broken

    monkeypatch.setattr(quotient, "respond_compiled", compiled)
    assert np.array_equal(quotient.respond(problem, kappa), expected)
    assert not asked
    monkeypatch.setattr(quotient, "COMPILED_WORK", 10)
    assert np.array_equal(quotient.respond(problem, kappa), expected)
    assert len(asked) == 1


@pytest.mark.parametrize(("changes", "shared"), [({"c_O": 360}, True), ({"tau": 5}, False), ({"c_O": 0}, False)])
def test_configured_copy_shares_what_rows_alone_decide(changes, shared):
    f = [0.0, 3.0, 40.0]
    asked = (["theta_1", "T_T", "twist(gearbox)", "twist(half_shaft)"], "T_M", f)
    first = tn.load("amt_rig")
    first.frequency_response(*asked)
    copy, fresh = first.configured(**changes), tn.load("amt_rig").configured(**changes)
    assert copy.frequency_response(*asked).values == pytest.approx(fresh.frequency_response(*asked).values, rel=1e-14)
    assert (copy.assembly.system.memo is first.assembly.system.memo) is shared


rows_strategy = st.dictionaries(st.integers(0, 5), st.floats(0.1, 10).map(lambda x: x - 5.05), min_size=1, max_size=5)


@given(rows_strategy, rows_strategy)
def test_combined_row_leaves_the_coordinate_out(first, second):
    v = min(first)
    found = combine_rows(first, second, v)
    assert v not in found
    for j in range(6):
        expected = second.get(v, 0) * first.get(j, 0) - first[v] * second.get(j, 0)
        assert found.get(j, 0.0) == pytest.approx(expected, abs=1e-11)


@given(rows_strategy, st.lists(st.sampled_from([1.0, 0.3, -2.0]), min_size=6, max_size=6))
def test_clique_acts_as_the_row(row, scale):
    total = np.zeros((6, 6))
    for part, weight in equivalent_links(row, dict(enumerate(scale))):
        b = np.array([part.get(j, 0.0) for j in range(6)])
        total += weight * np.outer(b, b)
    a = np.array([row.get(j, 0.0) for j in range(6)])
    assert total == pytest.approx(np.outer(a, a), abs=1e-9)


def test_common_motion_of_gears():
    assert common_motion([{0: 1.0, 1: -3.0}, {1: 2.0, 2: 1.0}]) == {0: 1.0, 1: 1 / 3, 2: pytest.approx(-2 / 3)}


def test_rows_are_the_same_up_to_a_factor():
    assert normalised({1: 2.0, 0: -4.0})[0] == normalised({0: 1.0, 1: -0.5 * (1 + 1e-15)})[0]
    assert normalised({0: 1.0, 1: -0.5})[0] != normalised({0: 1.0, 1: -0.5001})[0]


# --- frequencies that resolve the peaks -------------------------------------------------------------------------------


def test_adaptive_frequencies_find_the_height_of_a_narrow_peak():
    zeta, f_0 = 1e-5, 50.0
    omega = 2 * np.pi * f_0
    rig = tn.Drivetrain(
        "one mass",
        [
            tn.Inertia("J", node="a", inertia=1),
            tn.Spring("k", nodes=("a", "ground"), stiffness=omega**2, damping=2 * zeta * omega),
        ],
    )
    H = rig.frequency_response("a", "a", tn.Adaptive(1, 200, points=50))
    assert H.magnitude.max() == pytest.approx(1 / (2 * zeta * omega**2), rel=1e-3)
    phase = np.degrees(np.unwrap(np.angle(H.values[:, 0, 0])))
    assert np.abs(np.diff(phase)).max() < 6
    assert H.frequencies[0] == 1
    assert (np.diff(H.frequencies) > 0).all()
    even = rig.frequency_response("a", "a", np.geomspace(1, 200, len(H.frequencies)))
    assert even.magnitude.max() < 0.01 * H.magnitude.max()


def test_adaptive_frequencies_resolve_poles_of_a_measured_input():
    rig = tn.load("amt_rig").configured("V")
    H = rig.frequency_response("theta_1", "T_T", tn.Adaptive(1, 20, points=5))
    near = rig.modes(measured_input="T_T").eigenvalues
    peak = near[near.imag > 0][0].imag / (2 * np.pi)
    assert np.abs(H.frequencies - peak).min() < 1e-9 * peak


def test_impossible_range_is_refused():
    with pytest.raises(tn.UsageError, match="unordered-rows"):
        tn.Adaptive(10, 1)


def test_modes_in_common_but_for_rounding_give_one_set_of_points():
    modes = tn.load("dmf_rig").modes()
    shifted = replace(modes, eigenvalues=modes.eigenvalues * (1 + 1e-15))
    grid = tn.Adaptive(1, 200)
    assert len(grid.frequencies(modes, shifted)) == len(grid.frequencies(modes))
