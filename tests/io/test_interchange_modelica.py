"""Modelica text, read by the reader in ``modelica_reader`` with the equations of the Modelica Standard Library 4.0.

No Modelica tool runs here: what is tested is that the text is of the form the reader knows, and that with the library's
equations it has the poles and responses of the drivetrain.
"""

import numpy as np
import pytest
from support.library_cases import library_cases
from support.made_up_elements import EXPORTED, GROUND, TwoPorts, of_kind
from support.modelica_reader import Model
from support.models import EVERY_ELEMENT, around, geared_line, without_indeterminate

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.io import to_modelica, write_modelica

FREQUENCIES = [0.7, 5.3, 21.0]
OVER_FREQUENCY = {"tabulated_spring", "continuous_shaft"}
NO_COUNTERPART = {
    "arc_spring",
    "hysteretic_spring",
    *OVER_FREQUENCY,
    "controller",
    "fluid_coupling",
    "torque_converter",
}
NO_OPERATING_POINT = {"clearance", "friction"}


def has_counterpart(rig):
    """Whether no element is of a type that Modelica lacks, or loses energy as rubber does."""
    laws = [law for _, law in rig.assembly.kinematics.laws if law.acts]
    lossy = any(law.loss_factor or law.table for law in laws)
    return not lossy and not any(element.kind in NO_COUNTERPART for element in rig.definition.active)


def different(name):
    """A library model in the configurations with other elements or parameters than those before; not all of what runs."""
    rig, seen = tn.load(name), []
    for configuration in rig.configurations or ("",):
        one = rig.configured(configuration) if configuration else rig
        what = [one.definition.active, one.parameters]
        if what not in seen:
            seen.append(what)
            yield one


SMALL = """
model geared_line "geared line"
  parameter Real J_1(unit="kg.m2") = 0.2;
  parameter Real J_2(unit="kg.m2") = 0.5;
  parameter Real k_1(unit="N.m/rad") = 900;
  parameter Real k_2(unit="N.m/rad") = 4000;
  parameter Real tau(unit="1") = 3;
  parameter Real c(unit="N.m.s/rad") = 2;
  Modelica.Blocks.Interfaces.RealInput T_M(unit="N.m");
  Modelica.Blocks.Interfaces.RealOutput angle(unit="rad");
  Modelica.Blocks.Interfaces.RealOutput T(unit="N.m");
  Modelica.Mechanics.Rotational.Components.Inertia motor(J=J_1);
  Modelica.Mechanics.Rotational.Sensors.TorqueSensor T_meter;
  Modelica.Mechanics.Rotational.Components.SpringDamper soft(c=k_1, d=c);
  Modelica.Mechanics.Rotational.Components.Inertia wheel(J=J_2);
  Modelica.Mechanics.Rotational.Components.IdealGear stage(ratio=tau);
  Modelica.Mechanics.Rotational.Components.Spring stiff(c=k_2);
  Modelica.Mechanics.Rotational.Components.Fixed brake;
  Modelica.Mechanics.Rotational.Sources.Torque T_M_source;
  Modelica.Mechanics.Rotational.Sensors.AngleSensor angle_sensor;
equation
  connect(T_meter.tau, T);
  connect(T_M, T_M_source.tau);
  connect(angle_sensor.phi, angle);
  // m
  connect(motor.flange_a, T_meter.flange_a);
  connect(motor.flange_a, T_M_source.flange);
  connect(motor.flange_a, angle_sensor.flange);
  // p
  connect(T_meter.flange_b, soft.flange_a);
  // g
  connect(soft.flange_b, wheel.flange_a);
  connect(soft.flange_b, stage.flange_a);
  // o
  connect(stage.flange_b, stiff.flange_a);
  // h
  connect(stiff.flange_b, brake.flange);
  annotation(uses(Modelica(version="4.0.0")));
end geared_line;
"""


def agree(rig, model, rtol=1e-10):
    expected = rig.frequency_response(model.outputs, model.inputs, FREQUENCIES).values
    found = np.array([model.responses(2j * np.pi * f) for f in FREQUENCIES])
    scale = np.abs(expected).max(axis=0)
    scale[scale == 0] = 1  # the twist of something rigid
    np.testing.assert_allclose(found / scale, expected / scale, atol=rtol)


@pytest.mark.parametrize("name", library_cases())
def test_library_models_respond_alike(name):
    for rig in different(name):
        if has_counterpart(rig):
            model = Model(to_modelica(rig))
            assert (model.inputs, model.outputs) == (list(rig.inputs), list(rig.sensors))
            agree(rig, model)


@pytest.mark.parametrize(
    ("name", "configuration", "expected"),
    [  # natural frequencies of the paper's equations, calculated with dense LAPACK from its matrices
        ("dmf_rig", "", [7.10526, 80.98336]),
        ("amt_rig", "V", [5.912, 18.079]),
    ],
)
def test_poles_are_those_of_the_paper(name, configuration, expected):
    rig = tn.load(name).configured(configuration) if configuration else tn.load(name)
    poles = Model(to_modelica(rig)).eigenvalues()
    natural = np.unique((np.abs(poles[poles.imag > 1]) / (2 * np.pi)).round(5))
    np.testing.assert_allclose(natural, expected, atol=6e-4)


CASES = {
    kind: element for kind, element in EVERY_ELEMENT.items() if kind not in NO_COUNTERPART | NO_OPERATING_POINT
} | {
    "rigid gear": tn.Gear("e", nodes=("a", "b"), ratio=-2.5, housing="c"),
    "compliant planetary": tn.Planetary("e", sun="a", ring="b", carrier="c", ratio=2.6, stiffness=900, damping=3),
    "ring on ground": tn.Planetary("e", sun="a", ring="ground", carrier="c", teeth=(30, 72), planet_inertia=0.1),
    "locked differential": tn.Differential("e", cage="a", left="b", right="c", locked=True),
    "lumped shaft": tn.Shaft("e", nodes=("a", "b"), outer_diameter=0.05, length=1, segments=2, inertia="lumped"),
    "light shaft": tn.Shaft("e", nodes=("a", "b"), outer_diameter=0.05, length=1, inertia="none"),
    "damping measure": tn.Spring("e", nodes=("a", "b"), stiffness=300, damping={"zeta": 0.05, "at": "3 Hz"}),
    "spring without damping": tn.Spring("e", nodes=("a", "b"), stiffness=300),
}


@pytest.mark.few(17)
@pytest.mark.parametrize("case", CASES)
def test_every_element_with_all_its_sensors(case):
    rig = without_indeterminate(around(CASES[case]))
    assert len(rig.sensors) >= 4
    agree(rig, Model(to_modelica(rig)))


@pytest.mark.parametrize("case", EXPORTED)
def test_an_element_the_format_knows_nothing_of_is_written_by_its_parts(case):
    rig = without_indeterminate(around(EXPORTED[case]))
    assert {"twist", "a"} <= set(rig.sensors)
    agree(rig, Model(to_modelica(rig)))


def test_laws_keep_their_parameters():
    element = of_kind(TwoPorts, nodes=("a", GROUND), give="2*k/(1 + k)**2")
    parts = [tn.Inertia("i", node="a", inertia=2), element]
    rig = tn.Drivetrain("x", parts, {"k": 3}, inputs={"T": {"torque": "a"}}, sensors={"y": {"angle": "a"}})
    text = to_modelica(rig)
    assert "Spring e(c=2*k/(1 + k)^2)" in text
    agree(rig.configured(k=7), Model(text, k=7.0))


def test_parameters_stay_parameters():
    text = to_modelica(tn.load("amt_rig"))
    agree(tn.load("amt_rig").configured(tau=3.26, k_1=900, I_1=0.3), Model(text, tau=3.26, k_1=900.0, I_1=0.3))


def test_expressions_keep_their_meaning():
    parameters = {
        "G": "80 GPa", "d": "20 mm", "L": "0.5 m", "k": "G*pi*d**4/(32*L)", "ratio": "-3/(2 - 1/3)", "x": 3, "i": "sqrt(x)/x**(-2)",
        "time": 2, "end": 0.5,
    }  # fmt: skip
    rig = tn.Drivetrain(
        "model",
        [
            tn.Inertia("der", node="a", inertia="i*time**2"),
            tn.Spring("k", nodes=("a", "b"), stiffness="k"),
            tn.Gear("a", nodes=("b", "c"), ratio="ratio"),
            tn.Inertia("T", node="c", inertia="end/(time*2)"),
        ],
        parameters=parameters,
        inputs={"T": {"torque": "a"}},
        sensors={"model": {"angle": "c"}, "k": {"torque": "k"}},
    )
    model = Model(to_modelica(rig))
    assert model.name == "model_2"
    assert not {"end", "der", "time"} & {*model.values, *model.components}
    found = np.array([model.responses(2j * np.pi * f) for f in FREQUENCIES])
    expected = rig.frequency_response(["model", "k"], ["T"], FREQUENCIES).values
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def test_text_of_a_small_model():
    text = to_modelica(geared_line())
    assert text.splitlines() == SMALL.strip().splitlines()


def test_same_model_same_text(tmp_path):
    write_modelica(tn.load("planetary_set"), tmp_path / "a.mo")
    assert (tmp_path / "a.mo").read_text(encoding="utf-8") == to_modelica(tn.load("planetary_set"))


def test_descriptions_are_quoted():
    rig = tn.Drivetrain(
        'x"; end x; //', [tn.Inertia("i", node="a", inertia="J")],
        parameters={"J": {"value": 2, "description": 'a "quote" and a \\ and\na line'}},
        source="two\nlines", description='"\\',
    )  # fmt: skip
    text = to_modelica(rig)
    assert text.splitlines()[0] == r'model x_end_x "\"\\"'
    assert r'= 2 "a \"quote\" and a \\ and a line";' in text
    assert Model(text).values == {"J": 2}


@pytest.mark.parametrize("kind", sorted(NO_COUNTERPART))
def test_elements_without_counterpart_are_refused_by_name(kind):
    laws = dict.fromkeys(("arc_spring", "hysteretic_spring"), "loss factor on a - b") | dict.fromkeys(
        OVER_FREQUENCY, "table over frequency on a"
    )
    part = laws.get(kind, "torque on . - . that follows")
    with pytest.raises(UsageError, match=rf" of e \({kind}\), .*{part}"):
        to_modelica(around(EVERY_ELEMENT[kind]))


@pytest.mark.parametrize("kind", sorted(NO_OPERATING_POINT))
def test_laws_of_motion_need_an_operating_point(kind):
    with pytest.raises(UsageError, match=rf"(?s) e \({kind}\) .*no-counterpart"):
        to_modelica(around(EVERY_ELEMENT[kind]))


def test_an_imposed_angle_is_a_position():
    parts = [tn.Inertia("i", node="a", inertia=2), tn.Spring("s", nodes=("a", "b"), stiffness=80, damping=1)]
    rig = tn.Drivetrain("x", parts, inputs={"phi": {"angle": "b"}}, sensors={"y": {"angle": "a"}, "T": {"torque": "s"}})
    agree(rig, Model(to_modelica(rig)))


def test_switched_off_parts_are_left_out():
    rig = tn.load("direct_drive_wind_turbine").configured("undamped")
    assert "modal" not in to_modelica(rig).split("equation")[1]


def test_torques_and_stiffnesses_have_units_of_their_own():
    """Their dimensions are one as rad is 1: told by the entry they stand in, else by the unit they were written in."""
    text = to_modelica(
        tn.Drivetrain(
            "units",
            [
                tn.DualMassFlywheel(
                    "dmf", nodes=("a", "b"), primary_inertia="J", secondary_inertia="J_2", torque="Q", stages=[{"stiffness": 9}]
                ),
                tn.Spring("k", nodes=("b", "c"), stiffness="k_1 + k_2"),
                tn.Inertia("c", node="c", inertia="q*J"),
            ],
            parameters={
                "J": 3, "J_2": "J", "Q": 50, "k_1": "3 N*m/rad", "k_2": "4 N*m", "T": "12 N*m", "q": 2, "d": "3 N*m/deg",
                "t": "2 ms", "share": "3 %",
            },
        )
    )  # fmt: skip
    expected = {
        "J": "kg.m2", "J_2": "kg.m2", "Q": "N.m", "k_1": "N.m/rad", "k_2": "N.m/rad", "T": "N.m", "d": "N.m/rad",
        "t": "s", "share": "1",
    }  # fmt: skip
    for name, unit in expected.items():
        assert f'parameter Real {name}(unit="{unit}")' in text, name
    assert "parameter Real q =" in text
