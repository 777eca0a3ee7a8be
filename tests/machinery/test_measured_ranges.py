"""Measured half ranges beside limits and barred ranges, and tracked orders beside calculated ones, from one file."""

import json

import numpy as np
import pytest
from support.command_line import run
from support.measured_pump import PLANT, RPM, torque, tracked

import torsionnet as tn
from torsionnet.io.tracked_order_tables import write_tracked_orders
from torsionnet.machinery.verdicts.measured_range import measured_ranges


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.yaml").write_text(PLANT)


class TestLimits:
    def test_a_peak_outside_the_barred_range_is_named(self):
        """The test's resonance lies 15 % lower, beside the range that the calculation bars."""
        rpm = np.arange(310.0, 890.0, 5.0)
        write_tracked_orders([tracked(rpm, torque(rpm, 0.85))], "tracked.csv")
        result = run("limits", "plant.yaml", "--measured", "tracked.csv", "--json", "--plot", "beside.png")
        (found,) = json.loads(result.stdout)
        assert found["verdict"] == "barred range"
        ((low, high),) = found["barred_rpm"]
        (test,) = found["measured"]
        above = rpm[np.abs(torque(rpm, 0.85)) > 100]
        assert above[0] < low or above[-1] > high
        assert test["verdict"] == "exceeds the limit"
        assert test["measured"] == pytest.approx(np.abs(torque(rpm, 0.85)), rel=1e-9)
        assert test["calculated"] == pytest.approx(np.abs(torque(rpm)), rel=2e-3)
        text = " ".join(run("limits", "plant.yaml", "--measured", "tracked.csv").stdout.split())
        assert "pump on a motor: measured half ranges" in text
        assert "above it from" in text

    def test_exceeded_in_the_barred_range_alone(self):
        from torsionnet.plot import limit_check

        rpm = np.arange(310.0, 890.0, 5.0)
        model = tn.load("plant.yaml")
        check = model.check_limits()
        (found,) = measured_ranges(model, check, [tracked(rpm, torque(rpm))])
        assert found.verdict == "only in barred range"
        assert found.sentence.endswith("which is barred")
        assert found.peak_difference == pytest.approx(0, abs=0.5)
        (kept,) = measured_ranges(model, check, [tracked(rpm, 0.1 * torque(rpm))])
        assert (kept.verdict, kept.utilisation.max() < 1) == ("keeps the limit", True)
        (panel,) = limit_check(check, measured=[found]).axes
        dots = next(line for line in panel.lines if line.get_label() == "test, T")
        assert dots.get_ydata() == pytest.approx(np.abs(torque(rpm)), rel=1e-12)

    @pytest.mark.parametrize(
        ("test", "text"),
        [
            ({"name": "phi"}, "the channels are phi, and limits judge the half range of torque(shaft)"),
            ({"half_range": False}, "the file has no half ranges"),
            ({"quantity": "angle"}, "no measured half range belongs to a limit"),
        ],
    )
    def test_what_is_wrong_is_told(self, test, text):
        rpm = np.arange(310.0, 890.0, 50.0)
        write_tracked_orders([tracked(rpm, torque(rpm), **test)], "tracked.csv")
        said = run("limits", "plant.yaml", "--measured", "tracked.csv", code=2).stderr
        assert text in " ".join(said.split())


class TestOrders:
    def test_a_file_of_tracked_orders_has_phases_and_intervals(self):
        rpm = np.arange(310.0, 890.0, 7.0)
        values = torque(rpm) * np.exp(6j * rpm * RPM * -1.5e-3)  # 1.5 ms late
        write_tracked_orders(
            [tracked(rpm, values), tracked(rpm, values, name="speed", quantity="speed")], "tracked.csv"
        )
        options = ["--output", "T", "--measured", "tracked.csv"]
        (found,) = json.loads(run("orders", "plant.yaml", *options, "--json").stdout)
        (row,) = found["outputs"][0]["measured"]
        assert (row["verdict"], row["delay_s"]) == ("time delay", pytest.approx(1.5e-3, rel=1e-3))

    def test_channels_of_one_unit_need_the_name(self):
        rpm = np.arange(310.0, 890.0, 50.0)
        write_tracked_orders([tracked(rpm, torque(rpm), name=name) for name in ("one", "two")], "tracked.csv")
        said = run("orders", "plant.yaml", "--output", "T", "--measured", "tracked.csv", code=2).stderr
        assert "tracked.csv has several channels for T in N*m; there are one in N*m, two in N*m" in " ".join(
            said.split()
        )
