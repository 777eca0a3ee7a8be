"""Conditions in documents: titles, the normal one first, instructions of each by itself, ranges that no shaft may pass."""

import math
import re

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows, words
from support.tanker import TANKER, torque

import torsionnet as tn
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.operating_instructions import instruction_table, operating_instructions
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.report import make_report
from torsionnet.report.document_tree import Listing, Paragraph, TableBlock

RPM = math.pi / 30
SECTIONS = ["conclusion", "conditions", "limits", "passage", "measurement_plan"]
FULL, ZERO = ("pitch=full,firing=normal", "propeller at zero pitch")


def above(allowed, damping, amplitude):
    """Whole rpm outward of the speeds at which the torque by hand is above a value in N m."""
    speeds = np.arange(20, 120, 0.001)
    over = speeds[torque(speeds, damping, amplitude) > allowed]
    return math.floor(over[0]), math.ceil(over[-1])


@pytest.fixture(scope="module")
def tanker():
    return tn.loads(TANKER)


@pytest.fixture(scope="module")
def checks(tanker):
    return tuple(tanker.configured(name).check_limits() for name in tanker.configurations)


@pytest.fixture(scope="module")
def report(tanker):
    return make_report(tanker, sections=SECTIONS, date=None)


def everything(report):
    """All texts of a document in one."""
    found = []
    for section in report.sections:
        for block in section.blocks:
            if isinstance(block, TableBlock):
                cells = [cell for group in block.groups for row in group.rows for cell in row]
                found += [block.caption, *(group.title for group in block.groups), *cells, *block.notes]
            elif isinstance(block, Listing):
                found += block.items
            elif isinstance(block, Paragraph):
                found.append(block.text)
    return "\n".join(map(words, found))


def captioned(report, section, caption):
    return next(one for one in of(TableBlock, blocks(report, section)) if words(one.caption).startswith(caption))


class TestPassage:
    """In zero pitch the tail shaft has more than it bears in passing; the flange alone could pass."""

    def test_numbers_are_those_by_hand(self, checks):
        for check, damping, amplitude in zip(checks, [20e3, 20e3, 9e3, 9e3], [10e3, 10.5e3] * 2, strict=True):
            one = check.of("tail", "in passing")
            assert one.worst_value == pytest.approx(torque(one.worst_rpm, damping, amplitude), rel=1e-6)
            assert (one.verdict == "fail") == (damping == 9e3)

    def test_the_union_of_all_limits_and_the_least_passage_decide(self, checks):
        found = {one.conditions[0]: one for one in operating_instructions(checks)}
        low, high = above(50e3, 20e3, 10e3)
        one = found[FULL]
        assert (one.from_rpm, one.to_rpm, one.action) == (low, high, "pass without stopping")
        assert one.limits == ("flange, continuous", "tail, continuous")
        assert one.besides == "no limit in passing is given for flange"
        low, high = above(50e3, 9e3, 10e3)
        one = found["pitch=zero,firing=normal"]
        assert (one.from_rpm, one.to_rpm) == (low, high)
        assert one.action == f"not to be run or passed: not above {low} rpm"
        assert one.limits == ("tail, in passing", "flange, continuous", "tail, continuous")
        assert (one.allowed, one.allowed_in_passing) == pytest.approx((60e3, 120e3))
        assert one.value == pytest.approx(torque(one.rpm, 9e3, 10e3), rel=1e-6)

    def test_what_remains_and_where_it_may_be_passed_is_said(self, checks):
        """Only the pitch is changed, not the firing beside it."""
        found = {one.conditions[0]: one.elsewhere for one in operating_instructions(checks)}
        low, high = above(50e3, 20e3, 10.5e3)
        assert found["pitch=zero,firing=uneven"] == f"pass {low} to {high} rpm in condition pitch=full,firing=uneven"
        assert found[FULL] == ""
        (alone,) = operating_instructions(checks[2:3])
        assert alone.elsewhere == "no condition examined reaches higher speeds"

    def test_highest_speed_is_below_it(self, checks):
        low, _ = above(50e3, 9e3, 10e3)
        assert math.floor(checks[2].highest / RPM) == low
        assert checks[2].passed == ()
        assert checks[2].finding() == f"flange, tail do not hold; at most {low} rpm of e"
        assert checks[2].permits(low * RPM)
        assert not checks[2].permits(100 * RPM)
        assert checks[0].highest is None
        assert checks[0].permits(100 * RPM)

    def test_conditions_that_exclude_each_other_are_never_joined(self, tanker, checks):
        ends = {name: above(50e3, 20e3, size) for name, size in (("normal firing", 10e3), ("uneven", 10.5e3))}
        assert ends["normal firing"] != ends["uneven"]
        zero, _ = above(50e3, 9e3, 10e3)
        assert zero == above(50e3, 9e3, 10.5e3)[0]  # so that these two are told together
        said = LimitConclusion(checks, ConditionTitles(tanker.definition.configurations)).findings
        for name, (low, high) in ends.items():
            assert f"limits hold with {low} to {high} rpm of e barred in full pitch, {name}" in said
        assert f"in {ZERO}: at most {zero} rpm of e" in said

    def test_what_holds_elsewhere_may_be_run(self, checks):
        (note,) = instruction_table(checks).notes
        assert note.startswith(
            "Not kept in single conditions: flange, tail; there only the remaining speeds may be run, "
        )
        (note,) = instruction_table(checks[::-1]).notes
        assert note.startswith("Not kept in normal operation: flange, tail; only the remaining speeds may be run, ")


def test_a_range_below_one_with_rated_speed_in_it_is_still_passed():
    """Order 5 has its peak at 103 rpm and is too large up to rated speed; that of order 8 at 64 rpm is passed."""
    text = TANKER.replace("{8: {amplitude: 10 kN*m}}}", "{8: {amplitude: 7 kN*m}, 5: {amplitude: 30 kN*m}}}")
    check = tn.loads(text).configured(FULL).check_limits("flange")
    (one,) = check.verdicts
    assert one.verdict == "fail"
    (barred,), (refused,) = one.barred, one.refused
    assert barred.high < refused.low < 110 * RPM < refused.high
    assert check.highest == refused.low
    below, above_it = operating_instructions([check])
    assert below.action == "pass without stopping"
    assert above_it.action == f"not to be run or passed: not above {above_it.from_rpm} rpm"


class TestDocument:
    """All tables tell the same of a condition, and call it by its title."""

    def test_no_name_of_a_configuration_is_printed(self, report):
        text = everything(report)
        assert "pitch=" not in text
        assert "firing=" not in text
        assert "propeller at zero pitch, uneven" in text
        assert "full pitch, normal firing" in text

    def test_tables_agree(self, report, checks):
        conditions = {row[0]: row for row in rows(captioned(report, "conditions", "Conditions examined"))}
        zero = conditions["Propeller at zero pitch, normal firing"]
        # What one limit refuses to pass, no other one only bars: flange and tail are not kept.
        assert zero[1] == "fail: flange, tail"
        assert checks[2].of("flange").verdict == checks[2].of("tail", "continuous").verdict == "fail"
        table = captioned(report, "conclusion", "Operating instructions")
        groups = {group.title: [tuple(map(words, row)) for row in group.rows] for group in table.groups}
        assert [*groups] == [words(name) for name in conditions]
        ((low, _, action, limits, at, value, *_),) = groups["Propeller at zero pitch, normal firing"]
        assert zero[2] == f"20 to {low} rpm"
        low, high = above(50e3, 20e3, 10e3)
        assert conditions["Full pitch, normal firing"][2] == f"20 to {low} rpm, {high} to 120 rpm"
        assert limits.startswith("tail, in passing; ")
        assert "tachometer red, notice at each control station" in action
        worst = [row for row in rows(captioned(report, "conclusion", "Verdict")) if row[2].startswith("propeller")]
        assert {row[3] for row in worst if row[1] == "in passing"} == {"fail"}
        assert float(value) == pytest.approx(torque(float(at), 9e3, 10e3) / 1e3, rel=1e-3)

    def test_what_must_not_be_passed_is_not_among_passages(self, report):
        listed = of(Listing, blocks(report, "passage"))[0]
        assert [words(item).partition(":")[0] for item in listed.items] == [
            f"{above(50e3, 9e3, 10e3)[0]} to {above(50e3, 9e3, 10e3)[1]} rpm, {ZERO}, normal firing",
            f"{above(50e3, 9e3, 10.5e3)[0]} to {above(50e3, 9e3, 10.5e3)[1]} rpm, {ZERO}, uneven",
        ]
        assert all("zero" not in words(one.caption) for one in of(TableBlock, blocks(report, "passage")))

    def test_a_plan_has_the_barred_ends_of_its_own_condition(self, report):
        low, high = above(50e3, 20e3, 10e3)
        table = captioned(report, "measurement_plan", "Torque")
        ends = {row[1]: float(row[0]) for row in rows(table) if "arred" in row[1]}
        assert ends == {"Barred from": low, "Barred to": high}

    def test_highest_permitted_is_the_same_number(self, tanker):
        named = make_report(
            tanker, sections=["measurement_plan"], date=None, configurations=["pitch=zero,firing=normal"]
        )
        (highest,) = [row[0] for row in rows(captioned(named, "measurement_plan", "Torque")) if "ermitted" in row[1]]
        assert float(highest) == above(50e3, 9e3, 10e3)[0]

    def test_a_changed_parameter_is_told_by_its_element(self, report):
        (row,) = [row for row in rows(captioned(report, "conditions", "What the")) if "zero" in row[1]]
        assert row[2] == "Water: damping 9000 instead of 20000 (−55 %)"

    def test_german(self, tanker):
        text = everything(make_report(tanker, sections=SECTIONS, date=None, language="de"))
        for english in (" barred", "not to be", "permitted", "pass ", "at most", "instead of", "Normal condition"):
            assert english not in text
        low = above(50e3, 9e3, 10e3)[0]
        assert f"In {ZERO}: höchstens {low} min⁻¹ von e" in text
        assert f"nicht zu betreiben und nicht zu durchfahren: nicht über {low} min⁻¹" in text


class TestNormalCondition:
    @pytest.mark.parametrize(
        ("named", "first", "said"),
        [
            ("", "Full pitch, normal firing", "the first alternative of each choice, as the model names none"),
            ("firing=uneven", "Full pitch, uneven", "Normal condition at rated load: full pitch, uneven; sections"),
            (
                "pitch=zero,firing=uneven",
                "Propeller at zero pitch, uneven",
                "zero pitch, uneven; sections begin with it",
            ),
        ],
    )
    def test_it_comes_first_and_is_said(self, named, first, said):
        text = TANKER.replace("report: {", f'report: {{normal: "{named}", ') if named else TANKER
        found = make_report(tn.loads(text), sections=["conclusion", "conditions"], date=None)
        assert captioned(found, "conclusion", "Verdict").groups[0].title == first
        assert rows(captioned(found, "conditions", "Conditions examined"))[0][0] == first
        assert said in everything(found)

    def test_where_it_is_left_out_the_document_says_so(self, tanker):
        some = ["pitch=zero,firing=normal", "pitch=zero,firing=uneven"]
        found = make_report(tanker, sections=["conditions"], date=None, configurations=some)
        said = "The normal condition at rated load, full pitch, normal firing, is not in this document; sections begin"
        assert said in everything(found)

    def test_a_wrong_name_is_told_with_its_place(self):
        text = TANKER.replace("report: {", "report: {normal: pitch=ful, ")
        with pytest.raises(tn.ModelError) as caught:
            tn.loads(text)
        (fault,) = caught.value.faults
        assert re.search('"pitch" .* "full"', str(fault))
        assert (fault.position.line, fault.position.column) == (25, 18)


class TestTitles:
    def test_titles_are_kept_and_change_nothing(self):
        again = tn.loads(tn.loads(TANKER).to_yaml())
        assert again.definition.configurations["pitch"]["zero"].title == "propeller at zero pitch"
        titled = tn.loads(TANKER.replace("full: {}", "full: {title: pitch set}"))
        assert titled.definition.configurations["pitch"]["full"].changes_nothing
        assert titled.other_configurations == tn.loads(TANKER).other_configurations

    def test_a_title_is_a_text(self):
        with pytest.raises(tn.ModelError, match="title"):
            tn.loads(TANKER.replace("title: propeller at zero pitch", "title: [3]"))


@pytest.mark.parametrize(
    ("model", "unwanted"),
    [
        pytest.param(
            "reciprocating_compressor_train",
            ("cylinder out", "isfire", "control station", "the engine"),
            marks=pytest.mark.nightly,
        ),
        ("engine_generator_set", ("control station", "tachometer red", "firing=", "rubber=")),
    ],
)
@pytest.mark.slow
def test_actions_and_words_fit_the_plant(model, unwanted):
    sections = ["conclusion", "conditions", "harmonics", "limits", "measurement_plan"]
    text = everything(make_report(model, sections=sections, date=None))
    assert not [one for one in unwanted if one in text]
