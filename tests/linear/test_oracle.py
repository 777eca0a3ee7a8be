"""The comparison of random drivetrains with exact mechanics: what it rests on, that it can fail, and its result."""

import warnings
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from math import inf, pi, sqrt

import numpy as np
import pytest
from oracle.answers import INFINITE, Answer, Question, SingularInputError
from oracle.calls import Context, called
from oracle.campaign import run
from oracle.comparing_poles import compare_poles
from oracle.comparing_responses import compare_responses, respond
from oracle.comparing_shapes import compare_shapes
from oracle.description import Model, Part, Reading
from oracle.drawing import draw
from oracle.package import drivetrain, source
from oracle.poles import Poles
from oracle.questions import Asked, readings_of
from oracle.roles import EVERY, roles
from oracle.rounding import unavoidable
from oracle.solution import Mechanics
from oracle.tally import Finding, Tally

import torsionnet as tn

F = Fraction


def part(kind, name, **values):
    return Part(kind, name, values)


def inertia(node, value=1):
    return part("inertia", f"J_{node}", node=node, inertia=F(value))


def spring(a, b, k, **more):
    return part("spring", f"k_{a}_{b}", nodes=(a, b), stiffness=F(k), **more)


def gear(a, b, ratio, **more):
    return part("gear", f"g_{a}_{b}", nodes=(a, b), ratio=F(ratio), **more)


def model(*parts, **inputs):
    return Model(parts, inputs or {"T": ("torque", "a")})


TWO_MASSES = model(inertia("a"), spring("a", "b", 100), inertia("b", 2))


def values(model, readings, frequency, *, measured=(), drive=("T",)):
    """Exact values of the first column, as complex numbers or the word for infinity."""
    excitations = tuple(model.inputs[name] for name in drive)
    answer = Answer(Mechanics(model), Question(tuple(readings), excitations, tuple(measured)))
    table = answer.at(frequency) if frequency else answer.at_rest()
    return [row[0] if row[0] == INFINITE else complex(row[0]) for row in table]


def torque(name, port):
    return Reading("torque", name, port)


# --- exact mechanics against formulas -------------------------------------------------------------------------------


def test_poles_of_two_masses():
    poles = Poles(Mechanics(TWO_MASSES))
    own = sqrt(100 * (1 + 1 / 2))
    assert (poles.count.rigid, poles.count.zeros, poles.count.others) == (1, 2, 2)
    assert sorted(complex(root).imag for root in poles.roots()) == pytest.approx([-own, own], rel=1e-15)
    assert abs(poles.correction(1j * own * (1 + 1e-6))) == pytest.approx(1e-6 * own, rel=1e-5)


def test_a_free_damped_rotor_has_one_zero_and_one_pole():
    poles = Poles(Mechanics(model(inertia("a", 4), part("damper", "d", nodes=("a", "ground"), damping=F(8)))))
    assert (poles.count.rigid, poles.count.zeros) == (1, 1)
    assert [complex(root) for root in poles.roots()] == [pytest.approx(-2)]


def test_two_poles_in_one_place_are_counted():
    twins = [part("damper", f"d{n}", nodes=(n, "ground"), damping=F(3)) for n in "bc"]
    poles = Poles(Mechanics(model(inertia("a"), spring("a", "b", 6), spring("a", "c", 6), *twins)))
    assert poles.number_inside(-2, 1e-3) == 1  # one leaves -2 with the motion of a, the other stays
    both = Poles(Mechanics(model(*twins, spring("b", "ground", 6), spring("c", "ground", 6), inertia("a"))))
    assert both.number_inside(-2, 1e-6) == 2


def test_response_of_two_masses():
    (angle, through) = values(TWO_MASSES, [Reading("angle", "b"), torque("k_a_b", "first")], 2.0)
    s2 = -((4 * pi) ** 2)
    assert angle == pytest.approx(100 / (s2 * (2 * s2 + 300)), rel=1e-14)
    assert through == pytest.approx(2 * s2 * angle, rel=1e-14)


def test_limits_at_rest():
    """A free drivetrain: the angle grows without bound, the shaft carries the share of what it drives."""
    readings = [Reading("angle", "a"), torque("k_a_b", "second"), Reading("twist", "k_a_b"), Reading("velocity", "b")]
    found = values(TWO_MASSES, readings, 0.0)
    assert found == [INFINITE, pytest.approx(2 / 3), pytest.approx(2 / 300), INFINITE]
    held = model(
        inertia("a"), part("hysteretic_spring", "h", nodes=("a", "ground"), stiffness=F(5), loss_factor=F(1, 2))
    )
    assert values(held, [Reading("angle", "a"), Reading("acceleration", "a")], 0.0) == [
        pytest.approx(1 / (5 + 2.5j)),
        0,
    ]


def test_torques_at_the_members_of_a_planetary_set():
    """Without inertia: 1 at the sun, z at the ring, both out of the set through the carrier."""
    planetary = part("planetary", "p", sun="a", ring="r", carrier="c", ratio=F(3))
    held = model(planetary, part("lock", "l", node="r"), spring("c", "ground", 10))
    found = values(held, [torque("p", port) for port in ("sun", "ring", "carrier")] + [torque("l", "node")], 1.0)
    assert found == [pytest.approx(x) for x in (1, -3, 4, -3)]


def test_torques_of_a_gear_in_a_housing():
    stage = gear("a", "b", -2, housing="h")
    ports = [torque("g_a_b", port) for port in ("first", "second", "housing")]
    held = model(stage, part("lock", "l", node="b"), part("lock", "m", node="h"), spring("a", "ground", 10))
    assert values(held, ports, 1.0) == [1, -2, 3]
    turning = model(stage, inertia("b"), inertia("a"), part("lock", "m", node="h"))
    assert values(turning, ports, 1.0) == pytest.approx([1 / 5, -2 / 5, 3 / 5])  # the inertia behind counts a quarter


def test_shaft_inertia_is_consistent_with_a_linear_twist():
    """Clamped at one end, one segment: J/3 on k, both of the whole shaft."""
    shaft = part("shaft", "s", nodes=("a", "ground"), outer_diameter=F(1, 20), length=F(2))
    polar = pi * 0.05**4 / 32
    k, J = 79.3e9 * polar / 2, 7850 * polar * 2
    (root,) = (complex(r) for r in Poles(Mechanics(model(shaft))).roots() if complex(r).imag > 0)
    assert root.imag == pytest.approx(sqrt(3 * k / J), rel=1e-13)


def test_a_table_is_interpolated_and_kept_beyond_its_ends():
    rows = ((F(1), F(100), F(2)), (F(3), F(300), F(4)))
    bush = model(part("tabulated_spring", "t", nodes=("a", "ground"), table=rows))
    for f, k, c in ((0.5, 100, 2), (2.0, 200, 3), (9.0, 300, 4)):
        assert values(bush, [Reading("angle", "a")], f) == [pytest.approx(1 / (k + 2j * pi * f * c))]


def test_an_imposed_angle_holds_its_node_under_other_inputs():
    driven = model(inertia("a"), spring("a", "b", 100), inertia("b", 2), phi=("angle", "a"), T=("torque", "b"))
    assert values(driven, [Reading("angle", "a"), Reading("angle", "b")], 0.0) == [0, pytest.approx(0.01)]
    assert values(driven, [Reading("angle", "b")], 0.0, drive=("phi",)) == [pytest.approx(1)]


def test_a_measured_input_that_is_always_zero_is_found():
    free = model(inertia("a"), spring("a", "b", 7))
    measured = [torque("k_a_b", "first")]
    with pytest.raises(SingularInputError):
        values(free, [Reading("angle", "a")], 1.0, measured=measured)
    again = values(TWO_MASSES, [Reading("angle", "b")], 1.0, measured=measured)
    assert again == [pytest.approx(-1 / (2 * (2 * pi) ** 2))]


def test_torques_in_a_rigid_loop_are_indeterminate():
    loop = model(gear("a", "b", 2), gear("b", "c", 3), gear("a", "c", 6), inertia("c"), gear("c", "d", 2), inertia("d"))
    mechanics = Mechanics(loop)
    known = {str(r) for r in readings_of(loop) if r.quantity == "torque" and mechanics.is_determinate(r)}
    assert known == {"torque(J_c, node)", "torque(J_d, node)", "torque(g_c_d, first)", "torque(g_c_d, second)"}


def test_rounding_of_the_numbers_is_magnified_near_a_resonance():
    mechanics = Mechanics(model(inertia("a", "0.3"), spring("a", "ground", "70.1")))
    answer = Answer(mechanics, Question((Reading("angle", "a"),), (("torque", "a"),)))
    near = sqrt(70.1 / 0.3) / (2 * pi) * (1 + 1e-6)
    assert unavoidable(answer, near, 0, 0) == pytest.approx(1e6 * 2.0**-53, rel=0.01)


# --- the comparison can fail ----------------------------------------------------------------------------------------

ASKED = Asked(
    Question((Reading("angle", "b"), torque("k_b_c", "first")), (("torque", "a"),)), ("b", "torque(k_b_c)"), ("T",)
)


def compared(call, *, exact_zeros=True, frequencies=(1.0, 3.0)):
    drawn = model(inertia("a"), spring("a", "b", 100), inertia("b", 2), spring("b", "c", 9))
    tally = Tally()
    context = Context("test", Mechanics(drawn), drivetrain(drawn), tally)
    compare_responses(
        context, "responses", ASKED, frequencies, call(respond(context.drivetrain)), exact_zeros=exact_zeros
    )
    return tally


def test_right_values_are_counted():
    tally = compared(lambda right: right)
    assert (tally.values, tally.beyond) == (4, 0)
    assert tally.lines["responses"].worst < 1e-15


def test_a_wrong_digit_is_found():
    tally = compared(lambda right: lambda *question: right(*question) * (1 + 3e-9))
    assert (tally.values, tally.beyond) == (4, 2)
    assert "rounding the numbers of the model alone" in tally.findings[0].what


def test_noise_in_the_place_of_zero_is_found_unless_rounding_is_allowed():
    def noisy(right):
        return lambda *question: right(*question) + 1e-17

    assert compared(noisy).beyond == 2
    assert compared(noisy, exact_zeros=False).beyond == 0


@pytest.mark.parametrize(("text", "counts"), [("mostly rounding", (4, 0)), ("the response is infinite", (0, 4))])
def test_a_warning_about_digits_excuses_a_value_and_one_about_infinity_does_not(text, counts):
    def wrong(right):
        def call(*question):
            warnings.warn(text, tn.TorsionnetWarning, stacklevel=1)
            return right(*question) * 2 + 1

        return call

    tally = compared(wrong)
    assert (tally.lines["responses"].warned, tally.beyond) == counts


def test_other_warnings_are_findings():
    tally = compared(
        lambda right: (
            lambda *question: (warnings.warn("divide by zero", RuntimeWarning, stacklevel=1), right(*question))[1]
        )
    )
    assert "RuntimeWarning: divide by zero" in tally.findings[0].what


def test_a_static_value_must_be_infinite_where_it_grows():
    assert compared(lambda _: lambda *_: np.full((1, 2, 1), 7.0), frequencies=[0.0]).beyond == 2


def test_errors_of_any_kind_are_findings():
    outcome = called(lambda: 1 / 0)
    assert isinstance(outcome.error, ZeroDivisionError)
    tally = compared(lambda _: lambda *_: np.zeros(2).shape[5])
    assert "IndexError" in tally.findings[0].what


@pytest.mark.parametrize(
    "change",
    [
        lambda poles: poles * (1 + 1e-8),
        lambda poles: poles[:-1],
        lambda poles: np.append(poles[:-1], poles[-2]),
        lambda poles: np.append(poles, -5.0),
    ],
    ids=["moved", "missing", "one twice", "one too many"],
)
def test_wrong_poles_are_found(change):
    drawn = model(inertia("a"), spring("a", "b", 100, damping=F(1)), inertia("b", 2), spring("b", "ground", 7))
    right = drivetrain(drawn).modes()

    class Wrong:
        undamped_natural_frequencies = right.undamped_natural_frequencies
        eigenvalues = change(right.eigenvalues)
        nodes, shapes = right.nodes, np.resize(right.shapes, (2, len(eigenvalues)))
        kinds = ("oscillatory",) * len(eigenvalues)
        converged = np.full(len(eigenvalues), fill_value=True)

        def modes(self):
            return self

    for asked, beyond in ((drivetrain(drawn), 0), (Wrong(), 1)):
        tally = Tally()
        compare_poles(Context("test", Mechanics(drawn), asked, tally))
        assert (tally.beyond >= 1) == bool(beyond)


def test_a_wrong_shape_is_found():
    drawn = model(inertia("a"), spring("a", "b", 100, damping=F(1)), inertia("b", 2), spring("b", "ground", 7))
    right = drivetrain(drawn).modes()
    for factor, beyond in ((1, 0), (1 + 1e-8, len(right))):
        tally = Tally()
        wrong = replace(right, shapes=right.shapes * np.array([[factor], [1]]))
        every = [*right.eigenvalues, *right.eigenvalues.conj()]
        compare_shapes(Context("test", Mechanics(drawn), None, tally), wrong, every)
        assert (tally.beyond, tally.values) == (beyond, beyond or 4)


def test_tallies_are_joined_and_written():
    first, second = Tally(), Tally()
    first.agreed("0-1", "poles", 1e-12, 1e-9, 3)
    second.wrong(Finding("0-2", "poles", "eigenvalue", "1", "2", 0.5), 1e-9)
    second.wrong(Finding("0-2", "poles", "eigenvalue", "1", "3", inf), 1e-9)
    assert (first.join([second]).values, first.beyond, len(first.distinct())) == (5, 2, 1)
    assert first.table().splitlines()[1].split() == ["poles", "2", "5", "inf", "1e-09", "2", "0", "0"]
    assert str(first.findings[0]) == "0-2 poles: eigenvalue: exact 1, got 2 (0.5)"


# --- the comparison -------------------------------------------------------------------------------------------------


def test_the_same_seed_draws_the_same_model():
    assert source(draw("5-3")) == source(draw("5-3")) != source(draw("5-4"))


@pytest.mark.slow
def test_every_element_is_drawn_in_every_role():
    drawn = Counter()
    for i in range(500):
        drawn.update(roles(Mechanics(draw(f"0-{i}"))))
    assert not EVERY - drawn.keys()


def agrees(seeds, values):
    tally = run(seeds)
    assert tally.beyond == 0, "\n".join(map(str, (tally.table(), *tally.distinct()[:20])))
    assert tally.values >= values
    return tally


@pytest.mark.slow
def test_random_drivetrains_agree_with_exact_mechanics():
    agrees((f"quick-{i}" for i in range(10)), 2000)


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(3))
def test_many_random_drivetrains_agree_with_exact_mechanics(part):
    agrees((f"tests-{i}" for i in range(25 * part, 25 * part + 25)), 8000)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "seed",
    [
        "7-41",
        "7-100",
        pytest.param("8-8", marks=pytest.mark.slow),
        "tests-69",
        "9-64",
        "9-149",
        "9-190",
        "9-531",
        "10-15",
    ],
)
def test_models_that_once_disagreed(seed):
    """Symbols that cancel, shares next to 1, direct shares of torques as floats, dependent inputs in many digits.

    And a vibration without damping beside a table whose stiffness begins at 0.
    """
    agrees([seed], 400)
