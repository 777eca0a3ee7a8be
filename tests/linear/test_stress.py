"""Nominal shear stress of a shaft as a sensor: torque over the section modulus by hand, and where there is none."""

import math

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.io import read_frequency_response, write_frequency_response, write_modelica
from torsionnet.linear.sensitivity.parametric import parametric_response

OUTER, BORE = 0.1, 0.04
MODULUS = math.pi * (OUTER**4 - BORE**4) / (16 * OUTER)
FILE = """\
torsionnet: 1
name: shaft
elements:
  motor: {type: inertia, node: a, inertia: 2}
  shaft: {type: shaft, nodes: [a, b], outer_diameter: 100 mm, inner_diameter: 40 mm, length: 1 m}
  coupling: {type: spring, nodes: [b, c], stiffness: 1e5}
  load: {type: inertia, node: c, inertia: 3}
inputs: {T: {torque: a}}
sensors: {tau: {stress: shaft}}
"""


def test_it_is_the_torque_over_the_section_modulus_at_either_end():
    found = tn.loads(FILE).frequency_response(
        ["tau", "torque(shaft)", "stress(shaft, b)", "torque(shaft, b)"], "T", [5, 20]
    )
    first, torque, second, handed_on = found.values[:, :, 0].T
    assert first * MODULUS == pytest.approx(torque, rel=1e-14)
    assert second * MODULUS == pytest.approx(handed_on, rel=1e-14)
    assert abs(first - second).min() > 0  # the shaft has inertia
    assert found.outputs[0].unit == "Pa"


def test_a_static_torque_of_188_7_kNm_makes_23_4_N_per_mm2():
    tail = tn.Drivetrain(
        "tail",
        [tn.Shaft("tail", nodes=("a", "ground"), outer_diameter="345 mm", length="7.2 m", inertia="none")],
        inputs={"T": {"torque": "a"}},
    )
    assert abs(tail.frequency_response("stress(tail)", "T", [1]).values[0, 0, 0]) * 188.7e3 == pytest.approx(
        23.4e6, rel=2e-3
    )


def test_symbols_say_the_same():
    rig = tn.loads(FILE)
    tau = rig.symbolic().transfer_function("tau", "T")
    f = np.array([3.0, 40.0])
    numbers = rig.frequency_response("tau", "T", f).values[:, 0, 0]
    assert tau.evaluate(f).values[:, 0, 0] == pytest.approx(numbers, rel=1e-12)


class TestWhereTheSectionIsAParameter:
    @pytest.fixture
    @staticmethod
    def rig():
        elements = [
            tn.Inertia("J", node="a", inertia=2),
            tn.Shaft("shaft", nodes=("a", "ground"), outer_diameter="d", length=1),
        ]
        return tn.Drivetrain(
            "rig", elements, parameters={"d": 0.1}, inputs={"T": {"torque": "a"}}, sensors={"tau": {"stress": "shaft"}}
        )

    @pytest.mark.parametrize("output", ["tau", "stress(shaft)"])
    def test_every_copy_has_its_own(self, rig, output):
        for d in (0.1, 0.12, 0.08):
            found = rig.configured(d=d).frequency_response(output, "T", [0.0]).values[0, 0, 0]
            assert found == pytest.approx(16 / (math.pi * d**3), rel=1e-12)

    def test_so_has_every_variant(self, rig):
        diameters = np.array([0.1, 0.1, 0.12, 0.08])
        found = rig.frequency_responses("tau", "T", [0.0], {"d": diameters}).values[:, 0, 0, 0]
        assert found == pytest.approx(16 / (math.pi * diameters**3), rel=1e-12)

    def test_derivatives_are_those_of_differences(self, rig):
        f, step = [7.0, 90.0], 1e-7
        low, high = (rig.configured(d=0.1 + s).frequency_response("tau", "T", f).values[:, 0, 0] for s in (-step, step))
        response = parametric_response(rig, "tau", "T", f, ["d"])
        for start in (0.12, 0.1):
            found = response.evaluation([start])
        assert found.values[:, 0, 0] == pytest.approx((high + low) / 2, rel=1e-9)
        assert found.jacobian[:, 0, 0, 0] == pytest.approx((high - low) / (2 * step), rel=1e-5)

    def test_a_measured_stress_too(self, rig):
        for d in (0.1, 0.12):
            found = rig.configured(d=d).frequency_response("angle(a)", "tau", [1e-3], driven_by="T").values[0, 0, 0]
            assert found == pytest.approx(2 * 1 / (79.3e9 * d), rel=1e-6)


def test_tables_show_N_per_mm2_and_files_give_back_pascals(tmp_path):
    found = tn.loads(FILE).frequency_response(["tau", "torque(shaft)"], "T", [5, 20])
    assert found.unit(0, 0) == "N/mm^2/(N*m)"
    for name in ("h.csv", "h.uff", "h.npz"):
        write_frequency_response(found, tmp_path / name)
        again = read_frequency_response(tmp_path / name)
        assert [channel.unit for channel in again.outputs] == ["Pa", "N*m"]
        assert again.values == pytest.approx(found.values, rel=1e-12)


def test_a_simulation_has_it_too():
    rig = tn.loads(FILE)
    record = rig.simulate(["tau", "torque(shaft)"], {"T": [0.0, 1, 1, 0, 0]}, 1000.0)
    assert record["tau"].unit == "Pa"
    assert record["tau"].values * MODULUS == pytest.approx(record["torque(shaft)"].values)


@pytest.mark.parametrize(
    ("sensor", "kind"),
    [
        ("{stress: coupling}", "unfit-channel"),
        ("{stress: shafft}", "unknown-element"),
        ("{stress: shaft, at: c}", "unknown-word"),
        ("{stres: shaft}", "unknown-entry"),
    ],
)
def test_what_has_none_is_named_with_its_place(sensor, kind):
    with pytest.raises(tn.ModelError, match=f"<text>:9:.*{kind}"):
        tn.loads(FILE.replace("{stress: shaft}", sensor))


def test_modelica_is_told_to_measure_a_torque(tmp_path):
    with pytest.raises(tn.UsageError, match=r"(?s)tau .*torque\(shaft\).*no-counterpart"):
        write_modelica(tn.loads(FILE), tmp_path / "rig.mo")
