"""Harmonics of cylinders, firing, vector sums, and their section in the document for approval."""

import cmath
import math
import re

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows
from support.running_plants import PRESSURE, engine
from support.twin_engines import text

import torsionnet as tn
from torsionnet.machinery.excitations.reciprocating_engine import (
    cylinder_harmonics,
    firing_intervals,
    indicated_pressures,
)
from torsionnet.machinery.orders.excitation_lines import excitation_lines
from torsionnet.machinery.orders.vector_sums import vector_sums
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, Picture, TableBlock

SPEED = 78.5
AREA, RADIUS, ROD, MASS = math.pi * 0.32**2 / 4, 0.2, 0.84, 78.0


def way(phi):
    """Way of the piston over the crank radius, from the geometry of crank and rod."""
    return 1 - np.cos(phi) + (ROD - np.sqrt(ROD**2 - (RADIUS * np.sin(phi)) ** 2)) / RADIUS


def harmonic(values, phi, order):
    return 2 * np.mean(values * np.exp(-1j * order * phi))


class TestCylinder:
    def test_gas_and_mass_apart(self):
        """Against sums over the cycle, with derivatives of the piston's way by central differences."""
        phi, step = np.linspace(0, 4 * np.pi, 720, endpoint=False), 1e-4
        rate = (way(phi + step) - way(phi - step)) / (2 * step)
        bend = (way(phi + step) - 2 * way(phi) + way(phi - step)) / step**2
        found = {one.order: one for one in cylinder_harmonics(engine(orders=[0.5, 1, 2, 3]), SPEED)}
        for order in (0.5, 1.0, 2.0, 3.0):
            gas = harmonic((PRESSURE.round(1) - 1e5) * rate, phi, order)
            mass = harmonic(-MASS * RADIUS * SPEED**2 / AREA * rate * bend, phi, order)
            assert found[order].gas == pytest.approx(abs(gas), rel=1e-6)
            assert found[order].inertia == pytest.approx(abs(mass), rel=1e-5, abs=1.0)
            assert found[order].resulting == pytest.approx(abs(gas + mass), rel=1e-5)
            assert found[order].torque == pytest.approx(abs(gas + mass) * AREA * RADIUS, rel=1e-5)
            assert found[order].phase == pytest.approx(cmath.phase(gas + mass), abs=1e-5)

    def test_mean_indicated_pressure_is_the_work_of_a_cycle(self):
        """The area of the indicator diagram, by trapezia over the volume, over the swept volume."""
        phi = np.linspace(0, 4 * np.pi, 721)
        volume = AREA * RADIUS * way(phi)
        work = np.trapezoid(np.append(PRESSURE.round(1), PRESSURE[0].round(1)), volume)
        (one,) = indicated_pressures(engine(), np.array([SPEED]))
        assert one.pressure == pytest.approx(work / (2 * AREA * RADIUS), rel=1e-4)
        assert one.power == pytest.approx(6 * work * SPEED / (4 * math.pi), rel=1e-4)

    def test_double_acting_cylinder_has_both_ends(self):
        upper, lower = PRESSURE.round(1).tolist(), (0.5 * PRESSURE).round(1).tolist()
        both = engine(gas={"fired": upper, "crank_end": lower}, piston_rod="160 mm")
        (one,), (single,) = (indicated_pressures(item, np.array([SPEED])) for item in (both, engine()))
        assert one.pressure == pytest.approx(single.pressure * (1 - 0.5 * 0.75), rel=1e-6)  # rod: a quarter of the area

    def test_pressure_follows_the_speed_and_may_be_unknown(self):
        law = engine(gas={"fired": PRESSURE.round(1).tolist(), "rated": "750 rpm", "exponent": 2})
        half, full = indicated_pressures(law, np.array([375, 750]) * np.pi / 30)
        assert half.pressure == pytest.approx(full.pressure / 4)
        assert indicated_pressures(engine(gas=None), np.array([SPEED])) == ()

    def test_uneven_firing(self):
        """A V4 of 60 degrees that fires at 0, 60, 360 and 420 degrees."""
        one = engine(
            cylinders={1: "c1", 2: "c2", 3: "c3", 4: "c4"}, firing_order=[],
            firing_angles={1: "0 deg", 2: "360 deg", 3: "60 deg", 4: "420 deg"},
        )  # fmt: skip
        degrees = {number: round(math.degrees(angle)) for number, angle in firing_intervals(one).items()}
        assert degrees == {1: 60, 3: 300, 2: 60, 4: 300}


def chain(firing):
    """Four throws and a heavy flywheel; dense matrices give its modes."""
    names = ["c1", "c2", "c3", "c4", "fly"]
    elements = [tn.Inertia(f"J_{name}", node=name, inertia=30 if name == "fly" else 1) for name in names]
    elements += [
        tn.Spring(f"k_{place}", nodes=(names[place], names[place + 1]), stiffness=1e6 * (1 + place))
        for place in range(4)
    ]
    given = {
        "type": "reciprocating_engine", "speed_of": "fly", "cycle": 4, "cylinders": {1: "c1", 2: "c2", 3: "c3", 4: "c4"},
        "firing_order": firing, "bore": "100 mm", "stroke": "120 mm", "rod_length": "240 mm",
        "reciprocating_mass": "1 kg",
    }  # fmt: skip
    return tn.Drivetrain(
        "four", elements, speeds={"of": "fly", "range": "600..3000 rpm", "step": "100 rpm", "rated": "3000 rpm"},
        excitations={"engine": given},
    )  # fmt: skip


def dense_shapes():
    M, K = np.diag([1.0, 1, 1, 1, 30]), np.zeros((5, 5))
    for place in range(4):
        K[place : place + 2, place : place + 2] += 1e6 * (1 + place) * np.array([[1, -1], [-1, 1]])
    scale = 1 / np.sqrt(np.diag(M))
    values, vectors = np.linalg.eigh(K * np.outer(scale, scale))
    return np.sqrt(np.abs(values)) / (2 * np.pi), vectors * scale[:, None]


class TestVectorSums:
    @pytest.mark.parametrize("order", [0.5, 1.0, 1.5, 2.0, 4.0])
    def test_by_complex_exponentials(self, order):
        """Firing 1-3-4-2 every 180 degrees: angles written out, shapes from dense matrices."""
        angles = np.radians([0, 540, 180, 360])  # of cylinders 1 to 4
        sums = vector_sums(chain([1, 3, 4, 2]), "engine", modes=[1, 2])
        _, shapes = dense_shapes()
        for mode in (1, 2):
            theta = shapes[:4, mode]
            expected = abs(np.sum(theta * np.exp(1j * order * angles))) / abs(theta).max()
            assert sums.of(mode, order) == pytest.approx(expected, rel=1e-9, abs=1e-9)
            vectors = theta * np.exp(1j * order * angles) / abs(theta).max()
            out = vector_sums(chain([1, 3, 4, 2]), "engine", modes=[mode], orders=[order], without=[3])
            assert out.of(mode, order) == pytest.approx(abs(vectors.sum() - vectors[2]), rel=1e-9, abs=1e-9)

    def test_orders_with_equal_sums_stand_together(self):
        """Even firing of a four-stroke four: stars repeat every second order, and mirrored ones have equal sums."""
        sums = vector_sums(chain([1, 3, 4, 2]), "engine", modes=[1, 2], orders=[0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4])
        assert sums.groups() == ((0.5, 1.5, 2.5, 3.5), (1, 3), (2, 4))
        assert [row[0] for row in sums.table().rows] == ["0.5, 1.5, 2.5, 3.5", "1, 3", "2, 4"]

    def test_misfire_and_factors_do_not_count(self):
        ship = tn.load("two_stroke_ship")
        sound, without = (vector_sums(ship.configured(name), "engine", modes=[1]) for name in ("normal", "misfire_2"))
        assert without.of(1, 6) == pytest.approx(sound.of(1, 6), rel=1e-12)

    def test_refusals(self):
        with pytest.raises(tn.UsageError, match="unknown-name"):
            vector_sums(tn.load("two_stroke_ship").configured("normal"), "propeller")
        with pytest.raises(tn.UsageError, match="no mode 9"):
            vector_sums(chain([1, 3, 4, 2]), "engine", modes=[9])


def test_lines_of_a_propeller_are_shares_of_its_mean_torque():
    """2 % of 1280 kN m at blade order 2; what the blades take counts against the rotation: half a turn more."""
    _, second = excitation_lines(tn.load("two_stroke_ship").configured("normal"), "propeller")
    assert (second.order, second.node) == (8, "propeller")
    assert second.amplitude == pytest.approx(25600)
    assert second.share == pytest.approx(0.02)
    assert math.degrees(second.phase) == pytest.approx(135)


@pytest.fixture(scope="module")
def section():
    (found,) = make_report("bulk_carrier", sections=["harmonics"], date=None).sections
    return found


def table(section, caption):
    return next(one for one in of(TableBlock, section.blocks) if caption in str(one.caption))


class TestSection:
    def test_pressures_of_an_engine_behind_a_gear_are_at_its_own_speed(self):
        """Mean pressure times swept volume over the angle of a four-stroke cycle; the reference turns a third as fast."""
        engine = """type: reciprocating_engine, cycle: 4, firing_order: [1, 2, 3], bore: 200 mm, stroke: 250 mm,
            rod_length: 500 mm, gas: {harmonics: {10 bar: {1: {amplitude: 2 bar, phase: 0 deg}}}},
            load: {mean_indicated_pressure: 10 bar}, orders: [1, 1.5]"""
        plant = re.sub(
            r"speeds: \{.*\}", "speeds: {of: w, list: [130 rpm, 240 rpm], rated: 240 rpm}", text(engine=engine)
        )
        report = make_report(tn.loads(plant), sections=["harmonics"], date=None)
        half, row = rows(of(TableBlock, blocks(report, "harmonics"))[0])
        torque = 1e6 * 3 * np.pi / 4 * 0.2**2 * 0.25 / (4 * np.pi)
        assert row == ("720.0", "10.00", f"{torque / 1e3:.4f}", f"{torque * 720 * np.pi / 30 / 1e3:.0f}", "100.0")
        assert half == ("720.0", "5.00", f"{torque / 2e3:.4f}", f"{torque * 360 * np.pi / 30 / 1e3:.0f}", "50.0")

    def test_firing_in_words(self, section):
        text = str(of(Paragraph, section.blocks)[0].text)
        assert "Firing order 1–5–3–4–2–6, every 60° of crank angle" in text

    def test_numbers_are_those_of_the_functions(self, section):
        ship = tn.load("bulk_carrier").configured("normal")
        found = rows(table(section, "tangential pressure"))
        for row, one in zip(
            found, cylinder_harmonics(ship.definition.excitations["engine"], 105 * np.pi / 30), strict=True
        ):
            shown = [float(cell.replace("−", "-")) for cell in row[:6]]
            expected = [one.order, one.gas / 1e6, one.inertia / 1e6, one.resulting / 1e6, one.torque / 1e3]
            assert shown[:5] == pytest.approx(expected, abs=0.06)
            assert shown[1:4] == pytest.approx(expected[1:4], abs=6e-5)
            assert shown[5] == pytest.approx(math.degrees(one.phase), abs=0.06)
        sums = vector_sums(ship, "engine", modes=[1, 2])
        whole = table(section, "vector sums").groups[0].rows
        assert float(str(whole[-1][1])) == pytest.approx(sums.of(1, 6), abs=6e-5)

    def test_propeller_misfire_and_stars(self, section):
        assert rows(table(section, "Screw: 4 blades, mean torque 637 kN·m at 105 rpm"))[0][:4] == (
            "1",
            "4",
            "5.00",
            "31.85",
        )
        assert rows(table(section, "Misfire"))[0] == ("misfire", "engine", "2", "no injection: compression only")
        assert len(of(Picture, section.blocks)) == 1

    def test_machines_without_pistons(self):
        (found,) = make_report("wind_turbine_3mw", sections=["harmonics"], date=None).sections
        assert ("tower", "harmonic", "hub", "3") in [row[:4] for row in rows(table(found, "Other excitations"))]

    def test_models_without_excitations_have_none(self):
        assert make_report("dmf_rig", sections=["harmonics"], date=None).sections == ()
