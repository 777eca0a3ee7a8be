"""What a calculation for approval says of a cylinder out, and of values that hang on little damping."""

import math

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows
from support.written_models import SHIP_SHAFTING

import torsionnet as tn
from torsionnet.machinery.excitations.reciprocating_engine import lost_harmonics
from torsionnet.machinery.orders.vector_sums import vector_sums
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock

RPM = np.pi / 30


@pytest.fixture(scope="module")
def carrier():
    sections = ["conditions", "harmonics", "measurement_plan"]
    return make_report("bulk_carrier", sections=sections, date=None)


def table(report, section, words):
    return next(one for one in of(TableBlock, blocks(report, section)) if words in str(one.caption))


def texts(report, section):
    return " ".join(str(one.text) for one in of(Paragraph, blocks(report, section)))


def test_conditions_say_how_much_of_the_mean_torque_is_left(carrier):
    """Cylinder 2 of 6 does not fire; its compression and expansion give back what they took, but for the gas exchange."""
    gas = tn.load("bulk_carrier").definition.excitations["engine"].gas
    phi = 2 * np.pi * np.arange(len(gas.fired.values)) / len(gas.fired.values)
    engine = tn.load("bulk_carrier").definition.excitations["engine"]
    ratio = engine.stroke / 2 / engine.rod_length
    rate = np.sin(phi) + ratio * np.sin(phi) * np.cos(phi) / np.sqrt(1 - (ratio * np.sin(phi)) ** 2)
    left = np.mean(gas.motored.values * rate) / np.mean(gas.fired.values * rate)
    assert f"rpm: {100 * (5 + left) / 6:.3g} % (misfire)" in texts(carrier, "conditions")


def test_what_is_lost_at_a_cylinder_by_order():
    """Gas pressure with and without injection, their difference over the cycle by sums of cosines and sines."""
    engine = tn.load("two_stroke_ship").configured("misfire_2").definition.excitations["engine"]
    gas, area, radius, rod = engine.gas, math.pi * 0.6**2 / 4, 1.2, 2.46
    phi, step = 2 * np.pi * np.arange(90) / 90, 1e-4

    def way(angle):
        return radius * (1 - np.cos(angle)) + rod - np.sqrt(rod**2 - (radius * np.sin(angle)) ** 2)

    torque = (np.array(gas.fired.values) - gas.motored.values) * area * (way(phi + step) - way(phi - step)) / (2 * step)
    found = lost_harmonics(engine, 105 * RPM)
    for place, order in enumerate((1, 2, 3)):
        expected = 2 * math.hypot(np.mean(torque * np.cos(order * phi)), np.mean(torque * np.sin(order * phi)))
        assert found[place] == pytest.approx(expected, rel=1e-6)


def test_harmonics_with_a_cylinder_out(carrier):
    """Beside the torque of a cylinder what is lost with it, and vector sums with it left out."""
    ship = tn.load("bulk_carrier").configured("misfire")
    harmonics = table(carrier, "harmonics", "tangential pressure")
    assert str(harmonics.columns[-1].text) == "Lost"
    lost = lost_harmonics(ship.definition.excitations["engine"], 105 * RPM) / 1e3
    assert [float(row[-1]) for row in rows(harmonics)] == pytest.approx(lost.tolist(), abs=0.06)
    sums = table(carrier, "harmonics", "vector sums")
    assert [str(group.title) for group in sums.groups] == ["All cylinders working", "Without cylinder 2"]
    out = vector_sums(ship, "engine", modes=[1], without=[2])
    assert float(rows(sums)[-1][1]) == pytest.approx(out.of(1, 6), abs=6e-5)
    assert {len(cell.partition(".")[2]) for row in rows(sums) for cell in row[1:]} == {4}  # decimals, of both groups
    assert "With a cylinder out: that cylinder" in str(table(carrier, "harmonics", "indicated").notes)


def test_gas_off_is_a_cylinder_out_everywhere():
    """One question, asked once: limits, groups of tables, what is not examined."""
    text = (tn.load("bulk_carrier").to_yaml()).replace("engine.misfire", "engine.gas_off")
    report = make_report(tn.loads(text), kind="approval", sections=["conditions", "forced_response"], date=None)
    groups = [str(group.title) for group in table(report, "forced_response", "Largest utilisation").groups]
    assert groups == ["All cylinders working", "With a cylinder out"]
    assert "83.3 % (misfire)" in texts(report, "conditions")
    assert "no condition of the model has it" not in str(blocks(report, "conditions"))


def test_plan_has_what_is_expected_with_a_cylinder_out(carrier):
    found = rows(table(carrier, "measurement_plan", "Expected with a cylinder out"))
    ship = tn.load("bulk_carrier").configured("misfire")
    assert {row[0].partition(",")[0] for row in found} == {"Angle", "Torque"}
    for row in found:
        output = "angle(c1)" if row[0].startswith("Angle") else "torque(int_shaft)"
        run = ship.order_response(output, speeds=[float(row[1]) * RPM])
        scale = 1e3 if row[0].startswith("Angle") else 1e-3
        half_range = next(cell for cell in row[2:] if cell.replace(".", "").isdigit())
        assert float(half_range) == pytest.approx(run.half_range[0, 0] * scale, rel=0.02)


def damped(value):
    return SHIP_SHAFTING.replace("damping: 4000}", f"damping: {value}}}").replace(
        "  slip: {type: damper", "  # slip: {type: damper"
    )


@pytest.mark.parametrize(("value", "told"), [(500.0, True), (20000.0, False)])
def test_conclusion_says_where_a_value_hangs_on_little_damping(value, told):
    """The water alone damps: the ratio of the first mode by eigenvalues of matrices written out."""
    ship = tn.loads(damped(value))
    report = make_report(ship, kind="approval", sections=["conclusion"], date=None)
    k = [79.3e9 * math.pi * 0.3**4 / 32 / length for length in (3, 4)]
    M, D = np.diag([5000.0, 100, 3000]), np.diag([0, 0, value])
    K = np.array([[k[0], -k[0], 0], [-k[0], k[0] + k[1], -k[1]], [0, -k[1], k[1]]])
    poles = np.linalg.eigvals(
        np.block([[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    )
    first = min((one for one in poles if one.imag > 1), key=lambda one: one.imag)
    ratio = -first.real / abs(first)
    assert bool(ratio < 0.005) is told
    words = str(of(Listing, blocks(report, "conclusion"))[0].items)
    assert (
        "Tail, " in words and f"with mode 1, whose calculated damping ratio is only {100 * ratio:.1g} %" in words
    ) is told
    assert ("a measurement is advised" in words) is told
