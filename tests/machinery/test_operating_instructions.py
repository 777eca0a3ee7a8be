"""Operating instructions: ranges outward and highest speeds down to 1 rpm, conditions apart, and what they rest on."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.command_line import run
from support.limit_cases import RPM, hump, m68, stressed

import torsionnet as tn
from torsionnet.base.result_fields import json_schema
from torsionnet.machinery.verdicts import limit_checking
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import without_contradictions, without_narrow_windows
from torsionnet.machinery.verdicts.operating_instructions import _way, instruction_table, operating_instructions
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan
from torsionnet.report.document_tree import TableBlock, inlines
from torsionnet.report.report import make_report


def check(found, configuration="", misfiring=False):
    """Check of a ship's shaft with these verdicts."""
    speeds = RPM * np.arange(20.0, 104.01, 0.5)
    names = ("normal", "other", "misfire")
    return LimitCheck(
        speeds, "crank", tuple(found.values()), configuration=configuration, misfiring=misfiring,
        configurations=names, others=tuple(name for name in names if name != configuration), rated=RPM * 105,
        propels=True,
    )  # fmt: skip


def two(stress, other, **options):
    """Verdicts on the shaft with one stress, and on a shaft "line" with another."""
    timed = {name: options.pop(name) for name in ("passing_time",) if name in options}
    line = stressed(other, m68(**timed), **options)
    renamed = {f"line {name}": replace(one, limit="line") for name, one in line.items()}
    return stressed(stress, m68(), **options) | renamed


class TestWindows:
    """Usual ranges 16 n/(18 - n/100) to (18 - n/100) n/16: around 50 rpm 45.7 to 54.7, 62 rpm from 57.1, 64 rpm from 59."""

    @staticmethod
    def closed(stress, other, rated=100.0):
        found = two(stress, other)
        speeds = RPM * np.arange(20.0, 104.01, 0.5)
        return check({str(place): one for place, one in enumerate(
            without_narrow_windows([*found.values()], speeds, [None, RPM * rated]))})  # fmt: skip

    @pytest.mark.parametrize(
        ("at", "rated", "ranges"),
        [
            (62, 100, [(45, 68)]),  # 2.4 rpm between, 4.4 % of 54.7 rpm
            (64, 100, [(45, 55), (58, 70)]),  # 7.9 %
            (62, 56, [(45, 55), (57, 68)]),  # rated speed is governed in its window, safe navigation kept
        ],
    )
    def test_no_speed_is_held_between_two_ranges_that_are_nearly_one(self, at, rated, ranges):
        done = self.closed(hump(70, 50), hump(70, at), rated)
        assert [span.rpm_outward for span in done.barred] == ranges
        assert [(row.from_rpm, row.to_rpm) for row in operating_instructions([done])] == ranges
        remarks = [remark for verdict in done.verdicts for remark in verdict.remarks if "narrow" in remark]
        assert len(remarks) == (len(ranges) == 1)

    @pytest.mark.parametrize(("condition", "safe"), [("misfire", 63 * RPM), ("normal", None)])
    def test_with_a_cylinder_out_the_window_of_safe_navigation_stays(self, monkeypatch, condition, safe):
        kept = []
        monkeypatch.setattr(
            limit_checking, "without_narrow_windows", lambda known, _, speeds: kept.extend(speeds) or known
        )
        tn.load("two_stroke_ship").configured(condition).check_limits("tail", speeds=[60 * RPM, 80 * RPM], refine=False)
        assert kept == [pytest.approx(105 * RPM), safe and pytest.approx(safe)]

    @pytest.mark.parametrize(("misfire", "verdict"), [(False, "fail"), (True, "barred range")])
    def test_no_window_is_closed_where_the_rule_lets_no_range_be_barred(self, misfire, verdict):
        """Barred up to 79.8 rpm and, by the maker of the crankshaft, from 82 rpm on: above lambda = 0.8 M68 bars nothing."""
        found = stressed(hump(70, 74), m68(), misfire=misfire)
        crank = replace(found["tau_C"], limit="crank", barred=(SpeedSpan(82 * RPM, 86 * RPM),), free_above=None)
        speeds = RPM * np.arange(20.0, 104.01, 0.5)
        done = check(dict(enumerate(without_narrow_windows([found["tau_C"], crank], speeds, [100 * RPM]))))
        assert done.verdicts[0].verdict == verdict
        assert done.verdicts[0].barred[0].high == pytest.approx(82 * RPM)
        told = [remark for remark in done.verdicts[0].remarks if "above 80 rpm, where no range may be barred" in remark]
        assert len(told) == (not misfire)
        (row,) = operating_instructions([done])
        assert (row.from_rpm, row.to_rpm, row.action) == (68, 86, "pass without stopping")

    def test_a_single_speed_that_is_barred_is_not_refused(self):
        """The range of one speed has no width."""
        speed = np.array([10.0])
        alone = replace(
            stressed(hump(70, 50), m68())["tau_C"], verdict="fail", speeds=speed, values=speed, allowed=speed / 2
        )
        assert replace(alone, barred=(SpeedSpan(10.0, 10.0),)).refused == ()
        assert alone.refused != ()

    def test_nor_below_a_range_that_is_not_passed(self):
        """Barred up to lambda = 0.8, and exceeded again from 0.83 on, where no range may be barred."""
        done = self.closed(hump(70, 75), hump(70, 85))
        (row,) = operating_instructions([done])
        assert (row.from_rpm, row.action) == (69, "not to be run or passed: not above 69 rpm")
        assert done.highest == pytest.approx(RPM * 16 * 75 / 17.25, rel=1e-3)


class TestMisfire:
    """What cannot be passed with a cylinder out limits the speed; nothing "holds" then."""

    def test_a_range_with_rated_speed_in_it_is_a_highest_speed(self):
        found = stressed(hump(70, 100), m68(), misfire=True)["tau_C"]
        assert found.verdict == "reduced speed"
        assert found.highest / RPM == pytest.approx(16 * 100 / 17, rel=1e-6)
        assert found.passed == ()
        assert found.restrictions == "at most 94 rpm"
        # What leaves no speed at all is not kept.
        nothing = replace(found, highest=float(found.speeds[0]))
        kept, lost = (without_contradictions([one], found.speeds)[0] for one in (found, nothing))
        assert (kept.verdict, lost.verdict) == ("reduced speed", "fail")

    @pytest.mark.parametrize(("at", "words"), [(93.5, "at most 87 rpm"), (92, "86 to 99 rpm")])
    def test_a_range_marked_up_to_rated_speed_is_a_highest_speed(self, at, words):
        """16 n/(18 - n/100) to (18 - n/100) n/16: 87.7 to 99.7 rpm, marked up to 100 rpm, the rated; 86.2 to 98.2."""
        found = stressed(hump(70, at), m68(), misfire=True)["tau_C"]
        assert found.restrictions == words
        (row,) = operating_instructions([check({"tau_C": found}, "misfire", misfiring=True)])
        low = math.floor(16 * at / (18 - at / 100))
        assert (row.from_rpm, row.to_rpm) == ((low, None) if at > 93 else (low, 99))
        assert row.action == ("not above 87 rpm, reduce power" if at > 93 else "pass without stopping")

    @pytest.mark.parametrize(("at", "verdict"), [(96, "fail"), (95, "barred range")])
    def test_normal_firing_keeps_its_rated_speed_off_the_mark(self, at, verdict):
        """5 + 65/(1 + (d/2)^2) is above 20 N/mm^2 up to d = 3.65 rpm: to 99.65 rpm, marked up to 100, or to 98.65."""
        limit = {"rule": "fatigue", "element": "shaft", "fatigue_strength": "20 MPa", "mean_stress": "none"}
        assert stressed(hump(70, at), limit)["tau_W"].verdict == verdict

    def test_in_normal_firing_it_fails_and_nothing_is_to_be_barred(self):
        found = stressed(hump(70, 88), m68())["tau_C"]
        assert (found.verdict, found.barred, found.highest) == ("fail", (), None)
        assert [span.rpm_outward for span in found.refused] == [(86, 91)]
        assert check({"tau_C": found}).finding() == "shaft does not hold; at most 86 rpm of crank"

    def test_a_range_below_stays_to_be_passed(self):
        both = lambda rpm: max(hump(70, 100)(rpm), hump(90, 50)(rpm))  # noqa: E731
        found = stressed(lambda rpm: [both(one) for one in rpm], m68(), misfire=True)["tau_C"]
        assert found.restrictions == "at most 94 rpm, 45 to 55 rpm barred"
        said = check({"tau_C": found}, "misfire", misfiring=True).finding(" in misfire")
        assert said == "in misfire: at most 94 rpm of crank, 45 to 55 rpm barred"

    def test_a_speed_for_safe_navigation_above_it_fails(self):
        found = stressed(hump(70, 97, width=0.5), m68(safe_speed="104 rpm"), misfire=True)["tau_C"]
        assert found.verdict == "fail"
        assert found.remarks[0] == "safe_speed is above the highest speed permitted: at most 91 rpm"

    def test_exceeded_from_the_lowest_speed_on_nothing_is_permitted(self):
        found = stressed(lambda rpm: 500 + 0 * rpm, m68(), misfire=True)["tau_C"]
        assert (found.verdict, found.barred) == ("fail", ())
        assert "exceeded at all speeds" in found.remarks


class TestInstructions:
    """Rows for the crew."""

    def test_a_barred_range(self):
        found = stressed(hump(90, 50), m68(tachometer_tolerance="2 %"))
        (one,) = operating_instructions([check(found, "normal")])
        assert (one.from_rpm, one.to_rpm) == (math.floor(0.98 * 0.91429 * 50), math.ceil(1.02 * 1.09375 * 50))
        assert (one.tolerance, one.limit, one.criterion, one.shaft) == (0.02, "shaft", "tau_C", "crank")
        assert one.value == pytest.approx(90e6)
        assert one.allowed == pytest.approx(66.562e6, rel=1e-4)
        assert one.allowed_in_passing == pytest.approx(1.7 * 66.562e6, rel=1e-4)
        assert one.action == "pass without stopping"

    def test_conditions_are_never_joined(self):
        first, second = stressed(hump(90, 50), m68()), stressed(hump(100, 53), m68())
        found = operating_instructions([check(first, "normal"), check(second, "other")])
        assert [one.conditions for one in found] == [("normal",), ("other",)]
        assert [one.value for one in found] == pytest.approx([90e6, 100e6])
        assert [one.from_rpm for one in found] == [math.floor(16 / 17.5 * 50), math.floor(16 / (18 - 0.53) * 53)]

    def test_ranges_of_two_shafts_are_one_that_names_both(self):
        (one,) = operating_instructions([check(two(hump(90, 50), hump(100, 53)))])
        assert one.limits == ("line, tau_C", "shaft, tau_C")
        assert (one.from_rpm, one.to_rpm) == (45, math.ceil((18 - 0.53) / 16 * 53))
        assert (one.value, one.action) == (pytest.approx(100e6), "pass without stopping")

    @pytest.mark.parametrize("order", [1, -1])
    @pytest.mark.parametrize("misfire", [False, True])
    def test_the_least_permitted_passage_decides(self, order, misfire):
        """One shaft may pass from 45 to 55 rpm; the other has 120 N/mm^2 at 52 rpm, above its tau_T of 112.6."""
        found = two(hump(90, 50), hump(120, 52), misfire=misfire)
        judged = check(dict([*found.items()][::order]), misfiring=misfire)
        (one,) = operating_instructions([judged])
        assert one.action == "not to be run or passed: not above 45 rpm"
        assert one.elsewhere == "no condition examined reaches higher speeds"
        other = stressed(hump(90, 50), m68())
        beside = []
        for out in (misfire, not misfire):
            every = operating_instructions([check(other, "free", misfiring=out), judged])
            beside += [row.elsewhere for row in every if row.action == one.action]
        # Nobody chooses that all cylinders work, or that one does not.
        ways = {True: "higher speeds only once the fault is mended", False: "higher speeds only with a cylinder out"}
        assert beside == ["pass 45 to 55 rpm in condition free", ways[misfire]]
        assert one.value == pytest.approx(120e6)
        assert one.allowed < one.allowed_in_passing < one.value
        assert one.rpm == pytest.approx(52)
        assert set(one.limits) == {"shaft, tau_C", "line, tau_C", "line, tau_T"}
        assert one.limited_by.startswith("line, tau_T; ")
        assert one.from_rpm <= 45
        assert one.to_rpm >= 55

    def test_the_shortest_time_of_several_limits_counts(self):
        found = two(hump(90, 50), hump(80, 53), passing_time="8 s")
        (one,) = operating_instructions([check(found)])
        assert one.action == "pass without stopping within 8 s"
        assert one.limits == ("line, tau_C", "shaft, tau_C")  # the one with a time decides

    def test_a_range_above_the_highest_speed_is_not_passed(self):
        """With a cylinder out, one shaft ends at 94 rpm; what the other one has above that is part of it."""
        found = two(hump(70, 100), hump(120, 97), misfire=True)
        *below, last = operating_instructions([check(found, "misfire", misfiring=True)])
        assert last.to_rpm is None
        assert last.action == f"not above {last.from_rpm} rpm, reduce power"
        assert set(last.limits) >= {"shaft, tau_C", "line, tau_C"}
        assert all(one.to_rpm <= last.from_rpm for one in below)

    def test_where_no_range_can_be_barred_the_row_says_so(self):
        (one,) = operating_instructions([check(stressed(hump(70, 88), m68()), "normal")])
        assert (one.action, one.limits) == ("not to be run or passed: not above 86 rpm", ("shaft, tau_C",))
        assert one.from_rpm < 88 < one.to_rpm

    def test_conditions_with_a_cylinder_out_are_apart(self):
        normal, out = stressed(hump(90, 50), m68()), stressed(hump(70, 100), m68(), misfire=True)
        found = operating_instructions([check(normal, "normal"), check(out, "misfire", misfiring=True)])
        assert [one.conditions for one in found] == [("normal",), ("misfire",)]
        assert (found[1].from_rpm, found[1].to_rpm) == (94, None)
        assert found[1].action == "not above 94 rpm, reduce power"
        whole = LimitConclusion((check(normal, "normal"), check(out, "misfire", misfiring=True)))
        assert whole.verdict == "incomplete"
        assert "limits hold with 45 to 55 rpm of crank barred in normal" in whole.sentence
        assert whole.sentence.endswith("in misfire: at most 94 rpm of crank")

    def test_whole_numbers_stay(self):
        found = stressed(hump(90, 50), m68())["tau_C"]
        for low in range(21, 100):
            span = SpeedSpan(low * RPM, (low + 3) * RPM)
            (one,) = operating_instructions([check({"tau_C": replace(found, barred=(span,))})])
            assert (one.from_rpm, one.to_rpm) == (low, low + 3)

    @pytest.mark.parametrize(
        ("stress", "last"),
        [
            (hump(10, 50), "No restrictions from 20 to 104 rpm of crank"),
            (hump(90, 50), "No other restrictions from 20 to 104 rpm of crank"),
            (
                hump(130, 50),
                "Not kept in normal operation: shaft; only the remaining speeds may be run, which the conditions list",
            ),
        ],
    )
    def test_what_stands_below(self, stress, last):
        """Every start passes speeds below those examined: the verdict says so itself."""
        found = check(stressed(stress, m68()))
        assert instruction_table([found]).notes == (f"{last}; starts and stops not examined.",)
        said = "starts and stops not examined: speeds below 20 rpm of crank"
        assert said in found.conclusion
        assert said in LimitConclusion((found, replace(found, configuration="other"))).sentence


def test_command_and_report_show_them():
    result = run("limits", "two_stroke_ship", "-c", "all")
    lines = result.stdout.splitlines()
    assert lines[-1].endswith(
        "reduced speed: starts and stops not examined: speeds below 20 rpm of flywheel; limits hold in normal, misfire_2; in misfire: at most 97 rpm of flywheel"
    )
    assert lines[0].endswith("worst of every limit")
    assert lines[5].split()[:4] == ["misfire", "tail", "tail", "tau_C"]
    assert lines.index("operating instructions") > 0
    overall = json.loads(run("limits", "two_stroke_ship", "-c", "all", "--json").stdout)[0]["overall"]
    (one,) = overall["instructions"]
    assert one["conditions"] == ["misfire"]
    assert (one["from_rpm"], one["to_rpm"], one["criterion"]) == (97, None, "tau_C")
    assert set(json_schema(LimitConclusion)["properties"]) == set(overall)
    report = make_report(tn.load("two_stroke_ship"), sections=["limits"], date=None)
    captions = [inlines(block.caption) for block in report.sections[0].blocks if isinstance(block, TableBlock)]
    assert ("Operating instructions",) in captions


@pytest.mark.parametrize(
    ("permitted", "free"), [([], "40 to 50"), ([SpeedSpan(45 * RPM, 90 * RPM)], "45 to 50")], ids=["all", "a part"]
)
def test_another_condition_is_free_in_the_part_that_it_permits(permitted, free):
    other = SimpleNamespace(configuration="b", passed=[], permitted=permitted)
    assert free in str(_way(other, SpeedSpan(40 * RPM, 50 * RPM), str))
