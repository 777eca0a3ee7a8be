"""Holzer tables: against tables made by hand, published cases, and equilibrium."""

import math
import re

import numpy as np
import pytest
from support.command_line import run
from support.running_plants import FOLDER
from validation.build import build, read_case

import torsionnet as tn
from torsionnet.model.elements.rigid import Gear

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

    def test_shaft_with_inertia(self):
        """A consistent shaft in two segments: half of each segment at its ends, and its torque is still k times twist."""
        shaft = tn.Shaft("shaft", nodes=("a", "b"), outer_diameter=0.2, length=2, segments=2)
        plant = tn.Drivetrain(
            "one shaft", [tn.Inertia("A", node="a", inertia=2), shaft, tn.Inertia("B", node="b", inertia=3)]
        )
        holzer = plant.holzer_table(1)
        whole = 7850 * math.pi * 0.2**4 / 32 * 2
        stations = holzer.branches[0].stations
        assert [one.inertia for one in stations] == pytest.approx([2 + whole / 4, whole / 2, 3 + whole / 4])
        assert stations[0].torque == pytest.approx(stations[0].link.stiffness * stations[0].link.twist)
        assert holzer.relative_remainder < 1e-12


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
            ({}, "of a mode .* or of a trial frequency"),
            ({"mode": 1, "at": 3.0}, "one of the two"),
            ({"mode": 8}, "there is no mode 8; there are 7, counted from 1 without rigid bodies"),
            ({"mode": 0}, "there is no mode 0"),
            ({"at": 0.0}, "above 0 Hz"),
            ({"mode": 1, "first": "cyl1"}, 'did you mean "cyl_1"'),
            ({"mode": 1, "referred_to": "wheel"}, 'no node is named "wheel"'),
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
            ([], "give a mode, as --mode 1, or --at"),
            (["--mode", "1", "--at", "3"], "give a mode, as --mode 1, or --at"),
            (["--mode", "90"], "there is no mode 90"),
            (["--at", "3 m"], '"3 m" is not a value of frequency; expected a unit such as Hz'),
        ],
    )
    def test_what_is_wrong_is_told(self, options, text):
        assert text in run("holzer", "marine_steam_turbine", *options, code=2).stderr
