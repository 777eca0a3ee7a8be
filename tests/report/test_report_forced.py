"""Sections on critical speeds and forced response: numbers of their tables against the checks of limits."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, governing_peaks, line_name, order_peaks, order_shares
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, Picture, TableBlock
from torsionnet.report.free_end import free_end

PLANT = """
torsionnet: 1
name: fan
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  wheel: {type: inertia, node: b, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 10 kN*m/rad, damping: 2}
speeds: {of: a, range: 400..700 rpm, step: 5 rpm}
excitations:
  blades: {type: harmonic, node: b, orders: {2: {amplitude: 10}, 3: {amplitude: 0.5}, 5: {amplitude: 4}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 200 N*m, source: maker}}
configurations:
  light: {blades.orders: {2: {amplitude: 5}, 3: {amplitude: 0.5}, 5: {amplitude: 4}}}
  heavy: {}
  medium: {blades.orders: {2: {amplitude: 9.8}, 3: {amplitude: 0.5}, 5: {amplitude: 4}}}
"""
NATURAL = math.sqrt(1e4 * 1.5)
"""Undamped natural frequency of the twist in rad/s."""


@pytest.fixture(scope="module")
def fan():
    return tn.loads(PLANT)


@pytest.fixture(scope="module")
def checks(fan):
    return [fan.configured(name).check_limits() for name in fan.configurations]


@pytest.fixture(scope="module")
def report(fan):
    return make_report(fan, sections=["resonances", "forced_response"])


def table(report, section, caption):
    return next(one for one in of(TableBlock, blocks(report, section)) if caption in str(one.caption))


def torque(order, rpm, amplitude):
    """Torque in N m of the shaft: one degree of freedom for the twist."""
    omega = order * rpm * math.pi / 30
    return abs((1e4 + 2j * omega) * amplitude / (1e4 - omega**2 * 2 / 3 + 2j * omega) * 2 / 3)


class TestOrderPeaks:
    def test_peak_is_that_of_one_degree_of_freedom(self, fan, checks):
        (peak,) = (
            one
            for one in order_peaks(checks[1], fan.configured("heavy").critical_speeds())
            if line_name(one) == "blades 2"
        )
        sizes = [torque(2, rpm, 10) for rpm in np.arange(580, 590, 0.01)]
        assert peak.amplitude == pytest.approx(max(sizes), rel=1e-3)
        assert peak.rpm == pytest.approx(NATURAL / 2 * 30 / math.pi, rel=2e-3)
        assert peak.share == pytest.approx(max(sizes) / 200, rel=1e-3)

    def test_outside_the_range_counts_the_nearer_end(self, fan, checks):
        """Order 3 is critical at 389.8 rpm, below 400 rpm; order 5 at 233.9 rpm, too far below."""
        found = {line_name(one): one for one in order_peaks(checks[1], fan.configured("heavy").critical_speeds())}
        assert set(found) == {"blades 2", "blades 3"}
        assert found["blades 3"].rpm == 400
        assert found["blades 3"].amplitude == pytest.approx(torque(3, 400, 0.5), rel=1e-6)

    def test_largest_share_of_every_order(self, checks):
        shares = order_shares(checks[1])
        speeds = checks[1].rpm
        assert shares[1] == pytest.approx(max(torque(3, rpm, 0.5) for rpm in speeds) / 200, rel=1e-6)


class TestGoverningPeaks:
    def test_each_order_in_its_worst_condition_and_none_is_asked_for_besides(self, fan, checks):
        asked = []

        def critical(check, lines):
            asked.append((check.configuration, list(lines)))
            return fan.configured(check.configuration).critical_speeds(lines=lines)

        found = governing_peaks(checks, critical)
        assert asked == [("heavy", ["blades 2"])]
        assert [(one.check.configuration, line_name(one)) for one in found.peaks] == [("heavy", "blades 2")]
        assert found.others == ("blades 3", "blades 5")

    def test_share_can_be_chosen(self, fan, checks):
        found = governing_peaks(
            checks, lambda check, lines: fan.configured(check.configuration).critical_speeds(lines=lines), 1e-6
        )
        assert {line_name(one) for one in found.peaks} == {"blades 2", "blades 3"}
        assert found.others == ()


class TestLines:
    def test_only_those_asked_for(self, fan):
        found = fan.critical_speeds(lines=["blades 2"])
        assert [one.line for one in found.crossings] == ["2"]
        assert found.of(1, 2).generalised_force == fan.critical_speeds().of(1, 2).generalised_force

    def test_others_are_refused_with_those_there_are(self, fan):
        with pytest.raises(
            tn.UsageError, match="no order line is named blades 4; there are blades 2, blades 3, blades 5"
        ):
            fan.critical_speeds(lines=["blades 4"])


class TestResonances:
    def test_row_of_a_critical_speed(self, report):
        """Equilibrium amplitude 10 N m/(1.5 kg m^2 omega^2) at the wheel; magnifier 1/(2 zeta)."""
        ((mode, order, speed, angle, force, magnifier, damping, limit, peak, alone, every),) = rows(
            table(report, "resonances", "Critical speeds that matter")
        )
        zeta = 2 / (2 * math.sqrt(1e4 * 2 / 3))
        largest = max(torque(2, rpm, 10) for rpm in np.arange(580, 590, 0.01))
        assert (mode, order, limit, damping) == (
            "1",
            "blades\N{NO-BREAK SPACE}2",
            "shaft continuous",
            "shaft 100\N{NO-BREAK SPACE}%",
        )
        assert float(speed) == pytest.approx(NATURAL / 2 * 30 / math.pi, abs=0.1)
        assert float(angle) == pytest.approx(1e3 * 10 / (1.5 * NATURAL**2), rel=2e-3)
        assert float(force) == pytest.approx(0.01)
        assert float(magnifier) == pytest.approx(1 / (2 * zeta), rel=5e-3)
        assert float(peak.split()[0]) == pytest.approx(1e-3 * largest, rel=5e-3)
        assert float(alone) == pytest.approx(largest / 2, rel=5e-3)
        assert float(every) >= float(alone)

    def test_rule_and_what_is_left_out_are_said(self, report):
        text = str([one.text for one in of(Paragraph, blocks(report, "resonances"))])
        assert f"at least {100 * LEAST_SHARE:g} % of a limit" in text
        assert "Every other order uses less at all speeds: blades 3, blades 5." in text

    def test_without_limits_the_largest_at_resonance(self):
        model = tn.loads(without_limits())
        found = make_report(model, sections=["resonances", "forced_response"])
        assert [section.name for section in found.sections] == ["resonances"]
        names = [row[1].split()[1] for row in rows(table(found, "resonances", "Critical speeds"))]
        assert names == ["3", "2"]

    def test_nothing_without_excitations(self):
        rig = tn.load("dmf_rig")
        assert not make_report(rig, sections=["resonances", "forced_response"]).sections


def without_limits():
    return "\n".join(line for line in PLANT.splitlines() if not line.startswith("limits"))


class TestForcedResponse:
    def test_worst_condition_of_every_limit(self, report, checks):
        ((component, condition, speed, value, allowed, unit, use, orders),) = rows(
            table(report, "forced_response", "Largest utilisation")
        )
        verdict = checks[1].of("shaft")
        at = int(np.argmax(verdict.values))
        assert (component, condition, unit) == ("shaft continuous", "heavy", "kN·m")
        assert float(speed) == pytest.approx(checks[1].rpm[at], abs=0.05)
        assert float(value) == pytest.approx(1e-3 * verdict.values[at], rel=5e-3)
        assert float(allowed) == 0.2
        assert float(use) == pytest.approx(100 * verdict.utilisation[at], rel=5e-3)
        names = [one.partition(":")[0] for one in orders.split("; ")]
        assert names[0] == "blades 2"
        assert len(names) == 3

    def test_orders_at_the_critical_speed(self, report):
        (row,) = rows(table(report, "forced_response", "Orders at the peaks"))
        assert row[1:3] == ("blades 2, mode 1", "shaft")
        largest = max(torque(2, rpm, 10) for rpm in np.arange(580, 590, 0.01))
        assert float(row[-1].split("; ")[0].removeprefix("blades 2: ")) == pytest.approx(1e-3 * largest, rel=5e-3)

    def test_pictures_say_what_they_show(self, report):
        free, family = of(Picture, blocks(report, "forced_response"))
        assert (family.name, free.name) == ("forced_response_1", "free_end")
        (panel,) = family.figure.axes
        assert panel.get_ylabel().replace("\n", " ") == "torque(shaft), half range [N·m]"
        assert panel.get_xlabel() == "speed of a [rpm]"
        assert free.figure.axes[0].get_ylabel().endswith("[mrad]")


class TestFamilies:
    def test_worst_is_marked_and_the_others_are_counted(self, checks):
        from torsionnet.plot import limit_families

        (panel,) = limit_families(checks).axes
        labels = [text.get_text() for text in panel.get_legend().get_texts()]
        assert labels == ["heavy", "2 other conditions"]
        black = next(line for line in panel.lines if line.get_label() == "heavy")
        assert np.max(black.get_ydata()) == pytest.approx(np.max(checks[1].of("shaft").values))
        assert [text.get_text() for text in panel.texts] == ["continuous"]

    def test_unknown_limits_are_refused(self, checks):
        from torsionnet.plot import limit_families

        with pytest.raises(tn.UsageError, match="nothing to draw"):
            limit_families(checks, "screw")


class TestAxes:
    @pytest.mark.parametrize(
        ("unit", "largest", "expected"),
        [("N*m", 999.0, "N·m"), ("N*m", 1e3, "kN·m"), ("N*m", 9e7, "kN·m"), ("N*m", 1e8, "MN·m"), ("Pa", 3e7, "N/mm²")],
    )
    def test_unit_of_an_axis(self, unit, largest, expected):
        from torsionnet.plot.drawing.labels import axis_unit

        assert axis_unit(unit, largest)[1] == expected

    def test_labels_of_low_modes_do_not_overprint(self):
        """The wind turbine has seven modes in the lowest twentieth of its axis, which is a logarithmic one."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.text import Text

        from torsionnet.plot import interference_diagram

        figure = interference_diagram(tn.load("wind_turbine_3mw").configured("free").critical_speeds())
        FigureCanvasAgg(figure).draw()
        labels = [one for one in figure.axes[0].texts if one.get_text().startswith("mode")]
        boxes = [Text.get_window_extent(one) for one in labels]  # without the lines to the modes
        assert len(boxes) == 13
        (axes,) = figure.axes
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
        # Order 58 meets mode 14 at 1773 Hz and 16.9 rpm, beyond the range of 6 to 14 rpm, and is not excited.
        assert 800 < axes.get_ylim()[1] < 1000
        assert not any(
            one.y0 < other.y1 - 2 and other.y0 < one.y1 - 2 for i, one in enumerate(boxes) for other in boxes[:i]
        )
        heights = [figure.axes[0].transData.transform((0, one.xy[1]))[1] for one in labels]
        for label, box in zip(labels, boxes, strict=True):
            crossed = any(box.y0 + 1 < height < box.y1 - 1 for height in heights)
            assert label.get_bbox_patch() is not None or not crossed, label.get_text()


class TestFreeEnd:
    @pytest.mark.parametrize(
        ("name", "node"),
        [("marine_medium_speed", "free_end"), ("bulk_carrier", "c1"), ("reciprocating_compressor_train", "t4")],
    )
    def test_end_nearest_to_a_cylinder(self, name, node):
        assert free_end(tn.load(name).definition) == node

    def test_without_elements_there_is_none(self):
        assert free_end(SimpleNamespace(active=(), excitations={})) == ""
