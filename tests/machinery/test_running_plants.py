"""Plants of the library that run: numbers by hand, by closed forms, or from a dense solution made elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from support.forced_plants import plant as forced_plant
from support.forced_plants import reference

import torsionnet as tn
from torsionnet.model.elements import Values
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.model.speeds import total_ratio
from torsionnet.report.report import make_report

RPM = 30 / np.pi


def swept(engine):
    """Volume in m^3 that one piston sweeps."""
    return np.pi / 4 * engine.bore**2 * engine.stroke


def mean_indicated_pressure(engine, kind):
    """In Pa by the work p dV of the trace, summed with trapezoids over the volume."""
    p = np.array(getattr(engine.gas, kind).values)
    phi = np.linspace(0, engine.cycle * np.pi, len(p) + 1)
    r, rod = engine.stroke / 2, engine.rod_length
    volume = np.pi / 4 * engine.bore**2 * (r * (1 - np.cos(phi)) + rod - np.sqrt(rod**2 - (r * np.sin(phi)) ** 2))
    closed = np.append(p, p[0])
    return float(((closed[1:] + closed[:-1]) / 2 * np.diff(volume)).sum()) / swept(engine)


def gas_harmonic(engine, kind, order):
    """Complex torque of one cylinder in N m, from the samples of its trace."""
    p = np.array(getattr(engine.gas, kind).values) - engine.gas.crankcase
    phi = engine.cycle * np.pi * np.arange(len(p)) / len(p)
    ratio = engine.stroke / 2 / engine.rod_length
    lever = np.sin(phi) + ratio * np.sin(phi) * np.cos(phi) / np.sqrt(1 - (ratio * np.sin(phi)) ** 2)
    torque = p * np.pi / 4 * engine.bore**2 * engine.stroke / 2 * lever
    return 2 * np.mean(torque * np.exp(-1j * order * phi))


def engine_of(name):
    return next(one for one in tn.load(name).definition.excitations.values() if one.kind == "reciprocating_engine")


def pole_frequencies(plant):
    """|lambda|/2 pi in Hz of every vibration."""
    modes = plant.modes()
    return np.unique(np.round(np.abs(modes.eigenvalues[modes.eigenvalues.imag > 0]) / (2 * np.pi), 6))


def worst_speed(run, order, output):
    """Speed in r/min at which one order is largest."""
    return run.rpm[np.argmax(np.abs(run.of_order(order, output)))]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "power", "rpm", "efficiency", "cylinders"),
    [
        ("marine_medium_speed", 3000e3, 750, 0.92, 6),
        ("engine_generator_set", 1200e3, 900, 0.90, 6),
        ("front_wheel_drive_car", 200 * 1500 / RPM, 1500, 0.88, 4),
    ],
)
def test_pressure_traces_make_the_power(name, power, rpm, efficiency, cylinders):
    """Mean indicated pressure of a four-stroke engine: p = P/(eta z V n/2)."""
    engine = engine_of(name)
    wanted = power / (efficiency * cylinders * swept(engine) * rpm / 120)
    assert mean_indicated_pressure(engine, "fired") == pytest.approx(wanted, rel=0.02)  # trapezoids of 5 degrees
    assert 0 <= mean_indicated_pressure(engine, "motored") < 0.05 * wanted


class TestMarine:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("marine_medium_speed").configured("water=wet")

    @pytest.mark.slow
    def test_undamped_and_damped_frequency_of_the_crankshaft(self, plant):
        """The film holds the ring: 38.75 Hz, order 3 at 775 r/min, is in truth 26.49 Hz, 530 r/min."""
        undamped = plant.modes().undamped_natural_frequencies
        np.testing.assert_allclose(undamped[[1, 2, 4]], [3.52, 10.55, 38.75], atol=6e-3)
        assert undamped[4] * 60 / 3 == pytest.approx(775, abs=0.1)
        assert np.abs(pole_frequencies(plant) - 26.49).min() < 0.005
        assert pole_frequencies(plant)[np.abs(pole_frequencies(plant) - 26.49).argmin()] * 20 == pytest.approx(
            530, abs=0.2
        )

    def test_torque_of_the_crankshaft_by_equal_cylinders(self, plant):
        """Third order with the same torque on all throws in phase: largest at 521 r/min."""
        rpm = np.arange(450, 651)
        response = plant.frequency_response("T_crank", [f"cyl{number}.T" for number in range(1, 7)], rpm * 3 / 60)
        assert rpm[np.abs(response.values[:, 0].sum(axis=1)).argmax()] == pytest.approx(521, abs=1)

    def test_lowest_modes_meet_half_orders(self, plant):
        low = plant.modes().undamped_natural_frequencies
        assert low[1] * 60 / 0.5 == pytest.approx(423, abs=1)
        assert low[2] * 60 / 1.5 == pytest.approx(422, abs=1)

    def test_misfire_brings_order_one_half(self, plant):
        normal, misfire = (plant.configured(f"firing={name}").order_response("T_cpl") for name in ("normal", "misfire"))
        half = [np.abs(run.of_order(0.5, "T_cpl")).max() for run in (normal, misfire)]
        assert half[1] > 20 * half[0]
        assert worst_speed(misfire, 0.5, "T_cpl") == pytest.approx(423, abs=15)

    def test_mean_torque_and_stress_of_the_tail_shaft(self, plant):
        """188.7 kN m by P/omega, 23.4 N/mm^2 by 16 T/(pi d^3)."""
        found = plant.mean_response(["T_tail", "stress(prop_shaft)"], speeds=[750 / RPM])
        torque = 3000e3 / (750 / 4.94 / RPM)
        assert torque == pytest.approx(188.7e3, rel=1e-3)
        np.testing.assert_allclose(np.abs(found.values[0]), [torque, 16 * torque / (np.pi * 0.345**3)], rtol=1e-3)
        assert abs(found.values[0, 1]) / 1e6 == pytest.approx(23.4, abs=0.05)

    def test_damping_of_the_propeller_is_archers(self, plant):
        """c = a Q/n, a = 30, n in r/min, Q over n squared: half of it at half the speed."""
        for share in (1, 0.5):
            point = OperatingPoint(speed={"fly": f"{750 * share} rpm"})
            there = tn.Drivetrain.from_definition(replace(plant.definition, operating_point=point))
            (law,) = there.elements["propeller"].parts(Values(there.exact_values))
            assert float(law.damping) == pytest.approx(share * 30 * 188.7e3 / 151.8, rel=1e-3)


class TestTwoStroke:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("two_stroke_ship")

    def test_natural_frequencies(self, plant):
        """Those of the plant of the validation page; the intermediate shaft and the tail by their geometry."""
        expected = reference("forced_two_stroke_propulsion")["undamped_natural_frequencies_hz"]
        np.testing.assert_allclose(plant.modes().undamped_natural_frequencies, expected, rtol=5e-5, atol=1e-9)

    @pytest.mark.parametrize(("configuration", "key"), [("normal", None), ("misfire_2", "motored")])
    def test_half_ranges(self, plant, configuration, key):
        """Against the dense solution, whose traces have steps of one degree: a percent at most.

        That has the damping of full power at all speeds.
        """
        data = reference("forced_two_stroke_propulsion")
        full = plant.configured(configuration, Q_prop="1280 kN*m", n_prop="105 rpm")
        run = full.order_response(["T_int", "T_tail"])
        for case in data["misfire"][key] if key else data["normal"]:
            at = np.argmin(np.abs(run.rpm - case["rpm"]))
            expected = [case["half_range"][name] for name in ("intermediate", "tail")]
            np.testing.assert_allclose(run.half_range[at], expected, rtol=5e-3)

    def test_damping_of_the_propeller_follows_its_speed(self, plant):
        """29.0 N/mm^2 at 52 r/min; 16.5 by the damping of full power, which held at all speeds before.

        The plant of the dense solution, given by hand the damping a Q/n of this speed, has the same.
        """
        data = reference("forced_two_stroke_propulsion")
        data["normal"] = [{"rpm": 52}]
        (screw,) = (node for node in data["model"]["nodes"] if node["name"] == "propeller")
        at_full_power, found = screw["damping_to_ground"], []
        for damping in (at_full_power, at_full_power * 52 / 105):
            screw["damping_to_ground"] = damping
            half_range = forced_plant(data).order_response("torque(intermediate)").half_range[0, 0]
            found.append(16 * half_range / (np.pi * 0.48**3) / 1e6)
        assert found == pytest.approx([16.5, 29.0], abs=0.1)
        stress = plant.order_response("stress(intermediate)", speeds=[52 / RPM]).half_range[0, 0] / 1e6
        assert stress == pytest.approx(found[1], rel=5e-3)  # traces of four degrees, and of one

    def test_order_six_is_at_52(self, plant):
        run = plant.order_response("T_int")
        assert worst_speed(run, 6, "T_int") == pytest.approx(5.2121 * 60 / 6, abs=1)


class TestBulkCarrier:
    """Nine inertias in a row, with the matrices written down here."""

    G, DENSITY = 79.3e9, 7850.0
    SHAFTS = ((0.44, 6.0), (0.5, 5.0))

    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("bulk_carrier").configured("normal")

    def matrices(self, rpm):
        """Inertia, damping and stiffness (9, 9) at a speed; half the inertia of each shaft at either end."""
        polar = np.array([np.pi * d**4 / 32 for d, _ in self.SHAFTS])
        lengths = np.array([length for _, length in self.SHAFTS])
        of_shafts = self.DENSITY * polar * lengths
        inertia = np.array([9500.0] * 6 + [12000, 0, 52000])
        inertia[6:8] += of_shafts / 2
        inertia[7:9] += of_shafts / 2
        k = np.array([900e6] * 5 + [1.1e9, *(self.G * polar / lengths)])
        c = np.array([300e3] * 6 + [*(2 * 0.008 * k[6:] / (2 * np.pi * 5))])
        shape = np.eye(8, 9) - np.eye(8, 9, 1)
        water = 30 * 7e6 / (105 / RPM) * (rpm / 105) ** 2 / rpm
        damping = shape.T @ np.diag(c) @ shape
        damping[8, 8] += water
        return np.diag(inertia), damping, shape.T @ np.diag(k) @ shape

    def test_natural_frequencies(self, plant):
        inertia, _, stiffness = self.matrices(105)
        expected = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(inertia, stiffness)))) / (2 * np.pi)
        found = plant.modes().undamped_natural_frequencies
        assert found[1:4] == pytest.approx(np.sort(expected)[1:4], rel=2e-3)
        assert found[1] * 60 / 6 == pytest.approx(51, abs=0.5)

    def test_order_six_in_the_intermediate_shaft(self, plant):
        """All cylinders are in phase then. The reciprocating mass, some 1 % at order 6, is left out here."""
        engine = engine_of("bulk_carrier")
        run = plant.order_response("T_int")
        k, c = self.G * np.pi * 0.44**4 / 32 / 6, 2 * 0.008 / (2 * np.pi * 5)
        expected = []
        for rpm in run.rpm:
            inertia, damping, stiffness = self.matrices(rpm)
            omega = 6 * rpm / RPM
            torque = (rpm / 105) ** 2 * gas_harmonic(engine, "fired", 6)
            load = np.array([torque] * 6 + [0] * 3)
            angle = np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * inertia, load)
            expected.append(abs(k * (1 + 1j * omega * c) * (angle[6] - angle[7])))
        found = np.abs(run.of_order(6, "T_int"))
        assert found.max() == pytest.approx(max(expected), rel=0.03)
        assert run.rpm[np.argmax(found)] == pytest.approx(run.rpm[np.argmax(expected)], abs=0.3)

    def test_it_lies_between_what_it_may_be_in_operation_and_in_passing(self, plant):
        found = {(one.limit, one.criterion): one for one in plant.check_limits().verdicts}
        tau_c, tau_t = (found["intermediate", name] for name in ("tau_C", "tau_T"))
        assert (tau_c.verdict, tau_t.verdict) == ("barred range", "pass")
        assert tau_c.values.max() / 1e6 == pytest.approx(68.5, abs=0.2)
        at = int(np.argmax(tau_c.values))
        # (560 + 160)/18 (0.35 + 0.93 440^-0.2) (3 - 2 (51/105)^2), and 1.7 times that
        allowed = 40 * (0.35 + 0.93 * 440**-0.2) * (3 - 2 * (51.07 / 105) ** 2)
        assert tau_c.allowed[at] / 1e6 == pytest.approx(allowed, rel=1e-3)
        assert tau_t.allowed[at] / 1e6 == pytest.approx(1.7 * allowed, rel=1e-3)
        assert tau_c.barred[0].high < 0.8 * 105 / RPM


class TestCar:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("front_wheel_drive_car").configured("gear=III")

    @pytest.mark.slow
    def test_order_two_meets_the_dual_mass_flywheel(self, plant):
        """|lambda|/2 pi 23.59 Hz is 708 r/min, 20.86 Hz undamped is 626; the twist is largest at 704 to 706."""
        assert np.abs(pole_frequencies(plant) - 23.59).min() < 0.005
        assert np.abs(plant.modes().undamped_natural_frequencies - 20.86).min() < 0.005
        assert 23.59 * 30 == pytest.approx(708, abs=0.5)
        run = plant.order_response("tw_dmf")
        assert 703 <= worst_speed(run, 2, "tw_dmf") <= 707

    def test_four_cylinders_on_one_node_leave_even_orders(self, plant):
        run = plant.order_response("tw_dmf")
        largest = {line.order: np.abs(run.of_order(line.order, "tw_dmf")).max() for line in run.lines}
        assert max(size for order, size in largest.items() if order % 2) < 1e-9 * largest[2]

    def test_ratio_of_a_gear(self, plant):
        """Twice engaged, twice turned around: gear III by 3.45."""
        assert float(total_ratio(plant.definition, plant.exact_values, "prim", "cage")) == pytest.approx(1.257 * 3.45)


class TestGeneratingSet:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("engine_generator_set")

    def test_mode_of_the_coupling(self, plant):
        """Two masses, all of the engine and all of the generator, on the coupling; its film is soft there."""
        engine, generator = 6 * 4.2 + 58 + 1.6, 96 + 2.4
        two_masses = np.sqrt(62e3 * (1 / engine + 1 / generator)) / (2 * np.pi)
        assert plant.modes().undamped_natural_frequencies[2] == pytest.approx(two_masses, rel=5e-3)

    def test_misfire_shakes_two_masses(self, plant):
        """Order 1/2 of the gas that is missing, on the engine as one mass, through the coupling to the generator."""
        engine, omega = plant.definition.excitations["engine"], 900 / RPM / 2
        missing = gas_harmonic(engine, "fired", 0.5) - gas_harmonic(engine, "motored", 0.5)
        driving, driven, k = 6 * 4.2 + 58 + 1.6 + 7.5, 96 + 2.4, 62e3 * (1 + 1j * 1.0 / (2 * np.pi))
        reduced = driving * driven / (driving + driven)
        expected = abs(missing * driven / (driving + driven) * k / (k - omega**2 * reduced))
        run = plant.configured("firing=misfire").order_response("T_cpl", speeds=[900 / RPM])
        assert abs(run.of_order(0.5, "T_cpl")[0]) == pytest.approx(expected, rel=0.05)

    def test_load_comes_at_rated_speed(self, plant):
        found = plant.mean_response("T_cpl", speeds=np.array([600, 900]) / RPM)
        np.testing.assert_allclose(np.abs(found.values[:, 0]), [0, 12.73e3], rtol=1e-6, atol=1e-6)
        assert 12.73e3 * 900 / RPM == pytest.approx(1200e3, rel=1e-3)


class TestCompressor:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("reciprocating_compressor_train")

    def test_indicated_power_is_the_load(self, plant):
        """Work of the net trace of four cylinders a turn, against the torque that the load takes."""
        engine = plant.definition.excitations["compressor"]
        work = -4 * mean_indicated_pressure(engine, "fired") * swept(engine)
        taken = sum(one.torque for one in plant.definition.load.by_place.values())
        assert work / (2 * np.pi) == pytest.approx(taken, rel=0.01)

    def test_ideal_work_of_one_end(self, plant):
        """n/(n - 1) p_s (V_1 - V_4)((p_d/p_s)^((n - 1)/n) - 1) with clearance 14 %, n = 1.28, both ends."""
        engine = plant.definition.excitations["compressor"]
        n, ratio = 1.28, 11 / 4
        taken_in = swept(engine) * (1.14 - 0.14 * ratio ** (1 / n))
        ideal = n / (n - 1) * 4e5 * taken_in * (ratio ** ((n - 1) / n) - 1) * 1.96
        assert -mean_indicated_pressure(engine, "fired") * swept(engine) == pytest.approx(ideal, rel=0.01)

    def test_orders_that_opposed_throws_cancel(self, plant):
        """Top dead centres a quarter of a turn apart: of a stiff crankshaft only every fourth order is left."""
        engine = plant.definition.excitations["compressor"]
        sums = np.abs(engine.torques(np.array([50.0])).amplitudes[0].sum(axis=1))
        assert (sums[engine.acting_orders % 4 != 0] < 1e-9 * sums.max()).all()

    @pytest.mark.slow
    def test_a_lost_head_end_meets_the_coupling_with_order_two(self, plant):
        low = plant.modes().undamped_natural_frequencies[1]
        run = plant.configured("one_head_end_lost").order_response("T_cpl")
        assert worst_speed(run, 2, "T_cpl") == pytest.approx(low * 60 / 2 * 2.96, rel=0.01)
        full = plant.configured("full").order_response("T_cpl")
        assert run.half_range.max() > 2 * full.half_range.max()


class TestWindTurbine:
    @pytest.fixture(scope="class")
    @staticmethod
    def plant():
        return tn.load("wind_turbine_3mw")

    def test_ratio_through_a_housing_on_springs(self, plant):
        """(1 + 99/21)(1 + 94/20)(97/29): orders of the generator are 109 times as many of the rotor."""
        run = plant.order_response("T_hs", speeds=[1.2], excitation=["generator"])
        ratio = (1 + 99 / 21) * (1 + 94 / 20) * 97 / 29
        assert sorted(float(line.relative) for line in run.lines) == pytest.approx([2 * ratio, 12 * ratio])

    def test_a_rotor_locked_by_its_brake_has_no_orders(self, plant):
        """With the brake on, the rotor could turn with the housing alone, which stands on torque arms."""
        locked = plant.configured("locked")
        message = "no-effect"
        with pytest.raises(tn.UsageError, match=message):
            locked.order_response("T_ms", speeds=[1.2])
        with pytest.raises(tn.UsageError, match=message):
            locked.critical_speeds()
        # Its ratios and mean speeds are those of the turbine that runs, and the housing stands still.
        assert locked.ratio_between("gen", "hub") == plant.ratio_between("gen", "hub")
        assert locked.mean_speeds == plant.mean_speeds
        assert "hous" not in locked.mean_speeds

    def test_reports_leave_a_locked_rotor_out_of_orders_and_say_so(self, plant):
        (section,) = make_report(plant, sections=["critical_speeds"], date=None).sections
        lead = "".join(map(str, section.blocks[0].text))
        assert lead.endswith(" Not in locked generator: hub is locked by brake on there and has no orders.")

    @pytest.mark.slow
    def test_weight_of_three_blades_does_not_reach_the_shaft(self, plant):
        run = plant.order_response(
            ["T_ms", "torque(blade1.edge)"], speeds=[1.2], excitation=["weight_A", "weight_B", "weight_C"]
        )
        assert abs(run.of_order(1, "T_ms")[0]) < 1e-6 * abs(run.of_order(1, "torque(blade1.edge)")[0])

    def test_three_times_a_turn(self, plant):
        """Ninth order meets the first vibration of rotor against generator."""
        run = plant.order_response("T_ms", excitation=["tower"])
        first = plant.modes().damped_frequencies
        near = first[np.abs(first - 1.685).argmin()]
        assert worst_speed(run, 9, "T_ms") == pytest.approx(near * 60 / 9, abs=0.05)

    def test_teeth_meet_at_their_frequency(self, plant):
        """29 times the pinion is 97 times the wheel."""
        run = plant.order_response("T_hs", speeds=[1.2], excitation=["teeth_pinion", "teeth_wheel"])
        pinion, wheel = (
            sorted(line.relative for line in run.lines if line.excitation == name)
            for name in ("teeth_pinion", "teeth_wheel")
        )
        assert pinion == pytest.approx(wheel, rel=1e-12)
