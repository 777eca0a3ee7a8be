"""What a reader signs: verdicts name margins that are not kept, loads of compressors, judged speeds and open passages."""

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows, words

import torsionnet as tn
from torsionnet.machinery.verdicts.operating_instructions import passed_ranges
from torsionnet.machinery.verdicts.range_passage import range_passages
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock

FAN = """torsionnet: 1
name: fan
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  wheel: {type: inertia, node: b, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 10 kN*m/rad, damping: 2}
speeds: {of: a, range: 400..700 rpm, step: 5 rpm}
excitations: {blades: {type: harmonic, node: b, orders: {2: {amplitude: 10}}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 100 N*m, source: maker}}
report: {kind: approval, rules: api684}
"""


def said(report, section):
    found = blocks(report, section)
    texts = [words(one.text) for one in of(Paragraph, found)]
    return texts + [words(item) for one in of(Listing, found) for item in one.items]


@pytest.fixture(scope="module")
def compressor():
    return tn.load("reciprocating_compressor_train")


@pytest.fixture(scope="module")
def compressor_report(compressor):
    """Report on all conditions, which the tests of its sections share."""
    return make_report(compressor, sections=["conclusion", "conditions"], date=None)


class TestCompressor:
    def test_all_cylinders_unloaded_alike_are_a_load_and_no_fault(self, compressor, compressor_report):
        checks = {name: compressor.configured(name).check_limits("crankshaft") for name in compressor.configurations}
        assert {name: check.misfiring for name, check in checks.items()} == {
            "full": False, "half": False, "one_head_end_lost": True,
        }  # fmt: skip
        table = next(one for one in of(TableBlock, blocks(compressor_report, "conditions")))
        sets = {row[0]: row[1] for row in rows(table)}
        assert sets["Half load"] == "Compressor: all cylinders unloaded alike"
        assert sets["One head end lost"] == "Compressor: cylinder 1 unloaded, the others loaded"

    def test_the_verdict_names_margins_that_are_not_kept(self, compressor_report):
        """Order 2 of the motor's line frequency goes from 40 to 100 Hz over the mode at 78 Hz: a margin of 0."""
        lead, *findings = said(compressor_report, "conclusion")
        assert lead.endswith("; separation margins not kept")
        (margins,) = [text for text in findings if text.startswith("Separation margins by api684 not kept")]
        assert "mode 2 from 2 x motor, electrical, 9 x compressor" in margins
        assert "no instruction makes up for that" in " ".join(
            words(note) for one in of(TableBlock, blocks(compressor_report, "conclusion")) for note in one.notes
        )

    def test_limits_that_nobody_states_are_named(self, compressor_report):
        found = said(compressor_report, "conclusion")
        assert "Limits whose values have no source: coupling, teeth." in found  # the crankshaft has one

    def test_without_a_rule_nothing_is_said_of_margins(self, compressor):
        plain = tn.loads(compressor.to_yaml().replace("rules: api684", "normal: full"))
        report = make_report(plain, sections=["conclusion"], configurations=["full"], date=None)
        assert "margins" not in " ".join(said(report, "conclusion"))


@pytest.fixture(scope="module")
def passages():
    fan = tn.loads(FAN)
    (barred,) = passed_ranges([fan.check_limits()])
    return range_passages(fan, barred, [1.0])


class TestPassages:
    def test_the_largest_value_is_one_of_the_range(self, passages):
        """Passed in a second the vibration is largest behind the range of some 3 rpm; the row is about the range."""
        for one in passages:
            low, high = np.floor(one.low * 30 / np.pi), np.ceil(one.high * 30 / np.pi)
            assert low - 1e-9 <= one.rpm <= high + 1e-9
            whole = one.response.peak("torque(shaft)").half_range
            assert one.largest <= whole * (1 + 1e-9)

    def test_what_dies_away_beside_it_is_said_with_the_steady_value(self, passages):
        up = next(one for one in passages if one.is_upward)
        rpm, value, steady = up.beyond
        assert rpm > up.high * 30 / np.pi
        assert value > 100 > steady
        # Two masses on a spring by hand, order 2: T = k (theta_a - theta_b).
        s = 2j * rpm * np.pi / 30
        spring = 10e3 + 2 * s
        one, two = 2 * s**2 + spring, s**2 + spring
        by_hand = abs(10 * spring * (spring - one) / (one * two - spring**2))
        assert steady == pytest.approx(by_hand, rel=0.02)

    def test_passages_that_are_not_calculated_are_named(self):
        """Half a dozen orders pass the one mode, at six speeds: the two that are used least are only named."""
        orders = "{2: {amplitude: 10}, 3: {amplitude: 10}, 4: {amplitude: 10}, 5: {amplitude: 10}, 6: {amplitude: 10}, 7: {amplitude: 10}}"
        text = FAN.replace("{2: {amplitude: 10}}", orders).replace("400..700 rpm", "150..700 rpm")
        fan = tn.loads(text.replace("rules: api684", "passage: [5 s]"))
        count = len(passed_ranges([fan.check_limits()]))
        assert count == 6
        found = said(make_report(fan, sections=["passage"], date=None), "passage")
        assert "Passages not examined, to be passed all the same:" in found
        assert len([text for text in found if text.endswith("rpm: shaft")]) == count - 4

    def test_a_limit_with_several_criteria_is_named_once(self):
        """Vibratory torque and heat of one coupling bar the same speeds; two of six passages are only named."""
        orders = "{2: {amplitude: 10}, 3: {amplitude: 10}, 4: {amplitude: 10}, 5: {amplitude: 10}, 6: {amplitude: 10}, 7: {amplitude: 10}}"
        limit = "{rule: coupling, element: shaft, T_KW: 100 N*m, P_KV: 1.5 W, T_Kmax: 9 kN*m, source: maker}"
        text = FAN.replace("{rule: curve, output: torque(shaft), value: 100 N*m, source: maker}", limit)
        fan = tn.loads(text.replace("{2: {amplitude: 10}}", orders).replace("400..700 rpm", "150..700 rpm"))
        ranges = passed_ranges([fan.check_limits()])
        assert {frozenset(one.criterion for one in barred.verdicts) for barred in ranges} == {
            frozenset(("T_KW", "P_KV"))
        }
        found = said(make_report(fan, sections=["passage"], date=None), "passage")
        named = [text.rpartition("rpm: ")[2] for text in found if "rpm: shaft" in text]
        assert named == ["shaft"] * (len(ranges) - 4)

    def test_a_passage_that_no_limit_judges_is_no_instruction_without_words(self):
        report = make_report(tn.loads(FAN), sections=["conclusion"], date=None)
        tables = of(TableBlock, blocks(report, "conclusion"))
        (row,) = next(rows(one) for one in tables if words(one.caption) == "Operating instructions")
        assert row[2] == "pass without stopping; the passage is not judged: no limit in passing is given"
        verdicts = next(one for one in tables if words(one.caption).startswith("Verdict"))
        place = [column.text for column in verdicts.columns].index("Judged")
        assert [row[place] for row in rows(verdicts)] == ["400 to 700"]


def test_states_have_the_name_of_what_they_are_of():
    text = FAN + "configurations: {pump: {on: {}, off: {off: [wheel]}}, gear: {full: {}, V: {}}}\n"
    titles = tn.loads(text.replace("off: [wheel]", "rotor.inertia: 3")).definition.configurations
    from torsionnet.model.condition_titles import ConditionTitles

    assert ConditionTitles(titles).of("pump=off,gear=full") == "pump off, full gear"
