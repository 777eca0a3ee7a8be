"""Measured amplitudes of orders over calculated ones: tables of tests, and those written by the command itself."""

import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet.io.tracked_order_tables import read_orders
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.orders.calculated_order import between_speeds
from torsionnet.machinery.orders.order_comparison import compared_orders
from torsionnet.machinery.orders.order_line import OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.signals.orders.tracked_orders import MeasuredOrder

RPM = np.pi / 30
PLANT = """torsionnet: 1
name: two fans on a motor
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [m, f], stiffness: 40 kN*m/rad, damping: 20 N*m*s/rad}
  fan: {type: inertia, node: f, inertia: 2 kg*m^2}
  belt: {type: gear, nodes: [f, slow], ratio: 2}
speeds: {of: m, range: 300..900 rpm, step: 5 rpm}
excitations:
  motor: {type: harmonic, node: m, orders: {6: {amplitude: 20 N*m}}}
  fan: {type: harmonic, node: slow, orders: {12: {amplitude: 8 N*m, phase: 20 deg}}}
configurations: {motor: {smooth: {motor.orders: {6: {amplitude: 5 N*m}}}, rough: {}}}
"""


def torque(rpm):
    """Of the shaft by order 6, both excitations together: two masses on a spring, by hand; slow drives f by half."""
    s = 6j * rpm * RPM
    kappa, motor, fan = 4e4 + 20 * s, 0.5 * s**2, 2 * s**2
    return kappa * (20 / motor - 4 * np.exp(1j * np.radians(20)) / fan) / (1 + kappa * (1 / motor + 1 / fan))


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.yaml").write_text(PLANT)
    return tmp_path


def recorded(folder, more=""):
    rows = [f"{rpm};6;{1.1 * abs(torque(rpm)) / np.sqrt(2)}" for rpm in range(320, 1000, 15)]
    (folder / "test.csv").write_text("\n".join(["# a run-up", "speed [rpm];order;rms [N*m]", *rows, more, ""]))
    return "test.csv"


class TestCommand:
    def test_a_test_ten_percent_higher(self, folder):
        recorded(folder, more="400;1;3")
        text = run("orders", "plant.yaml", "-c", "rough", "--output", "torque(shaft)", "--measured", "test.csv").stdout
        (row,) = re.findall(r"^ *6 .*", text, re.MULTILINE)
        peak = max(abs(torque(rpm)) for rpm in range(320, 901, 15))
        assert row.endswith("no interval")
        numbers = [float(cell) for cell in row.split()[:-2]]
        assert numbers[:2] == pytest.approx([6, 1.1 * peak], rel=1e-5)
        assert numbers[3] == pytest.approx(peak, rel=1e-5)
        assert numbers[5:] == pytest.approx([10, 10], rel=1e-3)  # (measured - calculated)/calculated
        assert "order 6: the test states no interval" in text
        assert "amplitudes 10 % above the calculated ones at every speed" in " ".join(text.split())
        assert "measured, but not calculated: 1" in text

    def test_json_has_both(self, folder):
        recorded(folder)
        options = ["-c", "rough", "--output", "torque(shaft)", "--measured", "test.csv", "--json"]
        (found,) = json.loads(run("orders", "plant.yaml", *options).stdout)
        (pair,) = found["outputs"][0]["measured"]
        assert pair["of_reference"] == 6
        assert pair["calculated"] == pytest.approx([abs(torque(rpm)) for rpm in pair["speeds_rpm"]], rel=1e-9)
        assert pair["measured"] == pytest.approx([1.1 * size for size in pair["calculated"]], rel=1e-9)

    def test_what_the_command_wrote_is_what_it_calculates(self):
        """Two excitations with one frequency, of shafts that turn differently, and several configurations in a file."""
        output = ["--output", "torque(shaft)", "--output", "f"]
        run("orders", "plant.yaml", "-c", "all", *output, "--csv", "all.csv")
        sums = [row for row in Path("all.csv").read_text(encoding="utf-8").splitlines() if " + " in row]
        assert len(sums) == len({tuple(row.split(",")[:2]) for row in sums}) > 10
        text = run("orders", "plant.yaml", "-c", "smooth", *output, "--measured", "all.csv").stdout
        assert [float(row.split()[6]) for row in re.findall(r"^ *6 .*", text, re.MULTILINE)] == pytest.approx(
            [0, 0], abs=1e-6
        )
        assert (
            "configurations smooth, rough; choose"
            in run("orders", "plant.yaml", *output, "--measured", "all.csv", code=2).stderr
        )

    @pytest.mark.parametrize(
        ("content", "words"),
        [
            ("speed [rpm],order,amplitude [rad]\n400,6,1\n", r"test\.csv .*rad.*torque\(shaft\).*wrong-unit"),
            ("order,speed,amplitude [N*m]\n6,400,1\n", r"test\.csv:1:7: .*missing-unit"),
            ("order,speed [kg],amplitude [N*m]\n6,400,1\n", r"test\.csv:1:7: .*wrong-unit"),
            ("order,amplitude [N*m]\n6,1\n", "missing-column"),
            ("speed [rpm],order,amplitude [N*m]\n400,6,1\n500,6\n", r"test\.csv:3:1: .*wrong-count"),
            ("speed [rpm],order,amplitude [N*m]\n400,6,1\n500,6,x\n", r'test\.csv:3:7: .*"x".*not-a-number'),
            ("speed [rpm],order,amplitude [N*m]\n400,7,1\n", r"m \(7\).*unknown-order"),
            ("speed [rpm],order,amplitude [N*m]\n200,6,1\n", r"m \(6\).*unknown-order"),
            ("speed [rpm],order,amplitude [N*m]\n", r"test\.csv:1:1: .*wrong-file"),
        ],
    )
    def test_what_is_wrong_is_told(self, folder, content, words):
        (folder / "test.csv").write_text(content)
        arguments = ["plant.yaml", "-c", "rough", "--output", "torque(shaft)", "--measured", "test.csv"]
        code = 1 if "csv:" in words else 2
        assert re.search(words, " ".join(run("orders", *arguments, code=code).stderr.split()))

    def test_a_test_is_of_one_configuration(self, folder):
        arguments = ["plant.yaml", "-c", "all", "--output", "f", "--measured", recorded(folder)]
        assert "[wrong-count]" in run("orders", *arguments, code=2).stderr
        assert "[missing-file]" in run("orders", "plant.yaml", "--output", "f", "--measured", "none.csv", code=2).stderr


@pytest.mark.parametrize(("count", "degree"), [(2, 1), (3, 1), (4, 3), (9, 3)])
def test_between_calculated_speeds(count, degree):
    """A line is met from two speeds on, a polynomial of the third degree from four."""
    speeds, at = np.linspace(1.0, 3.0, count), np.linspace(1.0, 3.0, 7)

    def values(at):
        return (1 + 2j) + (3 - 1j) * at + (degree == 3) * (0.5 + 0.25j) * at**3

    assert between_speeds(speeds, values(speeds), at) == pytest.approx(values(at), rel=1e-12)


class TestPicture:
    def test_dots_over_lines(self, folder):
        from torsionnet.plot.order_overlay_plot import order_overlay

        response = tn.loads(PLANT).configured("rough").order_response("torque(shaft)")
        measured = read_orders(folder / recorded(folder), response.outputs[0])
        (panel,) = order_overlay(response, {"torque(shaft)": measured}).axes
        model, test = panel.lines
        for line, factor in ((model, 1), (test, 1.1)):
            expected = [factor * abs(torque(rpm)) for rpm in line.get_xdata()]
            assert line.get_ydata() == pytest.approx(np.array(expected), rel=1e-9)
        assert (len(model.get_xdata()), len(test.get_xdata())) == (121, 39)
        assert (panel.get_xlabel(), panel.get_ylabel()) == ("speed of m [rpm]", "torque(shaft) [N·m]")

    def test_orders_of_the_largest_amplitudes_are_drawn_calculated_or_measured(self):
        """Of eight the first is large in the calculation alone, the last but one in the test alone, the second in none."""
        from torsionnet.plot.order_overlay_plot import order_overlay

        speeds, names = np.array([400, 600, 800]) * RPM, range(1, 9)
        lines = tuple(OrderLine("engine", order, Fraction(1)) for order in names)
        values = np.array([[9.0, 0.1, 3, 4, 5, 6, 0.2, 0.3]] * 3, dtype=complex)[:, :, None]
        response = OrderResponse(speeds, "m", lines, values, (Channel("T", "N*m"),))
        seen = [0.1, 0.1, 3, 4, 5, 6, 8, 0.3]
        measured = [MeasuredOrder(order, speeds, np.full(3, size)) for order, size in zip(names, seen, strict=True)]
        (panel,) = order_overlay(response, {"T": measured}).axes
        drawn = {round(float(np.max(line.get_ydata())), 3) for line in panel.lines}
        assert drawn == {9.0, 0.1, 3, 4, 5, 6, 8, 0.2}

    def test_speeds_that_were_not_calculated_are_left_out(self):
        response = tn.loads(PLANT).order_response("f")
        one = MeasuredOrder(6.002, np.array([250, 500, 950]) * RPM, np.array([1.0, 2.0, 3.0]))
        (pair,) = compared_orders(response, None, [one])
        assert pair.measured.amplitude.tolist() == [2]
