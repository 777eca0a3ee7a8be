"""Every library model once more as a part of another model: dots in all names, and everything else as before."""

from dataclasses import replace

import numpy as np
import pytest
from support.dotted_models import dotted
from support.library_cases import library_cases

import torsionnet as tn
from torsionnet.model.configurations import DEFAULT_AXIS
from torsionnet.model.defining import check_definition
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.writer import dump, flat_text


@pytest.mark.parametrize("name", library_cases())
def test_a_model_as_a_part_answers_as_alone(name):
    plain = tn.load(name)
    rig = dotted(plain)
    assert [fault for fault in check_definition(rig.definition) if fault.severity == "error"] == []
    assert list(rig.nodes) == [f"rig.{node}" for node in plain.nodes]
    assert list(rig.parameters) == [f"rig.{name}" for name in plain.parameters]
    pairs = [(plain, rig)]
    choice = {axis: list(alternatives)[-1] for axis, alternatives in plain.axes.items()}
    if choice:
        own = ",".join(f"{axis}={name}" for axis, name in choice.items())
        axes = {axis: "rig" if axis == DEFAULT_AXIS else f"rig.{axis}" for axis in choice}
        whole = ",".join(f"{axes[axis]}={name}" for axis, name in choice.items())
        pairs.append((plain.configured(own), rig.configured(whole)))
    for one, other in pairs:
        np.testing.assert_array_equal(other.modes().eigenvalues, one.modes().eigenvalues)


@pytest.mark.few(7)
@pytest.mark.parametrize("name", library_cases())
def test_a_model_as_a_part_is_written_and_read(name):
    definition = dotted(tn.load(name)).definition
    for text in (dump(definition), flat_text(definition)):
        found, faults = read_text(text, "")
        assert found is not None, [str(fault) for fault in faults]
        assert found.flat_data() == definition.flat_data()
    assert dump(definition).count("rig: {part: model}") == 1
    assert dump(replace(definition, authored=None)) == flat_text(definition)


def test_symbols_of_parts_have_their_owner_as_index():
    import sympy

    rig = dotted(tn.load("dmf_rig"))
    function = rig.symbolic().transfer_function("rig.theta_1", "rig.T_M")
    plain = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_M")
    renamed = {
        sympy.Symbol(f"rig.{name}"): sympy.Symbol(name) for name in rig.definition.parameters for name in [name[4:]]
    }
    found = sympy.together(function.expanded().expression.subs(renamed) - plain.expanded().expression)
    assert sympy.simplify(found) == 0
    assert r"k_{1,\mathrm{rig}}" in rig.symbolic().to_latex("K")


def test_code_of_parts_has_plain_names():
    rig = dotted(tn.load("dmf_rig"))
    space = {}
    exec(rig.symbolic().transfer_function("rig.theta_1", "rig.T_M").python_code("H"), space)
    frequencies = np.array([3.0, 20.0])
    wanted = rig.frequency_response("rig.theta_1", "rig.T_M", frequencies).values[:, 0, 0]
    np.testing.assert_allclose(space["H"](frequencies), wanted, rtol=1e-9)
    moved = rig.configured(**{"rig.k_2": 600}).frequency_response("rig.theta_1", "rig.T_M", frequencies).values[:, 0, 0]
    np.testing.assert_allclose(space["H"](frequencies, rig_k_2=600), moved, rtol=1e-9)


def test_a_name_with_a_dot_and_one_with_a_line_stay_apart():
    model = tn.Drivetrain(
        "two",
        [tn.Inertia("a.J", node="a.n", inertia="a.J"), tn.Spring("a_J", nodes=("a.n", "ground"), stiffness="a_J")],
        parameters={"a.J": 2, "a_J": 300},
    )
    space = {}
    exec(model.symbolic().transfer_function("a.n", "a.n").python_code("H"), space)
    wanted = model.frequency_response("a.n", "a.n", [1.0]).values[0, 0, 0]
    np.testing.assert_allclose(space["H"](np.array([1.0])), [wanted], rtol=1e-12)


def test_modelica_and_matlab_take_the_names():
    from torsionnet.io.modelica import to_modelica

    rig = dotted(tn.load("dmf_rig"))
    text = to_modelica(rig)
    assert "rig_k_2" in text
    assert "rig.k_2" not in text.replace('"rig.k_2', "")


def test_parameters_of_parts_are_set_by_an_alternative():
    text = """{torsionnet: 1, name: x, elements: {m: {type: inertia, node: a, inertia: 1}},
      parts: {s: {ports: [p], parameters: {k: 100}, elements: {s: {type: spring, nodes: [p, ground], stiffness: k}}}},
      use: {left: {part: s, at: {p: a}}}, configurations: {stiff: {left.k: 400 N*m/rad}, odd: {left.k: 2*left.k0}},
      parameters: {left.k0: 50}}"""
    model = tn.loads(text)
    assert model.configured("stiff").parameters["left.k"] == 400
    assert model.configured("odd").parameters["left.k"] == 100
    assert model.configured("stiff").modes().natural_frequencies[0] == pytest.approx(20 / (2 * np.pi))
