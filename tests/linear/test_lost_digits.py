"""Points that an elimination marks as uncertain, against dense solutions in 60 digits: none that lost any is missed."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import scipy
from support import campaigns
from support.doubts import in_doubt

import torsionnet as tn
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.dynamic_stiffness import quotient, response_problem
from torsionnet.linear.dynamic_stiffness.quotient import NOTHING, rounding_errors, uncertain_points
from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem
from torsionnet.linear.responses import transfer

DIGITS = 60
UNMARKED_ERROR = 1e-10
"""Relative error of every unmarked value, a tenth of what responses promise."""

both_ways = pytest.mark.parametrize(
    "respond", [response_problem.eliminate, quotient.respond_compiled], ids=["numpy", "compiled"]
)


def plant(rng, held):
    """Row, J, c, k of every law: inertias and springs in a tree with gears, loops and shafts of distributed mass.

    Stiffnesses spread over nine decades; damping is 0.03 % of critical at some frequency.
    """
    n = int(rng.integers(2, 9))
    laws = [({i: 1.0}, 10 ** rng.uniform(-3, 3), 0.0, 0.0) for i in range(n)]
    pairs = [(int(rng.integers(i)) if rng.random() < 0.5 else i - 1, i) for i in range(1, n)]
    pairs += [tuple(sorted(rng.choice(n, 2, replace=False).tolist())) for _ in range(int(rng.integers(0, 3)))]
    for i, j in pairs:
        ratio = 1.0 if rng.random() < 0.6 else float(rng.choice([-1.0, 4.94, -0.2, 17.3]))
        k = 10 ** rng.uniform(0, 9)
        laws.append(({i: 1.0, j: -ratio}, 0.0, 2 * 3e-4 * k / 10 ** rng.uniform(0, 3), k))
        if rng.random() < 0.2:
            laws.append(({i: 1.0, j: 1.0}, 10 ** rng.uniform(-3, 1), 0.0, 0.0))
    if held:
        laws.append(({int(rng.integers(n)): 1.0}, 0.0, 0.0, 10 ** rng.uniform(0, 9)))
    return n, laws


def examined(rng, n, laws):
    """Twelve circular frequencies in rad/s, half of them next to resonances and antiresonances."""
    B = np.array([[row.get(j, 0.0) for j in range(n)] for row, *_ in laws])
    M, K = (B.T @ (np.array([law[place] for law in laws])[:, None] * B) for place in (1, 3))
    rest = np.delete(np.arange(n), int(rng.integers(n)))
    squares = [
        *scipy.linalg.eigh(K, M, eigvals_only=True),
        *scipy.linalg.eigh(K[np.ix_(rest, rest)], M[np.ix_(rest, rest)], eigvals_only=True),
    ]
    own = np.sqrt(np.array([value for value in squares if value > 0]))
    near = rng.choice(own, 6) * (1 + rng.choice([-1.0, 1.0], 6) * 10 ** -rng.uniform(0, 12, 6))
    return np.concatenate([10 ** rng.uniform(-3, 6, 6), near])


def exact_motions(n, laws, omega, at):
    """Motions of all coordinates under a unit torque at one, in 60 digits."""
    D, w = mpmath.zeros(n), mpmath.mpf(float(omega))
    for row, J, c, k in laws:
        kappa = mpmath.mpc(mpmath.mpf(k) - mpmath.mpf(J) * w**2, mpmath.mpf(c) * w)
        for i, a in row.items():
            for j, b in row.items():
                D[i, j] += kappa * mpmath.mpf(a) * mpmath.mpf(b)
    return mpmath.lu_solve(D, mpmath.matrix([int(i == at) for i in range(n)]))


def errors(seed, held, respond):
    """Largest relative error of any motion or twist at each of twelve points, and which points are marked."""
    rng = np.random.default_rng(seed)
    n, laws = plant(rng, held)
    omega = examined(rng, n, laws)
    loads = [int(j) for j in rng.choice(n, min(n, int(rng.integers(1, 3))), replace=False)]
    rows = [*({j: 1.0} for j in range(n)), laws[n][0]]
    rows = rows[:2] if rng.random() < 0.5 else rows
    problem = ResponseProblem([law[0] for law in laws], n, tuple(Loading(load={j: 1.0}) for j in loads), tuple(rows))
    J, c, k = (np.array([[law[place] for law in laws]]) for place in (1, 2, 3))
    kappa = LawStiffness(J, c, k, omega=omega)
    found = respond(problem, kappa)
    worst = np.zeros(len(omega))
    with mpmath.workdps(DIGITS):
        for point, w in enumerate(omega):
            for number, load in enumerate(loads):
                q = exact_motions(n, laws, w, load)
                for place, row in enumerate(rows):
                    value = sum(mpmath.mpf(a) * q[j] for j, a in row.items())
                    error = abs(mpmath.mpmathify(complex(found[place, number, point])) - value) / abs(value)
                    worst[point] = max(worst[point], float(error))
    return worst, in_doubt(respond, problem, kappa)


def none_missed(seeds, held, respond=response_problem.eliminate):
    found = [errors(seed, held, respond) for seed in seeds]
    worst, marked = (np.concatenate(part) for part in zip(*found, strict=True))
    assert worst[~marked].max() < UNMARKED_ERROR
    return worst, marked


@pytest.mark.parametrize(("held", "seeds"), [(False, (0, 1, 242)), (True, (0, 167, 170))], ids=["free", "held"])
def test_no_point_that_lost_digits_goes_unmarked(held, seeds):
    """The last plants of both have loops with a spring at their end that cancel next to an inertia."""
    none_missed(seeds, held)


@pytest.mark.slow
@pytest.mark.parametrize("held", [False, True], ids=["free", "held"])
def test_no_point_of_many_plants_goes_unmarked_and_few_are_marked_for_nothing(held):
    worst, marked = none_missed(range(100, campaigns.examples(140, 250)), held)
    assert (worst > UNMARKED_ERROR).any()
    # Half of the points lie next to resonances, and each that differs marks its neighbours.
    assert (marked & (worst < 1e-12)).mean() < 0.25


def resonant_chain(share, n):
    """Dynamic stiffnesses (1, n + (n - 1)) of grounds and links such that every pivot is 1/share of its link."""
    grounds, carried = [], 0.0
    for _ in range(n - 1):
        grounds.append(-1.0 + 1.0 / share - carried)
        carried = (grounds[-1] + carried) / (grounds[-1] + carried + 1.0)
    return np.array([*grounds, 2.0 - carried, *[1.0] * (n - 1)])


@both_ways
@pytest.mark.parametrize(("share", "n", "marked"), [(30.0, 2, False), (30.0, 5, True)])
def test_losses_of_small_pivots_in_a_row_multiply(respond, share, n, marked):
    """A pivot that is a thirtieth of its terms costs what follows three digits; four of them in a row leave none over."""
    rows = [{i: 1.0} for i in range(n)] + [{i: 1.0, i + 1: -1.0} for i in range(n - 1)]
    problem = ResponseProblem(rows, n, (Loading(load={n - 1: 1.0}),), ({n - 1: 1.0},))
    nothing, kappa = np.zeros((1, len(rows))), resonant_chain(share, n).astype(complex)
    stiffness = LawStiffness(nothing, nothing, nothing, np.ones(1)).with_sampled_stiffness(kappa[:, None])
    assert in_doubt(respond, problem, stiffness).tolist() == [marked]


def test_few_points_of_a_plant_with_distributed_shafts_are_solved_again(monkeypatch):
    """Torques at the ends of its shafts are sums that cancel at all frequencies, yet count little in what is read."""
    shares = []

    def marked(*arguments):
        doubts = uncertain_points(*arguments)
        shares.append(doubts.mean())
        return doubts

    monkeypatch.setattr(transfer, "uncertain_points", marked)
    plant = tn.load("marine_medium_speed")
    readings = ["torque(int_shaft, first)", "torque(int_shaft, second)", "torque(coupling)", "torque(damper, node)"]
    plant.frequency_response(readings, list(plant.inputs), np.geomspace(1, 200, 30))
    assert shares[0] < 0.3


@pytest.mark.parametrize(("k", "p"), [(1024.0, 1023.99999999), (256.0, 255.99999), (4096.0, 4095.99999)])
def test_a_controller_that_all_but_cancels_a_spring_loses_no_digits(k, p):
    """J = 1: the angle per torque is 1/(k - p - omega^2), with numbers that seven digits hold exactly."""
    elements = [tn.Inertia("J", node="a", inertia=1), tn.Spring("k", nodes=("a", "ground"), stiffness=k)]
    elements.append(tn.Controller("c", sense={"angle": "a"}, act="a", law=str(p)))
    rig = tn.Drivetrain("held", elements, inputs={"T": {"torque": "a"}}, sensors={"th": {"angle": "a"}})
    f = np.geomspace(1e-8, 1e-3, 60)
    found = rig.frequency_response("th", "T", f).values[:, 0, 0]
    exact = [1 / (Fraction(k) - Fraction(str(p)) - Fraction(2 * np.pi * one) ** 2) for one in f]
    assert found.real == pytest.approx([float(one) for one in exact], rel=1e-9)


@pytest.mark.parametrize(
    ("double", "single", "error"),
    [
        (1.0, 1.0 + 2**-20, 2**-49),
        (1e-20, 2e-20, 2**-29),
        (1e-40, 0.0, np.inf),  # below the numbers of single precision, which says nothing
        (1e-40, 1e-40, 0.0),
        (1.0, np.nan, np.inf),
        (np.inf, np.inf, np.inf),
        (0.0, 0.0, 0.0),
        (1e-310, 2e-310, 2**-29 * 1e-310 / NOTHING),  # too small to have digits
    ],
)
def test_error_of_a_value_by_its_calculation_to_seven_digits(double, single, error):
    nothing = np.zeros((1, 1))
    kappa = LawStiffness(nothing, nothing, nothing + 1.0, np.ones(1))

    def evaluate(laws, _):
        return np.full((1, 1, 1), single if laws.stiffness.dtype == np.float32 else double, dtype=complex)

    assert rounding_errors(evaluate, kappa, evaluate(kappa, False)).item() == pytest.approx(error, rel=1e-6)


def test_a_stop_band_far_below_single_precision_is_calculated_without_a_warning():
    """J = 1, k = 1 in a row of 40, without damping: x_n/T_0 of the chain in closed form, at twice its cut-off."""
    n, w = 40, 4.0
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=1) for i in range(n)]
    elements += [tn.Spring(f"k{i}", nodes=(f"n{i - 1}", f"n{i}"), stiffness=1) for i in range(1, n)]
    found = tn.Drivetrain("chain", elements).frequency_response(f"n{n - 1}", "n0", [w / (2 * np.pi)]).values.item()
    with mpmath.workdps(DIGITS):
        # x_i = cos((n - 1/2 - i) mu) with 2 cos mu = 2 - w^2 has a free far end; T_0 = -w^2 sum x_i.
        omega = 2 * mpmath.pi * mpmath.mpf(w / (2 * np.pi))
        mu = mpmath.acos(1 - omega**2 / 2)
        shape = [mpmath.cos((n - mpmath.mpf(1) / 2 - i) * mu) for i in range(n)]
        exact = shape[-1] / (-(omega**2) * mpmath.fsum(shape))
    assert abs(found) < 1e-40
    assert abs(found / complex(exact) - 1) < 1e-9
