"""Sections of a report on running machinery: what stands in them, and that models without it have none."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.report_blocks import blocks, of, rows
from support.written_models import TWO_FANS

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, Picture, TableBlock
from torsionnet.report.sections.excitations import _torques

SENSOR = "sensors: {T_s: {torque: shaft}, phi: {angle: f}}\n"


@pytest.fixture(scope="module")
def found():
    return make_report(tn.loads(TWO_FANS + SENSOR), sections=["excitations", "orders"])


def table(report, section, caption):
    return next(one for one in of(TableBlock, blocks(report, section)) if caption in str(one.caption))


class TestExcitations:
    def test_speeds_in_the_unit_of_a_tachometer(self, found):
        text = str(of(Paragraph, blocks(found, "excitations"))[0].text)
        assert "speed of m runs from 300 to 1500 rpm, 121 values" in text

    def test_amplitude_and_phase_of_every_order(self, found):
        assert rows(table(found, "excitations", "Torques of fan"))[0][:3] == ("5", "12.00", "20.0")

    def test_orders_that_cancel_have_no_amplitude_and_no_phase(self):
        """Two cylinders half a revolution apart on one crank: of odd orders nothing is left but rounding."""
        pressure = 1e5 + 80e5 * np.exp(-(((np.arange(72) * 5 - 15) / 25.0) ** 2))
        engine = {
            "type": "reciprocating_engine", "speed_of": "a", "cycle": 2, "cylinders": {1: "a", 2: "a"},
            "firing_order": [1, 2], "bore": 0.3, "stroke": 0.4, "rod_length": 0.8, "reciprocating_mass": 50,
            "orders": [1, 2, 3], "gas": {"fired": pressure.tolist()},
        }  # fmt: skip
        parts = [tn.Inertia("A", node="a", inertia=1), tn.Spring("k", nodes=("a", "b"), stiffness=1)]
        rig = tn.Drivetrain(
            "rig", [*parts, tn.Inertia("B", node="b", inertia=1)], speeds={"of": "a", "list": ["600 rpm"]},
            excitations={"engine": engine},
        )  # fmt: skip
        shown = rows(_torques(SimpleNamespace(drivetrain=rig), "engine", rig.definition.excitations["engine"]))
        assert [row[:3] for row in (shown[0], shown[2])] == [("1", "0", ""), ("3", "0", "")]
        assert float(shown[1][1]) > 1e3

    def test_what_a_configuration_changes(self, found):
        changes = table(found, "excitations", "What configurations change")
        assert [row[:3] for row in rows(changes)] == [("smooth", "motor", "orders")]
        assert "amplitude 5 N·m" in rows(changes)[0][3]


class TestOrders:
    @pytest.mark.slow
    def test_worst_speed_of_every_configuration(self, found):
        """Against the sum over the common cycle, worked out from a dense solution of the two discs."""
        worst = rows(table(found, "orders", "largest over the speeds"))
        assert [row[0] for row in worst] == ["smooth", "rough"]
        for row, amplitude in zip(worst, (5, 20), strict=True):
            speed, half_range = dense_worst(amplitude)
            assert float(row[1]) == pytest.approx(speed, abs=0.2)
            assert float(row[2]) == pytest.approx(half_range, rel=1e-3)

    def test_only_torques_unless_others_are_asked_for(self, found):
        assert len(of(Picture, blocks(found, "orders"))) == 2
        angles = make_report(tn.loads(TWO_FANS + SENSOR + "report: {orders: [phi], sections: [orders]}\n"))
        assert "phi" in str(of(TableBlock, blocks(angles, "orders"))[0].caption)


def dense_worst(amplitude):
    """Speed in r/min and half range in N m of the torque in the shaft, largest over the speeds."""
    M, C, K = np.diag([0.5, 2.0]), 20 * np.array([[1, -1], [-1, 1]]), 4e4 * np.array([[1, -1], [-1, 1]])
    phi = np.linspace(0, 2 * np.pi, 20001)
    best = (0.0, 0.0)
    for rpm in np.concatenate([np.arange(300, 1501, 10), np.arange(495, 510, 0.2)]):
        wave = np.zeros_like(phi)
        for order, load in ((6, [amplitude, 0]), (5, [0, 12 * np.exp(1j * np.radians(20))])):
            w = order * rpm * np.pi / 30
            angles = np.linalg.solve(K + 1j * w * C - w**2 * M, load)
            wave += ((4e4 + 20j * w) * (angles[0] - angles[1]) * np.exp(1j * order * phi)).real
        best = max(best, ((wave.max() - wave.min()) / 2, rpm))
    return best[1], best[0]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("report: {orders: [T_x]}", r":13:19: .*unknown-channel"),
        ("report: {order: [T_s]}", 'did you mean "orders"'),
    ],
)
def test_wrong_outputs_are_told(text, told):
    with pytest.raises(tn.ModelError, match=told):
        tn.loads(f"{TWO_FANS}{SENSOR}{text}\n")


def test_orders_without_excitations_are_told():
    with pytest.raises(tn.ModelError, match=r":3:10: .*missing-entry"):
        tn.loads("torsionnet: 1\nelements: {J: {type: inertia, node: a, inertia: 1}}\nreport: {orders: [a]}\n")


@pytest.mark.slow
def test_the_largest_crossings_are_those_of_any_condition():
    """Order 0.5 cancels in normal firing; with a misfire it is the largest of the first mode."""
    from torsionnet.report.sections.resonances import MOST_ROWS, _largest

    # The propeller's damping of full power at all speeds: one set of modes instead of one for each crossing.
    ship = tn.load("marine_medium_speed").configured(Q_prop="188.7 kN*m", n_prop="151.8 rpm")
    runs = [
        ship.configured(f"water=wet,coupling=nominal,firing={name}").critical_speeds() for name in ("normal", "misfire")
    ]
    shown = _largest(runs[0], runs)
    assert len(shown.crossings) == MOST_ROWS < len(runs[0].crossings)
    assert shown.of(1, 0.5).excited is False
