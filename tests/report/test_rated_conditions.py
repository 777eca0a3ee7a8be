"""Values at rated speed in further conditions and damping by the water at critical speeds, against sums by hand."""

import math

import pytest
from support.report_blocks import blocks, of, words
from support.tanker import TANKER, torque

import torsionnet as tn
from torsionnet.base.number_text import NumberText
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, TableBlock

RATED = 110
ARCHER = TANKER.replace(
    'c_prop: {value: 20000, description: "propeller, full pitch"}',
    "Q: {by: load, of: p}\n  n: {by: speed, of: p}\n  a: 30",
)
ARCHER = ARCHER.replace(
    "screw: {type: inertia, node: p, inertia: 6000}",
    "screw: {type: propeller, node: p, inertia: 6000, archer: a, torque: Q, speed: n}",
)
ARCHER = ARCHER.replace("  water: {type: damper, nodes: [p, ground], damping: c_prop}\n", "").replace(
    "c_prop: 9000", "a: 13"
)
ARCHER = ARCHER.replace(
    "excitations:", "load: {absorbed_at: p, torque: 80 kN*m, torque_exponent: 2, driven_by: {e: 1}}\nexcitations:"
)


def tables(text, section, caption):
    report = make_report(tn.loads(text), sections=[section], date=None)
    return [one for one in of(TableBlock, blocks(report, section)) if words(one.caption).startswith(caption)]


class TestRatedSpeedByCondition:
    def rows(self, amplitude):
        (table,) = tables(
            TANKER.replace("10.5 kN*m", amplitude),
            "components",
            f"Components at rated speed, {RATED} rpm, by condition",
        )
        return table, {words(row[0]): row[1:] for group in table.groups for row in group.rows}

    def test_values_are_those_by_hand_beside_what_is_allowed(self):
        table, rows = self.rows("14 kN*m")
        assert [words(one.text) for one in table.columns] == ["Condition", "flange, kN·m", "tail, kN·m", "Used most"]
        assert [cell.value for cell in rows["Allowed"][:2]] == [50, 60]
        for title, damping, amplitude in [
            ("full pitch, normal firing", 20e3, 10e3),
            ("full pitch, uneven", 20e3, 14e3),
            ("propeller at zero pitch, uneven", 9e3, 14e3),
        ]:
            size = float(torque(RATED, damping, amplitude)) / 1e3
            assert [cell.value for cell in rows[title]] == pytest.approx([size, size, 100 * size / 50], rel=1e-6)

    def test_what_differs_by_less_than_5_percent_is_left_out(self):
        """Zero pitch alone changes the torque at 110 rpm, far above the resonance, by less than a per cent."""
        assert torque(RATED, 9e3, 10e3) == pytest.approx(torque(RATED, 20e3, 10e3), rel=0.05)
        _, rows = self.rows("14 kN*m")
        assert "propeller at zero pitch, normal firing" not in rows
        assert not tables(TANKER.replace("10.5 kN*m", "10.1 kN*m"), "components", "Components at rated speed, 110")


class TestDampingByTheWater:
    def test_archer_at_the_critical_speed(self):
        """c = a Q/n with Q as the square of the speed, so that it goes with the speed: at the resonance of order 8."""
        (table,) = tables(ARCHER, "resonances", "Critical speeds in normal operation")
        (note,) = [words(one) for one in table.notes if words(one).startswith("Absolute damping of screw")]
        stiffness = 79.3e9 * math.pi * 0.3**4 / 32 / 6
        speed = math.sqrt(stiffness * (1 / 9000 + 1 / 6000)) / 8 * 30 / math.pi
        damping = 30 * 80e3 * (speed / 110) ** 2 / speed
        assert f"by Archer c = a Q/n: {damping / 1e3:.1f} at {speed:.1f} kN·m·s/rad." in note


def test_damping_of_a_rubber_coupling_at_the_critical_speed():
    """With eta of 1.13/2 pi the mode of order 8 has c = eta k/omega, omega where both masses swing on |k (1 + j eta)|."""
    rubber = "{type: hysteretic_spring, nodes: [e, p], stiffness: 4 MN*m/rad, loss_factor: {psi: 1.13}}"
    shaft = "{type: shaft, nodes: [e, p], outer_diameter: 300 mm, length: 6 m, inertia: none}"
    text = TANKER.replace(shaft, rubber).replace("{value: 20000,", "{value: 1,")
    (table,) = tables(text, "resonances", "Critical speeds in normal operation")
    (note,) = [words(one) for one in table.notes if words(one).startswith("Damping of tail as viscous")]
    eta = 1.13 / (2 * math.pi)
    omega = abs((4e6 * (1 + 1j * eta) * (1 / 9000 + 1 / 6000)) ** 0.5)
    assert f"c = η k/ω: {NumberText(eta * 4e6 / omega / 1e3, 3)} in mode 1 kN·m·s/rad." in note


def test_cyclic_irregularity_of_a_generator():
    """With one order h of amplitude a in the angle the speed swings by h W a, so that it is 2 h a."""
    text = TANKER.replace(
        "limits:", "limits:\n  flicker: {rule: machine_angle, node: p, pole_pairs: 3, angle: 9 deg, source: maker}"
    )
    report = make_report(tn.loads(text), sections=["components"], date=None)
    (told,) = [words(one.text) for one in of(Paragraph, blocks(report, "components")) if "Cyclic" in words(one.text)]
    s = 8j * RATED * math.pi / 30
    angle = torque(RATED, 20e3, 10e3) / abs(6000 * s**2 + 20e3 * s)
    assert told.startswith(f"Cyclic irregularity of p at {RATED} rpm, (ω_max − ω_min)/ω_mean of all orders: ")
    assert f"1/{NumberText(1 / (2 * 8 * angle), 3)} in normal firing; 1/" in told


def test_without_tolerances_the_document_says_what_was_not_examined():
    def said(text):
        report = make_report(tn.loads(text), sections=["resonances"], date=None)
        return [words(one.text) for one in of(Paragraph, blocks(report, "resonances"))]

    (told,) = [one for one in said(TANKER) if "states a tolerance" in one]
    assert told.endswith("is not examined beyond the conditions listed.")
    given = TANKER.replace("{value: 20000,", "{value: 20000, tolerance: 10 %,")
    assert not any("states a tolerance" in one for one in said(given))
