"""Remarks on critical speeds: what values that were assumed move, sources and cylinders that cancel."""

import math
import re

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows, words

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock

PLANT = """torsionnet: 1
name: two stages
parameters:
  k: {value: 10 kN*m/rad, tolerance: 10 %, description: coupling}
  c: {value: 2 N*m*s/rad, tolerance: 30 %}
  J: {value: 1 kg*m^2}
elements:
  rotor: {type: inertia, node: a, inertia: 2 kg*m^2}
  wheel: {type: inertia, node: b, inertia: J}
  shaft: {type: spring, nodes: [a, b], stiffness: k, damping: c}
speeds: {of: a, range: 400..700 rpm, step: 5 rpm}
excitations:
  low: {type: harmonic, node: b, orders: {2: {amplitude: 10 N*m}}}
  high: {type: harmonic, node: b, orders: {2: {amplitude: 9 N*m, phase: 180 deg}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 200 N*m, source: maker}}
report: {kind: approval}
"""


def criticals(text, **options):
    return of(
        TableBlock, blocks(make_report(tn.loads(text), sections=["resonances"], date=None, **options), "resonances")
    )


def assumed(tables):
    return next(one for one in tables if words(one.caption).startswith("What values"))


def notes(table):
    return "\n".join(map(words, table.notes))


def test_changes_are_those_of_the_closed_form():
    """omega^2 = k/mu, zeta = c/(2 sqrt(k mu)) with mu = 2/3 kg m^2; Q = 1/(2 zeta) goes with sqrt(k)/c."""
    found = {row[0]: row for row in rows(assumed(criticals(PLANT)))}
    speed = math.sqrt(1e4 * 1.5) / 2 * 30 / math.pi
    assert found["k"][1:4] == ("10", "5", "5")
    assert found["c"][1:4] == ("30", "0", "-30")
    assert found["together"][2:4] == ("5", "30.4")  # sqrt(5^2 + 30^2)
    moved = re.findall(r"(low|high) 2: ([\d.]+) ± ([\d.]+)", found["k"][4])
    assert {name for name, *_ in moved} == {"low", "high"}
    for _, at, off in moved:
        assert (float(at), float(off)) == pytest.approx((speed, 0.05 * speed), abs=0.06)
    assert found["c"][4] == ""


def test_without_limits_and_without_tolerances():
    unjudged = re.sub(r"^limits:.*\n", "", PLANT, flags=re.MULTILINE)
    assert len(rows(assumed(criticals(unjudged)))) == 3
    exact = re.sub(r", tolerance: \d+ %", "", PLANT)
    assert not any(words(one.caption).startswith("What values") for one in criticals(exact))


def test_sources_that_cancel_are_told_beside_their_sum():
    (table, _) = criticals(PLANT)
    text = notes(table)
    assert "Sources at one frequency cancel each other: low 2 + high 2, mode 1 (10 % of the largest)" in text  # 10 - 9
    heads = [words(column.text) for column in table.columns]
    alone = {row[0].replace("\xa0", " "): float(row[heads.index("Order alone")]) for row in rows(table)}
    assert alone["low 2 + high 2"] == pytest.approx(alone["low 2"] - alone["high 2"], abs=2e-3)
    aligned = notes(criticals(PLANT.replace("phase: 180 deg", "phase: 0 deg"))[0])
    assert "cancel" not in aligned


ENGINE = """torsionnet: 1
name: two cylinders
elements:
  one: {type: inertia, node: c1, inertia: 1 kg*m^2}
  crank: {type: spring, nodes: [c1, c2], stiffness: 1 MN*m/rad, damping: 20}
  two: {type: inertia, node: c2, inertia: 1 kg*m^2}
  shaft: {type: spring, nodes: [c2, b], stiffness: 50 kN*m/rad, damping: 5}
  fan: {type: inertia, node: b, inertia: 3 kg*m^2}
speeds: {of: c1, range: 600..3000 rpm, step: 10 rpm}
excitations:
  engine:
    {type: reciprocating_engine, speed_of: c1, cycle: 2, cylinders: {1: c1, 2: c2}, firing_angles: {1: 0 deg, 2: 180 deg},
     bore: 200 mm, stroke: 200 mm, rod_length: 400 mm, reciprocating_mass: 10 kg, orders: [1, 2],
     gas: {tangential: {pressure: [0 bar, 10 bar]}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 200 N*m, source: maker}}
report: {kind: approval}
"""


def test_cylinders_that_cancel_are_told_with_what_is_left():
    mass, stiffness = np.diag([1.0, 1.0, 3.0]), 1e6 * np.array([[1, -1, 0], [-1, 1, 0], [0, 0, 0.0]])
    stiffness[1:, 1:] += 5e4 * np.array([[1, -1], [-1, 1]])
    values, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    first = np.abs(shapes[:2, np.argsort(values)[1]])
    left = abs(first[0] - first[1]) / first.sum()
    text = ENGINE.replace("gas: {tangential: {pressure: [0 bar, 10 bar]}}", f"gas: {{fired: {PRESSURE}}}")
    (table,) = criticals(text)
    (told,) = re.findall(r"engine 1, mode 1 \(([\d.]+)\s%\)", notes(table))
    assert float(told) == pytest.approx(100 * left, rel=0.02)
    assert "engine 2, mode 1 (" not in notes(table)


PRESSURE = [round(4e5 * (1.2 + math.cos(math.radians(angle)))) for angle in range(0, 360, 5)]
"""Pressure over a turn from top dead centre on, in Pa."""


def test_in_german():
    found = criticals(PLANT, language="de")
    table = next(one for one in found if words(one.caption).startswith("Was angenommene"))
    assert [row[0] for row in rows(table)] == ["k", "c", "zusammen"]
    assert "Quellen einer Frequenz heben einander auf: low 2 + high 2, Eigenform 1 (10 % der größten)" in notes(
        found[0]
    )


@pytest.mark.parametrize("share", ["0 %", "100 %", "-5 %"])
def test_a_tolerance_is_a_share_below_one(share):
    with pytest.raises(tn.ModelError, match=r":4:38: .*out-of-range"):
        tn.loads(PLANT.replace("tolerance: 10 %", f"tolerance: {share}"))


def test_a_tolerance_stays_where_a_condition_changes_the_value():
    text = PLANT + "configurations: {stiff: {k: 12 kN*m/rad}, soft: {}}\n"
    model = tn.loads(text).configured("stiff")
    assert model.parameter_definitions["k"].tolerance == pytest.approx(0.1)
    assert tn.loads(tn.loads(text).to_yaml()).parameter_definitions["k"].tolerance == pytest.approx(0.1)
