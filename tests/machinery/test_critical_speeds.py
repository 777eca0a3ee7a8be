"""Critical speeds: against closed forms, the numbers of two plants, and what a user may ask wrongly."""

import csv
import itertools
import math
import re

import numpy as np
import pytest
from support.command_line import run
from support.running_plants import INLINE_SIX, PRESSURE, car, engine, marine, two_mass

import torsionnet as tn
from torsionnet.linear.modes.mode_pairs import amplification
from torsionnet.linear.sensitivity import mode_sensitivities
from torsionnet.machinery.criticals.speed_peaks import SAME_PEAK
from torsionnet.machinery.orders.vector_sums import StarDiagram, star_diagram
from torsionnet.machinery.verdicts.margin_rules import PRESETS, MarginClause, MarginRule, margin_rule
from torsionnet.study.quantities.natural_frequency import NaturalFrequency
from torsionnet.study.quantities.quantity import VariantBlock

RPM = np.pi / 30
RIGID = dict.fromkeys(("c1", "c2", "c3", "c4", "c5", "c6"), 1.0)
BENT = dict(zip(RIGID, (1, 0.9, 0.7, 0.45, 0.15, -0.1), strict=True))


@pytest.fixture(scope="module")
def cylinders():
    """The marine plant with one torque on every cylinder."""
    orders = {order: {"amplitude": 1000} for order in (0.5, 1.5, 3)}
    return marine({f"cyl{n}": {"type": "harmonic", "node": f"c{n}", "orders": orders} for n in range(1, 7)})


class TestPhaseVectorSums:
    """Four-stroke inline six 1-5-3-6-2-4."""

    @pytest.mark.parametrize("order", np.arange(0.5, 12.5, 0.5))
    def test_rigid_shape(self, order):
        star = star_diagram(engine(), "engine", order, RIGID)
        assert abs(star.sum) == pytest.approx(6 if order % 3 == 0 else 0, abs=1e-12)

    @pytest.mark.parametrize("order", np.arange(0.5, 12.5, 0.5))
    def test_one_cylinder_out(self, order):
        star = star_diagram(engine(gas_off=[3]), "engine", order, RIGID)
        assert abs(star.sum) == pytest.approx(5 if order % 3 == 0 else 1, abs=1e-12)

    @pytest.mark.parametrize(("order", "total"), [(0.5, 0.7399), (1.5, 2.1), (3, 3.1)])
    def test_bent_shape(self, order, total):
        assert abs(star_diagram(engine(), "engine", order, BENT).sum) == pytest.approx(total, abs=5e-5)

    def test_lengths_are_relative_to_the_largest_amplitude(self):
        star = star_diagram(engine(), "engine", 3, {node: 0.2 * angle for node, angle in BENT.items()})
        assert np.abs(star.vectors) == pytest.approx(np.abs(list(BENT.values())))
        assert [row[0] for row in star.table().rows] == ["1", "2", "3", "4", "5", "6", "sum"]

    def test_lengths_and_phases_of_the_table(self):
        """Of 1, 2j and 0 the sum is 1 + 2j; a vector of no length has no phase, nor has a sum of none."""
        star = StarDiagram("engine", 1.0, ("1", "2", "3"), ("a", "b", "c"), np.array([1, 2j, 0]))
        lengths, phases = zip(*(row[2:] for row in star.table().rows), strict=True)
        assert lengths == pytest.approx([1, 2, 0, np.sqrt(5)])
        assert phases == (0, pytest.approx(90), None, pytest.approx(np.degrees(np.arctan(2))))
        against = StarDiagram("engine", 1.0, ("1", "2"), ("a", "b"), np.array([1j, -1j]))
        assert [row[2:] for row in against.table().rows] == [(1, 90), (1, -90), (0, None)]


class TestMarginRules:
    @pytest.mark.parametrize("name", ["api610", "api617", "api684"])
    @pytest.mark.parametrize("order", [0, 0.5, 1, 7, 24])
    def test_ten_percent_of_everything(self, name, order):
        assert margin_rule(name).required(order) == 0.10

    def test_reciprocating_compressors(self):
        rule = margin_rule("api618")
        assert [rule.required(order) for order in (1, 2, 10, 11, 1.5)] == [0.10, 0.05, 0.05, None, None]

    def test_line_frequency_only(self):
        assert [margin_rule("line_frequency").required(order) for order in (0, 1)] == [0.10, None]

    @pytest.mark.parametrize("given", ["12 %", "12%", "0.12", 0.12])
    def test_own_share(self, given):
        assert margin_rule(given).required(3.5) == pytest.approx(0.12)

    def test_every_preset_names_its_source(self):
        assert all("edition" in rule.source for name, rule in PRESETS.items() if name.startswith("api"))

    @pytest.mark.parametrize(
        ("given", "kind"),
        [
            ("api648", "unknown-word"),
            ("ten", "unknown-word"),
            ("110 %", "out-of-range"),
            (0, "out-of-range"),
            (math.nan, "out-of-range"),
        ],
    )
    def test_others_are_refused(self, given, kind):
        with pytest.raises(tn.UsageError, match=kind):
            margin_rule(given)


class TestAmplification:
    def test_as_in_the_literature_on_api_617(self):
        """Wang, Feese and Pettinato 2012 tabulate it: 10 % margin gives about 5."""
        assert amplification(0.9, 0.01) == pytest.approx(5.24, abs=0.005)
        assert amplification(1, 0.05) == pytest.approx(10)
        assert amplification(1, 0) == math.inf

    def test_at_resonance(self):
        found = two_mass(damping=2.0).critical_speeds().modes[0]
        assert found.amplification == pytest.approx(1 / (2 * found.damping_ratio))
        assert two_mass(damping=0.0).critical_speeds().modes[0].amplification == math.inf


class TestTwoMasses:
    """Shaft k between J_a = 2 and J_b = 1 in which an order h acts on b: one degree of freedom for the twist."""

    J, K = 2 / 3, 1e4

    def test_speed_margin_and_force(self):
        found = two_mass(damping=0.0).critical_speeds(margin="api684").of(1, 2)
        omega = math.sqrt(self.K / self.J)
        assert found.undamped_speed == pytest.approx(omega / 2)
        assert found.natural_speed == pytest.approx(omega / 2)
        assert (found.margin, found.passes) == (0, False)
        assert found.generalised_force == pytest.approx(10)  # b moves most, and there the torque acts

    @pytest.mark.parametrize(
        ("speeds", "margin"), [((300, 500), 584.773 / 500 - 1), ((620, 700), 1 - 584.773 / 620), ((500, 700), 0)]
    )
    def test_margin_is_over_the_excitation_frequency(self, speeds, margin):
        found = two_mass(damping=0.0).critical_speeds(speeds=np.array(speeds) * RPM).of(1, 2)
        assert found.margin == pytest.approx(margin, abs=2e-5)

    @pytest.mark.parametrize("zeta", [0.002, 0.02, 0.1, 0.3])
    def test_actual_peak_is_that_of_one_degree_of_freedom(self, zeta):
        """Largest at omega sqrt(1 - 2 zeta^2), neither undamped nor damped, by 1/(2 zeta sqrt(1 - zeta^2))."""
        omega = math.sqrt(self.K / self.J)
        plant = two_mass(damping=2 * zeta * math.sqrt(self.K * self.J))
        found = plant.critical_speeds("twist(shaft)").of(1, 2)
        (peak,) = found.peaks
        assert peak.speed == pytest.approx(omega * math.sqrt(1 - 2 * zeta**2) / 2, rel=2e-4)
        static = 10 * (2 / 3) / self.K
        assert peak.amplitude == pytest.approx(static / (2 * zeta * math.sqrt(1 - zeta**2)), rel=1e-5)
        assert found.damped_speed == pytest.approx(omega * math.sqrt(1 - zeta**2) / 2)

    def test_too_much_damping_leaves_no_critical_speed(self):
        plant = two_mass(damping=3 * math.sqrt(self.K * self.J))
        found = plant.critical_speeds("twist(shaft)").of(1, 2)
        assert math.isnan(found.natural_speed)
        assert found.undamped_speed == pytest.approx(math.sqrt(self.K / self.J) / 2)
        assert found.peaks == ()
        assert "overdamped" in found.remark

    def test_line_frequency_has_no_speed_but_a_margin(self):
        found = two_mass(damping=0.0).critical_speeds(line_frequency=18, margin="line_frequency", reach=0.5)
        first = next(one for one in found.crossings if one.fixed == 18)
        natural = math.sqrt(self.K / self.J) / (2 * np.pi)
        assert math.isnan(first.undamped_speed)
        assert first.margin == pytest.approx(natural / 18 - 1)
        assert (first.required, first.passes, first.excited) == (0.1, False, None)
        assert found.of(1, 2).passes is None  # this rule is about the line only

    @pytest.mark.parametrize("frequency", [17.0, 22.0])
    def test_torque_at_a_fixed_frequency(self, frequency):
        line = {"frequency": f"{frequency} Hz", "multiples": {1: {"amplitude": 5}}}
        found = with_machine(line=line).critical_speeds(reach=0.3).of(1, 0)
        natural = math.sqrt(self.K / self.J) / (2 * np.pi)
        assert math.isnan(found.undamped_speed)
        assert found.margin == pytest.approx(abs(natural / frequency - 1))
        assert found.generalised_force == pytest.approx(5)
        assert found.excited
        assert found.line == f"{frequency:g} Hz"

    def test_slip_of_a_starting_motor_meets_a_mode_twice(self):
        """Twice the slip frequency is |2 (50 Hz - 2 n)|: 19.49 Hz at 1500 (1 -+ 19.49/100) r/min."""
        slip = {"frequency": "50 Hz", "amplitude": [["0 rpm", 60], ["3000 rpm", 60]]}
        plant = with_machine(slip=slip, pole_pairs=2)
        natural = math.sqrt(self.K / self.J) / (2 * np.pi)
        below = plant.critical_speeds(speeds=np.array([800, 1400]) * RPM).of(1, -4)
        assert below.undamped_speed / RPM == pytest.approx(1500 * (1 - natural / 100))
        assert below.margin == 0
        both = plant.critical_speeds(speeds=np.array([1300, 1450]) * RPM)
        meant = [1500 * (1 + sign * natural / 100) for sign in (-1, 1)]
        assert [one.undamped_speed / RPM for one in both.crossings] == pytest.approx(meant)
        assert both.of(1, -4, near=1800 * RPM).undamped_speed / RPM == pytest.approx(meant[1])
        with pytest.raises(tn.UsageError, match=r"(?s)1207\.6.*1792\.4.*ambiguous-name"):
            both.of(1, -4)
        assert [one.margin for one in both.crossings] == [pytest.approx(natural / (100 - 4 * 1300 / 60) - 1)] * 2

    def test_cranks_that_turn_against_each_other_add_up(self):
        """Both cylinders fire at once and drive their own crank: twice the torque, although one angle is negative."""
        twin = {**INLINE_SIX, "speed_of": "left", "cylinders": {1: "left", 2: "right"},
                "firing_angles": {1: "0 deg", 2: "0 deg"}, "orders": [2]}  # fmt: skip
        del twin["firing_order"]
        elements = [
            tn.Inertia("J_l", node="left", inertia=20), tn.Gear("timing", nodes=("left", "right"), ratio=-1),
            tn.Inertia("J_r", node="right", inertia=20), tn.Spring("k", nodes=("left", "load"), stiffness=1e5),
            tn.Inertia("J", node="load", inertia=9),
        ]  # fmt: skip
        plant = tn.Drivetrain("twin", elements, speeds={"of": "left", "list": [40, 80]}, excitations={"engine": twin})
        found = plant.critical_speeds(reach=0.5).of(1, 2)
        assert found.star.sum == pytest.approx(-2, abs=1e-12) or found.star.sum == pytest.approx(2, abs=1e-12)
        assert found.excited

    def test_stator_takes_the_opposite_torque_whichever_way_the_rotor_turns(self):
        """The rotor turns against the reference shaft: what acts is the torque times the angle between the two."""
        elements = [
            tn.Inertia("J_r", node="rotor", inertia=1), tn.Spring("k", nodes=("rotor", "pinion"), stiffness=5e3),
            tn.Gear("stage", nodes=("pinion", "wheel"), ratio=-1), tn.Inertia("J_w", node="wheel", inertia=2),
            tn.Inertia("J_s", node="stator", inertia=3), tn.Spring("feet", nodes=("stator", "ground"), stiffness=9e3),
            tn.Spring("field", nodes=("rotor", "stator"), stiffness=2e3),
        ]  # fmt: skip
        machine = {"type": "electric_machine", "node": "rotor", "stator": "stator", "orders": {6: {"amplitude": 7}}}
        plant = tn.Drivetrain("motor on feet", elements, speeds={"of": "wheel", "list": [5, 20]},
                              excitations={"motor": machine})  # fmt: skip
        found = plant.critical_speeds(reach=0.5)
        assert found.crossings
        for one in found.crossings:
            shape = found.shape(one.mode.number)
            assert one.generalised_force == pytest.approx(7 * abs(shape["rotor"] - shape["stator"]))

    def test_an_imposed_motion_has_no_generalised_force_but_a_peak(self):
        wobble = {"type": "harmonic", "node": "a", "orders": {2: {"angle": 0.01}}}
        plant = two_mass(damping=4.0)
        shaken = tn.Drivetrain("shaken", plant.elements.values(), excitations={"wobble": wobble},
                               speeds={"of": "a", "list": ["400 rpm", "700 rpm"]})  # fmt: skip
        found = shaken.critical_speeds("twist(shaft)")
        assert [one.excited for one in found.crossings] == [True]
        assert math.isnan(found.of(1, 2).generalised_force)
        # The node whose angle is given stands still in the vibration: 1 kg m^2 on 10 kN m/rad.
        assert found.of(1, 2).undamped_speed == pytest.approx(100 / 2)
        assert found.of(1, 2).peaks[0].speed == pytest.approx(50, rel=0.01)
        assert "-" in found.table().to_text()

    def test_orders_count_on_their_own_shaft(self):
        plant = tn.Drivetrain(
            "geared",
            [tn.Inertia("motor", node="m", inertia=1), tn.Spring("shaft", nodes=("m", "p"), stiffness=2e3),
             tn.Gear("stage", nodes=("p", "w"), ratio=-4), tn.Inertia("mill", node="w", inertia=16)],
            speeds={"of": "m", "range": "300..700 rpm", "step": "10 rpm"},
            excitations={"mill": {"type": "harmonic", "node": "w", "orders": {5: {"amplitude": 8}}}},
        )  # fmt: skip
        found = plant.critical_speeds().of(1, 5)
        natural = math.sqrt(2e3 * 2)  # two masses of 1 kg m^2, referred to the motor
        assert found.own_speed == pytest.approx(natural / 5)
        assert found.undamped_speed == pytest.approx(4 * natural / 5)
        assert found.generalised_force == pytest.approx(8 / 4)  # the motor moves by 1, the mill by 1/4


class TestMarinePlant:
    """Numbers of the wet plant: strong damper, so that undamped and damped frequencies have little to do."""

    def test_undamped_and_damped_order_3(self, cylinders):
        critical = cylinders.critical_speeds(excitation=["cyl1"]).of(3, 3)
        assert critical.mode.undamped_frequency == pytest.approx(38.75, abs=0.005)
        assert critical.mode.natural_frequency == pytest.approx(26.49, abs=0.005)
        assert critical.undamped_speed / RPM == pytest.approx(775, abs=0.1)
        assert critical.natural_speed / RPM == pytest.approx(530, abs=0.2)

    def test_peak_of_the_crankshaft_torque(self, cylinders):
        at = np.arange(480, 580, 0.25) * RPM
        run = cylinders.order_response("torque(k56)", speeds=at)
        together = abs(sum(run.of_order(3, excitation=f"cyl{n}") for n in range(1, 7)))
        assert run.rpm[np.argmax(together)] == pytest.approx(521, abs=1)
        one = cylinders.critical_speeds("torque(k56)", excitation=["cyl3"]).of(3, 3).peaks[0]
        alone = cylinders.order_response("torque(k56)", speeds=at, excitation=["cyl3"])
        assert one.speed / RPM == pytest.approx(alone.rpm[np.argmax(abs(alone.of_order(3)))], abs=0.25)

    def test_lowest_modes(self, cylinders):
        found = cylinders.critical_speeds(excitation=["cyl1"])
        assert found.of(1, 0.5).mode.undamped_frequency == pytest.approx(3.52, abs=0.005)
        assert found.of(1, 0.5).undamped_speed / RPM == pytest.approx(423, abs=0.5)
        assert found.of(2, 1.5).mode.undamped_frequency == pytest.approx(10.55, abs=0.005)
        assert found.of(2, 1.5).undamped_speed / RPM == pytest.approx(422, abs=0.5)

    def test_the_mode_of_the_ring_is_overdamped(self, cylinders):
        modes = cylinders.critical_speeds(excitation=["cyl1"]).modes
        assert modes[-1].undamped_frequency == pytest.approx(17.89, abs=0.005)
        assert math.isnan(modes[-1].natural_frequency)
        assert [mode.number for mode in modes] == list(range(1, len(modes) + 1))
        assert all(mode.similarity > 0.6 for mode in modes[:-1])

    @pytest.mark.slow
    def test_one_mode_has_one_number(self, cylinders):
        """The film leaves the third undamped mode no vibration: what all tables call mode 3 is the fourth without it."""
        modes = cylinders.modes()
        found = cylinders.critical_speeds(excitation=["cyl1"])
        numbered = dict(zip(modes.numbers, modes.natural_frequencies.tolist(), strict=True))
        assert numbered.keys() > {None}
        for mode in found.modes[:-1]:
            assert numbered[mode.number] == mode.natural_frequency
            assert cylinders.holzer_table(mode.number).frequency == pytest.approx(mode.undamped_frequency, rel=1e-9)
        assert "with damping its natural frequency is 26.494 Hz" in cylinders.holzer_table(3).notes
        assert mode_sensitivities(cylinders).numbers == tuple(modes.numbers[1:])
        film = next(iter(cylinders.parameters))
        study = {
            name: NaturalFrequency(mode=3, which=name)
            .evaluate(VariantBlock(cylinders, {film: np.array([cylinders.parameters[film]])}, {}, None))
            .item()
            for name in ("natural", "undamped")
        }
        assert study == pytest.approx({"natural": 26.494, "undamped": 38.7504}, abs=1e-3)

    def test_named_film_as_a_locked_ring(self, cylinders):
        """Against the plant with a coupling in the film's place, written down again."""
        elements = [
            tn.RigidCoupling("dmp_film", nodes=("ring", "free_end")) if element.name == "dmp_film" else element
            for element in cylinders.elements.values()
        ]
        stiff = tn.Drivetrain("locked", elements, parameters=cylinders.definition.parameters)
        locked = cylinders.critical_speeds(rings="locked", damper=["dmp_film"], excitation=["cyl1"])
        assert "damper ring locked" in locked.title
        frequencies = stiff.modes().undamped_natural_frequencies
        assert [mode.undamped_frequency for mode in locked.modes] == pytest.approx(frequencies[frequencies > 0])

    def test_misfire_excites_what_the_normal_engine_does_not(self):
        plant = marine({"engine": INLINE_SIX}, {"firing": {"normal": {}, "gas_off": {"engine.gas_off": [3]}}})
        normal, misfire = (plant.configured(name).critical_speeds() for name in ("normal", "gas_off"))
        assert not normal.of(1, 0.5).excited
        assert misfire.of(1, 0.5).excited
        assert normal.of(3, 3).excited
        told = normal.in_conditions([misfire]).of(1, 0.5)
        assert told.excited_in == ("gas_off",)
        assert told.remark == "not excited, but in gas_off"
        assert normal.of(1, 0.5).remark == "not excited in this condition"

    def test_generalised_force_is_the_sum_over_the_cylinders(self):
        plant = marine({"engine": INLINE_SIX})
        found = plant.critical_speeds().of(3, 3)
        acts = plant.definition.excitations["engine"].torques(np.array([found.natural_speed]))
        place = acts.orders.tolist().index(3.0)
        shape = dict(zip(plant.assembly.nodes, found.mode.shape.real, strict=True))
        by_hand = sum(acts.amplitudes[0, place, n] * shape[node] for n, node in enumerate(acts.nodes))
        assert found.generalised_force == pytest.approx(abs(by_hand))

    def test_cylinders_that_cancel_on_one_throw_excite_nothing(self):
        """Two cylinders on each throw, half a period of order 3 apart: nothing is left of it, whatever the shape."""
        shared = {str(number): f"c{(number + 1) // 2}" for number in range(1, 13)}
        angles = {number: f"{60 * ((int(number) + 1) % 2)} deg" for number in shared}
        vee = {**INLINE_SIX, "cylinders": shared, "firing_angles": angles, "orders": [3, 6]}
        del vee["firing_order"]
        found = marine({"engine": vee}).critical_speeds()
        assert not found.of(3, 3).excited
        assert found.of(3, 6).excited


class TestCar:
    def test_gear_iii(self):
        critical = car().critical_speeds("tw_dmf").of(3, 2)
        assert critical.mode.natural_frequency == pytest.approx(23.59, abs=0.005)
        assert critical.mode.undamped_frequency == pytest.approx(20.86, abs=0.005)
        assert critical.natural_speed / RPM == pytest.approx(708, abs=0.5)
        assert critical.undamped_speed / RPM == pytest.approx(626, abs=0.5)
        assert 704 <= critical.peaks[0].speed / RPM <= 706.5

    def test_half_shafts_against_each_other_take_up_nothing(self):
        """In mode 4 the wheels swing against each other through the differential, and the engine stands still."""
        assert not car().critical_speeds().of(4, 2).excited


class TestDampers:
    """A mass J = 2 on a spring to ground with a viscous damper: closed forms for every state of the ring."""

    @pytest.mark.parametrize(("state", "inertia"), [("free", 2.1), ("half", 2.35), ("locked", 2.6)])
    def test_states(self, state, inertia):
        (mode,) = damped_mass().critical_speeds(rings=state).modes
        assert mode.undamped_frequency == pytest.approx(math.sqrt(1e4 / inertia) / (2 * np.pi))

    @pytest.mark.parametrize(("state", "inertia"), [("free", 2), ("half", 2.25), ("locked", 2.5)])
    def test_states_of_a_film_between_a_mass_and_a_ring(self, state, inertia):
        plant = tn.Drivetrain(
            "film of its own",
            [tn.Inertia("mass", node="a", inertia=2), tn.Spring("spring", nodes=("a", "ground"), stiffness=1e4),
             tn.Inertia("ring", node="r", inertia=0.5), tn.Damper("film", nodes=("a", "r"), damping=40)],
            speeds={"of": "a", "list": ["300 rpm", "400 rpm"]},
            excitations={"fan": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": 1}}}},
        )  # fmt: skip
        (mode,) = plant.critical_speeds(rings=state, damper=["film"]).modes
        assert mode.undamped_frequency == pytest.approx(math.sqrt(1e4 / inertia) / (2 * np.pi))

    def test_as_modelled(self):
        assert damped_mass().critical_speeds().modes[0].damping_ratio > 0.01

    @pytest.mark.parametrize(
        ("state", "names", "kind"),
        [
            ("lockd", None, "unknown-word"),
            ("locked", ["dampr"], "unknown-element"),
            ("locked", ["spring"], "not-applicable"),
        ],
    )
    def test_what_is_refused(self, state, names, kind):
        with pytest.raises(tn.UsageError, match=kind):
            damped_mass().critical_speeds(rings=state, damper=names)

    def test_without_a_damper(self):
        with pytest.raises(tn.UsageError, match="not-applicable"):
            two_mass(damping=0.0).critical_speeds(rings="free")


class TestPairsOfModes:
    def test_without_damping_every_mode_is_its_own(self):
        plant = marine({"cyl1": {"type": "harmonic", "node": "c1", "orders": {3: {"amplitude": 1}}}})
        plant = plant.configured(c_dmp=0, psi_cpl=1e-9, c_prop=0)
        for mode in plant.critical_speeds(lowest=6).modes:
            assert mode.natural_frequency == pytest.approx(mode.undamped_frequency, rel=1e-4)
            assert mode.similarity == pytest.approx(1, abs=1e-4)

    def test_repeated_modes_find_partners(self):
        """Three like blades on a hub have two modes of one frequency, whose shapes are arbitrary mixtures."""
        blades = [
            part
            for name in "abc"
            for part in (tn.Inertia(f"J_{name}", node=name, inertia=1),
                         tn.Spring(f"k_{name}", nodes=(name, "hub"), stiffness=1e3, damping=1.5))
        ]  # fmt: skip
        fan = {"fan": {"type": "harmonic", "node": "hub", "orders": {3: {"amplitude": 1}}}}
        plant = tn.Drivetrain(
            "fan",
            [*blades, tn.Inertia("hub", node="hub", inertia=2)],
            excitations=fan,
            speeds={"of": "hub", "list": [10]},
        )
        found = plant.critical_speeds(reach=0.9)
        assert [round(mode.similarity, 6) for mode in found.modes] == [1, 1, 1]
        assert [one.excited for one in found.crossings] == [False, False, True]


class TestQuestions:
    @pytest.mark.parametrize(
        ("settings", "text"),
        [
            ({"excitation": ["bladez"]}, 'did you mean "blades"'),
            ({"reach": 1.5}, "reach.*out-of-range"),
            ({"line_frequency": -50}, "above 0 Hz"),
            ({"speeds": [0.0, 10.0]}, "above 0, in rad/s"),
            ({"speeds": []}, "above 0, in rad/s"),
            ({"output": "shft"}, '"shft".*unknown-channel'),
            ({"margin": "api6"}, "no margin rule"),
        ],
    )
    def test_what_is_refused(self, settings, text):
        with pytest.raises(tn.UsageError, match=f"(?s){text}"):
            two_mass(damping=1.0).critical_speeds(**settings)

    def test_without_speeds_or_excitations(self):
        with pytest.raises(tn.UsageError, match="missing-entry"):
            tn.load("dmf_rig").critical_speeds()
        with pytest.raises(tn.UsageError, match="missing-entry"):
            tn.load("dmf_rig").critical_speeds(speeds=[10.0, 20.0], speed_of="motor")

    @pytest.mark.parametrize(
        ("mode", "order", "text"),
        [
            (7, 2, "unknown-mode"),
            (1, 3, "unknown-order"),
        ],
    )
    def test_unknown_mode_or_order(self, mode, order, text):
        with pytest.raises(tn.UsageError, match=text):
            two_mass(damping=1.0).critical_speeds().of(mode, order)

    def test_an_order_of_two_excitations(self):
        with pytest.raises(tn.UsageError, match="say which excitation"):
            marine({name: {"type": "harmonic", "node": name, "orders": {3: {"amplitude": 1}}} for name in ("c1", "c2")}
                   ).critical_speeds().of(3, 3)  # fmt: skip

    def test_own_rule(self):
        rule = MarginRule("ours", "house rule 7", (MarginClause(2, 2, 0.2),))
        found = two_mass(damping=0.0).critical_speeds(speeds=np.array([300, 500]) * RPM, margin=rule)
        assert found.of(1, 2).passes is False
        assert "margins: ours: house rule 7" in found.table().notes

    def test_one_peak_belongs_to_one_crossing(self):
        plant = marine({"engine": INLINE_SIX})
        by_order = {}
        for one in plant.critical_speeds("torque(k56)", lowest=8).crossings:
            for peak in one.peaks:
                by_order.setdefault(one.order, []).append(peak.speed)
        for speeds in by_order.values():
            assert np.diff(sorted(speeds)).min(initial=1) > SAME_PEAK * max(speeds) / 2


def with_machine(**entries):
    plant = two_mass(damping=0.0)
    return tn.Drivetrain(
        "two masses and a motor",
        plant.elements.values(),
        speeds={"of": "b", "list": ["400 rpm", "700 rpm"]},
        excitations={"motor": {"type": "electric_machine", "node": "b", **entries}},
    )


def damped_mass():
    return tn.Drivetrain(
        "damped mass",
        [tn.Inertia("mass", node="a", inertia=2), tn.Spring("spring", nodes=("a", "ground"), stiffness=1e4),
         tn.ViscousDamper("damper", node="a", ring_inertia=0.5, hub_inertia=0.1, damping=40)],
        speeds={"of": "a", "list": ["300 rpm", "400 rpm"]},
        excitations={"fan": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": 1}}}},
    )  # fmt: skip


class TestCommand:
    @pytest.fixture(autouse=True)
    def folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        plant = marine({"engine": {**INLINE_SIX, "orders": [0.5, 1.5, 3]}},
                       {"firing": {"normal": {}, "off": {"engine.gas_off": [3]}}})  # fmt: skip
        plant.to_yaml("plant.yaml")
        return tmp_path

    def test_table(self):
        printed = run("critical-speeds", "plant.yaml", "-c", "all", "--lowest", "4", "--margin", "api684").stdout
        assert "not excited, but in off" in printed
        assert "API RP 684" in printed
        assert "under 10 %" in printed

    def test_csv(self, folder):
        run("critical-speeds", "plant.yaml", "-c", "normal", "--lowest", "4", "--csv", folder / "c.csv")
        lines = [line for line in (folder / "c.csv").read_text().splitlines() if not line.startswith("#")]
        rows = {(row["mode"], row["order"]): row for row in csv.DictReader(lines)}
        assert float(rows["3", "3"]["undamped [rpm]"]) == pytest.approx(775.007, abs=1e-3)

    @pytest.mark.few(1)
    @pytest.mark.parametrize("stars", [[], ["--stars", "3"]])
    def test_pictures(self, folder, stars):
        run("critical-speeds", "plant.yaml", "-c", "normal", "--plot", folder / "a.png", *stars)
        assert (folder / "a.png").stat().st_size > 10_000

    @pytest.mark.parametrize(
        ("options", "text"),
        [
            (["--margin", "api648"], 'did you mean "api684"'),
            (["--stars", "40", "--plot", "x.png"], "there is no mode 40"),
            (["--rings", "locked"], "viscous_damper"),
            (["--excitation", "motor"], '"motor".*unknown-name'),
        ],
    )
    def test_what_is_wrong_is_told(self, options, text):
        assert re.search(text, run("critical-speeds", "plant.yaml", *options, code=2).stderr)


class TestPictures:
    def test_interference_diagram(self):
        from torsionnet.plot import interference_diagram

        found = marine({"engine": INLINE_SIX}).critical_speeds(margin="api684", lowest=6)
        (axes,) = interference_diagram(found).axes
        assert axes.get_xlabel() == "speed of fly [rpm]"
        assert axes.get_ylabel() == "frequency [Hz]"
        texts = [text.get_text() for text in axes.texts]
        assert {"3", "0.5", "mode 3: 26.49 Hz"} <= set(texts)
        marks = np.concatenate(
            [np.asarray(one.get_offsets()) for one in axes.collections if len(one.get_offsets()) > 1]
        )
        assert [529.88, 26.494] == pytest.approx(
            marks[np.argmin(abs(marks[:, 0] - 529.88) + abs(marks[:, 1] - 26.494))], 1e-4
        )

    def test_lines_that_end_at_one_place_share_a_label(self):
        orders = {order: {"amplitude": "1 N*m"} for order in (2, 2.02, 3)}
        rig = tn.Drivetrain(
            "two",
            [tn.Inertia("A", node="a", inertia=1), tn.Inertia("B", node="b", inertia=2),
             tn.Spring("s", nodes=("a", "b"), stiffness=1e4)],
            speeds={"of": "a", "list": ["100 rpm", "1000 rpm"]},
            excitations={"shake": {"type": "harmonic", "node": "a", "orders": orders}},
        )  # fmt: skip
        from torsionnet.plot import interference_diagram

        (axes,) = interference_diagram(rig.critical_speeds()).axes
        assert [text.get_text() for text in axes.texts if "Hz" not in text.get_text()] == ["2", "3"]
        labels = axes.get_legend_handles_labels()[1]
        assert len(labels) == len(set(labels))
        assert any(label.startswith("damped") for label in labels)

    def test_stars_of_one_diagram_share_a_panel(self):
        from torsionnet.plot import star_diagrams

        found = marine({"engine": INLINE_SIX}).critical_speeds(lowest=4)
        stars = [one.star for one in found.crossings if one.mode.number == 3]
        titles = [axes.get_title() for axes in star_diagrams(stars).axes]
        assert any(title.startswith("engine 3, 6, 9\n") for title in titles)

    def test_numbers_stand_beyond_the_circle_and_beside_the_sum(self):
        """7 points outwards; where the sum lies over the vector, 9 points below it."""
        from matplotlib.figure import Figure

        from torsionnet.plot.interference_plot import draw_star

        found = {}
        for vectors in ([1, 1j, -1, -1j], [1, 1, 0, 0]):
            axes = Figure().add_subplot()
            draw_star(axes, StarDiagram("engine", 1.0, ("1", "2", "3", "4"), ("a", "b", "c", "d"), np.array(vectors)))
            found |= {text.get_text(): text.xyann for text in axes.texts if text.get_text()}
        assert [found[label] for label in ("1", "2", "3", "4")] == [
            pytest.approx(place, abs=1e-3) for place in ((7, 0), (0, 7), (-7, 0), (0, -7))
        ]
        assert found["1,2"] == pytest.approx((0, -9), abs=1e-9)

    def test_no_stars(self):
        from torsionnet.plot import star_diagrams

        with pytest.raises(tn.UsageError, match="missing-data"):
            star_diagrams([])


class TestWorstOfSeveralCases:
    """A misfire of each cylinder, or spread: the largest sum of all cases, and never called not excited."""

    def crossings(self, **faults):
        gas = {**INLINE_SIX["gas"], "motored": (PRESSURE * 0.6 + 1e5).round(1).tolist()}
        engine_entry = {**INLINE_SIX, "gas": gas, "orders": [0.5, 1, 1.5, 3], **faults}
        return marine({"engine": engine_entry}).critical_speeds(lowest=2)

    @pytest.mark.slow
    def test_each_misfire_is_the_worst_of_six_single_ones(self):
        each = self.crossings(misfire="each")
        single = {number: self.crossings(misfire=[number]) for number in range(1, 7)}
        assert len(each.crossings) > 2
        for one in each.crossings:
            forces = {n: found.of(one.mode.number, one.order).generalised_force for n, found in single.items()}
            worst = max(forces, key=forces.get)
            assert one.generalised_force == pytest.approx(forces[worst], rel=1e-9)
            assert one.excited
            assert one.remark == f"misfire of cylinder {worst}"
            assert one.star.sum == pytest.approx(single[worst].of(one.mode.number, one.order).star.sum, abs=1e-9)

    def test_half_order_is_excited_by_a_misfire_only(self):
        assert self.crossings().of(1, 0.5).excited is False
        assert self.crossings(misfire="each").of(1, 0.5).relative_force > 0.1

    @pytest.mark.slow
    def test_spread_is_the_worst_sum_of_all_combinations(self):
        """The sum of the star is linear in the factors of the cylinders."""

        def phasor(**faults):
            one = self.crossings(**faults).of(1, 0.5)
            return one.generalised_force * one.star.sum / abs(one.star.sum)

        found = self.crossings(spread=0.1).of(1, 0.5)
        plain = phasor()
        raised = [phasor(factors={cylinder: 1.1}) for cylinder in range(1, 7)]
        changes = np.array(raised) - plain
        sums = [plain + changes @ signs for signs in itertools.product((-1, 1), repeat=6)]
        assert found.excited
        assert found.generalised_force == pytest.approx(np.abs(sums).max(), rel=1e-9)

    @pytest.mark.nightly
    def test_spread_is_the_worst_of_all_combinations(self):
        found = self.crossings(spread=0.1).of(1, 0.5)
        combinations = [dict(zip(range(1, 7), one, strict=True)) for one in itertools.product((0.9, 1.1), repeat=6)]
        forces = [self.crossings(factors=one).of(1, 0.5).generalised_force for one in combinations]
        assert found.excited
        assert found.generalised_force == pytest.approx(max(forces), rel=1e-9)


@pytest.mark.parametrize("outputs", [(), "torque(shaft)"])
def test_data_that_end_with_the_operating_range(outputs):
    """Order 2 meets sqrt(1.5e4) rad/s at 584.8 r/min; the fan is known up to 550 r/min, where its torque is doubled."""
    plain = two_mass(damping=2.0)
    fan = {
        "type": "harmonic",
        "node": "b",
        "orders": {2: {"amplitude": 10}},
        "factor": [["400 rpm", 1], ["550 rpm", 2]],
    }
    plant = tn.Drivetrain(
        "fan",
        plain.elements.values(),
        speeds={"of": "a", "list": ["400 rpm", "550 rpm"]},
        excitations={"fan": fan},
    )
    found = plant.critical_speeds(outputs)
    assert found.of(1, 2).undamped_speed == pytest.approx(math.sqrt(1.5e4) / 2)
    assert found.of(1, 2).generalised_force == pytest.approx(20, rel=1e-3)  # the mode is slightly damped
    assert "the data of fan do not go beyond the operating range" in found.notes[0]
