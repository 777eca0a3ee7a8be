"""Parts put into models: what they make, how they are written, changed, repeated and nested."""

import pickle

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.expression_reading import scalar
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.value_editing import ValuePlace, changed_text
from torsionnet.model.files.writer import dump, flat_text

MODEL = """\
torsionnet: 1
name: car  # a comment that stays
parts:
  half:
    ports: [inner, road]
    parameters: {k: 9 kN*m/rad, J: 0.9 kg*m^2}
    elements:
      shaft: {type: spring, nodes: [inner, hub], stiffness: k}
      wheel: {type: inertia, node: hub, inertia: J}
      tyre: {type: spring, nodes: [hub, road], stiffness: 2*k + 3 kN*m/rad}
    sensors: {T: {torque: shaft, at: hub}}
parameters: {k_l: 8 kN*m/rad}
elements:
  cage: {type: inertia, node: cage, inertia: 1}
  car: {type: inertia, node: road, inertia: 120}
use:
  left: {part: half, at: {inner: cage, road: road}, parameters: {k: k_l}}
  right: {part: half, at: {inner: cage, road: road}}
inputs: {T: {torque: cage}}
""".replace("2*k + 3 kN*m/rad", "2*k")


def model(text=MODEL):
    return tn.loads(text)


def test_a_part_has_the_names_of_its_use():
    car = model()
    assert list(car.elements) == [
        "cage",
        "car",
        *(f"{use}.{one}" for use in ("left", "right") for one in ("shaft", "wheel", "tyre")),
    ]
    assert car.nodes == ("cage", "road", "left.hub", "right.hub")
    assert str(car.sensors["left.T"]) == "torque(left.shaft, left.hub)"
    assert dict(car.parameters) == {"k_l": 8e3, "left.k": 8e3, "left.J": 0.9, "right.k": 9e3, "right.J": 0.9}
    assert car.configured(k_l=7e3).parameters["left.k"] == 7e3  # a value given in use: is of the model around it
    assert car.configured(**{"left.k": 5e3}).parameters["k_l"] == 8e3


def test_it_moves_as_the_same_drawn_out():
    by_hand = tn.Drivetrain(
        "by hand",
        [
            tn.Inertia("cage", node="cage", inertia=1),
            tn.Inertia("car", node="road", inertia=120),
            *(tn.Spring(f"s{k}", nodes=("cage", f"h{k}"), stiffness=k) for k in (8000, 9000)),
            *(tn.Inertia(f"w{k}", node=f"h{k}", inertia=0.9) for k in (8000, 9000)),
            *(tn.Spring(f"t{k}", nodes=(f"h{k}", "road"), stiffness=2 * k) for k in (8000, 9000)),
        ],
    )
    np.testing.assert_allclose(
        model().modes().natural_frequencies, by_hand.modes().natural_frequencies, rtol=1e-12, atol=1e-9
    )


@pytest.mark.parametrize(
    "change", [{}, {"left.k": 7e3}, {"right.J": 2}, {"k_l": 1e4}, {"left.k": "2*k_l", "right.k": "k_l"}]
)
def test_what_is_written_has_its_parts_and_reads_back(change):
    car = model().configured(**change)
    text = dump(car.definition)
    assert "use:" in text
    assert "left.shaft" not in text
    assert tn.loads(text) == car
    assert tn.loads(flat_text(car.definition)) == car


def test_what_parts_cannot_say_is_written_flat():
    car = model().switched(off=["left.tyre"])
    text = dump(car.definition)
    assert "use:" not in text
    assert "left.shaft" in text
    assert tn.loads(text) == car


def test_pickled_and_equal():
    car = model().configured(**{"left.k": 7e3})
    assert pickle.loads(pickle.dumps(car)) == car
    assert dump(pickle.loads(pickle.dumps(car)).definition) == dump(car.definition)
    assert car != model()


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("left.k", "parameters: {k: k_l}}", "parameters: {k: 7000}}"),
        ("left.J", "parameters: {k: k_l}}", "parameters: {J: 7000, k: k_l}}"),
        ("right.k", "right: {part", "right: {parameters: {k: 7000}, part"),
        ("k_l", "{k_l: 8 kN*m/rad}", "{k_l: 7000}"),
    ],
)
def test_a_fitted_value_stands_where_the_part_is_used(name, old, new):
    definition = model().definition
    found = changed_text(MODEL, definition, {ValuePlace(name): scalar(7000)})
    assert found == MODEL.replace(old, new)


def test_a_fitted_value_in_block_style():
    text = MODEL.replace(
        "  right: {part: half, at: {inner: cage, road: road}}",
        "  right:\n    part: half\n    at: {inner: cage, road: road}",
    )
    found = changed_text(text, model(text).definition, {ValuePlace("right.k"): scalar(7000)})
    assert found == text.replace("    part: half\n", "    parameters: {k: 7000}\n    part: half\n")


def test_a_fitted_value_of_one_of_several_copies():
    text = MODEL.replace("road: road}}\ninputs", "road: road}, repeat: 2, parameters: {J: [1, 2]}}\ninputs")
    definition = model(text).definition
    found = changed_text(text, definition, {ValuePlace("right2.J"): scalar(3)})
    assert found == text.replace("[1, 2]", "[1, 3]")
    found = changed_text(
        text, definition, {ValuePlace("right2.k"): scalar(3)}
    )  # one of two: not the author's text any more
    assert model(found).parameters["right2.k"] == 3
    assert model(found).parameters["right1.k"] == 9000
    assert "repeat: 2" in found


CHAIN = """\
torsionnet: 1
name: engine
parts:
  throw:
    ports: [front, rear]
    parameters: {J: 2, k: 100}
    elements:
      mass: {type: inertia, node: front, inertia: J}
      shaft: {type: spring, nodes: [front, rear], stiffness: k}
elements: {fly: {type: inertia, node: fly, inertia: 1}}
use: {cyl: {part: throw, repeat: 4, chain: [front, rear], at: {front: nose, rear: fly}, parameters: {J: [1, 1, 1, 1]}}}
"""


def test_a_chain_of_equal_masses_and_springs_against_its_closed_form():
    engine = tn.loads(CHAIN)
    assert engine.nodes == ("fly", "nose", "cyl2.front", "cyl3.front", "cyl4.front")
    wanted = [
        2 * 10 * np.sin(n * np.pi / 10) / (2 * np.pi) for n in range(5)
    ]  # free-free, 5 masses: 2 sqrt(k/J) sin(n pi/2N)
    np.testing.assert_allclose(engine.modes().natural_frequencies, wanted, atol=1e-8)


def test_a_list_of_nodes_names_those_of_a_chain():
    engine = tn.loads(CHAIN.replace("front: nose", "front: [c1, c2, c3, c4]"))
    assert engine.nodes == ("fly", "c1", "c2", "c3", "c4")
    assert engine.elements["cyl4.shaft"].nodes == ("c4", "fly")


def test_copies_side_by_side_have_nodes_and_values_by_index():
    text = CHAIN.replace("chain: [front, rear], at: {front: nose, rear: fly}", "at: {front: [a, b, c, d], rear: fly}")
    engine = tn.loads(text.replace("[1, 1, 1, 1]", "[1, 2, 3, 4]"))
    assert [engine.parameters[f"cyl{index}.J"] for index in (1, 2, 3, 4)] == [1, 2, 3, 4]
    assert engine.elements["cyl3.shaft"].nodes == ("c", "fly")


def test_parts_in_parts_and_values_through_both():
    text = CHAIN.replace(
        "use: {cyl:", "use: {engine: {part: row, at: {fly: fly}, parameters: {J_1: 7, cyl2.k: 50}}}\n#"
    ).replace(
        "elements: {fly",
        "  row: {ports: [fly], parameters: {J_1: 3}, use: {cyl: {part: throw, repeat: 2, chain: [front, rear], "
        "at: {front: nose, rear: fly}, parameters: {J: [J_1, 2*J_1]}}}}\nelements: {fly",
    )
    engine = tn.loads(text)
    assert engine.parameters["engine.cyl2.J"] == 14
    assert engine.parameters["engine.cyl2.k"] == 50
    assert engine.elements["engine.cyl1.shaft"].nodes == ("engine.nose", "engine.cyl2.front")
    found = changed_text(text, engine.definition, {ValuePlace("engine.cyl2.k"): scalar(60)})
    assert found == text.replace("cyl2.k: 50", "cyl2.k: 60")


def test_configurations_of_a_part_are_an_axis_of_the_whole():
    part = "{ports: [p], parameters: {k: 4}, elements: {s: {type: spring, nodes: [p, ground], stiffness: k}}, configurations: CHOICE}"
    whole = "{torsionnet: 1, name: x, parts: {s: PART}, elements: {m: {type: inertia, node: a, inertia: 1}}, use: {u: {part: s, at: {p: a}}}}"
    for choice, axis in (("{gear: {I: {k: 16}, II: {}}}", "u.gear"), ("{I: {k: 16}, II: {}}", "u")):
        model = tn.loads(whole.replace("PART", part.replace("CHOICE", choice)))
        assert dict(model.axes) == {axis: ("I", "II")}
        assert model.configured("I").modes().natural_frequencies[0] == pytest.approx(4 / (2 * np.pi))
        assert model.configured(f"{axis}=II").parameters["u.k"] == 4


def half_shaft():
    return tn.Drivetrain(
        "half shaft",
        [tn.Spring("shaft", nodes=("inner", "hub"), stiffness="k"), tn.Inertia("wheel", node="hub", inertia=0.9)],
        parameters={"k": 9000},
        ports=["inner"],
    )


def test_parts_in_python_are_those_of_a_file():
    axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=1)], parameters={"k_l": 8e3})
    axle = axle.with_part("left", half_shaft(), at={"inner": "cage"}, parameters={"k": "k_l"})
    axle = axle.with_part("more", half_shaft(), at={"inner": "cage"}, repeat=2, parameters={"k": [1, 2]})
    assert dump(axle.definition).count("half_shaft:") == 1
    assert tn.loads(dump(axle.definition)) == axle
    assert axle.parameters["more2.k"] == 2
    given = tn.Drivetrain(
        "axle",
        [tn.Inertia("cage", node="cage", inertia=1)],
        parameters={"k_l": 8e3},
        parts={"half_shaft": half_shaft()},
        use={
            "left": {"part": "half_shaft", "at": {"inner": "cage"}, "parameters": {"k": "k_l"}},
            "more": {"part": "half_shaft", "at": {"inner": "cage"}, "repeat": 2, "parameters": {"k": [1, 2]}},
        },
    )
    assert given == axle


def test_two_models_of_one_name_are_two_parts():
    other = half_shaft().configured(k=5)
    axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=1)])
    axle = axle.with_part("left", half_shaft(), at={"inner": "cage"}).with_part("right", other, at={"inner": "cage"})
    assert (axle.parameters["left.k"], axle.parameters["right.k"]) == (9000, 5)
    assert {"half_shaft:", "half_shaft_2:"} <= set(dump(axle.definition).split())


def test_a_model_with_parts_is_a_part_of_another():
    axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=1)], ports=["cage"])
    axle = axle.with_part("left", half_shaft(), at={"inner": "cage"})
    car = tn.Drivetrain("car", [tn.Inertia("engine", node="e", inertia=1)]).with_part("front", axle, at={"cage": "e"})
    assert list(car.elements) == ["engine", "front.cage", "front.left.shaft", "front.left.wheel"]
    assert tn.loads(dump(car.definition)) == car


def test_a_part_keeps_configuration_and_changes_of_the_model():
    base = tn.Drivetrain(
        "axle",
        [tn.Inertia("cage", node="cage", inertia="J")],
        parameters={"J": 1, "k_l": 2},
        configurations={"heavy": {"J": 3}},
    )
    axle = base.configured("heavy", k_l=5).with_part(
        "left", half_shaft(), at={"inner": "cage"}, parameters={"k": "k_l"}
    )
    assert axle.configuration == "heavy"
    assert (axle.parameters["J"], axle.parameters["left.k"]) == (3, 5)


def test_the_schema_knows_parts():
    import jsonschema
    import yaml

    from torsionnet.model.files.model_schema import json_schema

    validator = jsonschema.Draft202012Validator(json_schema())
    for text in (MODEL, CHAIN):
        assert [error.message for error in validator.iter_errors(yaml.safe_load(text))] == []
    for old, new in (
        ("part: throw", "prt: throw"),
        ("repeat: 4", "repeat: 0"),
        ("ports: [front, rear]", "ports: 1"),
        ("use: {cyl", "use: {c.l"),
    ):
        assert old in CHAIN
        assert list(validator.iter_errors(yaml.safe_load(CHAIN.replace(old, new)))), new


def test_reading_is_faultless():
    assert [fault for fault in read_text(MODEL, "")[1] if fault.severity != "note"] == []


def test_show_prints_the_flat_file_and_draws_boxes(tmp_path, capsys):
    from torsionnet.app.cli.app import run

    path = tmp_path / "car.yaml"
    path.write_text(MODEL, encoding="utf-8")
    assert run(["show", "--flat", str(path)]) == 0
    assert tn.loads(capsys.readouterr().out) == model()
    assert run(["show", "--boxes", str(path), "--plot", str(tmp_path / "car.svg")]) == 0
    opened, closed = (tn.plot.schematic(model(), boxes=boxes) for boxes in (False, True))
    texts = [[text.get_text() for text in figure.axes[0].texts] for figure in (opened, closed)]
    assert "left.shaft" in texts[0]
    assert "left.shaft" not in texts[1]
    assert {"left", "right", "half"} <= set(texts[1])


@pytest.mark.parametrize("port", ["crank", "c"])
def test_a_port_at_which_values_are_quoted_only(port):
    """No element of the part is on that node: J at the gear's far side is 4 at the crank, which turns with the port."""
    text = f"""\
torsionnet: 1
name: quoted
parts:
  load:
    ports: [n, {port}]
    elements:
      g: {{type: gear, nodes: [n, m], ratio: 2}}
      j: {{type: inertia, node: m, inertia: 4, referred_to: {port}}}
elements:
  a: {{type: inertia, node: c, inertia: 1}}
  s: {{type: spring, nodes: [c, d], stiffness: 100}}
use:
  l: {{part: load, at: {{n: d, {port}: c}}}}
"""
    assert model(text).modes().natural_frequencies[1] == pytest.approx(np.sqrt(100 * (1 + 1 / 4)) / 2 / np.pi)
    with pytest.raises(tn.ModelError, match=f'no node is named "{port}"'):
        model(text.replace(f", referred_to: {port}", ""))
