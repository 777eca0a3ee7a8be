"""Holzer tables: against tables made by hand, published cases, and equilibrium."""

import math
import re

import numpy as np
import pytest
from support.command_line import run
from support.running_plants import FOLDER
from validation.build import build, read_case

import torsionnet as tn
from torsionnet.machinery.holzer.holzer import natural_frequencies
from torsionnet.model.elements.gears import Gear

ENGINE = [  # name, J in kg m^2, k to the next one in N m/rad: the engine of docs/how_to/from_holzer.md
    *((f"cyl_{number}", 0.45, 2.1e6) for number in range(1, 6)),
    ("cyl_6", 0.45, 3.4e6),
    ("flywheel", 14.0, 0.9e6),
    ("generator", 8.0, None),
]


def chain(table):
    elements = [tn.Inertia(f"J_{name}", node=name, inertia=inertia) for name, inertia, _ in table]
    elements += [
        tn.Spring(f"shaft_{i}", nodes=(table[i - 1][0], table[i][0]), stiffness=table[i - 1][2])
        for i in range(1, len(table))
    ]
    return tn.Drivetrain("engine", elements)


def by_hand(table, omega):
    """Amplitude, inertia torque, sum of torques and twist, column by column as it is taught."""
    theta, torque, rows = 1.0, 0.0, []
    for _, inertia, stiffness in table:
        own = inertia * omega**2 * theta
        torque += own
        twist = torque / stiffness if stiffness else math.nan
        rows.append((theta, own, torque, twist))
        theta -= twist
    return np.array(rows)


def columns_of(holzer):
    stations = holzer.branches[0].stations
    return np.array([(s.amplitude, s.inertia_torque, s.torque, s.link.twist if s.link else math.nan) for s in stations])


class TestChain:
    @pytest.mark.parametrize("at", [5.0, 40.0, 61.3, 200.0])
    def test_trial_is_the_table_made_by_hand(self, at):
        holzer = chain(ENGINE).holzer_table(at=at)
        expected = by_hand(ENGINE, 2 * np.pi * at)
        np.testing.assert_allclose(columns_of(holzer), expected, rtol=1e-8, atol=1e-8 * abs(expected[:, 2]).max())
        assert holzer.remainder == pytest.approx(expected[-1, 2], rel=1e-7)
        assert holzer.mode is None

    @pytest.mark.parametrize("mode", range(1, 8))
    def test_nothing_remains_at_a_natural_frequency(self, mode):
        holzer = chain(ENGINE).holzer_table(mode)
        expected = by_hand(ENGINE, 2 * np.pi * holzer.frequency)
        assert holzer.relative_remainder < 1e-12
        np.testing.assert_allclose(
            columns_of(holzer)[:-1], expected[:-1], rtol=1e-6, atol=1e-7 * abs(expected[:-1]).max()
        )

    def test_trial_at_a_natural_frequency_has_no_remainder(self):
        plant = chain(ENGINE)
        natural = plant.modes().undamped_natural_frequencies[2]
        assert plant.holzer_table(at=natural).relative_remainder < 1e-9

    def test_amplitude_scales_everything(self):
        one, small = chain(ENGINE).holzer_table(1), chain(ENGINE).holzer_table(1, amplitude=1e-3)
        np.testing.assert_allclose(columns_of(small)[:-1], 1e-3 * columns_of(one)[:-1])

    def test_it_may_begin_at_the_other_end(self):
        holzer = chain(ENGINE).holzer_table(1, first="generator")
        assert [one.node for one in holzer.branches[0].stations] == [name for name, *_ in reversed(ENGINE)]
        assert holzer.station("generator").amplitude == 1

    def test_begun_at_a_vibration_node(self):
        """The middle of three like masses rests in the first mode: it cannot be set to 1, and that is said."""
        plant = chain([("a", 1, 1e3), ("b", 1, 1e3), ("c", 1, None)])
        holzer = plant.holzer_table(1, first="b")
        assert "b stands still in this mode" in holzer.notes[0]
        assert abs(holzer.station("a").amplitude) == pytest.approx(1)


class TestPublishedCases:
    def test_three_rotors_of_an_oil_engine(self):
        """Khurmi and Gupta: 277 Hz with two nodes of vibration."""
        holzer = build(read_case("khurmi_three_rotor_oil_engine")).holzer_table(2)
        table = [("n0", 0.15, 132001.86932220918), ("n1", 0.3, 198002.8039833138), ("n2", 0.09, None)]
        assert holzer.frequency == pytest.approx(277, abs=1)
        np.testing.assert_allclose(
            columns_of(holzer)[:-1], by_hand(table, 2 * np.pi * holzer.frequency)[:-1], rtol=1e-9
        )
        assert [math.copysign(1, one.amplitude) for one in holzer.branches[0].stations] == [1, -1, 1]

    @pytest.mark.parametrize(("mode", "per_minute"), [(1, 177.7), (2, 220.2), (3, 1282.6)])
    def test_marine_turbine_with_branches_and_gears(self, mode, per_minute):
        """Gunter and Chen, example 8.1: HP and LP turbine on one bull gear."""
        plant = build(read_case("gunter_chen_8_1_marine_steam_turbine"))
        holzer = plant.holzer_table(mode)
        assert holzer.frequency * 60 == pytest.approx(per_minute, abs=0.3)
        assert holzer.relative_remainder < 1e-11
        assert [branch.joins for branch in holzer.branches] == [None, "bull"]
        check_equilibrium(plant, holzer)


def check_equilibrium(plant, holzer):
    """Every link of stiffness k carries k times its twist, and gears keep their ratios, by the elements themselves."""
    angle = {one.node: one.amplitude for branch in holzer.branches for one in branch.stations}
    largest = max(abs(one.torque) for branch in holzer.branches for one in branch.stations)
    seen = 0
    for element in plant.elements.values():
        if isinstance(element, tn.Spring):
            first, second = element.nodes
            carried = float(element.stiffness.evaluate(plant.exact_values)) * (angle[first] - angle[second])
            station = holzer.station(first)
            mine = station.link is not None and element.name in station.link.elements
            torque = station.torque if mine else -holzer.station(second).torque
            assert torque == pytest.approx(carried, abs=1e-9 * largest), element.name
            seen += 1
        if isinstance(element, Gear):
            first, second = element.nodes
            assert angle[first] == pytest.approx(float(element.ratio_value(plant.exact_values)) * angle[second])
    assert seen


class TestReferred:
    def test_gear_in_the_chain(self):
        """Against the same system reduced by hand to the first shaft."""
        tau = 2.5
        geared = tn.Drivetrain(
            "geared",
            [tn.Inertia("J_a", node="a", inertia=1), tn.Spring("k_ab", nodes=("a", "b"), stiffness=4e3),
             tn.Gear("stage", nodes=("b", "c"), ratio=-tau), tn.Spring("k_cd", nodes=("c", "d"), stiffness=9e4),
             tn.Inertia("J_d", node="d", inertia=30)],
        )  # fmt: skip
        reduced = chain([("a", 1, 4e3), ("c", 0, 9e4 / tau**2), ("d", 30 / tau**2, None)])
        one, other = geared.holzer_table(1), reduced.holzer_table(1)
        assert one.frequency == pytest.approx(other.frequency)
        rows = {row[0]: row for row in one.tables(referred=True)[0].rows}
        for node in "ad":
            station = other.station(node)
            assert rows[node][2:5] == pytest.approx((station.inertia, station.amplitude, station.inertia_torque))
        assert rows["c"][8] == pytest.approx(9e4 / tau**2)
        assert rows["c"][6] == pytest.approx(other.station("a").torque)
        real = {row[0]: row for row in one.tables()[0].rows}
        assert real["d"][1] == 30
        assert real["c"][6] == pytest.approx(-tau * real["a"][6])  # the wheel turns the other way

    def test_stress_of_a_shaft_from_its_diameter(self):
        shaft = tn.Shaft("shaft", nodes=("a", "b"), outer_diameter=0.1, inner_diameter=0.04, length=1, inertia="none")
        plant = tn.Drivetrain(
            "one shaft", [tn.Inertia("A", node="a", inertia=2), shaft, tn.Inertia("B", node="b", inertia=3)]
        )
        station = plant.holzer_table(1, amplitude=1e-3).station("a")
        section = math.pi * (0.1**4 - 0.04**4) / (16 * 0.1)
        assert station.link.stress == pytest.approx(station.torque / section)


STEEL = {"density": 7850.0, "shear_modulus": 79.3e9}


def two_discs(segments=1, **more):
    """Two discs of 10 and 1150 kg m^2 on a shaft of 280 mm and 1.9 m, whose own inertia is 9 kg m^2."""
    shaft = tn.Shaft("s", nodes=("a", "b"), outer_diameter=0.28, length=1.9, segments=segments, **STEEL, **more)
    discs = [tn.Inertia("A", node="a", inertia=10), tn.Inertia("B", node="b", inertia=1150)]
    return tn.Drivetrain("two discs and a heavy shaft", [discs[0], shaft, discs[1]])


def section_of(steel=STEEL, diameter=0.28, length=1.9):
    """Stiffness in N m/rad and inertia in kg m^2 of the shaft of ``two_discs``."""
    polar = math.pi * diameter**4 / 32
    return steel["shear_modulus"] * polar / length, steel["density"] * polar * length


def exact_frequency(first=10.0, second=1150.0):
    """Lowest natural frequency in Hz of a uniform shaft with a disc at each end, from the wave equation.

    With theta = cos(beta x) - (omega^2 J_1/(G I_p beta)) sin(beta x), beta = omega sqrt(rho/G), the torque at the far
    end is omega^2 J_2 theta(L).
    """
    from scipy.optimize import brentq

    stiffness, inertia = section_of()

    def unbalance(omega):
        beta = omega * math.sqrt(inertia / stiffness)  # over the length
        ratio = omega**2 * first / (stiffness * beta)
        angle = math.cos(beta) - ratio * math.sin(beta)
        slope = -beta * (math.sin(beta) + ratio * math.cos(beta))
        return stiffness * slope - omega**2 * second * angle

    return brentq(unbalance, 2 * np.pi * 150, 2 * np.pi * 300) / (2 * np.pi)


class TestShaftsWithInertia:
    """Tables at the frequency of the solver, whose rows close with the torque of the shafts' own inertia."""

    def test_frequency_is_that_of_the_solver(self):
        assert exact_frequency() == pytest.approx(221.85, abs=0.02)
        assert two_discs().holzer_table(1).frequency == pytest.approx(223.07, abs=0.02)
        assert two_discs(40).holzer_table(1).frequency == pytest.approx(exact_frequency(), rel=1e-5)

    def test_own_inertia_of_one_segment(self):
        """Consistent mass m/6 (2, 1; 1, 2): omega^2 (m/3 theta_1 + m/6 theta_2) at the first end."""
        holzer = two_discs().holzer_table(1)
        (first, second), omega = holzer.branches[0].stations, 2 * np.pi * holzer.frequency
        stiffness, mass = section_of()
        one, two = first.amplitude, second.amplitude
        assert (first.inertia, second.inertia) == (10, 1150)
        assert first.inertia_torque == pytest.approx(omega**2 * 10 * one)
        assert first.distributed == pytest.approx(omega**2 * mass * (one / 3 + two / 6))
        assert second.distributed == pytest.approx(omega**2 * mass * (one / 6 + two / 3))
        assert first.torque == pytest.approx(stiffness * (one - two))
        assert first.torque == pytest.approx(25.5e6, rel=2e-3)  # not 28.5 MN m, as with half of the shaft at each end

    @pytest.mark.parametrize("inertia", ["consistent", "lumped"])
    @pytest.mark.parametrize("segments", [1, 2, 7])
    def test_a_divided_shaft_is_one_row(self, segments, inertia):
        plant, (stiffness, mass) = two_discs(segments, inertia=inertia), section_of()
        holzer = plant.holzer_table(1)
        fine = plant.holzer_table(1, segments=True)
        assert len(fine.branches[0].stations) == segments + 1
        first, second = holzer.branches[0].stations
        assert first.link.stiffness == pytest.approx(stiffness)
        assert first.link.stress == pytest.approx(max(one.link.stress for one in fine.branches[0].stations[:-1]))
        assert first.inertia_torque + first.distributed == pytest.approx(first.torque)
        assert first.torque == pytest.approx(stiffness * (first.amplitude - second.amplitude))
        assert first.torque + second.inertia_torque + second.distributed == pytest.approx(0, abs=1e-8 * first.torque)
        # What the ends take over is all that the shaft has: omega^2 times the integral of theta dm.
        own = sum(one.distributed for one in fine.branches[0].stations)
        assert first.distributed + second.distributed == pytest.approx(own)
        assert holzer.relative_remainder < 1e-12
        table = plant.mass_elastic_table()
        assert [row.shaft_inertia for row in table.rows] == pytest.approx([mass / 2, mass / 2])
        assert [row.inertia - row.shaft_inertia for row in table.rows] == pytest.approx([10, 1150])

    def test_a_divided_shaft_that_joins_a_line(self):
        """A branch whose last link is a shaft: its far share counts at the junction, and the branch brings the rest."""
        branch = tn.Shaft("branch", nodes=("c", "hub"), outer_diameter=0.1, length=1, segments=2)
        discs = [tn.Inertia(f"J_{node}", node=node, inertia=size) for node, size in zip("abc", (4, 5, 2), strict=True)]
        springs = [
            tn.Spring("k_a", nodes=("a", "hub"), stiffness=2e5),
            tn.Spring("k_b", nodes=("hub", "b"), stiffness=4e5),
            tn.Spring("k_d", nodes=("b", "d"), stiffness=1e6),
            tn.Spring("k_e", nodes=("e", "a"), stiffness=1e6),
            tn.Spring("k_f", nodes=("d", "f"), stiffness=1e6),
        ]
        more = [
            tn.Inertia(f"J_{node}", node=node, inertia=size)
            for node, size in (("hub", 1), ("d", 3), ("e", 2), ("f", 2))
        ]
        plant = tn.Drivetrain("branched", [*discs, *more, *springs, branch])
        whole, fine = (plant.holzer_table(2, first="e", segments=segments) for segments in (False, True))
        assert [one.joins for one in whole.branches] == [None, "hub"]
        assert [one.node for one in whole.branches[1].stations] == ["c"]
        hub, same = whole.station("hub"), fine.station("hub")
        assert hub.torque == pytest.approx(same.torque)
        assert hub.distributed + hub.joined == pytest.approx(same.distributed + same.joined)
        end = whole.station("c")
        assert end.torque == pytest.approx(end.link.stiffness * (end.amplitude - hub.amplitude))
        assert hub.joined == pytest.approx(end.torque)

    def test_trial_frequency(self):
        plant = two_discs(5)
        assert plant.holzer_table(at=100).remainder == pytest.approx(
            plant.holzer_table(at=100, segments=True).remainder
        )

    def test_column_stands_only_where_shafts_have_inertia(self):
        assert "distributed" in [one.name for one in two_discs().holzer_table(1).tables()[0].columns]
        assert "distributed" not in [one.name for one in chain(ENGINE).holzer_table(1).tables()[0].columns]

    def test_ring_in_a_film_counts_with_what_swings_along(self):
        """A ring that oil alone drags along: J/(1 + (omega J/c)^2) in phase with the hub, by its own equation of motion."""
        damper = tn.ViscousDamper("damper", node="a", ring_inertia=3, damping=900)
        elements = [*two_discs().elements.values(), damper]
        holzer = tn.Drivetrain("damped", elements).holzer_table(1)
        assert holzer.frequency == pytest.approx(two_discs().holzer_table(1).frequency)
        omega = 2 * np.pi * holzer.frequency
        ring = 1j * omega * 900 / (1j * omega * 900 - omega**2 * 3)  # theta_r over theta of the hub
        note = next(one for one in holzer.notes if "damper.ring" in one)
        assert float(re.search(r"with damping (\S+) % of its inertia", note)[1]) == pytest.approx(
            100 * ring.real, rel=5e-3
        )


class TestWholePlants:
    @pytest.mark.few(2)
    @pytest.mark.parametrize("mode", range(1, 12))
    def test_marine_closes(self, mode):
        plant = tn.load(FOLDER / "marine.yaml")
        holzer = plant.holzer_table(mode)
        assert holzer.relative_remainder < 1e-11
        check_equilibrium(plant, holzer)

    @pytest.mark.few(2)
    @pytest.mark.parametrize("mode", range(1, 8))
    def test_car_with_loops_housing_and_differential_closes(self, mode):
        """What is not followed (the differential, the powertrain's mount) counts where it acts: all lines end with 0."""
        plant = tn.load(FOLDER / "front_wheel_drive_car.yaml").configured("gear=III,clutch=closed")
        holzer = plant.holzer_table(mode)
        assert holzer.relative_remainder < 1e-10
        assert {one.node for branch in holzer.branches for one in branch.stations} == set(plant.nodes)

    def test_locked_end_takes_the_torque(self):
        plant = tn.Drivetrain(
            "locked",
            [tn.Inertia("J", node="a", inertia=2), tn.Spring("k", nodes=("a", "wall"), stiffness=800),
             tn.Lock("clamp", node="wall")],
        )  # fmt: skip
        holzer = plant.holzer_table(1)
        assert holzer.frequency == pytest.approx(20 / (2 * np.pi))
        assert holzer.station("wall").joined == pytest.approx(-800)
        assert holzer.relative_remainder < 1e-12


class TestQuestions:
    @pytest.mark.parametrize(
        ("settings", "text"),
        [
            ({}, "contradicting-entries"),
            ({"mode": 1, "at": 3.0}, "one of the two"),
            ({"mode": 8}, "unknown-mode"),
            ({"mode": 0}, "unknown-mode"),
            ({"at": 0.0}, "above 0 Hz"),
            ({"mode": 1, "first": "cyl1"}, 'did you mean "cyl_1"'),
            ({"mode": 1, "referred_to": "wheel"}, "unknown-node"),
            ({"mode": 1, "amplitude": -1}, "above 0 rad"),
        ],
    )
    def test_what_is_refused(self, settings, text):
        with pytest.raises(tn.UsageError, match=text):
            chain(ENGINE).holzer_table(**settings)

    def test_a_first_station_that_cannot_move(self):
        plant = tn.Drivetrain(
            "locked",
            [tn.Inertia("J", node="a", inertia=2), tn.Spring("k", nodes=("a", "wall"), stiffness=800),
             tn.Lock("clamp", node="wall")],
        )  # fmt: skip
        with pytest.raises(tn.SolveError, match="stands still whatever acts"):
            plant.holzer_table(at=5, first="wall")


class TestCommand:
    def test_table_on_the_screen(self):
        printed = run("holzer", "marine_steam_turbine", "--mode", "1", "--amplitude", "1 mrad").stdout
        assert re.search(r"branch 1, .*\nstation", printed)
        assert "which it joins" in printed
        assert "referred to" in printed

    def test_trial(self):
        assert "trial at 3 Hz" in run("holzer", "marine_steam_turbine", "--at", "3 Hz", "--referred").stdout

    def test_csv(self, tmp_path):
        run("holzer", "marine_steam_turbine", "--mode", "1", "--csv", tmp_path / "h.csv")
        assert "branch,station,J [kg*m^2],J referred [kg*m^2],theta [rad]" in (tmp_path / "h.csv").read_text()

    @pytest.mark.parametrize(
        ("options", "text"),
        [
            ([], "missing-entry"),
            (["--mode", "1", "--at", "3"], "contradicting-entries"),
            (["--mode", "90"], "there is no mode 90"),
            (["--at", "3 m"], "wrong-unit"),
        ],
    )
    def test_what_is_wrong_is_told(self, options, text):
        assert text in run("holzer", "marine_steam_turbine", *options, code=2).stderr


def test_a_rigid_mesh_on_a_moving_housing_is_named():
    """Angles obey z_1 (theta_1 - theta_h) + z_2 (theta_2 - theta_h) = 0, whose third angle no station shows."""
    text = """
torsionnet: 1
elements:
  motor: {type: inertia, node: m, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [m, a], stiffness: 9 kN*m/rad}
  pinion: {type: inertia, node: a, inertia: 0.1 kg*m^2}
  mesh: {type: gear, nodes: [a, b], teeth: [20, -40]HOUSING}
  fan: {type: inertia, node: b, inertia: 5 kg*m^2}
  box: {type: inertia, node: h, inertia: 8 kg*m^2}
  mount: {type: spring, nodes: [h, ground], stiffness: 50 kN*m/rad}
"""
    note = "behind the rigid mesh of mesh the angle counts the motion of the housing"
    assert note in tn.loads(text.replace("HOUSING", ", housing: h")).holzer_table(1).notes
    assert note not in tn.loads(text.partition("  box:")[0].replace("HOUSING", "")).holzer_table(1).notes


def test_shares_of_the_energies_of_a_mode():
    """Two discs on one spring: J theta is the same for both, so that J theta^2 is as 1/J; all strain is in the spring."""
    elements = [tn.Inertia("rotor", node="a", inertia=3), tn.Inertia("wheel", node="b", inertia=1),
                tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]  # fmt: skip
    (one,) = natural_frequencies(tn.Drivetrain("fan", elements))
    assert (one.strain, one.kinetic) == ("shaft 100 %", "wheel 75 %, rotor 25 %")
