"""Mean indicated pressures at half load, and torques that a cylinder loses, in the condition of their table."""

import math

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.machinery.excitations.reciprocating_engine import lost_harmonics
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock

FIRED = [5 + 60 * math.exp(-((((degrees + 360) % 720 - 360 - 12) / 35) ** 2)) for degrees in range(0, 720, 10)]
MOTORED = [5 + 30 * math.exp(-((((degrees + 360) % 720 - 360) / 35) ** 2)) for degrees in range(0, 720, 10)]
PLANT = """torsionnet: 1
name: two cylinders
elements:
  one: {type: inertia, node: c1, inertia: 2 kg*m^2}
  crank: {type: spring, nodes: [c1, c2], stiffness: 1 MN*m/rad, damping: 40 N*m*s/rad}
  two: {type: inertia, node: c2, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [c2, w], stiffness: 0.5 MN*m/rad, damping: 100 N*m*s/rad}
  wheel: {type: inertia, node: w, inertia: 20 kg*m^2}
speeds: {of: c1, range: 500..1500 rpm, step: 50 rpm, rated: 1500 rpm}
excitations:
  engine: {type: reciprocating_engine, speed_of: c1, cycle: 4, cylinders: {1: c1, 2: c2}, firing_order: [1, 2],
    bore: 100 mm, stroke: 100 mm, rod_length: 200 mm, reciprocating_mass: 1 kg, gas: GAS}
limits: {shaft: {rule: curve, output: torque(shaft), value: 1 kN*m, source: own}}
configurations:
  normal: {}
  misfire: {engine.misfire: [1]}
report: {kind: approval}
"""


def document(exponent):
    pressures = ", ".join(
        f"{name}: [{', '.join(f'{one:.3f} bar' for one in values)}]"
        for name, values in (("fired", FIRED), ("motored", MOTORED))
    )
    gas = f"{{{pressures}, crankcase: 1 bar, reference: absolute, rated: 1500 rpm, exponent: {exponent}}}"
    return tn.loads(PLANT.replace("GAS", gas))


def table(report, words):
    return next(one for one in of(TableBlock, blocks(report, "harmonics")) if words in str(one.caption))


def pressures(model):
    report = make_report(model, sections=["harmonics"], date=None)
    return [tuple(map(float, row)) for row in rows(table(report, "mean indicated pressure"))]


def test_half_load_on_a_propeller_curve():
    """Pressure with the square of the speed, power with its third: half of it at 0.5^(1/3) of the rated speed."""
    found = {load: row for *row, load in pressures(document(2))}
    speed, pressure, torque, _ = found[50.0]
    _, full, most, _ = found[100.0]
    assert speed == pytest.approx(1500 * 0.5 ** (1 / 3), abs=0.06)
    assert pressure == pytest.approx(full * 0.5 ** (2 / 3), abs=0.01)
    assert torque == pytest.approx(most * 0.5 ** (2 / 3), rel=5e-3)


def test_half_load_at_one_speed():
    """Where the pressure does not follow the speed half the power at rated speed is half the pressure."""
    half, full = pressures(document(0))
    assert (half[0], half[-1], full[-1]) == (full[0], 50, 100) == (1500, 50, 100)
    assert half[1] == pytest.approx(full[1] / 2, abs=0.01)
    assert half[2] == pytest.approx(full[2] / 2, rel=2e-3)


def test_the_torque_lost_is_that_of_the_harmonics_in_the_row():
    model = document(2)
    report = make_report(model, sections=["harmonics"], date=None)
    found = table(report, "tangential pressure")
    engine = model.configured("misfire").definition.excitations["engine"]
    expected = dict(zip(engine.acting_orders.tolist(), lost_harmonics(engine, 1500 * np.pi / 30) / 1e3, strict=True))
    listed = [(float(row[0]), float(row[-1])) for row in rows(found)]
    assert listed
    assert [lost for _, lost in listed] == pytest.approx([expected[order] for order, _ in listed], abs=6e-4)


def test_other_loads_and_pitches_have_tables_of_their_own():
    """A quarter of the pressure at zero pitch, and blades that take 10 % of a fifth of 1000 N m, not 8 % of all."""
    load = "{mean_indicated_pressure: SIZE bar, rated: 1500 rpm, exponent: 2}"
    order = "{1: {amplitude: 1 bar, phase: 0 deg}}"
    text = PLANT.replace("GAS", f"{{harmonics: {{0 bar: {order}, 20 bar: {order}}}}}, load: {load}")
    screw = "screw: {type: propeller, node: w, blades: 3, torque: 1 kN*m, rated: 1500 rpm, pitch: controllable, "
    screw += "blade_orders: {1: {share: 8 %}}, conditions: {zero: {torque: 20 %, blade_orders: {1: {share: 10 %}}}}}"
    text = text.replace("SIZE", "16").replace("limits:", f"  {screw}\nlimits:")
    text = text.replace("misfire: {engine.misfire: [1]}", f"idle: {{screw.condition: zero, engine.load: {load}}}")
    report = make_report(tn.loads(text.replace("SIZE", "4")), sections=["harmonics"], date=None)
    found = of(TableBlock, blocks(report, "harmonics"))
    full, idle = (one for one in found if "mean indicated pressure" in str(one.caption))
    assert [float(rows(one)[-1][1]) for one in (full, idle)] == [16, 4]
    ahead, zero = (one for one in found if "blades" in str(one.caption))
    assert [float(rows(one)[0][3]) for one in (ahead, zero)] == pytest.approx([0.08, 0.02])
    assert [", idle" in str(one.caption) for one in (full, idle, ahead, zero)] == [False, True, False, True]
