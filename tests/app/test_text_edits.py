"""Edits of values and elements in the text of a model: comments and layout stay, in block, flow and JSON style."""

import json
import random

import pytest
from support import campaigns

from torsionnet.app.text.text_edits import WrittenText, as_parameter, edited
from torsionnet.base.errors import UsageError
from torsionnet.model.files.library import library_models
from torsionnet.model.files.located_yaml import compose

BLOCK = """\
elements:
  # the motor
  # and its rotor
  rotor: {type: inertia, node: a, inertia: 2}   # cast
  # a long one
  shaft:
    type: spring
    # stiff
    nodes: [a, b]

    stiffness: 3  # at 20 degC
    # to be measured
  # what is driven
  wheel:
    type: inertia
    node: b
    inertia: 5
# speeds come later
sensors: {theta: {angle: a}}
"""
SPREAD = """\
elements: {
  # the motor
  rotor: {type: inertia, node: a, inertia: 2},  # cast
  # the shaft
  shaft: {type: spring,
    nodes: [a, b], stiffness: 3},
  wheel: {type: inertia, node: b, inertia: 5}  # driven
}
"""
JSON = json.dumps(
    {"elements": {"rotor": {"type": "inertia", "inertia": "2 kg*m^2"}, "wheel": {"type": "inertia"}}}, indent=4
)
LOCK = {"type": "lock", "node": "a"}


def written(text, file=""):
    return WrittenText(text, compose(text.removeprefix("\ufeff"), file), file.endswith(".json"))


def without(text, name, file=""):
    return edited(text, written(text, file).removal(("elements", name)))


def inserted(text, name, value, file=""):
    return edited(text, [written(text, file).insertion(("elements",), name, value)])


def replaced(text, path, value, file=""):
    return edited(text, [written(text, file).replacement(path, value)])


def test_the_first_element_goes_with_the_comments_above_it():
    assert without(BLOCK, "rotor") == BLOCK.replace(
        "  # the motor\n  # and its rotor\n  rotor: {type: inertia, node: a, inertia: 2}   # cast\n", ""
    )


def test_an_element_in_the_middle_goes_with_its_comments_and_empty_lines():
    begin, end = BLOCK.index("  # a long one"), BLOCK.index("  # what is driven")
    assert without(BLOCK, "shaft") == BLOCK[:begin] + BLOCK[end:]


def test_the_last_element_leaves_what_follows():
    begin, end = BLOCK.index("  # what is driven"), BLOCK.index("# speeds come later")
    assert without(BLOCK, "wheel") == BLOCK[:begin] + BLOCK[end:]


def test_the_only_element_leaves_an_empty_table():
    text = "elements:  # all\n  a: {type: lock, node: n}\nname: x\n"
    assert without(text, "a") == "elements: {}  # all\nname: x\n"
    assert without("elements: {a: {type: lock}}", "a") == "elements: {}"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("rotor", "elements: {shaft: {k: 3}, wheel: {J: [5, 6]}}\n"),
        ("shaft", "elements: {rotor: {J: 2}, wheel: {J: [5, 6]}}\n"),
        ("wheel", "elements: {rotor: {J: 2}, shaft: {k: 3}}\n"),
    ],
)
def test_elements_on_one_line(name, expected):
    assert without("elements: {rotor: {J: 2}, shaft: {k: 3}, wheel: {J: [5, 6]}}\n", name) == expected


def test_elements_in_brackets_over_several_lines():
    assert without(SPREAD, "rotor") == SPREAD.replace(
        "  # the motor\n  rotor: {type: inertia, node: a, inertia: 2},  # cast\n", ""
    )
    begin, end = SPREAD.index("  # the shaft"), SPREAD.index("  wheel")
    assert without(SPREAD, "shaft") == SPREAD[:begin] + SPREAD[end:]
    last = SPREAD.index("  wheel")
    assert without(SPREAD, "wheel") == SPREAD[: last - 2] + "\n}\n"


@pytest.mark.parametrize("name", ["rotor", "wheel"])
def test_json_stays_json(name):
    data = json.loads(JSON)
    del data["elements"][name]
    assert json.loads(without(JSON, name, "m.json")) == data
    assert json.dumps(data, indent=4) == without(JSON, name, "m.json")


def test_an_element_is_inserted_in_block_style():
    line = "  wheel:\n    type: inertia\n    node: b\n    inertia: 5\n"
    assert inserted(BLOCK, "stop", LOCK) == BLOCK.replace(line, line + "  stop: {type: lock, node: a}\n")


def test_an_element_is_inserted_in_brackets():
    new = inserted(SPREAD, "stop", LOCK)
    data = compose(new, "").data["elements"]
    assert list(data) == ["rotor", "shaft", "wheel", "stop"]
    assert data["stop"] == LOCK
    assert "\n  stop: {type: lock, node: a}" in new
    assert new.count("#") == SPREAD.count("#")
    assert inserted("elements: {a: {k: 1}, b: {k: 2}}", "c", {"k": 3}) == (
        "elements: {a: {k: 1}, b: {k: 2}, c: {k: 3}}"
    )
    assert inserted("elements: {\n  a: {k: 1},\n}\n", "c", {"k": 3}) == ("elements: {\n  a: {k: 1},\n  c: {k: 3},\n}\n")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("name: x\nelements:\n", "name: x\nelements:\n  s: {type: lock}\n"),
        ("elements:  # none yet\nname: x\n", "elements:  # none yet\n  s: {type: lock}\nname: x\n"),
        ("elements: {}\n", "elements: {s: {type: lock}}\n"),
        ("a: 1\r\nelements:\r\n  x: {k: 1}\r\n", "a: 1\r\nelements:\r\n  x: {k: 1}\r\n  s: {type: lock}\r\n"),
        ("elements:\n  x: {k: 1}", "elements:\n  x: {k: 1}\n  s: {type: lock}"),
        ("\ufeffelements: {}", "\ufeffelements: {s: {type: lock}}"),
    ],
)
def test_a_first_element(text, expected):
    assert inserted(text, "s", {"type": "lock"}) == expected


def test_an_element_in_json():
    new = inserted(JSON, "stop", LOCK, "m.json")
    assert list(json.loads(new)["elements"]) == ["rotor", "wheel", "stop"]
    assert '\n        "stop": {"type": "lock", "node": "a"}\n' in new


@pytest.mark.parametrize(
    ("path", "value", "old", "new"),
    [
        (("elements", "shaft", "stiffness"), "4 kN*m/rad", "stiffness: 3 ", "stiffness: 4 kN*m/rad "),
        (("elements", "shaft", "nodes"), ["a", "c"], "[a, b]", "[a, c]"),
        (("elements", "shaft", "nodes", 1), "c", "[a, b]", "[a, c]"),
        (("elements", "rotor", "inertia"), 0.5, "inertia: 2}", "inertia: 0.5}"),
        (("elements", "wheel", "type"), "no", "wheel:\n    type: inertia", 'wheel:\n    type: "no"'),
        (("sensors", "theta"), {"angle": "b"}, "{angle: a}", "{angle: b}"),
        (
            ("elements", "wheel"),
            {"type": "lock"},
            "wheel:\n    type: inertia\n    node: b\n    inertia: 5\n",
            "wheel: {type: lock}\n",
        ),
    ],
)
def test_a_value_is_set(path, value, old, new):
    assert old in BLOCK
    assert replaced(BLOCK, path, value) == BLOCK.replace(old, new)


def test_values_in_json_and_without_a_value():
    assert '"inertia": "3 kg*m^2"' in replaced(JSON, ("elements", "rotor", "inertia"), "3 kg*m^2", "m.json")
    assert replaced("a:\nb: 1\n", ("a",), 2) == "a: 2\nb: 1\n"
    assert replaced("{a: , b: 1}", ("a",), 2) == "{a: 2, b: 1}"
    with pytest.raises(UsageError, match="unknown-entry"):
        replaced("a: 1\n", ("x", "y"), 2)


def test_edits_of_library_models_change_nothing_else():
    """Any element removed and inserted again gives the data of before; comments of others stay."""
    draw = random.Random(4)
    for _ in range(campaigns.examples(8, 400)):
        text = draw.choice(list(library_models().values())).read_text(encoding="utf-8")
        elements = compose(text, "").data["elements"]
        name = draw.choice(list(elements))
        new = without(text, name)
        assert compose(inserted(new, name, elements[name]), "").data == compose(text, "").data
        gone = [line for line in text.splitlines() if line not in new.splitlines()]
        assert len(gone) <= 1 + text.count("\n") - new.count("\n")


@pytest.mark.parametrize(
    ("text", "file", "expected"),
    [
        ("parameters:\n  J_m: 3\nelements:\n  m:\n    type: inertia\n    node: a\n    inertia: 2 kg*m^2  # known\n", "m.yaml",
         "parameters:\n  J_m: 3\n  J_m_2: 2 kg*m^2\nelements:\n  m:\n    type: inertia\n    node: a\n    inertia: J_m_2  # known\n"),
        ('{"elements": {"m": {"type": "inertia", "node": "a", "inertia": 2.5}}}', "m.json",
         '{"parameters": {"J_m": 2.5}, "elements": {"m": {"type": "inertia", "node": "a", "inertia": "J_m"}}}'),
    ],
)  # fmt: skip
def test_a_number_of_an_element_becomes_a_parameter(text, file, expected):
    assert edited(text, as_parameter(text, "m", "inertia", "J", file)) == expected


def test_what_is_no_number_of_the_text_becomes_no_parameter():
    with pytest.raises(UsageError, match="no entry elements"):
        as_parameter("elements: {m: {type: inertia}}", "m", "inertia", "J")
    with pytest.raises(UsageError, match="no number"):
        as_parameter("elements: {m: {type: spring, stiffness: {0: 1}}}", "m", "stiffness", "k")
