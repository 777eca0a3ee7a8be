"""Edits of values and elements in the text of a model: comments and layout stay, in block, flow and JSON style."""

import json
import random

import pytest
from support import campaigns
from support.broken_models import BASE

from torsionnet.app.text.element_edits import inserted_element, value_edit, without_element
from torsionnet.app.text.text_edits import edited
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


def without(text, name, file=""):
    return edited(text, without_element(text, name, file).edits)


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
    removal = without_element(text, "a")
    assert edited(text, removal.edits) == "elements: {}  # all\nname: x\n"
    assert any("a model needs elements" in one.fault.message for one in removal.faults)
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


def test_what_still_names_an_element_is_told():
    found = [one.fault.message for one in without_element(BASE, "shaft").faults]
    assert any('no element is named "shaft"' in one for one in found)
    assert without_element(BASE, "vehicle").faults != ()
    removal = without_element(BASE, "shaft")
    new = edited(BASE, removal.edits)
    (fault,) = [one for one in removal.faults if "no element" in one.fault.message]
    assert new[fault.span.start : fault.span.end] == "shaft"


def test_an_element_whose_anchor_is_used_elsewhere_stays():
    text = "elements:\n  a: {type: inertia, node: n, inertia: &J 3}\n  b: {type: inertia, node: m, inertia: *J}\n"
    with pytest.raises(UsageError, match=r'a holds the anchor "&J", which line 3 uses as "\*J"; write it out there'):
        without_element(text, "a")
    assert without(text, "b") == text[: text.index("  b:")]
    with pytest.raises(UsageError, match="holds the anchor"):
        value_edit(text, ("elements", "a", "inertia"), 4)
    assert edited(text, value_edit(text, ("elements", "b", "inertia"), 4)) == text.replace("*J", "4")
    own = "elements:\n  a: {x: &J 3, y: *J}\n  b: {x: &J 4}\n"
    assert without(own, "a") == "elements:\n  b: {x: &J 4}\n"


def test_an_unknown_element_and_a_broken_text_are_refused():
    with pytest.raises(UsageError, match=r'no element is named "rotr"; did you mean "rotor"\?'):
        without_element(BLOCK, "rotr")
    with pytest.raises(UsageError, match=r"the text is broken; mend it first: .* \(line 1\)"):
        without_element("elements: {a: {", "a")
    with pytest.raises(UsageError, match="was already given"):
        value_edit("a: 1\na: 2\n", ("a",), 3)


@pytest.mark.parametrize(
    ("after", "line"),
    [
        (None, "  wheel:\n    type: inertia\n    node: b\n    inertia: 5\n"),
        ("rotor", "  rotor: {type: inertia, node: a, inertia: 2}   # cast\n"),
        ("shaft", "    stiffness: 3  # at 20 degC\n    # to be measured\n"),
    ],
)
def test_an_element_is_inserted_in_block_style(after, line):
    new = edited(BLOCK, inserted_element(BLOCK, "stop", LOCK, after))
    assert new == BLOCK.replace(line, line + "  stop: {type: lock, node: a}\n")


@pytest.mark.parametrize("after", [None, "rotor", "shaft", "wheel"])
def test_an_element_is_inserted_in_brackets(after):
    new = edited(SPREAD, inserted_element(SPREAD, "stop", LOCK, after))
    data = compose(new, "").data["elements"]
    known = ["rotor", "shaft", "wheel"]
    known.insert(known.index(after or "wheel") + 1, "stop")
    assert list(data) == known
    assert data["stop"] == LOCK
    assert "\n  stop: {type: lock, node: a}" in new
    assert new.count("#") == SPREAD.count("#")
    one = "elements: {a: {k: 1}, b: {k: 2}}"
    assert edited(one, inserted_element(one, "c", {"k": 3}, "a")) == "elements: {a: {k: 1}, c: {k: 3}, b: {k: 2}}"
    assert edited(one, inserted_element(one, "c", {"k": 3})) == "elements: {a: {k: 1}, b: {k: 2}, c: {k: 3}}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "elements:\n  s: {type: lock}\n"),
        ("name: x", "name: x\nelements:\n  s: {type: lock}\n"),
        ("name: x\nelements:\n", "name: x\nelements:\n  s: {type: lock}\n"),
        ("elements:  # none yet\nname: x\n", "elements:  # none yet\n  s: {type: lock}\nname: x\n"),
        ("elements: {}\n", "elements: {s: {type: lock}}\n"),
        ("{name: x}\n", "{name: x, elements: {s: {type: lock}}}\n"),
        ("a: 1\r\nelements:\r\n  x: {k: 1}\r\n", "a: 1\r\nelements:\r\n  x: {k: 1}\r\n  s: {type: lock}\r\n"),
        ("elements:\n  x: {k: 1}", "elements:\n  x: {k: 1}\n  s: {type: lock}"),
        ("\ufeffelements: {}", "\ufeffelements: {s: {type: lock}}"),
    ],
)
def test_a_first_element(text, expected):
    assert edited(text, inserted_element(text, "s", {"type": "lock"})) == expected


def test_an_element_in_json():
    new = edited(JSON, inserted_element(JSON, "stop", LOCK, "rotor", "m.json"))
    assert list(json.loads(new)["elements"]) == ["rotor", "stop", "wheel"]
    assert '\n        "stop": {"type": "lock", "node": "a"},\n' in new
    for text in ("{}", ""):
        first = edited(text, inserted_element(text, "s", LOCK, None, "m.json"))
        assert json.loads(first) == {"elements": {"s": LOCK}}


def test_a_name_that_is_taken_or_unknown_is_refused():
    with pytest.raises(UsageError, match='an element is already named "rotor"'):
        inserted_element(BLOCK, "rotor", LOCK)
    with pytest.raises(UsageError, match=r'no element is named "whel"; did you mean "wheel"\?'):
        inserted_element(BLOCK, "stop", LOCK, "whel")
    with pytest.raises(UsageError, match="this text is no model"):
        inserted_element("- a\n", "stop", LOCK)


@pytest.mark.parametrize(
    ("path", "value", "old", "new"),
    [
        (("elements", "shaft", "stiffness"), "4 kN*m/rad", "stiffness: 3 ", "stiffness: 4 kN*m/rad "),
        (("elements", "shaft", "nodes"), ["a", "c"], "[a, b]", "[a, c]"),
        (("elements", "shaft", "nodes", 1), "c", "[a, b]", "[a, c]"),
        (("elements", "rotor", "inertia"), 0.5, "inertia: 2}", "inertia: 0.5}"),
        (("elements", "wheel", "type"), "no", "wheel:\n    type: inertia", 'wheel:\n    type: "no"'),
        (("sensors", "theta"), {"angle": "b"}, "{angle: a}", "{angle: b}"),
        (("elements", "rotor", "description"), "a, b", "inertia: 2}", 'inertia: 2, description: "a, b"}'),
        (("elements", "wheel", "enabled"), False, "inertia: 5\n", "inertia: 5\n    enabled: false\n"),
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
    assert edited(BLOCK, value_edit(BLOCK, path, value)) == BLOCK.replace(old, new)


def test_values_in_json_and_without_a_value():
    assert '"inertia": "3 kg*m^2"' in edited(
        JSON, value_edit(JSON, ("elements", "rotor", "inertia"), "3 kg*m^2", "m.json")
    )
    assert edited("a:\nb: 1\n", value_edit("a:\nb: 1\n", ("a",), 2)) == "a: 2\nb: 1\n"
    assert edited("{a: , b: 1}", value_edit("{a: , b: 1}", ("a",), 2)) == "{a: 2, b: 1}"
    for path in ((), ("x", "y"), ("a", "b")):
        with pytest.raises(UsageError):
            value_edit("a: 1\n", path, 2)


def test_edits_of_library_models_change_nothing_else():
    """Any element removed and put back behind the one before gives the data of before; comments of others stay."""
    draw = random.Random(4)
    for _ in range(campaigns.examples(8, 400)):
        path = draw.choice(list(library_models().values()))
        text = path.read_text(encoding="utf-8")
        elements = compose(text, "").data["elements"]
        name = draw.choice(list(elements))
        edits = without_element(text, name, str(path), path.parent).edits
        new = edited(text, edits)
        before = list(elements).index(name) - 1
        after = list(elements)[before] if before >= 0 else None
        back = edited(new, inserted_element(new, name, elements[name], after))
        assert compose(back, "").data == compose(text, "").data
        if after is not None:
            assert list(compose(back, "").data["elements"]) == list(elements)
        gone = [line for line in text.splitlines() if line not in new.splitlines()]
        assert len(gone) <= 1 + text.count("\n") - new.count("\n")


@pytest.mark.parametrize("step", [23, pytest.param(1, marks=pytest.mark.nightly)])
def test_a_text_cut_anywhere_is_edited_or_refused(step):
    refused = done = 0
    for end in range(step - 1, len(BASE), step):
        text = BASE[:end]
        try:
            new = edited(text, inserted_element(text, "stop", LOCK))
        except UsageError:
            refused += 1
        else:
            assert compose(new, "").data["elements"]["stop"] == LOCK
            done += 1
    assert min(refused, done) > 0
