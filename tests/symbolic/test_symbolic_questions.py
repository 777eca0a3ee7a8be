"""Transfer functions in symbols beyond one torque and a tree of single laws: each against the numbers."""

from itertools import pairwise

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.symbolic.formula_text import for_display
from torsionnet.symbolic.normalised import Factor

F = np.array([0.3, 2.0, 7.0, 19.0])
STEEL = {"shear_modulus": "G", "density": "rho"}


def shafts(count, inertia="consistent"):
    parameters = {"G": 80e9, "rho": 7850.0, "D": 0.05}
    elements = [tn.Inertia("first", node="n0", inertia=0.3)]
    for i in range(count):
        parameters[f"L_{i}"] = 0.3 + 0.01 * i
        ends = (f"n{i}", f"n{i + 1}")
        elements.append(
            tn.Shaft(f"s{i}", nodes=ends, outer_diameter="D", length=f"L_{i}", inertia=inertia, damping=0.1, **STEEL)
        )
    elements.append(tn.Inertia("last", node=f"n{count}", inertia=0.5))
    return tn.Drivetrain("shafts", elements, parameters, inputs={"T": {"torque": "n0"}})


def planetary_sets(count):
    elements, parameters = [tn.Inertia("first", node="n0", inertia="J")], {"J": 0.1}
    for i in range(count):
        sun, ring, carrier = f"n{i}", f"r{i}", f"n{i + 1}"
        parameters |= {f"z_{i}": 2 + 0.3 * i, f"k_{i}": 1e3 * (i + 1)}
        elements += [
            tn.Planetary(f"p{i}", sun=sun, ring=ring, carrier=carrier, ratio=f"z_{i}", stiffness=f"k_{i}"),
            tn.Inertia(f"ring_{i}", node=ring, inertia=0.3),
            tn.Inertia(f"carrier_{i}", node=carrier, inertia=0.2),
            tn.Spring(f"brake_{i}", nodes=(ring, "ground"), stiffness=900, damping=1),
        ]
    return tn.Drivetrain("sets", elements, parameters, inputs={"T": {"torque": "n0"}})


def agree(model, output, input, **options):
    H = model.symbolic().transfer_function(output, input, **options)
    expected = model.frequency_response(output, input, F, **options).values
    assert H.evaluate(F).values == pytest.approx(expected, rel=1e-10)
    return H


class TestLawsBetweenTheSameCoordinates:
    @pytest.mark.parametrize("output", ["n6", "n0", "n3", "twist(s2)", "torque(s2)", "torque(s4, n4)"])
    def test_shafts_with_inertia_of_their_own(self, output):
        agree(shafts(6), output, "T")

    @pytest.mark.slow
    def test_operations_grow_in_proportion_to_shafts(self):
        ten, twenty, forty = (
            shafts(n).symbolic().transfer_function(f"n{n}", "T").program.operations for n in (10, 20, 40)
        )
        assert forty - twenty == 2 * (twenty - ten)

    def test_operations_grow_in_proportion_to_compliant_planetary_sets(self):
        three, six, twelve = (planetary_sets(n) for n in (3, 6, 12))
        counts = [agree(model, f"n{n}", "T").program.operations for model, n in ((three, 3), (six, 6), (twelve, 12))]
        assert counts[2] - counts[1] <= 2.1 * (counts[1] - counts[0])

    def test_gears_side_by_side_and_a_rigid_planetary_with_inertia_on_its_ring(self):
        elements = [
            tn.Inertia("a", node="a", inertia="J"),
            tn.Inertia("b", node="b", inertia=0.2),
            tn.Inertia("ring", node="ring", inertia=0.4),
            tn.Inertia("carrier", node="carrier", inertia=0.1),
            tn.Gear("one", nodes=("a", "b"), ratio=2, stiffness="k", damping=0.5),
            tn.Gear("two", nodes=("a", "b"), ratio="tau", stiffness=3e3),
            tn.Planetary("set", sun="b", ring="ring", carrier="carrier", ratio="z"),
            tn.Spring("out", nodes=("carrier", "ground"), stiffness=900, damping=1),
        ]
        model = tn.Drivetrain("side by side", elements, {"J": 0.1, "k": 2e3, "tau": 2.5, "z": 3})
        for output in ("a", "carrier", "ring", "torque(one)", "torque(two, b)"):
            agree(model, output, "a")


class TestContinuedFractionsOfShafts:
    def test_a_shaft_is_a_spring_between_two_inertias(self):
        import sympy

        s, rho, G, L, d, J = sympy.symbols("s rho G L d J")
        shaft = tn.Shaft("s", nodes=("a", "b"), outer_diameter="d", length="L", **STEEL)
        model = tn.Drivetrain(
            "one",
            [shaft, tn.Inertia("load", node="b", inertia="J")],
            {"G": 80e9, "rho": 7850, "L": 2, "d": 0.05, "J": 3},
        )
        polar = sympy.pi * d**4 / 32
        half, spring = rho * polar * L / 2, G * polar / L - rho * polar * L * s**2 / 6
        expected = 1 / (half * s**2 + 1 / (1 / spring + 1 / ((J + half) * s**2)))
        H = agree(model, "a", "a")
        assert sympy.simplify(H.mechanical - expected) == 0
        assert str(H.mechanical).count("G") == 1

    @pytest.mark.slow
    def test_everything_appears_once(self):
        text = str(shafts(15).symbolic().transfer_function("n0", "T").mechanical)
        assert [text.count(f"/(32*L_{i})") for i in range(15)] == [1] * 15

    @pytest.mark.slow
    def test_python_code_of_a_long_chain(self):
        model = shafts(60)
        space = {}
        exec(model.symbolic().transfer_function("n60", "T").python_code(), space)
        expected = model.frequency_response("n60", "T", F, method="dense").values[:, 0, 0]
        assert space["transfer_function"](F) == pytest.approx(expected, rel=1e-8)


class TestImposedAngles:
    @pytest.fixture
    def rig(self):
        elements = [
            tn.Inertia("exciter", node="drive", inertia=0.3),
            tn.Spring("coupling", nodes=("drive", "a"), stiffness="k", damping=1),
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "end"), stiffness=700, damping=0.2),
            tn.Inertia("foundation", node="end", inertia=4),
        ]
        inputs = {"phi": {"angle": "drive"}, "psi": {"angle": "end"}, "T": {"torque": "a"}}
        sensors = {"T_c": {"torque": "coupling"}, "T_s": {"torque": "shaft"}}
        return tn.Drivetrain("driven", elements, {"k": 1e3, "J": 0.2}, inputs=inputs, sensors=sensors)

    @pytest.mark.parametrize("input", ["phi", "psi", "T"])
    @pytest.mark.parametrize("output", ["a", "T_c", "T_s", "velocity(a)", "twist(coupling)"])
    def test_as_the_numbers(self, rig, output, input):
        H = agree(rig, output, input)
        assert [channel.name for channel in H.channels] == [output, input]

    def test_what_hangs_on_the_driven_node_drops_out(self, rig):
        assert "3*s**2/10" not in str(rig.symbolic().transfer_function("a", "phi"))

    def test_under_a_measured_torque(self, rig):
        agree(rig, "a", "T_c", driven_by="phi")
        agree(rig, "a", "T_s", driven_by="T")

    def test_matrices_are_those_at_rest(self, rig):
        S = rig.symbolic()
        numbers = rig.assembly.system
        assert S.coordinates == ("a",)
        for symbols, matrix in ((S.M, numbers.M), (S.C, numbers.C), (S.K, numbers.K)):
            assert np.array(symbols.subs(S.values), dtype=float) == pytest.approx(matrix)


class TestMatrices:
    def test_receptances(self):
        rig = tn.load("amt_rig").configured("III")
        outputs, inputs = ["theta_1", "torque(half_shaft)"], ["T_M", "output_shaft"]
        G = rig.symbolic().transfer_matrix(outputs, inputs)
        expected = rig.frequency_response(outputs, inputs, F)
        assert G.evaluate(F).values == pytest.approx(expected.values, rel=1e-10)
        assert (G.outputs, G.inputs, G.shape) == (tuple(outputs), tuple(inputs), (2, 2))
        assert G["theta_1", "output_shaft"] is G[0, 1]
        assert G.to_latex().count("&") == 2

    @pytest.mark.parametrize("count", [2, 3])
    def test_several_measured_inputs(self, count):
        model = shafts(4, inertia="lumped")
        measured, excitation = ["torque(s0)", "torque(s2)", "angle(n4)"][:count], ["n0", "n2", "n4"][:count]
        outputs = ["n1", "n3"]
        G = model.symbolic().transfer_matrix(outputs, measured, excitation)
        expected = model.frequency_response(outputs, measured, F, driven_by=excitation)
        assert G.evaluate(F).values == pytest.approx(expected.values, rel=1e-9)

    @pytest.mark.parametrize("excitation", [["T", "U"], ["T", "psi"], ["phi", "psi"], ["U", "phi"]])
    def test_several_measured_inputs_and_imposed_angles(self, excitation):
        nodes = ["left", "a", "b", "c", "right"]
        elements = [tn.Inertia(f"j_{n}", node=n, inertia=f"J_{n}") for n in nodes]
        for i, ends in enumerate(pairwise(nodes)):
            elements.append(tn.Spring(f"k{i}", nodes=ends, stiffness=f"k_{i}", damping=0.3))
        values = {f"J_{n}": 0.1 * i + 0.1 for i, n in enumerate(nodes)} | {f"k_{i}": 300.0 * (i + 1) for i in range(4)}
        inputs = {"phi": {"angle": "left"}, "psi": {"angle": "right"}, "T": {"torque": "a"}, "U": {"torque": "c"}}
        model = tn.Drivetrain("between", elements, values, inputs=inputs)
        outputs, measured = ["b", "torque(k1)"], ["angle(a)", "torque(k2)"]
        G = model.symbolic().transfer_matrix(outputs, measured, excitation)
        expected = model.frequency_response(outputs, measured, F, driven_by=excitation)
        assert G.evaluate(F).values == pytest.approx(expected.values, rel=1e-10)

    def test_wrong_questions(self):
        S = shafts(4).symbolic()
        with pytest.raises(tn.UsageError, match="transfer_matrix takes several"):
            S.transfer_function(["n1"], "n0")
        with pytest.raises(tn.UsageError, match="unknown-name"):
            S.transfer_matrix(["n1"], ["n0"])["n9", 0]
        with pytest.raises(tn.UsageError, match="dependent-inputs"):
            S.transfer_matrix(["n1"], ["angle(n0)", "angle(n0)"], ["n0", "n1"])
        with pytest.raises(tn.UsageError, match="too-large"):
            S.transfer_matrix(["n1"], [f"angle(n{i})" for i in range(4)], [f"n{i}" for i in range(4)])


class TestShown:
    @pytest.mark.slow
    def test_polynomial_in_order(self):
        text = str(shafts(5, inertia="lumped").symbolic().transfer_function("n5", "T").polynomial)
        names = [f"a_{power}" for power in range(2, 13)]
        places = [text.index(f"{name}*s**") for name in names]
        assert places == sorted(places)

    def test_factors_in_words(self):
        import sympy

        H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        lines = str(H.normalised).splitlines()
        assert lines[0] == "gain (k_1 + k_2)/(k_1*k_2) = 0.0022491"
        assert lines[3] == "denominator: 1 + s/omega_n with omega_n = k_1/c_1 = 133000 rad/s"
        assert lines[2].endswith("= 55.012 rad/s, zeta = (c_2 + c_B)/(2*sqrt(I_2*k_2)) = 0.257121")
        assert str(H.subs(k_1=sympy.Symbol("k"), c_1=0.2).normalised).splitlines()[3].endswith("omega_n = 5*k rad/s")

    def test_damping_ratio_of_a_difference(self):
        """Where a sign is not plain from the symbols, nothing may be taken out of the root."""
        import sympy

        x, y = sympy.symbols("x y")
        coefficients = (sympy.Integer(1), (x + 1) / (x - y), -5 / (x - y))
        zeta = Factor(coefficients).zeta.xreplace({x: 1, y: 3})
        assert sympy.simplify(zeta + 1 / (2 * sympy.sqrt(sympy.Rational(5, 2)))) == 0

    def test_short_functions_in_one_line_and_long_ones_not(self):
        short = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        assert str(short) == f"theta_1/T_T = {short.mechanical}"
        assert "ask for .python_code()" in str(shafts(40).symbolic().transfer_function("n40", "T"))

    def test_expanded(self):
        short = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").expanded()
        assert (repr(short), str(short)) == ("<Expanded: 14 terms>", str(short.expression))
        assert str(shafts(3).symbolic().transfer_function("n3", "T").expanded()).startswith("<Expanded: ")

    def test_loops_are_not_written_out_by_the_page(self):
        H = planetary_sets(6).symbolic().transfer_function("n6", "T")
        with pytest.raises(tn.UsageError, match='ask for "program"'):
            H.to_latex()
        assert H._repr_latex_() == f"$\\displaystyle {H.to_latex('program')}$"
        assert shafts(40).symbolic().transfer_function("n40", "T")._repr_latex_() is None

    def test_long_numbers_and_turned_sums(self):
        import sympy

        z, k = sympy.symbols("z k")
        assert str(for_display((-z - 1) ** 2 * k)) == "k*(z + 1)**2"
        assert str(for_display(sympy.Rational(112984829027616, 10**12) * k)) == "112.98483*k"
        assert for_display(sympy.Rational(1, 3) * k) == k / 3
