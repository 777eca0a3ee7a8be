"""Conclusion of the calculation for approval: worst condition of every limit, instructions, what is not covered."""

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows
from support.written_models import SHIP_SHAFTING

import torsionnet as tn
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import GRAVITY
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, Picture, TableBlock


@pytest.fixture(scope="module")
def ship():
    return tn.loads(SHIP_SHAFTING)


@pytest.fixture(scope="module")
def report(ship):
    return make_report(ship, kind="approval", sections=["conclusion"], date=None)


def largest(ship, limit):
    """Largest utilisation over all conditions with its condition and speed in rpm, from the checks' own arrays."""
    found = []
    for name in ship.configurations:
        check = ship.configured(name).check_limits(limit)
        (verdict,) = check.verdicts
        share = verdict.values / verdict.allowed
        at = int(np.argmax(share))
        found.append((float(share[at]), name, float(check.rpm[at]), float(verdict.values[at])))
    return max(found)


def test_each_component_has_its_worst_condition(ship, report):
    table = of(TableBlock, blocks(report, "conclusion"))[0]
    heads = [str(column.text) for column in table.columns]
    found = [dict(zip(heads, row, strict=True)) for row in rows(table)]
    normal, worst = found[: len(found) // 2], found[len(found) // 2 :]
    assert [group.title for group in table.groups] == ["Normal", "Worst of 2 conditions"]
    assert {cells["Condition"] for cells in normal} == {""}
    for cells in worst:
        share, name, rpm, value = largest(ship, "tail" if cells["Component"].startswith("tail") else "front_torque")
        assert cells["Condition"] == name == "normal"
        assert float(cells["Speed"]) == pytest.approx(rpm, rel=1e-2)
        assert float(cells["Value"]) == pytest.approx(value / 1e3, rel=1e-2)
        assert float(cells["Utilisation"]) == pytest.approx(100 * share, rel=1e-2)


def test_verdict_is_the_gravest_of_any_condition(ship):
    checks = tuple(ship.configured(name).check_limits() for name in ship.configurations)
    for worst in LimitConclusion(checks).worst():
        those = [one.verdict for check in checks for one in check.verdicts if one.limit == worst.verdict.limit]
        assert worst.gravest == max(those, key=GRAVITY.index)


@pytest.mark.parametrize("output", ["torque(front)", "torque(tail)"])
def test_what_is_not_covered_names_shafts_without_a_limit(output):
    """A curve judges the shaft whose torque it limits."""
    text = SHIP_SHAFTING.replace(
        "  front_torque:",
        "  shaft: {rule: iacs_m68, element: tail, shaft: propeller, feature: keyless, material: carbon, "
        "tensile_strength: 560 MPa}\n  front_torque:",
    )
    limited = tn.loads(text.replace("output: torque(front)", f"output: {output}"))
    found = blocks(make_report(limited, kind="approval", sections=["conclusion"], date=None), "conclusion")
    said = [item for listed in of(Listing, found) for item in listed.items]
    assert (("Shafts without a limit, which are not judged: front.",) in said) == (output == "torque(tail)")


def test_conditions_left_out_are_no_pass(ship):
    found = make_report(ship, kind="approval", sections=["conclusion"], configurations=["weak"], date=None)
    assert "1 of 2 configurations not examined: normal" in str(of(Listing, blocks(found, "conclusion"))[0].items)
    assert "incomplete" in str(of(Paragraph, blocks(found, "conclusion"))[0])


def test_distances_from_rated_speed(ship):
    found = make_report(ship, kind="approval", sections=["resonances"], date=None)
    (text,) = [
        note[0] for table in of(TableBlock, blocks(found, "resonances")) for note in table.notes if "rated" in str(note)
    ]
    critical = next(
        one for one in ship.configured("normal").critical_speeds().crossings if one.order == 6 and one.mode.number == 1
    )
    share = 100 * (critical.natural_speed * 30 / np.pi / 110 - 1)
    assert f"gas 6, mode 1: {share:+.1f} %".replace("-", "\N{MINUS SIGN}") in text


@pytest.mark.parametrize(("configurations", "where"), [((), " in configuration normal"), (["weak"], "")])
def test_figures_of_limits_name_the_worst_of_several_conditions(ship, configurations, where):
    """``normal`` has the larger torque; of one condition there is nothing to tell apart. No sensor is needed."""
    found = make_report(ship, sections=["limits"], configurations=configurations, date=None)
    pictures = of(Picture, blocks(found, "limits"))
    assert [one.caption for one in pictures] == [
        (f"Limit {name} over speed{where}.",) for name in ("tail", "front torque")
    ]
