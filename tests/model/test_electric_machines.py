"""Electric machines on a line: slopes of their torque laws, swings on a grid, loads of constant power."""

import mpmath
import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.model.elements import Values

TWO_PI = 2 * np.pi
VALUES = Values({})


def alone(machine, *others, **given):
    return tn.Drivetrain("alone", [machine, *others], inputs={"T": {"torque": machine.node}}, **given)


def generator(**changes):
    given = {
        "rated_power": "555 MW",
        "speed": "3600 rpm",
        "grid_frequency": 377 / TWO_PI,
        "inertia_constant": "3.5 s",
        "synchronising_coefficient": 0.757,
    }
    return tn.GridGenerator("generator", node="rotor", **given | changes)


def induction(**changes):
    given = {"synchronous_speed": 100, "breakdown_torque": 400, "breakdown_slip": 0.1, "slip": 0.02}
    return tn.InductionMachine("motor", node="rotor", **given | changes)


def synchronous(**changes):
    return tn.SynchronousMachine("motor", node="rotor", **{"pull_out_torque": 500, "pole_pairs": 3} | changes)


class TestGridGenerator:
    def test_swings_on_an_infinite_bus(self):
        (mode,) = alone(generator()).modes().natural_frequencies
        assert mode == pytest.approx(np.sqrt(0.757 * 377 / 7) / TWO_PI, rel=1e-12)
        assert mode == pytest.approx(1.0162, abs=5e-5)

    def test_a_published_machine_behind_its_reactance(self):
        """H. Saadat, Power System Analysis, example 11.2: damping of 0.138 per unit for 1 rad/s of the load angle."""
        machine = generator(
            grid_frequency="60 Hz", inertia_constant=9.94, synchronising_coefficient=None, emf=1.35, grid_voltage=1,
            reactance=0.65, power=0.6, damping_coefficient=0.138 * 120 * np.pi,
        )  # fmt: skip
        modes = alone(machine).modes()
        natural = np.sqrt(np.pi * 60 / 9.94 * 1.35 / 0.65 * np.cos(np.arcsin(0.6 * 0.65 / 1.35)))
        assert modes.natural_frequencies[0] * TWO_PI == pytest.approx(natural, rel=1e-12)
        assert modes.damping_ratios[0] == pytest.approx(0.138 / 2 * np.sqrt(np.pi * 60 / (9.94 * 1.9884)), rel=1e-5)
        assert modes.eigenvalues[0].imag / TWO_PI == pytest.approx(0.9549, abs=5e-5)

    def test_two_machines_swing_against_each_other(self):
        unit = 555e6 / (120 * np.pi) ** 2
        modes = alone(generator(grid="other"), tn.Inertia("other", node="other", inertia=2 * 6.5 * unit)).modes()
        expected = np.sqrt(0.757 * 377 * (1 / 7 + 1 / 13)) / TWO_PI
        assert modes.natural_frequencies == pytest.approx([0, expected], rel=1e-12)

    def test_turns_though_a_spring_ties_it_to_the_field(self):
        plant = tn.Drivetrain(
            "plant",
            [
                generator(),
                tn.Gear("gear", nodes=("turbine", "rotor"), ratio=2),
                tn.Inertia("wheel", node="turbine", inertia=1e4),
            ],
            operating_point={"speed": {"rotor": "3600 rpm"}},
        )
        assert plant.mean_speeds["turbine"] == pytest.approx(240 * np.pi)

    @pytest.mark.parametrize(
        ("changes", "what"),
        [
            (
                {"synchronising_coefficient": None},
                r"elements\.generator: .*missing-entry",
            ),
            ({"power": 0.5}, r"elements\.generator\.power: .*needless-entry"),
            ({"speed": "3500 rpm"}, r"elements\.generator\.speed: .*contradicting-values"),
            ({"speed": "3500 rpm", "grid_frequency": "60 Hz"}, r"elements\.generator\.speed: .*contradicting-values"),
            ({"grid": "rotor"}, "same-node"),
            (
                {"synchronising_coefficient": None, "emf": 1, "grid_voltage": 1, "reactance": 0.5, "power": 2},
                r"elements\.generator\.power: .*out-of-range",
            ),
        ],
    )
    def test_what_is_wrong_is_said(self, changes, what):
        with pytest.raises(tn.ModelError, match=what):
            generator(**changes)


class TestSynchronousMachine:
    @pytest.mark.parametrize("reluctance", [None, 120])
    @pytest.mark.parametrize("angle", [0, 20, 55])
    def test_stiffness_is_the_slope_of_its_torque(self, angle, reluctance):
        machine = synchronous(load_angle=f"{angle} deg", reluctance_torque=reluctance)

        def torque(turned):
            delta = mpmath.radians(angle) + 3 * turned
            return 500 * mpmath.sin(delta) + (reluctance or 0) * mpmath.sin(2 * delta)

        assert float(machine.parts(VALUES)[0].stiffness) == pytest.approx(float(mpmath.diff(torque, 0)), rel=1e-12)

    def test_torque_and_load_angle_say_the_same(self):
        by_torque, by_angle = synchronous(torque=300), synchronous(load_angle=float(np.arcsin(0.6)))
        stiffness = [float(machine.parts(VALUES)[0].stiffness) for machine in (by_torque, by_angle)]
        assert stiffness == pytest.approx([1200, 1200], rel=1e-14)

    def test_torque_may_be_a_parameter_with_exact_derivatives(self):
        rig = alone(synchronous(torque="T", inertia=2), parameters={"T": "300 N*m"})
        (mode,) = rig.modes().natural_frequencies
        assert mode == pytest.approx(np.sqrt(1200 / 2) / TWO_PI)
        (changed,) = rig.configured(T=400).modes().natural_frequencies
        assert changed == pytest.approx(np.sqrt(900 / 2) / TWO_PI)

    def test_pulls_on_a_stator_that_gives_way(self):
        rig = alone(synchronous(inertia=2, housing="stator"), tn.Inertia("stator", node="stator", inertia=6))
        assert rig.modes().natural_frequencies == pytest.approx([0, np.sqrt(1500 / 1.5) / TWO_PI])

    @pytest.mark.parametrize(
        ("changes", "what"),
        [
            ({"pull_out_torque": None}, r"elements\.motor: .*missing-entry"),
            ({"stiffness": 100}, r"elements\.motor\.pull_out_torque: .*needless-entry"),
            ({"pole_pairs": None}, r"elements\.motor: .*missing-entry"),
            ({"torque": 500}, "out-of-range"),
            ({"load_angle": "90 deg"}, "out-of-range"),
            ({"torque": 300, "load_angle": "20 deg"}, "contradicting-entries"),
            ({"load_angle": "delta"}, r"elements\.motor\.load_angle: .*expression-not-allowed"),
            ({"reluctance_torque": 100}, r"elements\.motor\.reluctance_torque: .*missing-entry"),
            ({"housing": "rotor"}, "same-node"),
        ],
    )
    def test_what_is_wrong_is_said(self, changes, what):
        with pytest.raises(tn.ModelError, match=what):
            synchronous(**changes)

    def test_a_load_angle_past_the_peak_has_no_stiffness(self):
        with pytest.raises(tn.ModelError, match=r"elements\.motor: .*negative-law"):
            alone(synchronous(load_angle="120 deg", reluctance_torque=50, inertia=1))


class TestInductionMachine:
    @pytest.mark.parametrize("slip", [-0.05, 0, 0.02, 0.1, 0.4])
    def test_damping_is_the_slope_of_its_torque(self, slip):
        def braking(speed):
            s = 1 - speed / 100
            return -800 * s * mpmath.mpf("0.1") / (s**2 + mpmath.mpf("0.01"))

        (law,) = induction(slip=slip).parts(VALUES)
        assert float(law.damping) == pytest.approx(float(mpmath.diff(braking, 100 * (1 - slip))), abs=1e-9)

    def test_rated_data_give_the_breakdown_slip(self):
        machine = induction(breakdown_slip=None, slip=None, rated_torque=160, rated_slip=0.02)
        breakdown = float(machine._breakdown_slip(VALUES))
        assert 800 / (0.02 / breakdown + breakdown / 0.02) == pytest.approx(160)
        assert breakdown > 0.02

    def test_torque_lags_behind_the_slip(self):
        """J tau s^2 + J s + c = 0, and the response of inertia and lag in closed form."""
        rig = alone(induction(time_constant=0.05, inertia=3), sensors={"w": {"velocity": "rotor"}})
        slope = 2 * 400 * 0.1 * (0.01 - 0.0004) / (100 * 0.0104**2)
        modes = rig.modes()
        expected = np.roots([3 * 0.05, 3, slope])
        assert modes.eigenvalues == pytest.approx([0, expected[expected.imag > 0][0]], rel=1e-12)
        f = np.array([0.2, 2.0, 20.0])
        s = 1j * TWO_PI * f
        found = rig.frequency_response("w", "T", f).values.ravel()
        assert found == pytest.approx(1 / (3 * s + slope / (1 + 0.05 * s)), rel=1e-12)

    def test_beyond_breakdown_it_drives(self):
        rig = alone(induction(slip=0.3, inertia=3))
        (pole,) = rig.modes().eigenvalues[rig.modes().eigenvalues != 0]
        slope = 80 * (0.01 - 0.09) / (100 * 0.1**2)
        assert pole == pytest.approx(-slope / 3)
        assert any("-6.4 N*m*s/rad" in fault.message for fault in rig.check())

    @pytest.mark.parametrize(
        ("changes", "what"),
        [
            ({"breakdown_slip": None}, r"elements\.motor: .*missing-entry"),
            ({"rated_slip": 0.02}, "contradicting-entries"),
            ({"slip": 0.2, "time_constant": 0.05}, r"elements\.motor\.time_constant: .*needless-entry"),
            (
                {"breakdown_slip": None, "rated_slip": 0.02, "rated_torque": 500},
                r"elements\.motor\.rated_torque: .*out-of-range",
            ),
            ({"housing": "rotor"}, "same-node"),
        ],
    )
    def test_what_is_wrong_is_said(self, changes, what):
        with pytest.raises(tn.ModelError, match=what):
            induction(**changes)


LOAD = tn.ConstantPowerLoad("load", node="b", power=4000, speed=20)
SHAFT = tn.Spring("shaft", nodes=("a", "b"), stiffness=900, damping=1)


def driven():
    return tn.Drivetrain(
        "driven",
        [tn.Inertia("motor", node="a", inertia=2), SHAFT, tn.Inertia("rotor", node="b", inertia=0.5), LOAD],
        inputs={"T": {"torque": "a"}},
        sensors={"w": {"velocity": "a"}},
    )


class TestConstantPowerLoad:
    def test_runs_away_alone(self):
        rig = alone(tn.ConstantPowerLoad("load", node="a", power=4000, speed=20), tn.Inertia("J", node="a", inertia=5))
        assert rig.modes().eigenvalues == pytest.approx([0, 4000 / 20**2 / 5])

    def test_shaft_vibrates_ever_more(self):
        M, C = np.diag([2, 0.5]), np.array([[1, -1], [-1, 1 - 10]])
        K = 900 * np.array([[1, -1], [-1, 1]])
        companion = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
        expected = np.linalg.eigvals(companion)
        modes = driven().modes()
        growing = modes.eigenvalues[modes.eigenvalues.imag > 0]
        assert growing == pytest.approx(expected[expected.imag > 0], rel=1e-12)
        assert growing.real > 0
        assert modes.damping_ratios[modes.eigenvalues.imag > 0] < 0

    def test_response_and_state_space(self):
        rig, f = driven(), np.array([0.5, 3.0, 9.0])
        s = 1j * TWO_PI * f
        expected = [
            np.linalg.solve([[2 * x**2 + x + 900, -x - 900], [-x - 900, 0.5 * x**2 - 9 * x + 900]], [1, 0])[0] * x
            for x in s
        ]
        assert rig.frequency_response("w", "T", f).values.ravel() == pytest.approx(expected, rel=1e-10)
        system = rig.to_control()
        assert [complex(system(x)) for x in s] == pytest.approx(expected, rel=1e-9)

    def test_power_given_back_damps(self):
        (law,) = tn.ConstantPowerLoad("load", node="a", power=-4000, speed=20).parts(VALUES)
        assert law.damping == 10

    def test_on_its_own_housing(self):
        with pytest.raises(tn.ModelError, match="give two different nodes"):
            tn.ConstantPowerLoad("load", node="a", housing="a", power=1, speed=1)

    def test_power_and_speed_may_be_parameters(self):
        load = tn.ConstantPowerLoad("load", node="a", power="P", speed="n")
        rig = alone(load, tn.Inertia("J", node="a", inertia=5), parameters={"P": "4 kW", "n": "20 rad/s"})
        assert rig.configured(n=40).modes().eigenvalues[1] == pytest.approx(4000 / 40**2 / 5)


def random_driven(seed, size):
    """A chain with negative dampers, some on nodes without inertia."""
    draw = np.random.default_rng(seed)
    parts = []
    for i in range(size):
        if i % 3:
            parts.append(tn.Inertia(f"J{i}", node=f"n{i}", inertia=float(draw.uniform(0.5, 2))))
        else:
            parts.append(tn.Damper(f"c{i}", nodes=(f"n{i}", "ground"), damping=float(draw.uniform(1, 3))))
        if i % 4 == 0:
            parts.append(tn.ConstantPowerLoad(f"p{i}", node=f"n{i}", power=float(draw.uniform(0.1, 0.9)), speed=1))
    springs = enumerate(draw.uniform(50, 100, size - 1).tolist())
    parts += [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=k) for i, k in springs]
    parts.append(tn.Spring("last", nodes=(f"n{size - 1}", "ground"), stiffness=70))
    return tn.Drivetrain("driven", parts)


@pytest.mark.parametrize("seed", range(4))
def test_modes_with_negative_dampers_are_those_of_the_pencil(seed):
    rig = random_driven(seed, 9)
    system = rig.assembly.system
    n, zero = system.n_coordinates, np.zeros((system.n_coordinates,) * 2)
    values = scipy.linalg.eigvals(
        np.block([[zero, np.eye(n)], [-system.K, -system.C]]), np.block([[np.eye(n), zero], [zero, system.M]])
    )
    values = values[np.isfinite(values) & (np.abs(values) < 1e6)]
    expected = values[values.imag > 1e-9 * np.abs(values)]
    found = rig.modes().eigenvalues
    found = found[found.imag > 0]
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(expected), rel=1e-9)


def test_a_load_of_constant_power_beside_a_tabulated_spring():
    """The spring's table is a constant, so that the modes are those of a plain one."""

    def eigenvalues(spring):
        parts = [tn.Inertia("motor", node="a", inertia=2), spring, tn.Inertia("rotor", node="b", inertia=0.5), LOAD]
        return tn.Drivetrain("driven", parts).modes().eigenvalues

    table = tn.TabulatedSpring("shaft", nodes=("a", "b"), table=[[0.1, 900, 0], [99, 900, 0]])
    found, plain = eigenvalues(table), eigenvalues(tn.Spring("shaft", nodes=("a", "b"), stiffness=900))
    assert found[found.imag > 0] == pytest.approx(plain[plain.imag > 0], rel=1e-6)
    assert plain[plain.imag > 0].real > 0


@pytest.mark.slow
def test_few_modes_of_a_large_driven_system():
    rig = random_driven(1, 150)
    every, few = rig.modes().eigenvalues, rig.modes(lowest=6).eigenvalues
    assert few == pytest.approx(every[:6], rel=1e-9)
    assert every.real.max() > 0


def test_dampers_that_cancel_on_a_massless_node_are_refused():
    parts = [
        tn.Inertia("J", node="a", inertia=1),
        tn.Spring("k", nodes=("a", "b"), stiffness=10),
        tn.Damper("c", nodes=("b", "ground"), damping=2),
        tn.ConstantPowerLoad("p", node="b", power=2, speed=1),
    ]
    with pytest.raises(tn.SolveError, match="indeterminate-motion"):
        tn.Drivetrain("cancelled", parts).modes()
