"""Equations of the theory manual (docs/theory): closed forms written down here, against the package on small models.

Names of tests carry the numbers of the equations.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.machinery.limits.iacs_m68 import IacsM68
from torsionnet.machinery.limits.m68_factors import permissible, size_factor, usual_range
from torsionnet.machinery.orders.synthesis import cycle_extremes
from torsionnet.study.answers.sensitivity_answers import estimates_of, sobol_points
from torsionnet.study.answers.subset_sampling import counted_share

THEORY = Path(__file__).parents[2] / "docs" / "theory"
RPM = np.pi / 30
J1, J2, K, C = 0.4, 1.1, 900.0, 1.7


def train(*elements, **more):
    return tn.Drivetrain("t", list(elements), **more)


def inertia(node, value):
    return tn.Inertia(f"J_{node}", node=node, inertia=value)


def spring(first, second, stiffness=K, **more):
    return tn.Spring(f"k_{first}_{second}", nodes=(first, second), stiffness=stiffness, **more)


def two_masses(damping=C, **more):
    return train(inertia("a", J1), inertia("b", J2), spring("a", "b", damping=damping), **more)


def values(model, outputs, inputs, frequencies):
    return model.frequency_response(outputs, inputs, frequencies).values.squeeze()


class TestLaws:
    def test_1_3_every_law_adds_its_weighted_square(self):
        """A chain with a law over three nodes, its matrix written by rows."""
        rows = {"J_a": (J1, [1, 0, 0]), "J_b": (J2, [0, 1, 0]), "J_c": (0.3, [0, 0, 1])}
        stiff = [(K, [1, -1, 0]), (70.0, [0, 1, -1]), (50.0, [1, 2.5, -3.5])]
        M = sum(value * np.outer(row, row) for value, row in rows.values())
        matrix = sum(value * np.outer(row, row) for value, row in stiff)
        set_ = tn.Planetary("set", sun="a", ring="b", carrier="c", ratio="5/2", stiffness=50.0)
        model = train(
            inertia("a", J1), inertia("b", J2), inertia("c", 0.3), spring("a", "b"), spring("b", "c", 70.0), set_
        )
        omega = 2 * np.pi * 3.3
        exact = np.linalg.inv(matrix - omega**2 * M)
        found = values(model, ["a", "b", "c"], ["a", "b", "c"], [3.3])
        np.testing.assert_allclose(found, exact, rtol=1e-10)

    def test_1_4_loops_of_teeth_close_exactly(self):
        """17/61 times 61/23 times 23/17 is 1; 3.588 in place of 61/17 is not, by 0.007 %."""
        nodes = [inertia("a", J1), inertia("b", J2), inertia("c", 0.3)]
        loop = [tn.Gear("ab", nodes=("a", "b"), teeth=[17, 61]), tn.Gear("bc", nodes=("b", "c"), teeth=[61, 23])]
        assert train(*nodes, *loop, tn.Gear("ca", nodes=("c", "a"), teeth=[23, 17])).modes().kinds == ("rigid body",)
        with pytest.raises(tn.ModelError, match="contradict"):
            train(*nodes, *loop, tn.Gear("ca", nodes=("c", "a"), ratio=0.7391)).modes()

    def test_1_8_ends_of_a_continuous_shaft(self):
        """Receptance of a free shaft: the inverse of k x [[cot x, -1/sin x], [-1/sin x, cot x]]."""
        d, length, G, rho, f = 0.1, 2.0, 79.3e9, 7850.0, 1234.0
        polar = np.pi * d**4 / 32
        k, J = G * polar / length, rho * polar * length
        shaft = tn.ContinuousShaft("s", nodes=("a", "b"), outer_diameter=d, length=length, shear_modulus=G, density=rho)
        x = 2 * np.pi * f * np.sqrt(J / k)
        ends = k * x * np.array([[1 / np.tan(x), -1 / np.sin(x)], [-1 / np.sin(x), 1 / np.tan(x)]])
        found = values(train(shaft), ["a", "b"], ["a", "b"], [f])
        np.testing.assert_allclose(found, np.linalg.inv(ends), rtol=1e-10)

    def test_1_9_a_pendulum_holds_its_node_at_its_order(self):
        """Order sqrt(R/r) = 2 at 50 rad/s: the node does not move, and does at a tenth more."""
        pendulum = tn.PendulumAbsorber(
            "p", node="a", count=1, mass=1.3, pivot_radius=0.1, path_radius=0.025, speed=50.0
        )
        model = train(inertia("a", J1), pendulum, spring("a", "ground"))
        at = 2 * 50.0 / (2 * np.pi)
        held, beside = np.abs(values(model, "a", "a", [at, 1.1 * at]))
        assert held < 1e-12 * beside


class TestAssembly:
    def test_2_3_reflected_values(self):
        tau = 3.5
        model = train(
            inertia("a", J1), tn.Gear("stage", nodes=("a", "b"), ratio=tau), inertia("b", J2),
            spring("b", "ground", K, damping=C),
        )  # fmt: skip
        s = 2j * np.pi * 2.2
        exact = 1 / ((J1 + J2 / tau**2) * s**2 + C / tau**2 * s + K / tau**2)
        assert complex(values(model, "a", "a", [2.2])) == pytest.approx(exact, rel=1e-12)

    def test_2_6_torque_through_a_rigid_coupling(self):
        """Balance of what lies behind it: J_2 s^2 theta."""
        model = train(
            inertia("a", J1), tn.RigidCoupling("meter", nodes=("a", "b")), inertia("b", J2), spring("b", "ground")
        )
        found = values(model, ["torque(meter)", "b"], "a", [4.0])
        assert complex(found[0]) == pytest.approx((K - J2 * (8 * np.pi) ** 2) * complex(found[1]), rel=1e-12)

    def test_2_7_and_2_8_measures_of_damping(self):
        delta, f = 0.3, 12.0
        zeta = delta / np.sqrt(4 * np.pi**2 + delta**2)
        assert tn.convert_damping(delta, "log_decrement", "zeta") == pytest.approx(zeta, rel=1e-14)
        assert tn.convert_damping(zeta, "zeta", "Q") == pytest.approx(1 / (2 * zeta), rel=1e-14)
        assert tn.convert_damping(zeta, "zeta", "psi") == pytest.approx(4 * np.pi * zeta, rel=1e-14)
        c = 2 * zeta * K / (2 * np.pi * f)
        assert tn.convert_damping(zeta, "zeta", "c", stiffness=K, frequency=f) == pytest.approx(c, rel=1e-14)

    def test_2_9_power_lost_by_a_spring(self):
        plant = two_masses(
            speeds={"of": "a", "list": ["400 rpm"]},
            excitations={"x": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": "10 N*m"}}}},
        )
        omega = 2 * 400 * RPM
        s = 1j * omega
        kappa = K + C * s
        D = np.array([[J1 * s**2 + kappa, -kappa], [-kappa, J2 * s**2 + kappa]])
        first, second = np.linalg.solve(D, [10.0, 0.0])
        exact = 0.5 * omega * C * omega * abs(first - second) ** 2
        assert plant.dissipated_power(["k_a_b"]).values.item() == pytest.approx(exact, rel=1e-10)


class TestResponses:
    def test_3_4_continued_fraction_of_a_chain(self):
        s, J3 = 2j * np.pi * 5.5, 0.7
        inner = 1 / (J2 * s**2 + 1 / (1 / 300.0 + 1 / (J3 * s**2)))
        exact = 1 / (J1 * s**2 + 1 / (1 / (K + C * s) + inner))
        model = train(
            inertia("a", J1), inertia("b", J2), inertia("c", J3), spring("a", "b", damping=C), spring("b", "c", 300.0)
        )
        assert complex(values(model, "a", "a", [5.5])) == pytest.approx(exact, rel=1e-12)

    def test_3_7_share_of_the_torque_at_rest(self):
        found = values(two_masses(inputs={"T": {"torque": "a"}}), "torque(k_a_b)", "T", [0.0])
        assert complex(found) == pytest.approx(J2 / (J1 + J2), rel=1e-12)

    def test_3_8_motion_over_time_by_the_matrix_exponential(self):
        """A ramp of torque on one mass, stepped here by the exponential of a larger matrix."""
        model = train(inertia("a", J1), spring("a", "ground", damping=C), inputs={"T": {"torque": "a"}})
        h, torque = 0.01, np.array([0.0, 1.0, 3.0, 3.0, -2.0, 0.0])
        A = np.array([[0, 1, 0, 0], [-K / J1, -C / J1, 1 / J1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
        step, state, exact = scipy.linalg.expm(A * h), np.zeros(2), [0.0]
        for here, there in pairwise(torque):
            state = (step @ [*state, here, (there - here) / h])[:2]
            exact.append(state[0])
        found = model.simulate("a", {"T": torque}, 1 / h)
        np.testing.assert_allclose(found["a"].values, exact, rtol=1e-10, atol=1e-16)

    def test_3_9_to_3_11_periodic_motion_of_a_law_that_is_straight(self):
        """A spring in stages of one stiffness is a linear one: its receptance, multipliers exp(lambda T)."""
        stages = [{"stiffness": K, "to": "0.01 rad"}, {"stiffness": K}]
        law = tn.Spring("k", nodes=("a", "ground"), stages=stages, damping=C)
        late = tn.Controller("late", sense={"velocity": "a"}, act="a", law=-1e-9, delay=0.001)
        f = 6.0
        s, poles = 2j * np.pi * f, np.roots([J1, C, K])
        expected = np.exp(poles / f)
        for more in ((), (late,)):
            found = train(inertia("a", J1), law, *more).periodic_response("a", frequencies=[f], excitation={"a": 50})
            (motion,) = found.motions
            assert complex(motion.amplitudes[1, 0]) == pytest.approx(50 / (J1 * s**2 + C * s + K), rel=1e-8)
            assert np.abs(expected - motion.multipliers[0]).min() < 1e-6
            assert motion.stability == "stable"


class TestModes:
    def test_4_2_proportional_damping(self):
        alpha, beta = 0.6, 2e-4
        ground = [tn.Damper(f"c_{n}", nodes=(n, "ground"), damping=alpha * J) for n, J in (("a", J1), ("b", J2))]
        springs = [spring("a", "b", damping=beta * K), spring("b", "ground", damping=beta * K)]
        modes = train(inertia("a", J1), inertia("b", J2), *ground, *springs).modes()
        omega = 2 * np.pi * modes.natural_frequencies
        np.testing.assert_allclose(modes.damping_ratios, alpha / (2 * omega) + beta * omega / 2, rtol=1e-10)

    def test_4_3_two_inertias(self):
        modes = two_masses().modes()
        omega = np.sqrt(K * (1 / J1 + 1 / J2))
        assert modes.natural_frequencies[1] == pytest.approx(omega / (2 * np.pi), rel=1e-12)
        assert modes.damping_ratios[1] == pytest.approx(C * omega / (2 * K), rel=1e-12)

    def test_4_5_first_order_form(self):
        """Eigenvalues of [[-X'CX, -X'E'], [EX, 0]], rigid motion with one zero, against the poles of the package."""
        X = np.diag([1 / np.sqrt(J1), 1 / np.sqrt(J2)])
        row = np.array([[1.0, -1.0]])
        damping, E = C * row.T @ row, np.sqrt(K) * row
        A = np.block([[-X.T @ damping @ X, -X.T @ E.T], [E @ X, np.zeros((1, 1))]])
        exact = np.linalg.eigvals(A)
        assert np.sum(np.abs(exact) < 1e-9) == 1
        pole = exact[np.argmax(exact.imag)]
        assert two_masses().modes().eigenvalues[1] == pytest.approx(pole, rel=1e-12)

    def test_4_9_held_continuous_shaft(self):
        shaft = {"outer_diameter": 0.1, "length": 2.0, "shear_modulus": 79.3e9, "density": 7850.0}
        model = train(tn.ContinuousShaft("s", nodes=("a", "b"), **shaft), tn.Lock("l", node="a"))
        exact = (2 * np.arange(1, 4) - 1) / 8 * np.sqrt(79.3e9 / 7850)
        np.testing.assert_allclose(model.modes(lowest=3).natural_frequencies, exact, rtol=1e-12)

    def test_4_11_holzer_table(self):
        table = train(inertia("a", J1), spring("a", "b"), inertia("b", J2)).holzer_table(at=3.0)
        square = (6 * np.pi) ** 2
        second = 1 - J1 * square / K
        assert table.station("b").amplitude == pytest.approx(second, rel=1e-12)
        assert table.remainder == pytest.approx(J1 * square + J2 * square * second, rel=1e-12)


class TestMeasuredInputs:
    def test_5_2_and_5_4_torque_meter_of_the_dmf_rig(self):
        rig, f = tn.load("dmf_rig"), np.array([0.7, 6.0, 9.0, 40.0])
        p = {name: float(value) for name, value in rig.parameters.items()}
        s = 2j * np.pi * f
        exact = 1 / (p["k_1"] + p["c_1"] * s) + 1 / (p["I_2"] * s**2 + (p["c_2"] + p["c_B"]) * s + p["k_2"])
        np.testing.assert_allclose(values(rig, "theta_1", "T_T", f), exact, rtol=1e-12)
        applied = values(rig, "theta_1", "T_M", f)
        rotor = p["I_1"] * s**2 + p["c_M"] * s
        np.testing.assert_allclose(applied / (1 - rotor * applied), exact, rtol=1e-10)

    def test_5_4_poles_are_those_of_the_cut_rig(self):
        rig = tn.load("dmf_rig")
        p = {name: float(value) for name, value in rig.parameters.items()}
        exact = [-p["k_1"] / p["c_1"], *np.roots([p["I_2"], p["c_2"] + p["c_B"], p["k_2"]])]
        found = rig.modes(measured_input="T_T").eigenvalues
        wanted = sorted((pole for pole in exact if np.imag(pole) >= 0), key=abs)
        np.testing.assert_allclose(sorted(found, key=abs), wanted, rtol=1e-10)


class TestOrders:
    def test_6_4_series_of_the_inertia_torque(self):
        from torsionnet.machinery.excitations.pressure_trace import inertia_harmonics

        lam = 0.02  # small, so that what the series leaves out is below the tolerance
        series = [lam / 4 + lam**3 / 16, -0.5, -(3 * lam / 4 + 9 * lam**3 / 32), -(lam**2) / 4]
        np.testing.assert_allclose(-inertia_harmonics(lam, np.arange(1.0, 5.0)).imag, series, rtol=1e-3, atol=1e-7)

    def test_6_7_and_6_8_orders_of_two_masses(self):
        orders = {1: (10.0, 0.0), 3: (4.0, 0.7)}
        listed = {h: {"amplitude": f"{size} N*m", "phase": f"{phase} rad"} for h, (size, phase) in orders.items()}
        plant = two_masses(
            speeds={"of": "a", "list": ["240 rpm"]},
            excitations={"x": {"type": "harmonic", "node": "a", "orders": listed}},
        )
        run = plant.order_response("twist(k_a_b)")
        angle, wave = np.linspace(0, 2 * np.pi, 200_001), 0
        for order, (size, phase) in orders.items():
            s = 1j * order * 240 * RPM
            kappa = K + C * s
            D = np.array([[J1 * s**2 + kappa, -kappa], [-kappa, J2 * s**2 + kappa]])
            first, second = np.linalg.solve(D, [size * np.exp(1j * phase), 0])
            assert run.of_order(order, "twist(k_a_b)")[0] == pytest.approx(first - second, rel=1e-10)
            wave = wave + np.real((first - second) * np.exp(1j * order * angle))
        assert run.half_range[0, 0] == pytest.approx(np.ptp(wave) / 2, rel=1e-8)

    def test_6_9_a_grid_misses_no_more_than_its_bound(self):
        amplitudes, counts = np.array([1.0, 0.4 - 0.3j, 0.2j]), np.array([1, 3, 5])
        step = 2 * np.pi / 40
        grid = np.real(amplitudes @ np.exp(1j * np.outer(counts, step * np.arange(40))))
        top = cycle_extremes(amplitudes[None, :, None], counts.tolist())[0, 0, 0]
        assert 0 <= top - grid.max() <= step**2 / 8 * np.sum(np.abs(amplitudes) * counts**2)


class TestCriticalSpeedsAndLimits:
    def test_7_2_peak_of_one_mass(self):
        zeta, omega = 0.2, np.sqrt(K / J1)
        model = train(inertia("a", J1), spring("a", "ground", damping=2 * zeta * np.sqrt(K * J1)))
        at = omega * np.sqrt(1 - 2 * zeta**2) / (2 * np.pi)
        below, peak, above = np.abs(values(model, "a", "a", [0.999 * at, at, 1.001 * at])) * K
        assert peak == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-12)
        assert below < peak > above

    def test_7_1_and_7_4_crossing_and_equilibrium_amplitude(self):
        plant = two_masses(
            damping=0.05,
            speeds={"of": "a", "list": ["200 rpm", "300 rpm"]},
            excitations={"x": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": "10 N*m"}}}},
        )
        square = K * (1 / J1 + 1 / J2)
        crossing = plant.critical_speeds().of(1, 2)
        assert crossing.undamped_speed == pytest.approx(np.sqrt(square) / 2, rel=1e-10)
        shape = np.array([1, -J1 / J2])  # the lighter inertia moves most
        exact = 10 / (square * (np.array([J1, J2]) @ shape**2))
        assert crossing.equilibrium_amplitude == pytest.approx(exact, rel=1e-9)
        zeta = 0.05 * np.sqrt(square) / (2 * K)
        assert crossing.resonant_amplitude == pytest.approx(exact / (2 * zeta), rel=1e-6)

    def test_7_5_to_7_7_permissible_stress_of_a_propeller_shaft(self):
        shaft = IacsM68(
            element="tail", shaft="propeller", feature="keyless", material="carbon", tensile_strength="650 MPa"
        )
        factor = 600 + 160  # sigma_B counts up to 600 N/mm^2
        C_D = 0.35 + 0.93 * 450**-0.2
        assert shaft.strength == pytest.approx(600e6)
        assert shaft.feature_factor == pytest.approx(0.55)
        found = permissible(shaft.strength, 0.55 * size_factor(0.45), np.array([0.6, 1.0])) / 1e6
        np.testing.assert_allclose(found, factor / 18 * 0.55 * C_D * np.array([3 - 2 * 0.36, 1.38]), rtol=1e-12)
        barred = usual_range(52.0, 104.0)
        assert (barred.low, barred.high) == pytest.approx((16 * 52 / 17.5, 17.5 * 52 / 16), rel=1e-12)


class TestDampersAndControl:
    @pytest.mark.parametrize("c", [0.0, 3.0, 40.0, 1e6])
    def test_8_1_fixed_point_of_the_untuned_damper(self, c):
        mu, omega = 0.5, np.sqrt(K / J1)
        damper = tn.ViscousDamper("d", node="a", ring_inertia=mu * J1, damping=c)
        model = train(inertia("a", J1), spring("a", "ground"), damper)
        at = omega * np.sqrt(2 / (2 + mu)) / (2 * np.pi)
        assert abs(complex(values(model, "a", "a", [at]))) * K == pytest.approx(1 + 2 / mu, rel=1e-9)

    def test_8_5_closed_loop_of_one_mass(self):
        """T = -g e^(-s t) s theta on J s^2 + k."""
        gain, delay, f = 2.0, 0.03, 5.0
        controller = tn.Controller("g", sense={"velocity": "a"}, act="a", law=-gain, delay=delay)
        model = train(inertia("a", J1), spring("a", "ground"), controller)
        s = 2j * np.pi * f
        exact = 1 / (J1 * s**2 + K + gain * s * np.exp(-s * delay))
        assert complex(values(model, "a", "a", [f])) == pytest.approx(exact, rel=1e-10)

    def test_8_6_poles_with_a_delay_solve_their_equation(self):
        gain, delay = 2.0, 0.03
        controller = tn.Controller("g", sense={"velocity": "a"}, act="a", law=-gain, delay=delay)
        poles = train(inertia("a", J1), spring("a", "ground"), controller).modes().eigenvalues
        equation = J1 * poles**2 + K + gain * poles * np.exp(-poles * delay)
        assert len(poles)
        np.testing.assert_allclose(np.abs(equation) / K, 0, atol=1e-9)

    def test_machine_of_constant_power_decays_or_grows(self):
        load = tn.ConstantPowerLoad("load", node="a", power=500.0, speed=10.0)
        for damping in (9.0, 3.0):
            model = train(inertia("a", J1), tn.Damper("d", nodes=("a", "ground"), damping=damping), load)
            poles = model.modes().eigenvalues
            assert np.min(np.abs(poles + (damping - 500 / 100) / J1)) < 1e-9

    def test_8_8_margins_of_a_delayed_damper(self):
        gain, delay = 2.0, 0.001
        controller = tn.Controller("g", sense={"velocity": "a"}, act="a", law=-gain, delay=delay)
        margins = train(inertia("a", J1), spring("a", "ground", damping=1.0), controller).loop_margins("g")
        s = 2j * np.pi * margins.frequencies
        loop = gain * s * np.exp(-s * delay) / (J1 * s**2 + 1.0 * s + K)
        np.testing.assert_allclose(margins.loop, loop, rtol=1e-8, atol=1e-12)


class TestIdentification:
    def test_9_2_random_error(self):
        from torsionnet.signals.uncertainty import random_error

        found = random_error(np.array([0.8]), averages=20).magnitude.item()
        assert found == pytest.approx(np.sqrt(0.2 / (2 * 20 * 0.8)), rel=1e-12)


class TestSensitivitiesAndTolerances:
    def test_10_2_derivative_of_a_receptance(self):
        from torsionnet.linear.sensitivity.parametric import parametric_response

        model = train(
            inertia("a", J1), inertia("b", J2), spring("a", "b", "k", damping=C), parameters={"k": f"{K} N*m/rad"}
        )  # fmt: skip
        response = parametric_response(model, "a", "a", np.array([4.0]), ["k"])
        twist = complex(values(model, "twist(k_a_b)", "a", [4.0]))
        found = response.evaluation(response.start).jacobian.item()
        assert found == pytest.approx(-(twist**2), rel=1e-10)

    def test_10_3_and_10_4_derivative_of_a_natural_frequency(self):
        from torsionnet.linear.sensitivity import mode_sensitivities

        model = train(inertia("a", J1), inertia("b", J2), spring("a", "b", "k"), parameters={"k": f"{K} N*m/rad"})
        found = mode_sensitivities(model, ["k"])
        frequency = np.sqrt(K * (1 / J1 + 1 / J2)) / (2 * np.pi)
        slopes = np.asarray(found.frequency_slopes)
        assert np.max(np.abs(slopes)) == pytest.approx(frequency / (2 * K), rel=1e-9)

    def test_10_5_interval_of_a_share(self):
        share = counted_share(3, 40, 0.95)
        exact = scipy.stats.beta.ppf(0.025, 3, 38), scipy.stats.beta.ppf(0.975, 4, 37)
        assert (share.low, share.high) == pytest.approx(exact, rel=1e-9)

    def test_10_7_sobol_indices_of_a_product(self):
        """Y = (1 + x)(1 + 2 y) with x, y uniform in -1/2..1/2: variances 1/12, 4/12, interaction 4/144."""
        x, y = sobol_points(2, 4096, seed=1).T - 0.5
        found = estimates_of((1 + x) * (1 + 2 * y), 4096, seed=1, confidence=0.95)
        parts = np.array([1 / 12, 4 / 12, 4 / 144])
        np.testing.assert_allclose(found.first, parts[:2] / parts.sum(), atol=0.01)
        np.testing.assert_allclose(found.total, (parts[:2] + parts[2]) / parts.sum(), atol=0.01)


class TestRotatingTests:
    def test_11_2_over_the_own_angle_an_order_loses_by_a_bessel_function(self):
        """22 degrees swing of the phase of order 12 by 1.8 degrees of order 0.5: the line falls by J0(0.38)."""
        phi = np.linspace(0, 4 * np.pi, 20_001)[:-1]
        vibration = np.radians(1.8) * np.cos(0.5 * phi)
        theta = phi + vibration
        signal = np.cos(12 * phi)
        line = 2 * np.mean(signal * np.exp(-12j * theta) * (1 - 0.5 * np.radians(1.8) * np.sin(0.5 * phi)))
        assert abs(line) == pytest.approx(scipy.special.j0(12 * np.radians(1.8)), abs=2e-3)
        assert np.degrees(12 * vibration.max()) == pytest.approx(21.6)

    def test_11_4_a_cubic_spline_keeps_a_known_share_of_a_sine(self):
        from torsionnet.signals.orders.tracked_signals import spline_response

        at = np.arange(400.0)
        fine = np.linspace(100, 300, 20_001)[:-1]
        for share in (0.05, 0.15, 0.3):
            spline = scipy.interpolate.CubicSpline(at, np.cos(2 * np.pi * share * at))(fine)
            kept = 2 * np.mean(spline * np.exp(-2j * np.pi * share * fine))
            assert abs(kept) == pytest.approx(spline_response(np.array(share)), abs=2e-4)

    def test_11_7_torque_that_errors_of_teeth_leave(self):
        rng = np.random.default_rng(1)
        places = rng.normal(0, np.radians(0.05), (2, 4000, 60))
        lines = 2 / 60 * np.fft.fft(places, axis=2)[:, :, 3]
        torque = np.sqrt(np.mean(np.abs(2e6 * (lines[0] - lines[1])) ** 2))
        assert torque == pytest.approx(np.sqrt(2) * 2e6 * 2 * np.radians(0.05) / np.sqrt(60), rel=0.03)
        assert torque == pytest.approx(637, rel=0.03)

    @pytest.mark.parametrize("poles", [1, 2, 3, 4])
    def test_11_10_a_fluctuation_passes_by_its_frequency(self, poles):
        from torsionnet.signals.orders.vold_kalman import EnvelopeFilter

        time, width = np.arange(8000) / 200, 1.0
        knots = np.arange(0, 40.05, 0.1)
        phase = (2 * np.pi * 30 * time)[None]
        widths = np.full((2, len(knots) - 1), width)
        filtered = EnvelopeFilter(time, phase, knots, widths, poles)
        inner = np.linspace(10, 30, 401)
        for frequency in (0.25, 0.5, 1.0):
            beat = np.cos(phase + 2 * np.pi * frequency * time)
            _, envelope = filtered.envelopes(filtered.solve(beat), inner)
            found = np.mean(envelope[0, 0] * np.exp(-2j * np.pi * frequency * inner))
            expected = 1 / (1 + (np.sqrt(2) - 1) * (2 * frequency / width) ** (2 * poles))
            assert abs(found) == pytest.approx(expected, abs=0.01 if frequency <= width / 2 else 0.03)
