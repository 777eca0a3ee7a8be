"""Sections on critical speeds and forced response: numbers of their tables against the checks of limits."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows, words

import torsionnet as tn
from torsionnet.machinery.verdicts.order_peaks import differing_lines, line_name, order_peaks, order_shares
from torsionnet.report import make_report
from torsionnet.report.document_tree import Picture, TableBlock
from torsionnet.report.measured_orders import free_end

PLANT = """
torsionnet: 1
name: fan
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  wheel: {type: inertia, node: b, inertia: 1}
  shaft: {type: spring, nodes: [a, b], stiffness: 10 kN*m/rad, damping: 2}
speeds: {of: a, range: 400..700 rpm, step: 5 rpm}
excitations:
  blades: {type: harmonic, node: b, orders: {2: {amplitude: 10}, 3: {amplitude: 0.6}, 5: {amplitude: 4}}}
limits: {shaft: {rule: curve, output: torque(shaft), value: 200 N*m, source: maker}}
configurations:
  light: {blades.orders: {2: {amplitude: 5}, 3: {amplitude: 0.6}, 5: {amplitude: 4}}}
  heavy: {}
  medium: {blades.orders: {2: {amplitude: 9.8}, 3: {amplitude: 0.6}, 5: {amplitude: 4}}}
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


def heads(block):
    return [words(column.text) for column in block.columns]


def closed_form(row, amplitude):
    """Row of order 2: all its numbers from one degree of freedom, the twist of the shaft."""
    zeta = 2 / (2 * math.sqrt(1e4 * 2 / 3))
    largest = max(torque(2, rpm, amplitude) for rpm in np.arange(580, 590, 0.01))
    assert float(row["Critical speed"]) == pytest.approx(NATURAL / 2 * 30 / math.pi, abs=0.1)
    assert float(row["Equil. ampl."]) == pytest.approx(1e3 * amplitude / (1.5 * NATURAL**2), rel=5e-3)
    assert float(row["Gen. force"]) == pytest.approx(1e-3 * amplitude)
    assert float(row["Magnifier"]) == pytest.approx(1 / (2 * zeta), rel=5e-3)
    assert row["Component"] == "shaft, kN·m"
    assert float(row["Peak at"]) == pytest.approx(NATURAL / 2 * 30 / math.pi, abs=1)
    assert float(row["Order alone"]) == pytest.approx(1e-3 * largest, rel=5e-3)
    assert float(row["Allowed"]) == 0.2
    assert float(row["Used at peak"]) == pytest.approx(100 * float(row["All orders"]) / 0.2, rel=1e-2)
    # Wheel alone: amplitude at resonance times the stiffness and the shape, 1 at the wheel and -1/2 at the rotor.
    resonant = 1e-3 * float(row["Equil. ampl."]) * float(row["Magnifier"])
    assert 1.5 * 1e4 * resonant == pytest.approx(largest, rel=2e-2)


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

    def test_outside_the_range_there_is_none(self, fan, checks):
        """Order 3 is critical at 389.8 rpm: from 400 rpm on it falls and has no peak, whatever its value there."""
        found = {line_name(one): one for one in order_peaks(checks[1], fan.configured("heavy").critical_speeds())}
        assert set(found) == {"blades 2"}

    def test_largest_share_of_every_order(self, checks):
        shares = order_shares(checks[1])
        speeds = checks[1].rpm
        assert shares[1] == pytest.approx(max(torque(3, rpm, 0.6) for rpm in speeds) / 200, rel=1e-6)


class TestDifferingLines:
    def test_orders_that_differ_from_the_first_condition(self, checks):
        """Half the torque of order 2 differs; 98 % of it does not."""
        light, heavy, medium = checks
        assert differing_lines([heavy, light, medium]) == {1: ["blades 2"]}

    def test_of_alike_conditions_the_worst_is_named(self, checks):
        light, heavy, medium = checks
        assert differing_lines([light, medium, heavy]) == {2: ["blades 2"]}

    def test_small_orders_are_left_out(self, checks):
        assert differing_lines([checks[0], checks[1]], least=0.99) == {1: ["blades 2"]}
        assert differing_lines([checks[0], checks[1]], least=1.5) == {}


class TestLines:
    def test_only_those_asked_for(self, fan):
        found = fan.critical_speeds(lines=["blades 2"])
        assert [one.line for one in found.crossings] == ["2"]
        assert found.of(1, 2).generalised_force == fan.critical_speeds().of(1, 2).generalised_force

    def test_others_are_refused_with_those_there_are(self, fan):
        with pytest.raises(tn.UsageError, match="unknown-name"):
            fan.critical_speeds(lines=["blades 4"])


class TestResonances:
    def test_normal_condition_first(self, report):
        """Equilibrium amplitude 10 N m/(1.5 kg m^2 omega^2) at the wheel; magnifier 1/(2 zeta)."""
        first, further = [one for one in of(TableBlock, blocks(report, "resonances")) if one.groups]
        assert "normal operation, light" in str(first.caption)
        assert len(first.columns) <= 14
        row = dict(zip(heads(first), rows(first)[0], strict=True))
        assert row["Order"] == "blades\N{NO-BREAK SPACE}2"
        assert row["Damping by"] == "shaft 100\N{NO-BREAK SPACE}%"
        closed_form(row, 5)
        # The heavy condition has twice the torque; the medium one 98 % of it, which is the same.
        (group,) = further.groups
        assert group.title == "heavy"
        row = dict(zip(heads(further), rows(further)[0], strict=True))
        assert (row["Order"], row["Worst"]) == ("blades 2, mode 1", "worst")
        closed_form(row, 10)

    def test_what_is_small_and_what_is_outside_is_said(self, report):
        notes = str(of(TableBlock, blocks(report, "resonances"))[0].notes)
        assert "Every other order alone uses less than 1 % of a limit at all speeds examined: blades 5." in notes
        assert "Beside the range of 400 to 700 rpm, not examined: blades 3, mode 1 at 389." in notes

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
    def test_components_in_the_normal_condition(self, report, checks):
        ((component, place, speed, value, allowed, unit, use, made, orders),) = rows(
            table(report, "forced_response", "Components in normal operation")
        )
        verdict = checks[0].of("shaft")
        assert (component, place, made, unit) == ("shaft", "peak", "blades 2, mode 1", "kN·m")
        assert float(speed) == pytest.approx(checks[0].rpm[verdict.worst], abs=0.06)
        assert float(value) == pytest.approx(1e-3 * verdict.values[verdict.worst], rel=5e-3)
        assert float(use) == pytest.approx(100 * float(value) / float(allowed), rel=1e-2)
        # T = (K + j w C) phi, phi = M/((K + j w C) 3/2 - w^2) of the twist by M on the wheel; either end has its sign.
        w = 2 * float(speed) * math.pi / 30
        stiffness = 1e4 + 2j * w
        expected = math.degrees(np.angle(stiffness * 5 / (stiffness * 1.5 - w**2)))
        told = re.fullmatch(r"blades 2: 0\.\d+ \((−?\d+)°\); .*", orders)
        off = float(told[1].replace("−", "-")) - expected
        assert (off + 90) % 180 - 90 == pytest.approx(0, abs=3)  # a step of 0.1 rpm beside the top

    def test_peaks_in_further_conditions(self, report, checks):
        (group,) = table(report, "forced_response", "Peaks of the sum").groups
        assert group.title == "heavy"
        assert words(group.rows[0][1]) == f"{checks[1].of('shaft').worst_rpm:.1f}"

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

    def test_pictures_say_what_they_show(self, report):
        free, family = of(Picture, blocks(report, "forced_response"))
        assert (family.name, free.name) == ("forced_response_1", "free_end")
        (panel,) = family.figure.axes
        assert panel.get_ylabel().replace("\n", " ") == "torque(shaft), half range [N·m]"
        assert panel.get_xlabel() == "speed of a [rpm]"
        assert free.figure.axes[0].get_ylabel().endswith("[mrad]")


class TestFamilies:
    def test_worst_is_marked_and_the_others_are_counted(self, checks):
        from torsionnet.plot.limit_plot import limit_families

        (panel,) = limit_families(checks).axes
        labels = [text.get_text() for text in panel.get_legend().get_texts()]
        assert labels == ["heavy", "2 other conditions"]
        black = next(line for line in panel.lines if line.get_label() == "heavy")
        assert np.max(black.get_ydata()) == pytest.approx(np.max(checks[1].of("shaft").values))
        assert [text.get_text() for text in panel.texts] == ["continuous"]

    def test_unknown_limits_are_refused(self, checks):
        from torsionnet.plot.limit_plot import limit_families

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
