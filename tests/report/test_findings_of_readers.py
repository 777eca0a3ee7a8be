"""What a reader of a calculation for approval asked and did not find: flanks, engines that stand still, shares by throw."""

import re

import pytest
from support.report_blocks import blocks, of, rows, words

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock

TWO = """torsionnet: 1
name: two engines on one wheel
elements:
  port: {type: inertia, node: p, inertia: 20}
  port_shaft: {type: spring, nodes: [p, pc], stiffness: 60 kN*m/rad, damping: 40}
  port_clutch: {type: rigid_coupling, nodes: [pc, w]}
  starboard: {type: inertia, node: s, inertia: 21}
  starboard_shaft: {type: spring, nodes: [s, sc], stiffness: 60 kN*m/rad, damping: 40}
  starboard_hub: {type: inertia, node: sc, inertia: 2}
  starboard_clutch: {type: spring, nodes: [sc, w], stiffness: 9 MN*m/rad}
  wheel: {type: inertia, node: w, inertia: 30}
speeds: {of: p, range: 500..900 rpm, step: 5 rpm, rated: 800 rpm}
excitations:
  port: {type: harmonic, node: p, orders: {1: {amplitude: 1 kN*m}}}
  starboard: {type: harmonic, node: s, orders: {1: {amplitude: 1 kN*m}}}
limits:
  port_shaft: {rule: curve, output: torque(port_shaft), value: 90 kN*m, source: maker}
  clutch: {rule: coupling, element: starboard_clutch, T_KW: 90 kN*m, source: maker}
configurations:
  engines:
    both: {}
    port_alone: {"off": [starboard_clutch], starboard.enabled: false}
report: {kind: approval}
"""


def document(text, *sections):
    return make_report(tn.loads(text), sections=list(sections), date=None)


def test_a_limit_on_a_part_that_is_switched_off_is_named_in_the_conclusion():
    found = of(Listing, blocks(document(TWO, "conclusion", "conditions"), "conclusion"))[0]
    said = [words(item) for item in found.items]
    assert "Clutch not judged in port alone" in said


def test_a_part_that_nothing_connects_has_no_critical_speeds():
    """The starboard engine alone swings at 60 kN m/rad on 21 and 2 kg m^2; port's order 1 passes none of it on."""
    report = document(TWO, "resonances")
    for table in of(TableBlock, blocks(report, "resonances")):
        heads = [words(column.text) for column in table.columns]
        if "Gen. force" in heads:
            assert all(float(row[heads.index("Gen. force")] or 1) > 1e-6 for row in rows(table))


FLANK = """torsionnet: 1
name: flank of a resonance below the range
elements:
  engine: {type: inertia, node: e, inertia: 2}
  fan: {type: inertia, node: f, inertia: 1}
  shaft: {type: spring, nodes: [e, f], stiffness: 10 kN*m/rad, damping: 2}
speeds: {of: e, range: 650..800 rpm, step: 5 rpm}
excitations: {gas: {type: harmonic, node: f, orders: {2: {amplitude: 1 N*m}}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 200 N*m, source: maker}}
configurations: {firing: {even: {}, uneven: {gas.orders: {2: {amplitude: 40 N*m}}}}}
report: {kind: approval}
"""


def told_beside(text, how="not examined"):
    every = blocks(document(text, "resonances"), "resonances")
    texts = [words(one.text) for one in of(Paragraph, every)]
    texts += [words(note) for one in of(TableBlock, every) for note in one.notes]
    return [said for one in texts for said in re.findall(rf"(?:In|Beside)[^.]*{how}: [^.]*\.\d", one)]


def test_critical_speeds_outside_whose_flank_matters_are_named_with_their_condition():
    """Order 2 meets sqrt(1.5e4) rad/s at 584.8 rpm; in even firing it is still."""
    still = FLANK.replace("even: {}", "even: {gas.orders: {3: {amplitude: 1 N*m}}}")
    assert "In uneven, beside the range and not examined: gas 2, mode 1 at 584.8" in told_beside(still)
    assert told_beside(FLANK) == ["Beside the range of 650 to 800 rpm, not examined: gas 2, mode 1 at 584.8"]


def test_critical_speeds_that_starts_pass_are_not_said_to_be_unexamined():
    text = FLANK.replace("step: 5 rpm", "step: 5 rpm, run_up: {range: 500..650 rpm, load: 100 %}")
    said = "passed and judged by starts alone"
    assert told_beside(text, said) == [f"Beside the range of 650 to 800 rpm, {said}: gas 2, mode 1 at 584.8"]
    assert told_beside(text) == []
    alone = text.replace("configurations: {firing: {even: {}, uneven: {gas.orders: {2: {amplitude: 40 N*m}}}}}", "")
    tables = of(TableBlock, blocks(document(alone, "conclusion"), "conclusion"))
    notes = [words(note) for one in tables for note in one.notes]
    assert "Starts pass critical speeds, the largest at resonance first: gas 2, mode 1 at 584.8." in notes


def test_a_condition_whose_start_is_not_judged_names_the_limit():
    """At the resonance, 584.8 rpm, 40 N m make more than the 200 N m allowed; nothing is said of passing."""
    text = FLANK.replace("step: 5 rpm", "step: 5 rpm, run_up: {range: 500..650 rpm, load: 100 %}")
    tables = of(TableBlock, blocks(document(text, "conditions"), "conditions"))
    (found,) = [one for one in tables if words(one.caption).startswith("Conditions examined")]
    at = [words(column.text) for column in found.columns].index("Verdict")
    assert [row[at] for row in rows(found)] == ["pass", "pass; starts not judged: shaft"]


THROWS = """torsionnet: 1
name: crankshaft with a limit in passing
elements:
  one: {type: inertia, node: c1, inertia: 1}
  crank: {type: spring, nodes: [c1, c2], stiffness: 200 kN*m/rad, damping: 60}
  two: {type: inertia, node: c2, inertia: 1}
  shaft: {type: spring, nodes: [c2, b], stiffness: 500 kN*m/rad, damping: 5}
  fan: {type: inertia, node: b, inertia: 8}
sensors: {T_crank: {torque: crank}}
speeds: {of: c1, range: 1500..4500 rpm, step: 50 rpm}
excitations:
  engine:
    {type: reciprocating_engine, speed_of: c1, cycle: 2, cylinders: {1: c1, 2: c2}, firing_angles: {1: 0 deg, 2: 180 deg},
     bore: 100 mm, stroke: 100 mm, rod_length: 200 mm, reciprocating_mass: 1 kg, orders: [1, 2], gas: {fired: [PRESSURE]}}
limits: {crank: {rule: curve, output: T_crank, value: 1 kN*m, transient_factor: 2, source: maker}}
report: {kind: approval}
"""


def test_throws_are_shown_by_the_limit_that_is_used_most():
    pressure = ", ".join(str(round(4e5 * (1.2 - abs(place - 36) / 36))) for place in range(72))
    found = of(TableBlock, blocks(document(THROWS.replace("PRESSURE", pressure), "components"), "components"))
    throws = next(one for one in found if words(one.caption).startswith("Vibratory torque by throw"))
    heads = [words(column.text) for column in throws.columns]
    for row in rows(throws):
        largest, used = float(row[heads.index("Largest half range")]), float(row[heads.index("Used most")])
        assert used == pytest.approx(100 * largest / 1.0, rel=1e-2)  # of 1 kN m in continuous operation, not of 2


def test_sections_that_a_society_asks_for_are_called_by_their_titles():
    text = FLANK.replace("report: {kind: approval}", "report: {kind: approval, rules: kr}")
    report = document(
        text, "conditions", "natural_frequencies", "resonances", "forced_response", "components", "conclusion"
    )
    titles = {words(one.title) for one in report.sections}
    found = next(
        one for one in of(TableBlock, blocks(report, "conditions")) if words(one.caption).startswith("Particulars")
    )
    named = {row[2] for row in rows(found)}
    assert named - {"not in this document"} <= titles
    assert {"Critical speeds", "Shafts, crankshaft, couplings, gears, dampers"} <= named


def test_orders_above_the_table_of_tangential_pressures_are_said_to_be_left_out():
    """The masses act up to order 15 of a two-stroke engine, the gas up to the end of its table."""
    table = "gas: {harmonics: {1: {amplitude: 3 bar, phase: 0 deg}, 2: {amplitude: 1 bar, phase: 9 deg}}}"
    text = THROWS.replace("orders: [1, 2], gas: {fired: [PRESSURE]}", table)
    for section in ("harmonics", "resonances", "forced_response"):
        said = [words(one.text) for one in of(Paragraph, blocks(document(text, section), section))]
        assert any(one.endswith("not in the tables of the excitations and not examined: engine 2.") for one in said)
