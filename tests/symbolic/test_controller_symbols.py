"""Transfer functions of drivetrains with controllers in symbols, against dense matrices and closed forms."""

import math

import numpy as np
import pytest
from support.controlled_plants import FREQUENCIES, Plant

import torsionnet as tn
from torsionnet.linear.assembly.symbolic import symbolic_matrices


def speed_loop(delay=0, law=None):
    elements = [
        tn.Inertia("rotor", node="a", inertia="J"),
        tn.Controller("governor", sense={"velocity": "a"}, act="a", law=law or {"p": "-p", "i": "-i"}, delay=delay),
    ]
    parameters = {"J": 2, "p": 30, "i": 50, **({"tau": 0.05} if delay else {})}
    return tn.Drivetrain(
        "governed", elements, parameters=parameters, inputs={"T": {"torque": "a"}}, sensors={"w": {"velocity": "a"}}
    )


class TestNumbers:
    @pytest.mark.few(4)
    @pytest.mark.parametrize("seed", range(16))
    def test_are_those_of_dense_matrices(self, seed):
        plant = Plant(seed, delay=seed % 2 > 0)
        system = plant.rig.symbolic()
        names = ["n0", f"n{plant.n - 1}", "torque(act0)", "torque(k1)"]
        spring = plant.elements[plant.n]
        found = {
            (name, load): system.transfer_function(name, load).evaluate(FREQUENCIES).values[:, 0, 0]
            for name in names
            for load in ("n0", "n2")
        }
        for place, f in enumerate(FREQUENCIES):
            s = 2j * np.pi * f
            motions = np.linalg.inv(plant.dynamic_stiffness(s))
            for load in ("n0", "n2"):
                motion = motions[:, int(load[1:])]
                first, second = (motion[int(node[1:])] for node in spring.nodes)
                kappa = float(spring.stiffness.value) + s * float(spring.damping.value)
                expected = [motion[0], motion[-1], plant.torque(0, motion, s), kappa * (first - second)]
                got = [found[name, load][place] for name in names]
                assert got == pytest.approx(expected, rel=1e-9, abs=1e-12)

    @pytest.mark.parametrize("seed", range(4))
    def test_code_gives_the_same(self, seed):
        plant = Plant(seed, delay=seed % 2 > 0)
        H = plant.rig.symbolic().transfer_function("n1", "n0")
        space: dict = {}
        exec(H.python_code("H"), space)
        expected = [np.linalg.inv(plant.dynamic_stiffness(2j * np.pi * f))[1, 0] for f in FREQUENCIES]
        assert space["H"](FREQUENCIES) == pytest.approx(expected, rel=1e-8)

    def test_torques_behind_rigid_connections_and_measured_inputs(self):
        elements = [
            tn.Inertia("one", node="a", inertia=2),
            tn.RigidCoupling("joint", nodes=("a", "b")),
            tn.Inertia("two", node="b", inertia=3),
            tn.Spring("hold", nodes=("a", "ground"), stiffness=100),
            tn.Controller("brake", sense={"velocity": "a"}, act="b", law=-4, delay="50 ms"),
        ]
        system = tn.Drivetrain("two", elements).symbolic()
        s = 2j * np.pi * 1.5
        kappa = -4 * s * np.exp(-0.05 * s)
        motion = 1 / (5 * s**2 + 100 - kappa)

        def value(*asked):
            return system.transfer_function(*asked).evaluate([1.5]).values.item()

        assert value("torque(joint)", "a") == pytest.approx(3 * s**2 * motion - kappa * motion, rel=1e-11)
        assert value("torque(brake)", "a") == pytest.approx(kappa * motion, rel=1e-11)
        assert value("torque(joint)", "velocity(a)", "a") == pytest.approx((3 * s**2 - kappa) / s, rel=1e-11)
        matrix = system.transfer_matrix(["torque(joint)"], ["angle(a)"], ["a"])
        assert matrix.evaluate([1.5]).values.item() == pytest.approx(3 * s**2 - kappa, rel=1e-11)

    def test_through_a_gear_and_with_parameters_of_the_law(self):
        elements = [
            tn.Inertia("motor", node="m", inertia=0.1),
            tn.Gear("box", nodes=("m", "w"), ratio="r"),
            tn.Spring("shaft", nodes=("w", "v"), stiffness=4000, damping=3),
            tn.Inertia("car", node="v", inertia=100),
            tn.Controller("jerk", sense={"velocity": ["w", "v"]}, act="m", law={"p": "-g", "filter": "T"}, delay="tau"),
        ]
        rig = tn.Drivetrain("car", elements, parameters={"r": 9, "g": 2, "T": 0.003, "tau": 0.004})
        H = rig.symbolic().transfer_function("velocity(v)", "m")
        for r, g, tau in ((9, 2, 0.004), (7.5, 5, 0.01)):
            s = 2j * np.pi * FREQUENCIES
            kappa, loop = 4000 + 3 * s, -g * s * np.exp(-s * tau)
            own = 0.1 * r**2 * s**2 + kappa - r * loop
            across = -kappa + r * loop
            far = 100 * s**2 + kappa
            expected = s * r * kappa / (own * far + kappa * across)
            found = H.evaluate(FREQUENCIES, r=r, g=g, tau=tau).values[:, 0, 0]
            assert found == pytest.approx(expected, rel=1e-10)


class TestForms:
    def test_governor_is_the_textbook_second_order(self):
        import sympy

        H = speed_loop().symbolic().transfer_function("w", "T")
        s, J, p, i = sympy.symbols("s J p i")
        assert sympy.simplify(H.polynomial.expression - s / (J * s**2 + p * s + i)) == 0
        assert sympy.simplify(H.nested - s / (J * s**2 + p * s + i)) == 0
        assert H.static_gain == 0
        assert sympy.simplify(H.low_frequency - s / i) == 0
        assert sympy.simplify(H.high_frequency - 1 / (J * s)) == 0
        assert sympy.simplify(H.derivative("p").nested + s**2 / (J * s**2 + p * s + i) ** 2) == 0

    def test_the_loop_leaves_no_pole_of_the_drivetrain_alone(self):
        """Two masses, one sensed and the other driven: as many poles as states."""
        import sympy

        elements = [
            tn.Inertia("one", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k"),
            tn.Inertia("two", node="b", inertia="I"),
            tn.Controller("link", sense={"velocity": "b"}, act="a", law="g"),
        ]
        rig = tn.Drivetrain("two", elements, parameters={"J": 2, "I": 3, "k": 100, "g": -4})
        s, J, I, k, g = sympy.symbols("s J I k g")
        H = rig.symbolic().transfer_function("b", "a")
        assert sympy.simplify(H.polynomial.expression - k / ((J * s**2 + k) * (I * s**2 + k) - k**2 - k * g * s)) == 0
        assert len(H.polynomial.denominator) == 5  # two masses have no more than four poles

    def test_a_delay_stays_out_of_polynomials(self):
        import sympy

        H = speed_loop("tau").symbolic().transfer_function("w", "T")
        i, tau = sympy.symbols("i tau")
        assert tau in H.free_symbols
        (formula,) = H.formulas.values()
        assert formula == sympy.exp(-sympy.I * sympy.Symbol("omega") * tau)
        for ask in (lambda: H.polynomial, lambda: H.normalised, lambda: H.high_frequency):
            with pytest.raises(tn.UsageError, match="unsupported-law"):
                ask()
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            H.derivative("tau")
        assert sympy.simplify(H.low_frequency - sympy.Symbol("s") / i) == 0

    def test_what_delayed_and_undelayed_torques_leave_at_rest(self):
        """k - k e^(-s tau) is k tau s for slow motions: only the series of the delay knows."""
        import sympy

        elements = [
            tn.Inertia("rotor", node="a", inertia=2),
            tn.Spring("hold", nodes=("a", "ground"), stiffness="k"),
            tn.Controller("push", sense={"angle": "a"}, act="a", law="k", delay="tau"),
        ]
        rig = tn.Drivetrain("cancelled", elements, parameters={"k": 70, "tau": 0.05})
        H = rig.symbolic().transfer_function("velocity(a)", "a")
        assert sympy.simplify(H.static_gain - 1 / sympy.Symbol("k") / sympy.Symbol("tau")) == 0
        assert H.evaluate([0.0]).values.item() == pytest.approx(1 / 3.5, rel=1e-12)

    def test_simplified_and_shown(self):
        rig = speed_loop("tau")
        H = rig.symbolic().transfer_function("w", "T")
        assert "delay_governor(omega)" in str(H)
        assert "omega" in H.to_latex()
        alone = 2j * math.pi / (50 + 60j * math.pi - 8 * math.pi**2)
        assert H.evaluate([1.0], tau=0).values.item() == pytest.approx(alone, rel=1e-12)


def test_a_report_leaves_out_what_a_delay_has_not(tmp_path):
    from torsionnet.report import write_report

    model = tn.loads(
        "{torsionnet: 1, elements: {one: {type: inertia, node: a, inertia: 2}, hold: {type: spring, nodes: [a, ground],"
        " stiffness: 100, damping: 2}, governor: {type: controller, sense: {velocity: a}, act: a, law: -2, delay: 5 ms}},"
        " inputs: {T: {torque: a}}, sensors: {w: {velocity: a}}}"
    )
    write_report(model, tmp_path / "report.md")
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "Low frequency" in text or "Static value" in text
    assert "High frequency" not in text


def test_torques_of_one_element_have_names_of_their_own():
    converter = tn.TorqueConverter(
        "conv", pump="a", turbine="b", speed=200, speed_ratio=0.5, pump_torque=[[0, 180], [1, 100]], test_speed=200,
        torque_ratio=[[0, 2.2], [1, 1]],
    )  # fmt: skip
    rig = tn.Drivetrain("two", [converter, tn.Inertia("J", node="a", inertia=1), tn.Inertia("K", node="b", inertia=2)])
    owners = [one.owner for one in symbolic_matrices(rig).actions]
    assert owners == ["conv_1", "conv_2"]
