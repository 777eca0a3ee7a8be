"""Outline and explanations of model texts, also of broken ones."""

import subprocess
import sys
from itertools import pairwise

import pytest
from support import campaigns

from torsionnet.app.text.layout import hover, outline
from torsionnet.app.text.named_places import definition, named_places, references
from torsionnet.model.files.library import library_models

SHIP = library_models()["two_stroke_ship"].read_text(encoding="utf-8")
SMALL = """\
torsionnet: 1
name: small
source: measured
parameters:
  k: {value: 2 kN*m/rad, description: "the *shaft* <b>", bounds: [1 kN*m/rad, 3 kN*m/rad]}
  tau: 4
elements:
  rotor: {type: inertia, node: a, inertia: 2 kg*m^2, description: the rotor}
  disc: {type: inertia, node: a, inertia: 0.5 kg*m^2}
  shaft: {type: spring, nodes: [a, "b"], stiffness: k/tau^2}
  rubber: {type: flexible_coupling, nodes: [b, c], catalogue: example_couplings, size: A160}
  end: {type: inertia, node: c, inertia: J_missing}
sensors:
  T: {torque: shaft}
configurations: {soft: {k: 1 kN*m/rad}, hard: {}}
"""


def flat(items):
    return [one for item in items for one in (item, *flat(item.children))]


def explained(text, marker, shift=0):
    found = hover(text, text.index(marker) + shift)
    return None if found is None else found.markdown


def test_outline_of_a_model():
    found = {one.name: one for one in outline(SMALL)}
    assert list(found) == [
        "torsionnet", "name", "source", "parameters", "elements", "sensors", "configurations"
    ]  # fmt: skip
    assert [(one.name, one.kind, one.detail) for one in found["parameters"].children] == [
        ("k", "parameter", "2 kN*m/rad"),
        ("tau", "parameter", "4"),
    ]
    shaft = found["elements"].children[2]
    assert (shaft.name, shaft.kind, shaft.detail) == ("shaft", "element", "spring a, b")
    assert [(one.name, one.kind) for one in shaft.children] == [("a", "node"), ("b", "node")]
    assert SMALL[shaft.span.start : shaft.span.end] == 'shaft: {type: spring, nodes: [a, "b"], stiffness: k/tau^2}'
    assert [(one.name, one.kind) for one in found["configurations"].children] == [
        ("soft", "configuration"),
        ("hard", "configuration"),
    ]


def test_outline_of_parts_has_their_sections():
    text = "parts: {half: {ports: [x], elements: {s: {type: spring, nodes: [x, y], stiffness: 3 N*m/rad}}}}\n"
    (parts,) = outline(text)
    assert [(one.kind, one.name) for one in flat([parts])] == [
        ("section", "parts"),
        ("part", "half"),
        ("section", "ports"),
        ("section", "elements"),
        ("element", "s"),
        ("node", "x"),
        ("node", "y"),
    ]


def test_a_value_is_explained_by_its_formula_and_in_si_units():
    assert explained(SMALL, "/tau^2") == (  # 2000/4^2
        "parameter `k`: the \\*shaft\\* \\<b\\>\n\n`2 kN*m/rad` = 2000 N*m/rad\n\nbounds 1000 to 3000 in SI units\n\n"
        "used in 2 places; numbers of the model: measured"
    )
    assert explained(SMALL, "^2}\n  rubber").startswith("parameter `tau`")
    assert explained(SMALL, "2}\n  rubber") == (
        "`stiffness`: `k/tau**2` = 125 N*m/rad\n\nwith `k` = 2000 N*m/rad, `tau` = 4"
    )


def test_a_key_is_explained_by_unit_bounds_and_symbol():
    words = explained(SMALL, "stiffness: k")
    assert "stiffness in `N*m/rad`" in words
    assert "symbol `k`" in words


def test_a_node_says_what_meets_there_and_its_inertia():
    assert explained(SMALL, "[a,", 1) == (
        "node `a`\n\nhere meet inertia `rotor`, inertia `disc`, spring `shaft`\n\ninertia 2.5 kg·m^2"
    )
    assert "no inertia of its own" in explained(SMALL, '"b"', 1)
    assert "at least" not in explained(SMALL, "node: c", 6)


def test_an_element_its_type_and_its_size():
    assert explained(SMALL, "rotor: {") == (
        "element `rotor`: A rigid rotating mass at a node: torque J d2theta/dt2.\n\nthe rotor\n\n"
        "- `inertia`: `2 kg*m^2`"
    )
    assert explained(SMALL, "spring,").startswith("`spring`: ")
    assert "- `stiffness`: 5.1 kN\\*m/rad" in explained(SMALL, "A160")
    assert "has no value yet" in explained(SMALL, "end: {")
    assert explained(SMALL, "J_missing") == "parameter `J_missing`, which is not defined here; used in 1 place"


def test_where_nothing_stands_there_is_nothing_to_say():
    assert hover("", 0) is None
    assert hover("- 1", 2) is None
    assert hover("# only a comment", 5) is None


def test_definition_and_references_of_a_node():
    found = definition(SHIP, SHIP.index("angle: cyl1") + 8)
    assert SHIP[found.start : found.end] == "cyl1"
    assert found.start == SHIP.index("node: cyl1") + 6
    spans = references(SHIP, SHIP.index("angle: cyl1") + 8)
    # m1, d1, crank1, T_1, phi_1, the first cylinder of the engine
    assert len(spans) == 6
    assert definition(SHIP, SHIP.index("sensors:")) is None
    assert references(SHIP, SHIP.index("sensors:")) == []


def words(text):
    return " ".join(text.split())


def is_in_place(text):
    """Whether all stretches lie within a broken text, and hold the names they are of."""
    for one in named_places(text):
        assert text[one.span.start : one.span.end] == one.name
    items = outline(text)
    for one in flat(items):
        assert 0 <= one.span.start <= one.name_span.start <= one.name_span.end <= one.span.end <= len(text)
        assert words(one.name) in words(text[one.span.start : one.span.end])  # a broken key may fill several lines
    for first, second in pairwise(items):
        assert first.span.end <= second.span.start
    for offset in {0, len(text) // 2, len(text)}:
        found = hover(text, offset)
        assert found is None or 0 <= found.span.start <= found.span.end <= len(text)


def test_texts_cut_at_every_character():
    for length in range(len(SMALL)):
        is_in_place(SMALL[:length])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", campaigns.by_day(sorted(library_models()), "amt_rig", "drill_string", "marine_medium_speed")
)
def test_library_texts_cut_in_many_places(name):
    text = library_models()[name].read_text(encoding="utf-8")
    for length in range(0, len(text), campaigns.examples(211, 23)):
        is_in_place(text[:length])
        is_in_place(text[:length] + text[length + 7 :])


def test_every_offset_of_a_text_can_be_asked():
    for offset in range(len(SMALL) + 1):
        found = hover(SMALL, offset)
        assert found is None or found.span.start <= offset <= found.span.end
        definition(SMALL, offset)


def test_a_byte_order_mark_moves_all_places():
    marked = "\ufeff" + SMALL
    assert [one.span.start - 1 for one in named_places(marked)] == [one.span.start for one in named_places(SMALL)]


def test_no_numpy_for_a_model_without_excitations():
    code = (
        "import sys; from torsionnet.app.text.layout import hover; from torsionnet.app.text.named_places import rename\n"
        f"text = {SMALL!r}\n"
        "hover(text, text.index('[a,') + 1); rename(text, text.index('[a,') + 1, 'z'); print('numpy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
