"""Numbers of laws of motion as parameters: what varies gives the result of a file written with the new number."""

import re

import numpy as np
import pytest
from support.models import sympy_algebra

import torsionnet as tn
import torsionnet.io as io
from torsionnet.base.expressions import FLOAT
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.files.reader import read_text

PARAMETERS = {
    "k_1": "460 N*m/rad", "phi_1": "0.12 rad", "T_2": "150 N*m", "k_2": "1500 N*m/rad", "P": "3 N*m",
    "T_r": "100 N*m", "phi_r": "0.1 rad", "b": "0.4 deg", "k_3": "900 N*m/rad^3", "T_f": "4 N*m", "T_s": "5 N*m",
    "T_0": "6 N*m", "n_1": "3 rad/s",
}  # fmt: skip
ELEMENTS = """
  e: {type: inertia, node: crank, inertia: 0.15 kg*m^2}
  d: {type: spring, nodes: [crank, a], stages: [{stiffness: k_1, to_twist: phi_1}, {stiffness: k_2, preload: P, to_torque: T_2}, {stiffness: 7 kN*m/rad}]}
  i: {type: inertia, node: a, inertia: 0.05}
  t: {type: spring, nodes: [a, g], torque_over_twist: [[0, 0], [phi_r, T_r], [0.5 rad, 900 N*m]]}
  ig: {type: inertia, node: g, inertia: 0.05}
  mesh: {type: gear, nodes: [g, wheel], ratio: 4, stiffness: 20 kN*m/rad, damping: 2 N*m*s/rad, backlash: b}
  w: {type: inertia, node: wheel, inertia: 24}
  q: {type: spring, nodes: [wheel, h], stiffness: 3 kN*m/rad, cubic: k_3}
  h: {type: inertia, node: h, inertia: 3}
  rub: {type: friction, nodes: [h, ground], torque: T_f, stick: T_s, stiffness: 55}
  brake: {type: friction, nodes: [h, ground], torque_over_slip: [[0, T_0], [n_1, 5 N*m], [900, 1]], stiffness: 40}
"""
NEW = {
    "k_1": 500.0, "phi_1": 0.3, "T_2": 180.0, "k_2": 1800.0, "P": 7.0, "T_r": 150.0, "phi_r": 0.2, "b": 0.01,
    "k_3": 4000.0, "T_f": 4.5, "T_s": 8.0, "T_0": 9.0, "n_1": 6.0,
}  # fmt: skip
LOAD = {"crank": 120, "h": -480}


def written(values):
    """Drivetrain of a file with these parameter values in place of the expressions themselves."""
    text = ELEMENTS
    for name, value in values.items():
        text = re.sub(rf"(?<=[ \[]){name}(?=[,\]}}])", str(value), text)
    return tn.Drivetrain.from_definition(read(f"torsionnet: 1\nelements:{text}"))


def read(text):
    definition, faults = read_text(text, "model.yaml")
    assert not [fault for fault in faults if fault.severity == "error"], faults
    return definition


@pytest.fixture(scope="module")
def rig():
    parameters = "".join(f"  {name}: {value}\n" for name, value in PARAMETERS.items())
    return tn.Drivetrain.from_definition(read(f"torsionnet: 1\nparameters:\n{parameters}elements:{ELEMENTS}"))


def laws(model):
    value = Values(model.exact_values)
    return [part for one in model.definition.active for part in one.whole_parts(value) if isinstance(part, MotionLaw)]


@pytest.mark.parametrize("name", NEW)
def test_a_varied_number_is_that_of_a_file_written_with_it(rig, name):
    varied, expected = rig.configured(**{name: NEW[name]}), written({**PARAMETERS, name: NEW[name]})
    assert laws(varied) == laws(expected)
    assert laws(varied) != laws(rig)
    frequencies = [one.modes().natural_frequencies for one in (varied, expected)]
    np.testing.assert_allclose(*frequencies, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("name", ["phi_1", "k_2", "T_r", "k_3"])
def test_under_load_too(rig, name):
    varied = rig.configured(**{name: NEW[name]}).at(torque=LOAD).modes().natural_frequencies
    expected = written({**PARAMETERS, name: NEW[name]}).at(torque=LOAD).modes().natural_frequencies
    np.testing.assert_allclose(varied, expected, rtol=1e-9, atol=1e-6)
    assert np.abs(varied - rig.at(torque=LOAD).modes().natural_frequencies).max() > 1e-3


def test_a_batch_varies_them_at_rest(rig):
    """Variants in which the stages no longer rise are impossible, and others have the matrices of their own model."""
    values = {"k_1": [460.0, 500.0, 300.0, 460.0], "T_2": [150.0, 160.0, 170.0, 50.0]}
    batch = batch_plan(rig, list(values)).batch(values)
    assert batch.impossible.tolist() == [False, False, False, True]
    assert values["k_1"][:3] in batch.stiffness[:3].T.tolist()
    with pytest.raises(tn.ModelError, match=r"elements\.d\.stages\.1\.to_torque: .*50.*unordered-rows"):
        rig.configured(T_2=50)


def test_a_preload_of_zero_does_not_hold(rig):
    spring = tn.Spring("e", nodes=("a", "b"), stages=[{"stiffness": 100, "preload": "P"}])
    for preload, holds in ((5.0, True), (0.0, False)):
        (law,) = spring.whole_parts(Values({"P": preload}, FLOAT))
        assert law.curve.holds(law.curve.states_at(0)[0]) is holds
    assert rig.configured(P=0).modes().eigenvalues.shape == rig.modes().eigenvalues.shape


def test_stages_in_symbols():
    """k gamma up to phi_1, and k_2 (gamma - phi_1) more from there on."""
    import sympy

    k, k_2, phi, x = sympy.symbols("k k_2 phi_1 x", positive=True)
    algebra = sympy_algebra()
    stages = [{"stiffness": "k", "to_twist": "phi_1"}, {"stiffness": "k_2"}]
    (law,) = tn.Spring("e", nodes=("a", "b"), stages=stages).whole_parts(
        Values({"k": k, "k_2": k_2, "phi_1": phi}, algebra)
    )
    found = law.curve.pieces[-1]
    assert sympy.expand(found.torque + found.stiffness * x - (k * phi + k_2 * (x - phi))) == 0


def test_the_mean_torque_of_a_flywheel_finds_its_stage_among_varied_ones():
    entries = {"nodes": ("a", "b"), "primary_inertia": 1, "secondary_inertia": 2, "torque": "T"}
    stages = [{"stiffness": "k_1", "to_torque": "T_1"}, {"stiffness": 900, "to_torque": "3*T_1"}]
    flywheel = tn.DualMassFlywheel("dmf", **entries, stages=stages)
    rig = tn.Drivetrain("rig", [flywheel], {"k_1": 200, "T_1": 100, "T": 90})
    for changes, stiffness in (({}, 200), ({"T": 150}, 900), ({"T_1": 80}, 900), ({"k_1": 300, "T": 20}, 300)):
        found = rig.configured(**changes).modes().eigenvalues.imag.max() if changes else rig.modes().eigenvalues.imag
        assert np.max(found) == pytest.approx(np.sqrt(stiffness * 1.5), rel=1e-12)
    with pytest.raises(tn.ModelError, match=r"elements\.dmf\.torque: .*300.*contradicting-values"):
        rig.configured(T=301)
    batch = batch_plan(rig, ["T_1"]).batch({"T_1": [100.0, 80.0, 20.0]})
    assert batch.impossible.tolist() == [False, False, True]


PART = """
torsionnet: 1
parts:
  joint:
    ports: [left, right]
    parameters: {b: 0.02 rad, k: 100 N*m/rad, phi: 0.1 rad}
    elements:
      mesh: {type: clearance, nodes: [left, m], gap: b, stiffness: 5000}
      body: {type: inertia, node: m, inertia: 0.2}
      stop: {type: spring, nodes: [m, right], stages: [{stiffness: k, to_twist: phi}, {stiffness: 3*k}]}
use:
  one: {part: joint, at: {left: a, right: b}}
  two: {part: joint, at: {left: c, right: b}, parameters: {b: 0.04 rad, k: 200 N*m/rad}}
elements:
  ja: {type: inertia, node: a, inertia: 1}
  jb: {type: inertia, node: b, inertia: 2}
  jc: {type: inertia, node: c, inertia: 3}
"""


class TestPartsAndConfigurations:
    def test_parameters_of_a_part_are_those_of_its_use(self):
        rig = tn.Drivetrain.from_definition(read(PART))
        value = Values(rig.exact_values, FLOAT)

        def law(name):
            return rig.definition.elements[name].whole_parts(value)[0]

        for use, gap, k in (("one", 0.02, 100), ("two", 0.04, 200)):
            mesh, stop = law(f"{use}.mesh"), law(f"{use}.stop")
            assert mesh.row == {"a" if use == "one" else "c": 1, f"{use}.m": -1}
            assert [mesh.torque(x, 0) for x in (gap / 2, -gap / 2 - 0.01)] == pytest.approx([0, -50])
            assert stop.torque(0.15, 0) == pytest.approx(k * 0.1 + 3 * k * 0.05)

    @pytest.mark.parametrize("torque", [5, 60])
    def test_a_part_under_load_is_the_model_without_parts(self, torque):
        rig = tn.Drivetrain.from_definition(read(PART)).at(torque={"a": torque, "c": -torque})
        through = [200 if torque < 10 else 600, 100 if torque < 10 else 300]
        elements = [
            *(tn.Inertia(f"i{node}", node=node, inertia=size) for node, size in zip("abc", (1, 2, 3), strict=True)),
            *(tn.Inertia(f"i{node}", node=node, inertia=0.2) for node in "mn"),
            *(tn.Spring(f"k{ends}", nodes=tuple(ends), stiffness=5000) for ends in ("am", "cn")),
            tn.Spring("kmb", nodes=("m", "b"), stiffness=through[1]),
            tn.Spring("knb", nodes=("n", "b"), stiffness=through[0]),
        ]
        expected = tn.Drivetrain("flat", elements).modes().natural_frequencies
        np.testing.assert_allclose(rig.modes().natural_frequencies, expected, rtol=1e-9, atol=1e-5)

    def test_an_alternative_gives_other_stages(self):
        text = (
            ELEMENTS
            + """
configurations:
  spring:
    soft: {d.stages: [{stiffness: 50, to: 0.1 rad}, {stiffness: k_1}], k_1: 70}
    free: {d.stages: [{stiffness: k_2, preload: 9 N*m}], mesh.backlash: 3 deg, rub.stick: 2*T_f}
"""
        )
        parameters = "".join(f"  {name}: {value}\n" for name, value in PARAMETERS.items())
        rig = tn.Drivetrain.from_definition(read(f"torsionnet: 1\nparameters:\n{parameters}elements:{text}"))
        soft, free = (laws(rig.configured(f"spring={label}")) for label in ("soft", "free"))
        assert soft[0].torque(0.2, 0) == pytest.approx(5 + 70 * 0.1)
        assert free[0].torque(0.2, 0) == pytest.approx(9 + 1500 * 0.2)
        assert free[2].curve.corners() == pytest.approx([-np.pi / 120, np.pi / 120])
        assert max(piece.high for piece in free[4].curve.pieces if hasattr(piece, "high")) == 8

    def test_faults_of_an_alternative_stand_in_it(self):
        text = (
            ELEMENTS + "configurations: {x: {low: {T_2: 20 N*m}, bad: {d.stages: [{stiffness: 0}, {stiffness: 3}]}}}\n"
        )
        parameters = "".join(f"  {name}: {value}\n" for name, value in PARAMETERS.items())
        _, faults = read_text(f"torsionnet: 1\nparameters:\n{parameters}elements:{text}", "model.yaml")
        told = {fault.text: fault.position for fault in faults if fault.severity == "error"}
        assert any("than 0, got 0" in one for one in told), told
        assert all(told.values())


LOOSE = [
    tn.Clearance("e", nodes=("a", "b"), gap=0.1, stiffness=500),
    tn.Spring("e", nodes=("a", "b"), stages=[{"stiffness": 100, "to": "1 N*m"}, {"stiffness": 300}]),
    tn.Spring("e", nodes=("a", "b"), stiffness=100, cubic=30),
    tn.Spring("e", nodes=("a", "b"), torque_over_twist=[[0, 0], [0.1, 5], [1, 80]]),
    tn.Friction("e", nodes=("a", "b"), torque=20),
    tn.Friction("e", nodes=("a", "b"), torque=20, stiffness=300),
    tn.Gear("e", nodes=("a", "b"), ratio=2, stiffness=900, backlash=0.1),
    tn.Clutch("e", nodes=("a", "b"), state="slipping", torque=[[0, 30], [10, 20]]),
    tn.DualMassFlywheel("e", nodes=("a", "b"), primary_inertia=1, secondary_inertia=1, stages=[
        {"stiffness": 100, "to": "1 N*m"}, {"stiffness": 300}]),
    tn.DualMassFlywheel("e", nodes=("a", "b"), primary_inertia=1, secondary_inertia=1, stiffness=5, friction=2),
    tn.ConstantPowerLoad("e", node="a", power=600),
    tn.FluidCoupling("e", pump="a", turbine="b", k_factor=[[0, 30], [0.9, 50], [1, 90]]),
]  # fmt: skip


@pytest.mark.parametrize("element", LOOSE, ids=lambda one: f"{one.kind}-{'-'.join(one.to_data())[-12:]}")
def test_exports_of_linear_elements_ask_for_an_operating_point(element, tmp_path):
    bodies = [tn.Inertia("i", node="a", inertia=1), tn.Inertia("j", node="b", inertia=2)]
    ends = [tn.Spring("s", nodes=("a", "b"), stiffness=70)] if "b" not in element.ports.values() else []
    rig = tn.Drivetrain(
        "rig", [*bodies, *ends, element], inputs={"T": {"torque": "a"}}, sensors={"y": {"velocity": "b"}}
    )
    writers = (
        (io.write_matlab, "rig_model.m"), (io.write_matlab, "rig.mat"), (io.write_modelica, "Rig.mo"),
        (io.write_fmu, "rig.fmu"), (io.write_tors, "rig.tors"), (io.write_mass_elastic, "rig.csv"),
    )  # fmt: skip
    for write, name in writers:
        with pytest.raises(tn.UsageError, match=rf"(?s)e \({element.kind}\).*no-counterpart"):
            write(rig, tmp_path / name)
    assert not list(tmp_path.iterdir())
