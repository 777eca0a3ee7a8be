"""Symbolic transfer functions: every form against the numbers, the paper's equations, exactness, code, refusals."""

import ast
import random
import warnings
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from support import campaigns
from support.models import EVERY_ELEMENT, geared_line
from support.random_drivetrains import draw
from sympy import Rational, Symbol, simplify

import torsionnet as tn
from torsionnet.base.program import Program
from torsionnet.symbolic.algebra.deletion_contraction import ExpandedBlock, solve_block
from torsionnet.symbolic.algebra.recursion import orient

F = np.array([0.31, 3.3, 17.0, 61.0])
s = Symbol("s")
I_1, I_2, I_MT, k_1, k_2, c_1, c_2, c_B, c_M, c_O, tau = sympy.symbols("I_1 I_2 I_MT k_1 k_2 c_1 c_2 c_B c_M c_O tau")


def numbers(expression, values, frequencies=F):
    """An expression of s and parameters at frequencies in Hz, through the nested expression itself."""
    function = sympy.lambdify(s, expression.xreplace(dict(values)), "numpy")
    return function(2j * np.pi * frequencies) * np.ones(len(frequencies))


def run_code(text):
    space = {}
    exec(compile(text, "generated", "exec"), space)
    return space["transfer_function"]


def written_forms(H):
    yield "mechanical", H.mechanical
    yield "nested", H.nested
    table, result = H.program.where()
    for name, value in reversed(table.items()):
        result = result.xreplace({name: value})
    yield "program", result
    yield "polynomial", H.polynomial.expression
    kept = sorted(map(str, H.free_symbols))[::3]
    yield "keep", H.keep(kept).polynomial.expression
    yield "keep, mechanical", H.keep(kept).mechanical
    if H.predicted_terms() < 300:
        yield "expanded", H.expanded().expression
    if H.predicted_terms() < 60:
        yield "normalised", H.normalised.expression


def assert_equal(values, expected, form):
    assert np.abs(values - expected).max() <= 1e-10 * np.abs(expected).max(), form


def assert_all_forms(drivetrain, output, input):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = drivetrain.frequency_response(output, input, F)
    assume(np.isfinite(expected.values).all())
    assume(expected.conditioning is None or expected.conditioning.min() > 1e-4)
    values = expected.values[:, 0, 0]
    H = drivetrain.symbolic().transfer_function(output, input)
    assert_equal(H.evaluate(F).values[:, 0, 0], values, "evaluate")
    assert_equal(run_code(H.python_code())(F), values, "code")
    for form, expression in written_forms(H):
        assert_equal(numbers(expression, H.values), values, form)


def some_question(made):
    rnd = made.random
    nodes = [f"n{i}" for i in range(made.count)]
    return made.sensor(), rnd.choice(["T", *nodes]) if rnd.random() < 0.4 else made.sensor()


EXAMPLES = settings(max_examples=campaigns.examples(4, 25), deadline=None, suppress_health_check=list(HealthCheck))


def a_drivetrain_and_a_question(source, **options):
    try:
        drivetrain, made = draw(source, **options)
    except tn.ModelError:  # contradicting ratios and the like
        assume(False)
    question = some_question(made)
    try:
        drivetrain.frequency_response(*question, F[:1])
    except (tn.UsageError, tn.TorsionnetWarning):
        assume(False)
    return drivetrain, question


class TestEveryFormIsTheNumericResponse:
    @pytest.mark.slow
    @EXAMPLES
    @given(st.randoms(use_true_random=False))
    def test_trees_with_gears_and_branches(self, source):
        drivetrain, question = a_drivetrain_and_a_question(source)
        assert_all_forms(drivetrain, *question)

    @pytest.mark.slow
    @EXAMPLES
    @given(st.randoms(use_true_random=False), st.integers(1, 3))
    def test_closed_loops(self, source, loops):
        drivetrain, question = a_drivetrain_and_a_question(source, loops=loops, count=4)
        assert_all_forms(drivetrain, *question)

    @pytest.mark.slow
    @EXAMPLES
    @given(st.randoms(use_true_random=False))
    def test_a_law_over_three_coordinates(self, source):
        drivetrain, question = a_drivetrain_and_a_question(source, planetary=True, count=3)
        assert_all_forms(drivetrain, *question)

    @pytest.mark.slow
    def test_more_loops_than_deletion_and_contraction_takes(self):
        names = ["a", "b", "c", "d", "e"]
        elements = [tn.Inertia(f"J{n}", node=n, inertia=f"J_{n}") for n in names]
        parameters = {f"J_{n}": 1 + i for i, n in enumerate(names)}
        for i, (first, second) in enumerate((a, b) for a in names for b in names if a < b):
            elements.append(tn.Gear(f"g{i}", nodes=(first, second), ratio=f"t_{i}", stiffness=f"k_{i}", damping=0.5))
            parameters |= {f"t_{i}": 1.5 + i, f"k_{i}": 100 * (i + 2)}
        elements.append(tn.Spring("x", nodes=("a", "d"), stiffness=321))
        model = tn.Drivetrain("dense", elements, parameters, inputs={"T": {"torque": "a"}})
        H = model.symbolic().transfer_function("torque(g4)", "T")
        (block,) = orient(H.request.mechanism.network, "a").below["a"]
        assert isinstance(solve_block(block, {}, Program()), ExpandedBlock)
        expected = model.frequency_response("torque(g4)", "T", F).values[:, 0, 0]
        assert_equal(H.evaluate(F).values[:, 0, 0], expected, "evaluate")
        assert_equal(run_code(H.python_code())(F), expected, "code")

    @pytest.mark.few(9)
    @pytest.mark.parametrize("kind", [kind for kind in EVERY_ELEMENT if kind not in ("lock", "inertia")])
    def test_every_element(self, kind):
        """Against the numbers at other values than the model's, so that nothing may have been rounded in."""
        element = EVERY_ELEMENT[kind]
        ends = sorted({node for node in element.ports.values() if node != "ground"})
        inertias = [tn.Inertia(f"J{n}", node=n, inertia=1 + i) for i, n in enumerate(ends)]
        hold = tn.Spring("hold", nodes=(ends[0], "ground"), stiffness=90, damping="c")
        model = tn.Drivetrain("one", [element, *inertias, hold], {"c": 1}, inputs={"T": {"torque": ends[-1]}})
        for output in (f"angle({ends[0]})", "torque(hold)", f"twist({element.expanded()[-1].name})"):
            H = model.symbolic().transfer_function(output, "T")
            expected = model.configured(c=3).frequency_response(output, "T", F).values[:, 0, 0]
            assert_equal(H.evaluate(F, c=3).values[:, 0, 0], expected, output)

    @pytest.mark.slow
    def test_hundreds_of_coordinates_neither_overflow_nor_vanish(self):
        elements, parameters = [], {}
        for i in range(150):
            elements.append(tn.Inertia(f"j{i}", node=f"n{i}", inertia=f"J_{i}"))
            parameters[f"J_{i}"] = 1e-3 * (1 + i % 7)
            if i:
                nodes = (f"n{i - 1}", f"n{i}")
                elements.append(tn.Spring(f"k{i}", nodes=nodes, stiffness=f"k_{i}", damping=f"c_{i}"))
                parameters |= {f"k_{i}": 1e5 + i, f"c_{i}": 2.0}
        model = tn.Drivetrain("long", elements, parameters, inputs={"T": {"torque": "n0"}})
        for node in ("n0", "n149"):
            H = model.symbolic().transfer_function(node, "T")
            expected = model.frequency_response(node, "T", F).values[:, 0, 0]
            np.testing.assert_allclose(H.evaluate(F).values[:, 0, 0], expected, rtol=1e-8)
            np.testing.assert_allclose(run_code(H.python_code())(F), expected, rtol=1e-8)
            assert H.program.operations <= 12 * 150


class TestThePaper:
    """Equations (13) and (20), printed as G_11 / (1 - (J s^2 + c_M s) G_11), J up to the middle of the transducer."""

    branch = I_2 * s**2 + (c_2 + c_B) * s + k_2
    edge = k_1 + c_1 * s

    def test_equation_13_mechanical(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert H.mechanical == 1 / self.edge + 1 / self.branch
        assert str(H.mechanical) == "1/(I_2*s**2 + k_2 + s*(c_2 + c_B)) + 1/(c_1*s + k_1)"

    def test_equation_13_polynomial(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").polynomial
        assert H.numerator == (I_2, c_1 + c_2 + c_B, k_1 + k_2)  # the highest power first, as in Matlab
        for found, expected in zip(
            H.denominator[::-1],
            (k_1 * k_2, c_1 * k_2 + k_1 * (c_2 + c_B), I_2 * k_1 + c_1 * (c_2 + c_B), I_2 * c_1),
            strict=True,
        ):
            assert sympy.expand(found - expected) == 0
        assert str(H.named) == "(b_0 + b_1*s + b_2*s**2)/(a_0 + a_1*s + a_2*s**2 + a_3*s**3)"

    def test_parts_are_sympy_expressions(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert simplify(sympy.sympify(H) - 1 / self.edge - 1 / self.branch) == 0
        assert simplify(H.numerator / H.denominator - H.mechanical) == 0
        assert sympy.Poly(H.numerator, s).degree() == 2
        assert sympy.diff(H, k_2).has(k_2)
        for written in (sympy.latex, sympy.pretty, sympy.srepr, sympy.sstr):
            # sympy has a printer for a TransferFunction and a Rational of its own
            assert written(H) == written(H.nested)
            assert written(H.polynomial) == written(H.polynomial.expression)
        assert sympy.sympify("2") * H == 2 * H.nested == 2 * H
        assert (-H, H**2) == (-H.nested, H.nested**2)
        assert (1 / H, H - H, H.polynomial * s) == (1 / H.nested, 0, H.polynomial.expression * s)

    def test_equation_13_as_printed(self):
        G = (self.edge + self.branch) / ((I_1 * s**2 + c_M * s) * (self.edge + self.branch) + self.edge * self.branch)
        printed = G / (1 - (I_1 * s**2 + c_M * s) * G)
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert simplify(H.mechanical - printed) == 0
        assert simplify(H.polynomial.expression - printed) == 0
        assert simplify(tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_M").mechanical - G) == 0

    def test_equation_20_as_printed(self):
        behind = I_2 * s**2 + (c_B + c_O / tau**2) * s + k_2 / tau**2
        G = (self.edge + behind) / ((I_1 * s**2 + c_M * s) * (self.edge + behind) + self.edge * behind)
        printed = G / (1 - (I_MT * s**2 + c_M * s) * G)
        H = tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T")
        assert simplify(H.mechanical - printed) == 0
        assert simplify(H.polynomial.expression - printed) == 0
        assert "k_2/tau**2" in str(H.mechanical)
        assert H.polynomial.numerator[-1] == k_1 + k_2 / tau**2

    def test_a_wrong_equation_would_be_seen(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert simplify(H.mechanical - 1 / self.edge - 1 / (self.branch + c_M * s)) != 0

    def test_upstream_is_gone(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert H.free_symbols == {I_2, k_1, k_2, c_1, c_2, c_B}
        assert "independent of rotor, bearing" in H.notes[-1]

    def test_normalised(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").normalised
        assert simplify(H.gain - (1 / k_1 + 1 / k_2)) == 0
        orders = {factor.order: factor for factor in H.denominator}
        assert simplify(orders[1].omega_n - k_1 / c_1) == 0
        assert simplify(orders[2].omega_n ** 2 - k_2 / I_2) == 0
        assert simplify(orders[2].zeta ** 2 - (c_2 + c_B) ** 2 / (4 * I_2 * k_2)) == 0

    def test_limits(self):
        S = tn.load("dmf_rig").symbolic()
        measured, driven = S.transfer_function("theta_1", "T_T"), S.transfer_function("theta_1", "T_M")
        assert simplify(measured.static_gain - (1 / k_1 + 1 / k_2)) == 0
        assert measured.high_frequency == 1 / (c_1 * s)
        assert driven.high_frequency == 1 / (I_1 * s**2)
        assert S.transfer_function("velocity(motor)", "T_M").static_gain == 0
        assert simplify(S.transfer_function("velocity(motor)", "T_M").low_frequency / s - 1 / k_1 - 1 / k_2) == 0
        numeric = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [0]).values.item()
        assert measured.evaluate([0]).values.item() == pytest.approx(numeric, rel=1e-14)

    def test_free_drivetrains_have_no_static_value(self):
        model = tn.Drivetrain("free", [tn.Inertia("j", node="a", inertia="J")], {"J": 2})
        H = model.symbolic().transfer_function("a", "a")
        assert H.static_gain == sympy.oo
        assert H.low_frequency == 1 / (Symbol("J") * s**2)
        with pytest.warns(tn.TorsionnetWarning, match="infinite"):
            assert np.isinf(H.evaluate([0]).values.item())

    @pytest.mark.parametrize(
        ("rig", "name", "value"), [("dmf_rig", "c_2", 4), pytest.param("amt_rig", "c_O", 170, marks=pytest.mark.slow)]
    )
    def test_derivative(self, rig, name, value):
        H = tn.load(rig).symbolic().transfer_function("theta_1", "T_T")
        D = H.derivative(name)
        slope = sympy.diff(H.keep([name]).mechanical, Symbol(name))
        assert sympy.cancel(D.keep([name]).polynomial.expression - slope) == 0
        step = 1e-3
        high, low = (H.evaluate(F, **{name: value + sign * step}).values for sign in (1, -1))
        np.testing.assert_allclose(D.evaluate(F).values, (high - low) / (2 * step), rtol=1e-6)


class TestValues:
    def test_numbers_are_exact(self):
        model = tn.Drivetrain(
            "x", [tn.Inertia("j", node="a", inertia=0.1), tn.Spring("k", nodes=("a", "ground"), stiffness=0.5)]
        )
        H = model.symbolic().transfer_function("a", "a")
        assert H.mechanical == 1 / (s**2 / 10 + Rational(1, 2))
        for form in (H.mechanical, H.polynomial.expression, H.normalised.expression, H.expanded().expression):
            assert not form.atoms(sympy.Float)

    def test_half_is_one_half(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").subs(k_2=0.5, c_1=0)
        assert simplify(H.static_gain - 1 / k_1 - 2) == 0
        assert H.mechanical == 1 / (I_2 * s**2 + s * (c_2 + c_B) + Rational(1, 2)) + 1 / k_1

    def test_subs_then_evaluate(self):
        rig = tn.load("amt_rig")
        H = rig.symbolic().transfer_function("theta_1", "T_T").subs({"tau": 3.26, "c_O": 360})
        expected = rig.configured("V_c_O_360").frequency_response("theta_1", "T_T", F)
        np.testing.assert_allclose(H.evaluate(F).values, expected.values, rtol=1e-12)
        assert tau not in H.free_symbols

    def test_keep_leaves_only_the_named(self):
        H = tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T").keep(["c_O", "k_1"])
        assert H.free_symbols == {c_O, k_1}
        assert H.polynomial.expression.free_symbols == {c_O, k_1, s}
        assert not H.polynomial.expression.atoms(sympy.Float)

    def test_evaluate_gives_a_frequency_response(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").evaluate(F)
        assert (H.outputs[0].unit, H.inputs[0].unit, H.unit()) == ("rad", "N*m", "rad/(N*m)")

    def test_unknown_parameters(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        for call in (lambda: H.subs(k_3=1), lambda: H.keep(["k_3"]), lambda: H.evaluate(F, k_3=1)):
            with pytest.raises(tn.UsageError, match="unknown-parameter"):
                call()

    def test_equal_ratios_by_chance_are_not_equal_symbols(self):
        """Two parallel gear meshes with the same ratio today: the expression must hold for other ratios too."""
        model = tn.Drivetrain(
            "two meshes",
            [
                tn.Inertia("a", node="a", inertia=1),
                tn.Inertia("b", node="b", inertia=2),
                tn.Gear("g", nodes=("a", "b"), ratio="t_1", stiffness=500),
                tn.Gear("h", nodes=("a", "b"), ratio="t_2", stiffness=800),
            ],
            {"t_1": 2, "t_2": 2},
            inputs={"T": {"torque": "a"}},
        )
        H = model.symbolic().transfer_function("b", "T")
        expected = model.configured(t_2=3).frequency_response("b", "T", F).values
        np.testing.assert_allclose(H.evaluate(F, t_2=3).values, expected, rtol=1e-12)


class TestExpanded:
    def test_terms_are_predicted_exactly(self):
        H = geared_line().symbolic().transfer_function("angle", "T_M")
        assert H.expanded().terms == H.predicted_terms()

    def test_cap(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_M")
        count = H.predicted_terms()
        with pytest.raises(tn.UsageError, match=f"(?s){count} .*{count - 1}.*too-large"):
            H.expanded(cap=count - 1)
        assert H.expanded(cap=count).terms == count

    def test_ring(self):
        E = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_M").expanded()
        above, below = E.to_ring()
        assert simplify(above.as_expr() / below.as_expr() - E.expression) == 0


class TestCode:
    def test_names_and_defaults(self):
        rig = tn.load("amt_rig")
        text = rig.symbolic().transfer_function("theta_1", "T_T").python_code()
        function = run_code(text)
        expected = rig.configured("V").frequency_response("theta_1", "T_T", F).values[:, 0, 0]
        np.testing.assert_allclose(function(F, tau=3.26), expected, rtol=1e-12)
        arguments = ast.parse(text).body[1].args
        assert [a.arg for a in arguments.kwonlyargs] == ["I_1", "I_2", "I_MT", "c_1", "c_B", "c_O", "k_1", "k_2", "tau"]

    def test_only_arithmetic_in_it(self):
        text = geared_line().symbolic().transfer_function("angle", "T").python_code()
        calls = {ast.unparse(node.func) for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)}
        assert calls == {"_np.asarray"}

    @pytest.mark.parametrize("name", ["x; import os", "lambda", "_x", "a b", "", "a\nb"])
    def test_unsafe_names_are_refused(self, name):
        with pytest.raises(tn.UsageError, match="cannot be a name"):
            geared_line().symbolic().transfer_function("angle", "T").python_code(name)

    def test_unsafe_symbols_are_refused(self):
        H = geared_line().symbolic().transfer_function("angle", "T").subs({"k_1": Symbol("__import__('os')")})
        with pytest.raises(tn.UsageError, match="cannot be a name"):
            H.python_code()

    def test_parameters_named_like_the_function_uses_them(self):
        model = tn.Drivetrain(
            "x",
            [tn.Inertia("j", node="a", inertia="np"), tn.Spring("k", nodes=("a", "ground"), stiffness="f")],
            {"np": 2, "f": 50},
        )
        H = model.symbolic().transfer_function("a", "a")
        expected = model.frequency_response("a", "a", F).values[:, 0, 0]
        np.testing.assert_allclose(run_code(H.python_code())(F), expected, rtol=1e-12)

    def test_tables_are_arguments(self):
        model = tn.Drivetrain(
            "t",
            [
                tn.Inertia("j", node="a", inertia=1),
                tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[1, 300, 2], [90, 700, 1]]),
            ],
        )
        H = model.symbolic().transfer_function("a", "a")
        expected = model.frequency_response("a", "a", F).values[:, 0, 0]
        np.testing.assert_allclose(H.evaluate(F).values[:, 0, 0], expected, rtol=1e-12)
        kappa = model.assembly.system.dynamic[0][1].kappa(2 * np.pi * F)
        np.testing.assert_allclose(run_code(H.python_code())(F, _kappa_bush=kappa), expected, rtol=1e-12)


class TestLatex:
    def test_forms(self):
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        mechanical = H.to_latex()
        assert mechanical == r"\frac{1}{I_{2} s^{2} + k_{2} + s \left(c_{2} + c_{B}\right)} + \frac{1}{c_{1} s + k_{1}}"
        assert H._repr_latex_() == f"$\\displaystyle {mechanical}$"
        assert r"& a_{0} = k_{1} k_{2} \\" in H.to_latex("polynomial")
        for form in ("polynomial", "normalised", "program", "expanded"):
            text = H.to_latex(form)
            assert text.count("{") == text.count("}")

    @pytest.mark.parametrize("form", ["polynomial", "normalised"])
    def test_forms_that_would_fill_pages(self, form):
        """Coefficients of a chain of 12 inertias with damped shafts and gears have more than 20 000 symbols."""
        elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=f"J_{i}") for i in range(12)]
        for i in range(11):
            nodes = (f"n{i}", f"n{i + 1}")
            shaft = tn.Spring(f"e{i}", nodes=nodes, stiffness=f"k_{i}", damping=f"c_{i}")
            elements.append(tn.Gear(f"e{i}", nodes=nodes, ratio=f"tau_{i}") if i % 3 == 1 else shaft)
        names = [f"{name}_{i}" for name in ("J", "k", "c", "tau") for i in range(12)]
        chain = tn.Drivetrain("chain", elements, parameters=dict.fromkeys(names, 2))
        H = chain.symbolic().transfer_function("n11", "n0")
        with pytest.raises(tn.UsageError, match="too-large"):
            getattr(H, form)

    def test_unknown_form(self):
        with pytest.raises(tn.UsageError, match='did you mean "mechanical"'):
            tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").to_latex("mechanicl")


class TestQuestions:
    def test_names_are_explained_as_for_numbers(self):
        S = tn.load("dmf_rig").symbolic()
        with pytest.raises(tn.UsageError, match='did you mean "theta_1"'):
            S.transfer_function("theta_2", "T_T")
        with pytest.raises(tn.UsageError, match="wrong-count"):
            S.transfer_function(["theta_1", "T_T"], "T_M")

    def test_a_sensor_the_excitation_does_not_reach(self):
        model = tn.Drivetrain(
            "held",
            [
                tn.Inertia("a", node="a", inertia=1),
                tn.Spring("k", nodes=("a", "b"), stiffness=50),
                tn.Lock("wall", node="b"),
                tn.Spring("l", nodes=("b", "c"), stiffness=70),
                tn.Inertia("c", node="c", inertia=1),
            ],
            inputs={"T": {"torque": "a"}},
        )
        with pytest.raises(tn.UsageError, match="does not feel"):
            model.symbolic().transfer_function("c", "torque(l)")

    def test_indeterminate_torque(self):
        model = tn.Drivetrain(
            "loop",
            [
                tn.Inertia("j", node="a", inertia=1),
                tn.Gear("g1", nodes=("a", "b"), ratio=2),
                tn.Gear("g2", nodes=("a", "b"), ratio=2),
                tn.Spring("k", nodes=("b", "ground"), stiffness=5),
            ],
        )
        with pytest.raises(tn.UsageError, match="statically indeterminate"):
            model.symbolic().transfer_function("torque(g1)", "a")

    def test_torque_measured_on_the_far_side_of_a_gear(self):
        rig = geared_line()
        for output in ("twist(stiff)", "torque(brake)", "angle"):
            H = rig.symbolic().transfer_function(output, "torque(stage, o)")
            expected = rig.frequency_response(output, "torque(stage, o)", F).values
            np.testing.assert_allclose(H.evaluate(F).values, expected, rtol=1e-12)
        H = rig.symbolic().transfer_function("torque(brake)", "torque(stage, o)")
        assert H.mechanical == 1

    def test_referred_to_the_other_side(self):
        S = tn.load("amt_rig").symbolic(referred_to=["output_shaft"])
        H = S.transfer_function("theta_1", "T_T")
        assert "tau**2" in str(H.mechanical)
        assert "k_2/tau**2" not in str(H.mechanical)
        other = tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T")
        np.testing.assert_allclose(H.evaluate(F).values, other.evaluate(F).values, rtol=1e-12)


class TestSimplified:
    def test_error_is_what_it_says(self):
        rig = tn.load("dmf_rig")
        found = rig.symbolic().simplified("theta_1", "T_M", tolerance=0.02, band=(0.5, 20))
        assert found.changes == ("torque_meter rigid",)
        f = np.geomspace(0.5, 20, 400)
        whole = rig.frequency_response("theta_1", "T_M", f).values
        difference = np.abs(20 * np.log10(np.abs(found.transfer_function.evaluate(f).values / whole))).max()
        assert found.errors.decibels == pytest.approx(difference, rel=1e-9)
        first, kept = rig.modes(), found.drivetrain.modes()
        moved = abs(kept.natural_frequencies[0] / first.natural_frequencies[0] - 1)
        assert found.errors.omega == pytest.approx(moved, rel=1e-6)
        assert 0 < moved < 0.02
        assert "omega_n 0.17 %" in str(found)

    def test_damping_that_moves_no_pole_goes_and_its_spring_stays(self):
        """Of two dampings of 1e-4 and 2 N m s/rad in series the small one is left out."""
        elements = [
            tn.Inertia("J_1", node="a", inertia=1),
            tn.Inertia("J_2", node="b", inertia=2),
            tn.Spring("soft", nodes=("a", "b"), stiffness=1000, damping=1e-4),
            tn.Spring("held", nodes=("b", "ground"), stiffness=500, damping=2),
        ]
        rig = tn.Drivetrain("rig", elements, inputs={"T": {"torque": "a"}}, sensors={"phi": {"angle": "b"}})
        found = rig.symbolic().simplified("phi", "T", band=(0.5, 10))
        assert found.changes == ("soft without its damping",)
        assert found.drivetrain.definition.elements["soft"].stiffness == rig.definition.elements["soft"].stiffness

    def test_nothing_goes_where_nothing_may_move(self):
        found = tn.load("dmf_rig").symbolic().simplified("theta_1", "T_M", tolerance=1e-9, band=(0.5, 20))
        assert found.changes == ()
        assert found.errors.decibels < 1e-9

    def test_a_band_without_modes(self):
        with pytest.raises(tn.UsageError, match="no mode of vibration"):
            tn.load("dmf_rig").symbolic().simplified("theta_1", "T_M", band=(0.1, 1))


class TestLongExpressions:
    def test_operations_grow_with_the_number_of_coordinates(self):
        def operations(size):
            drivetrain, _ = draw(random.Random(3), count=size)
            return drivetrain.symbolic().transfer_function(f"n{size - 1}", "T").program.operations

        assert operations(60) <= 12 * 60

    def test_lambdify_is_never_called(self, monkeypatch):
        """Its common-subexpression search takes exponential time on nested forms."""
        monkeypatch.setattr(sympy, "lambdify", None)
        monkeypatch.setattr(sympy, "cse", None)
        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert np.isfinite(H.evaluate(F).values).all()
        assert H.python_code().startswith("import numpy")
        assert "frac" in H.to_latex("program")

    def test_values_are_exact_fractions(self):
        values = tn.load("dmf_rig").symbolic().values
        assert Fraction(values[c_1].p, values[c_1].q) == Fraction(1, 10)


@pytest.mark.parametrize("form", ["polynomial", "normalised"])
def test_coefficients_that_would_fill_pages_are_refused_at_once(form):
    parts = [tn.Inertia("J0", node="n0", inertia="J0")]
    values = {"J0": 1}
    for i in range(1, 14):
        parts += [
            tn.Inertia(f"J{i}", node=f"n{i}", inertia=f"J{i}"),
            tn.Spring(f"k{i}", nodes=(f"n{i - 1}", f"n{i}"), stiffness=f"k{i}", damping=f"c{i}"),
        ]
        values |= {f"J{i}": 1, f"k{i}": 100 + i, f"c{i}": 0.1}
    chain = tn.Drivetrain("chain", parts, parameters=values, inputs={"T": {"torque": "n0"}})
    found = chain.symbolic().transfer_function("n13", "T")
    with pytest.raises(tn.UsageError, match='ask for "program"'):
        found.to_latex(form)
    assert found.to_latex("program")
