"""Continuous shafts against closed forms, roots of transcendental equations in mpmath, and ever finer segments."""

import json
import pickle
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns

import torsionnet as tn
from torsionnet.base.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.linear.modes.continuous import negative_pivots
from torsionnet.linear.modes.continuous_damped import damped_modes
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.element_base.shaft_stiffness import ShaftEnd, ShaftTwist

G, RHO, D, L = 79.3e9, 7850.0, 0.1, 2.0
POLAR = np.pi * D**4 / 32
K, J = G * POLAR / L, RHO * POLAR * L
SPEED = np.sqrt(G / RHO)
UNIT = SPEED / (4 * L)
"""First natural frequency of the shaft with one end held, Hz."""


def shaft(name="s", nodes=("a", "b"), **changes):
    return tn.ContinuousShaft(name, nodes=nodes, **{"outer_diameter": D, "length": L, **changes})


def rig(*elements, **options):
    return tn.Drivetrain("t", list(elements), **options)


def held(*elements, **changes):
    """The end ``a`` held, ``b`` free but for the elements given."""
    return rig(shaft(**changes), tn.Lock("l", node="a"), *elements)


# --- laws -----------------------------------------------------------------------------------------------------------

EXACT = {
    ShaftTwist: lambda k, j, s: k * (x := mpmath.sqrt(-(s**2) * j / k)) / mpmath.sin(x),
    ShaftEnd: lambda k, j, s: -k * (x := mpmath.sqrt(-(s**2) * j / k)) * mpmath.tan(x / 2),
}


@pytest.mark.parametrize("kind", EXACT)
@pytest.mark.parametrize("eta", [0, 0.1])
@pytest.mark.parametrize("s", [0.05j, 0.3j, 0.7j, 0.72j, 5j, 40j, 22.214j, -0.3 + 3j, -2 + 0.5j, -4])
def test_law_and_its_derivatives(kind, eta, s):
    law = kind(Fraction(100), Fraction(2), eta)
    at, omega = np.array([complex(s)]), np.array([abs(complex(s).imag)])

    def exact(k, j, eta, s):
        return EXACT[kind](k * (1 + 1j * eta * (omega[0] > 0)), j, s)

    with mpmath.workdps(40):
        values = [mpmath.mpf(100), mpmath.mpf(2), mpmath.mpf(eta), mpmath.mpmathify(s)]
        expected = complex(exact(*values))
        slopes = [complex(mpmath.diff(exact, values, tuple(int(i == n) for i in range(4)))) for n in range(4)]
        assert complex(law.in_many_digits(values[3])) == pytest.approx(expected, rel=1e-14) or complex(s).imag == 0
    assert law.at(at, omega)[0] == pytest.approx(expected, rel=2e-12)
    size = abs(expected) / np.array([100, 2, 1])
    np.testing.assert_array_less(
        np.abs(law.slopes(at, omega)[:, 0] - slopes[:3]), 1e-11 * size + 1e-11 * np.abs(slopes[:3])
    )
    assert law.rates(at, omega)[0][0] == pytest.approx(slopes[3], rel=1e-11)
    if complex(s).real == 0:
        assert law.kappa_rate(omega[0]) == pytest.approx(1j * slopes[3], rel=1e-11)


def test_law_at_rest_and_far_from_the_axis():
    twist, end = ShaftTwist(100, 2), ShaftEnd(100, 2)
    at = np.array([0, -1e5 + 0j, 1e-12j])
    np.testing.assert_allclose(twist.at(at, np.zeros(3)), [100, 0, 100])
    np.testing.assert_allclose(end.at(at, np.zeros(3)), [0, np.sqrt(200) * 1e5, -1e-24], rtol=1e-12)
    assert np.isfinite(end.rates(at, np.zeros(3))[0]).all()


# --- closed forms ---------------------------------------------------------------------------------------------------


def test_one_end_held():
    modes = held().modes(lowest=50)
    np.testing.assert_allclose(modes.natural_frequencies, (2 * np.arange(50) + 1) * UNIT, rtol=1e-13)
    assert set(modes.kinds) == {"oscillatory"}
    assert modes.converged.all()


def test_trial_frequencies_that_hit_a_shaft_with_its_ends_held_mislead_nobody():
    modes = held(length=0.1, outer_diameter=0.05).modes(lowest=7)  # the seventh once came out at 6.472 in place of 6.5
    np.testing.assert_allclose(modes.natural_frequencies * 0.1 / SPEED, (np.arange(7) + 0.5) / 2, rtol=1e-13)


def test_both_ends_held_so_that_every_mode_is_one_inside():
    modes = rig(shaft(), tn.Lock("l", node="a"), tn.Lock("r", node="b")).modes(lowest=50)
    np.testing.assert_allclose(modes.natural_frequencies, 2 * np.arange(1, 51) * UNIT, rtol=1e-13)
    assert (np.abs(modes.shape_at("s.inside")) == 1).all()


def test_both_ends_free():
    modes = rig(shaft()).modes(lowest=30)
    np.testing.assert_allclose(modes.natural_frequencies, 2 * np.arange(30) * UNIT, rtol=1e-13, atol=1e-9)
    assert modes.kinds[:2] == ("rigid body", "oscillatory")
    n = np.arange(1, 30)
    np.testing.assert_allclose(modes.shape_at("a")[1:] / modes.shape_at("b")[1:], (-1.0) ** n, rtol=1e-9)
    inside = modes.shape_at("s.inside")[1:] / modes.shape_at("a")[1:]
    np.testing.assert_allclose(inside, np.cos(0.382 * n * np.pi), rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize(("ends_held", "numbers"), [(False, [0, 1, 1, 2, 3, 3, 4]), (True, [1, 2, 2, 3, 4, 4, 5])])
def test_star_of_equal_shafts_has_repeated_modes_with_its_centre_at_rest(ends_held, numbers):
    arms = [shaft(f"s{end}", ("centre", end)) for end in "abc"]
    locks = [tn.Lock(f"l{end}", node=end) for end in "abc"] if ends_held else []
    modes = rig(*arms, *locks).modes(lowest=7)
    np.testing.assert_allclose(modes.natural_frequencies, np.array(numbers) * UNIT, rtol=1e-12, atol=1e-9)
    for first in np.flatnonzero(np.diff(numbers) == 0):
        assert np.linalg.matrix_rank(modes.shapes[:, first : first + 2], tol=1e-6) == 2


def roots_of_discs(k, j, first, second, count):
    """Free shaft with a disc at each end: (J1 J2 x^2 - J^2) sin x = J (J1 + J2) x cos x, x = omega sqrt(J/k)."""

    def equation(x):
        left = (first * second * x**2 - j**2) * mpmath.sin(x)
        return left - j * (first + second) * x * mpmath.cos(x)

    found = []
    with mpmath.workdps(30):
        grid = [mpmath.mpf(n) / 200 * mpmath.pi + mpmath.mpf("1e-3") for n in range(200 * (count + 1))]
        for low, high in pairwise(grid):
            if equation(low) * equation(high) < 0:
                found.append(float(mpmath.findroot(equation, (low, high), solver="anderson")))
    return np.array(found[:count]) * np.sqrt(k / j) / (2 * np.pi)


@pytest.mark.few(1)
@pytest.mark.parametrize(("first", "second"), [(0.3, 0.8), (1e-4, 1e3), (0.15, 0.15)])
def test_discs_at_both_ends(first, second):
    modes = rig(shaft(), tn.Inertia("j1", node="a", inertia=first), tn.Inertia("j2", node="b", inertia=second)).modes()
    expected = roots_of_discs(K, J, first, second, 19)
    np.testing.assert_allclose(modes.natural_frequencies[1:], expected, rtol=1e-12)


def drill_string(make):
    ends = [tn.Inertia("rotary", node="top", inertia=200), tn.Inertia("bit", node="bottom", inertia=10)]
    sizes = {"outer_diameter": 0.78, "inner_diameter": 0.65, "length": 800, "shear_modulus": 75e9, "density": 8000}
    return rig(make("string", nodes=("top", "bottom"), **sizes), *ends)


@pytest.mark.slow
def test_drill_string_of_friswell_example_9_9():
    polar = np.pi * (0.78**4 - 0.65**4) / 32
    exact = roots_of_discs(75e9 * polar / 800, 8000 * polar * 800, 200, 10, 10)
    found = drill_string(tn.ContinuousShaft).modes(lowest=11).natural_frequencies[1:]
    np.testing.assert_allclose(found, exact, rtol=1e-12)
    case = json.loads((Path(__file__).parents[1] / "validation/cases/friswell_9_9_drillstring_5el.json").read_text())
    published = np.array(case["published"]["natural_frequencies_hz"][1:3])
    np.testing.assert_allclose(published, found[:2], rtol=0.08)  # five elements: above, and by (x/5)^2/24
    assert (published > found[:2]).all()
    np.testing.assert_allclose(found[:6], case["continuum_exact_frequencies_hz"], rtol=1e-12)


def test_segments_approach_the_drill_string_quadratically():
    exact = drill_string(tn.ContinuousShaft).modes(lowest=5).natural_frequencies[1:]

    def error(segments):
        rough = drill_string(lambda *a, **b: tn.Shaft(*a, **b, segments=segments)).modes(lowest=5)
        return rough.natural_frequencies[1:] / exact - 1

    np.testing.assert_allclose(error(20) / error(40), 4, rtol=0.02)


# --- damping --------------------------------------------------------------------------------------------------------


def damped_root(start, drag, disc, eta):
    """Of K x cot x + c s + J s^2 = 0, a held shaft with a disc and a damper at its end."""

    def equation(s):
        stiff = K * (1 + 1j * eta)
        x = mpmath.sqrt(-(s**2) * J / stiff)
        return stiff * x * mpmath.cot(x) + drag * s + disc * s**2

    with mpmath.workdps(30):
        return complex(mpmath.findroot(equation, mpmath.mpmathify(start)))


@pytest.mark.few(1)
@pytest.mark.parametrize("drag", [20.0, 200.0, 480.0])
@pytest.mark.parametrize("eta", [0, 0.03])
def test_damped_poles_are_roots(drag, eta):
    drivetrain = held(
        tn.Inertia("j", node="b", inertia=0.05), tn.Damper("c", nodes=("b", "ground"), damping=drag), loss_factor=eta
    )
    modes = drivetrain.modes(lowest=12)
    assert modes.converged.all()
    assert len(set(np.round(modes.eigenvalues, 3))) == 12
    for found in modes.eigenvalues[modes.eigenvalues.imag > 0]:
        assert damped_root(found, drag, 0.05, eta) == pytest.approx(found, rel=1e-12)


def test_as_many_poles_as_the_argument_principle_says():
    drag, disc = 300.0, 0.05
    modes = held(tn.Inertia("j", node="b", inertia=disc), tn.Damper("c", nodes=("b", "ground"), damping=drag)).modes()
    inside = modes.eigenvalues[modes.eigenvalues.imag > 0]
    top = (inside[7].imag + inside[8].imag) / 2

    def entire(s):  # times sin x / x it has no poles
        x = np.sqrt(-(s**2) * J / K)
        return K * np.cos(x) + (drag * s + disc * s**2) * np.sin(x) / x

    corners = [1 + 1j, 1 + 1j * top, -2e4 + 1j * top, -2e4 + 1j, 1 + 1j]
    path = np.concatenate([np.linspace(a, b, 20_000) for a, b in pairwise(corners)])
    turns = np.sum(np.angle(entire(path[1:]) / entire(path[:-1]))) / (2 * np.pi)
    assert round(turns) == np.sum(inside.imag < top)


def test_rigid_rotation_against_a_damper_is_a_real_pole():
    drag = 5.0
    modes = rig(shaft(), tn.Damper("c", nodes=("b", "ground"), damping=drag)).modes(lowest=4)
    assert modes.kinds == ("rigid body", "real pole", "oscillatory", "oscillatory")

    def equation(s):  # -K x tan x = -c s with x = -j s sqrt(J/K)
        y = s * mpmath.sqrt(J / K)
        return K * y * mpmath.tanh(y) + drag * s

    expected = float(mpmath.findroot(equation, float(modes.eigenvalues[1].real) * 1.0001))
    assert modes.eigenvalues[1] == pytest.approx(expected, rel=1e-11)
    assert modes.eigenvalues[1].real == pytest.approx(-drag / J, rel=0.05)


@pytest.mark.slow
def test_a_matched_damper_swallows_all_modes_and_that_is_said():
    matched = held(tn.Damper("c", nodes=("b", "ground"), damping=float(np.sqrt(K * J))))
    with pytest.warns(TorsionnetWarning, match="could not be followed"):
        matched.modes(lowest=5)


@pytest.mark.parametrize(("damping", "overdamped"), [(10, 0), (30, 0), (50, 1)])
def test_steps_are_newton_s_where_a_stiffness_follows_the_frequency(damping, overdamped):
    """Steep over Im s, and damped by a third: steps of an analytic D(s) crept along, and lost half of the modes."""
    table = tn.TabulatedSpring("rubber", nodes=("b", "ring"), table=[[50, 1e4, damping], [1200, 3e5, damping]])
    drivetrain = held(table, tn.Inertia("ring", node="ring", inertia=0.02))
    _, found, lost = damped_modes(drivetrain.assembly.system, 4)
    assert lost == 0
    assert np.sum(~found.real) == 4 - overdamped
    assert np.sum(found.real) == 2 * overdamped
    assert found.converged.all()
    assert found.iterations.max() <= 10


def test_loss_factor_alone():
    modes = held(loss_factor=0.04).modes(lowest=10)
    expected = 1j * 2 * np.pi * (2 * np.arange(10) + 1) * UNIT * np.sqrt(1 + 0.04j)
    np.testing.assert_allclose(modes.eigenvalues, expected, rtol=1e-13)


# --- random trees ---------------------------------------------------------------------------------------------------


@st.composite
def trees(draw):
    """A tree of shafts with discs, one end held or none, and a gear in between or none."""
    count = draw(st.integers(1, 4))
    number = st.integers(1, 20).map(lambda n: n / 10)
    ends, elements, lengths = ["n0"], [], []
    for index in range(1, count + 1):
        start = draw(st.sampled_from(ends))
        if draw(st.booleans()):
            elements.append(tn.Gear(f"g{index}", nodes=(start, f"m{index}"), ratio=draw(st.sampled_from([2, -3, 0.5]))))
            start = f"m{index}"
        ends.append(f"n{index}")
        lengths.append((f"s{index}", (start, f"n{index}"), draw(number), 0.04 + draw(number) / 20))
    heavy = [end for end in ends if draw(st.booleans())]
    elements += [tn.Inertia(f"j{end}", node=end, inertia=draw(number) / 10) for end in heavy]
    if draw(st.booleans()):
        elements.append(tn.Lock("l", node=draw(st.sampled_from(ends))))
    return elements, lengths


def made(tree, make, **options):
    elements, lengths = tree
    shafts = [make(name, nodes=nodes, length=one, outer_diameter=d, **options) for name, nodes, one, d in lengths]
    return rig(*shafts, *elements)


@pytest.mark.slow
@settings(max_examples=campaigns.examples(3, 40), deadline=None)
@given(trees())
def test_random_trees_against_fine_segments(tree):
    found = made(tree, tn.ContinuousShaft).modes(lowest=4).natural_frequencies
    rough, fine = (made(tree, tn.Shaft, segments=n).modes(lowest=4).natural_frequencies for n in (20, 40))
    np.testing.assert_allclose(found, (4 * fine - rough) / 3, rtol=2e-3, atol=1e-3)
    assert (found <= fine * (1 + 1e-9) + 1e-6).all()


@pytest.mark.slow
@settings(max_examples=campaigns.examples(3, 40), deadline=None)
@given(trees())
def test_response_of_random_trees_against_fine_segments(tree):
    locked = {part.node for part in tree[0] if part.kind == "lock"}
    node = next(one for one in ("n1", "n0") if one not in locked)
    f = np.array([1.0, 30.0, 100.0])
    exact = made(tree, tn.ContinuousShaft).frequency_response(node, node, f).values
    rough, fine = (made(tree, tn.Shaft, segments=n).frequency_response(node, node, f).values for n in (24, 48))
    size = np.abs(exact) + np.abs(rough - fine) * 1e3
    np.testing.assert_array_less(np.abs(exact - (4 * fine - rough) / 3), 1e-3 * size + 1e-15)


def test_negative_pivots_are_the_negative_eigenvalues():
    random = np.random.default_rng(3)
    for draw in range(60):
        rows = random.integers(-2, 3, (12, 5)).astype(float)
        if draw % 3:  # at most two coordinates a row, several rows on the same ones
            rows *= np.array([random.permutation([1, 1, 0, 0, 0]) for _ in rows])
        kappa = random.standard_normal((12, 1))
        expected = np.sum(np.linalg.eigvalsh(rows.T @ (kappa * rows)) < 0)
        maps = [{j: a for j, a in enumerate(row) if a} for row in rows.tolist()]
        assert negative_pivots(maps, kappa, 5).item() == expected


# --- responses, readings, derivatives -------------------------------------------------------------------------------


def test_response_also_next_to_clamped_frequencies_of_the_pieces():
    x = np.array([1e-9, 0.3, 1.5, np.pi, np.pi / 0.382, np.pi / 0.618, 2 * np.pi / 0.618, 40.0])
    f = x * np.sqrt(K / J) / (2 * np.pi)
    found = held().frequency_response("b", "b", f).values[:, 0, 0]
    with mpmath.workdps(40):
        stiffness = mpmath.mpf(G * POLAR / L)
        exact = []
        for one in f:
            y = 2 * mpmath.pi * mpmath.mpf(one) * mpmath.sqrt(mpmath.mpf(J) / stiffness)
            exact.append(complex(mpmath.tan(y) / (y * stiffness)))
    tolerance = 1e-9 + 1e-14 * x / np.abs(np.sin(x) * np.cos(x))
    np.testing.assert_array_less(np.abs(found / exact - 1), tolerance)


def test_torque_twist_and_stress_at_both_ends():
    sensors = {
        "held": Sensor("torque", "s", at="a"),
        "free": Sensor("torque", "s", at="b"),
        "stress": Sensor("stress", "s", at="a"),
        "twist": Sensor("twist", "s"),
    }
    model = rig(shaft(), tn.Lock("l", node="a"), tn.Inertia("j", node="b", inertia=0.3), sensors=sensors)
    f = np.array([3.0, 200.0, 900.0])
    values = model.frequency_response(list(sensors), "b", f).values[:, :, 0]
    w = 2 * np.pi * f
    x = w * np.sqrt(J / K)
    angle = 1 / (K * x / np.tan(x) - 0.3 * w**2)
    np.testing.assert_allclose(values[:, 0], -K * x / np.sin(x) * angle, rtol=1e-11)
    np.testing.assert_allclose(values[:, 1], -K * x / np.tan(x) * angle, rtol=1e-11)
    np.testing.assert_allclose(values[:, 2], values[:, 0] / (np.pi * D**3 / 16), rtol=1e-13)
    np.testing.assert_allclose(values[:, 3], -angle, rtol=1e-11)


def parametric(**changes):
    values = {"D": D, "L": L, "G": G, "rho": RHO, "eta": 0.02} | changes
    one = shaft(outer_diameter="D", length="L", shear_modulus="G", density="rho", loss_factor="eta")
    return rig(
        one,
        tn.Inertia("j", node="b", inertia=0.3),
        tn.Damper("c", nodes=("a", "ground"), damping=40),
        parameters=values,
    )


@pytest.mark.slow
def test_derivatives_of_poles():
    slopes = mode_sensitivities(parametric(), ["D", "L", "G", "rho", "eta"])
    for place, (name, value) in enumerate(zip(slopes.parameters, slopes.values, strict=True)):
        step = 1e-5 * value
        above, below = (parametric(**{name: value + sign * step}).modes(lowest=7).eigenvalues[1:] for sign in (1, -1))
        change = (above - below) / (2 * step)
        np.testing.assert_allclose(slopes.pole_slopes[:6, place], change, rtol=2e-5, atol=1e-6 * np.abs(change).max())


def test_derivatives_of_responses():
    f = np.array([5.0, 150.0, 700.0])
    found = parametric_response(parametric(), "a", "b", f, ["D", "L", "eta"]).evaluation([D, L, 0.02])
    for place, name in enumerate(["D", "L", "eta"]):
        value = {"D": D, "L": L, "eta": 0.02}[name]
        step = 1e-5 * value
        above, below = (
            parametric(**{name: value + sign * step}).frequency_response("a", "b", f).values for sign in (1, -1)
        )
        np.testing.assert_allclose(found.jacobian[..., place], (above - below) / (2 * step), rtol=1e-6)


def test_symbols_take_other_values_and_know_the_formula():
    model = parametric()
    H = model.symbolic().transfer_function("a", "b")
    f = np.array([5.0, 150.0, 700.0])
    np.testing.assert_allclose(H.evaluate(f).values, model.frequency_response("a", "b", f).values, rtol=1e-10)
    longer = parametric(L=3.0).frequency_response("a", "b", f).values
    np.testing.assert_allclose(H.evaluate(f, L=3.0).values, longer, rtol=1e-10)
    written = {str(name): formula for name, formula in H.formulas.items()}
    formula = written["kappa_s_twist_1(omega)"]
    assert {str(symbol) for symbol in formula.free_symbols} == {"D", "L", "G", "rho", "eta", "omega"}
    value = complex(formula.subs({"D": D, "L": L, "G": G, "rho": RHO, "eta": 0.02, "omega": 500.0}))
    law = next(table for _, table in model.assembly.system.dynamic)
    assert value == pytest.approx(law.kappa(np.array([500.0]))[0], rel=1e-12)


# --- what is said and refused ---------------------------------------------------------------------------------------


def test_all_modes_of_a_band():
    modes = held().modes(up_to=20 * UNIT)
    np.testing.assert_allclose(modes.natural_frequencies, np.arange(1, 20, 2) * UNIT, rtol=1e-12)
    assert len(held().modes(up_to=UNIT / 2)) == 0
    assert len(held().modes(up_to=20 * UNIT, lowest=3)) == 3
    assert not modes.notes


def test_without_a_number_the_first_twenty_are_given_and_that_is_said():
    modes = held().modes()
    assert len(modes) == 20
    assert "infinitely many" in modes.notes[-1]


def test_a_band_of_an_ordinary_drivetrain():
    rigid = tn.load("dmf_rig")
    assert rigid.modes(up_to=10).natural_frequencies.round(3).tolist() == [7.105]
    with pytest.raises(UsageError, match="above 0 Hz"):
        rigid.modes(up_to=-1)


def test_state_space_is_refused_with_the_way_out():
    model = rig(
        shaft(),
        tn.Inertia("j", node="a", inertia=1),
        inputs={"T": Input("torque", "a")},
        sensors={"v": Sensor("velocity", "a")},
    )
    with pytest.raises(UsageError, match="segments"):
        model.to_control()


def test_inner_diameter_is_smaller():
    with pytest.raises(ModelError, match="smaller than the outer"):
        shaft(inner_diameter=0.2)


def test_energies_are_those_of_fine_segments():
    discs = tn.Inertia("j", node="a", inertia=0.2), tn.Damper("c", nodes=("b", "ground"), damping=60)
    one = rig(shaft(), *discs).modes(lowest=5)
    many = rig(tn.Shaft("s", nodes=("a", "b"), outer_diameter=D, length=L, segments=80), *discs).modes(lowest=5)
    for part in ("kinetic", "strain", "dissipated"):
        np.testing.assert_allclose(getattr(one, part), getattr(many, part), atol=2e-3)


def test_pickles():
    model = parametric()
    copy = pickle.loads(pickle.dumps(model.assembly.system))
    assert copy.dynamic == model.assembly.system.dynamic


def test_equal_frequencies_part_by_their_damping():
    """Two equal shafts with a disc on one held node, one damped five times as much: each vibrates as it would alone."""

    def branch(number, damping):
        node = f"a{number}"
        disc = tn.Inertia(f"J{number}", node=node, inertia=0.3)
        drag = tn.Damper(f"d{number}", nodes=(node, "ground"), damping=damping)
        return [shaft(f"s{number}", ("hub", node)), disc, drag]

    def poles(*branches):
        parts = [part for branch in branches for part in branch]
        return rig(tn.Lock("held", node="hub"), *parts).modes(lowest=len(branches)).eigenvalues

    alone = np.concatenate([poles(branch(1, 4.0)), poles(branch(2, 20.0))])
    both = poles(branch(1, 4.0), branch(2, 20.0))
    np.testing.assert_allclose(np.sort_complex(both), np.sort_complex(alone), rtol=1e-9)
