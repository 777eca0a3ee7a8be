"""Completion of model texts: what is offered where, by hand and by writing whole models with it."""

from __future__ import annotations

import random
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support import campaigns
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.app.text.completion import Completion, completions
from torsionnet.app.text.completion_values import units_of
from torsionnet.app.text.text_edits import TextEdit, TextLines, edited
from torsionnet.base.units import DIMENSIONS, parse_unit
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.files.library import library_models
from torsionnet.model.files.located_yaml import LocatedNode, compose

MODELS = library_models()
FEW = ("dmf_rig", "geared_branch")
HEAD = "parameters: {k: 13.3 kN*m/rad, J: 2 kg*m^2}\nelements:\n  disc: {type: inertia, node: a, inertia: J}\n"


def offered(marked: str, folder: Path | None = None) -> list[Completion]:
    """Options at the mark | of a text."""
    at = marked.index("|")
    return completions(marked.replace("|", ""), at, folder=folder)


def labels(marked: str, folder: Path | None = None) -> list[str]:
    return [one.label for one in offered(marked, folder)]


def completed(marked: str, label: str) -> str:
    option = next(one for one in offered(marked) if one.label == label)
    return edited(marked.replace("|", ""), [TextEdit(option.span, option.insert)])


def test_an_empty_file_begins_with_the_version() -> None:
    assert labels("|")[:2] == ["torsionnet 1, a new model", "torsionnet"]
    assert "elements:\n  \ninputs:" in completed("|", labels("|")[0])
    assert completed("|", "torsionnet") == "torsionnet: "
    assert completed("torsionnet: |", "1") == "torsionnet: 1"
    assert "torsionnet" not in labels("torsionnet: 1\n|")
    assert completed("torsionnet: 1\nel|", "elements") == "torsionnet: 1\nelements:\n  "


@pytest.mark.parametrize("place", ["{|", "\n    |", "{type: inertia, node: a}\n  b: {|"])
def test_an_empty_element_offers_its_types_with_what_they_need(place: str) -> None:
    found = labels(f"elements:\n  m: {place}")
    assert found[0] == "type"
    assert "inertia with node, inertia" in found
    assert "spring with nodes, stiffness" in found
    assert found[1:3] == ["inertia with node, inertia", "spring with nodes, stiffness"]


def test_the_usual_types_are_offered_before_those_that_begin_alike() -> None:
    head = "elements:\n  a: {type: inertia, node: x, inertia: 1}\n  m: "
    assert labels(f"{head}in|")[0] == "inertia with node, inertia"
    assert labels(f"{head}s|")[:2] == ["spring with nodes, stiffness", "shaft with nodes, outer_diameter, length"]
    assert labels("elements: {m: {type: |")[:3] == ["inertia", "spring", "damper"]
    assert completed(f"{head}gea|", "gear with nodes, ratio").endswith("m: {type: gear, nodes: [x, y], ratio: }")


def test_a_whole_element_is_laid_out_like_its_neighbours() -> None:
    flow = "elements:\n  a: {type: lock, node: x}\n  m: |"
    label = "inertia with node, inertia"
    assert completed(flow, label).endswith("  m: {type: inertia, node: x, inertia: }")
    block = "elements:\n  a:\n    type: lock\n    node: x\n  m: |"
    assert completed(block, label).endswith("  m: \n    type: inertia\n    node: x\n    inertia: ")
    below = "elements:\n  m:\n    |"
    assert completed(below, label).endswith("  m:\n    type: inertia\n    node: \n    inertia: ")
    within = "elements:\n  m: {|}"
    assert completed(within, label).endswith("  m: {type: inertia, node: , inertia: }")


def test_types_come_with_their_description() -> None:
    found = {one.label: one for one in offered("elements: {m: {type: |")}
    assert found.keys() >= set(ELEMENT_TYPES)
    assert found["spring"].kind == "element type"
    assert "torsion spring" in found["spring"].documentation


def test_entries_of_the_type_come_required_first_without_those_that_are_there() -> None:
    assert labels("elements: {m: {type: inertia, |")[:2] == ["node", "inertia"]
    assert "node" not in labels("elements: {m: {type: inertia, node: a, |")
    assert "stiffness" not in labels("elements: {m: {type: inertia, node: a, |")
    assert labels("elements:\n  m:\n    type: gear\n    nodes: [a, b]\n    ra|")[0] == "ratio"
    found = {one.label: one for one in offered("elements: {m: {type: inertia, |")}
    assert found["inertia"].detail == "kg*m^2, required"


def test_an_entry_before_its_colon_gets_no_second_one() -> None:
    assert (
        completed("elements: {m: {type: inertia, ine|: 3}}", "inertia") == "elements: {m: {type: inertia, inertia: 3}}"
    )


def test_the_rest_of_a_word_behind_the_cursor_is_replaced() -> None:
    text = "elements: {m: {type: spr|ung, nodes: [a, b]}}"
    assert completed(text, "spring") == "elements: {m: {type: spring, nodes: [a, b]}}"
    text = "elements:\n  m:\n    type: spring\n    stif|nes: 3"
    assert completed(text, "stiffness") == "elements:\n  m:\n    type: spring\n    stiffness: 3"
    text = "elements: {m: {type: inertia, inertia: 3 k|g*m, node: a}}"
    assert completed(text, "kg*m^2") == "elements: {m: {type: inertia, inertia: 3 kg*m^2, node: a}}"


def test_nodes_of_the_model_are_offered_and_lists_closed() -> None:
    start = HEAD + "  shaft: {type: spring, nodes: "
    assert completed(start + "|", "a") == start + "[a, "
    assert labels(start + "[|") == ["a", "ground"]
    assert completed(start + "[b, |", "a") == start + "[b, a]"
    assert completed(start + "[b, |]}", "a") == start + "[b, a]}"
    assert labels(HEAD + "  lock: {type: lock, node: |") == ["a"]
    assert "new" not in labels(HEAD + "  lock: {type: lock, node: ne|")


def test_parameters_stand_in_expressions_where_their_dimension_fits() -> None:
    start = HEAD + "  shaft: {type: spring, nodes: [a, b], stiffness: "
    assert labels(start + "|") == ["k"]
    assert labels(start + "2*|") == ["k", "J"]
    assert completed(start + "2*k|", "k") == start + "2*k"
    assert labels(HEAD.replace("J: 2 kg*m^2", "J: |")) == ["k"]


def test_units_after_a_number_fit_the_dimension() -> None:
    assert labels("elements: {m: {type: inertia, inertia: 0.078 |")[0] == "kg*m^2"
    assert labels("elements:\n  m:\n    type: spring\n    stiffness: 1e3 kN|")[0] == "kN*m/rad"
    assert labels("elements: {m: {type: spring, damping: {zeta: 0.02, at: 60 |")[0] == "Hz"
    assert labels("operating_point: {speed: {a: 1500 |")[:2] == ["rad/s", "rpm"]
    assert labels("elements: {m: {type: spring, torque_over_twist: [[0 rad, 3 |")[0] == "N*m"
    assert labels("elements: {m: {type: spring, stiffness: k_1}}\nparameters: {k_1: 3 |")[0] == "N*m/rad"
    assert completed("elements: {m: {type: inertia, inertia: 0.078 kg|", "kg*m^2").endswith("0.078 kg*m^2")


@pytest.mark.parametrize("dimension", [name for name in DIMENSIONS if name != "1"])
def test_all_units_of_a_dimension_have_it(dimension: str) -> None:
    found = units_of(dimension)
    assert found
    assert all(parse_unit(unit).dimension == DIMENSIONS[dimension] for unit in found if unit != "degC")
    assert dimension != "inertia" or not {"N*m", "Nm"} & set(found)
    assert dimension != "stiffness" or not {"N*m", "Nm"} & set(found)


def test_measures_of_damping_and_their_frequency() -> None:
    start = "elements: {m: {type: spring, damping: {"
    assert {"zeta", "eta", "psi", "c", "at"} <= set(labels(start + "|"))
    assert labels(start + "zeta: 0.02, |") == ["at"]


def test_words_and_yes_or_no() -> None:
    assert labels("elements: {c: {type: clutch, state: |") == ["closed", "open", "slipping"]
    assert labels("elements: {c: {type: clutch, enabled: |") == ["true", "false"]
    assert labels("report: {kind: |") == ["rig", "approval"]
    assert "modes" in labels("report: {sections: [mo|")


def test_sizes_of_the_catalogue_that_is_given(tmp_path: Path) -> None:
    start = "elements: {c: {type: hysteretic_spring, catalogue: "
    assert "example_couplings" in labels(start + "|")
    assert "A350" in labels(start + "example_couplings, size: |")
    (tmp_path / "own.csv").write_text("size;stiffness [kN*m/rad]\nX1;11.2\nX2;16\n", encoding="utf-8")
    assert "own.csv" in labels(start + "|", tmp_path)
    assert labels(start + "own.csv, size: |", tmp_path) == ["X1", "X2"]
    assert labels(start + "none.csv, size: |", tmp_path) == []


def test_parts_of_the_model_its_files_and_the_library(tmp_path: Path) -> None:
    file = "parts:\n  far: {ports: [left, right], parameters: {k: 9 kN*m/rad}}\n"
    (tmp_path / "more.yaml").write_text(file, encoding="utf-8")
    text = "include: [more.yaml]\nparts: {own: {ports: [p], elements: {}}}\nuse:\n  x: {part: "
    assert {"own", "far", "half_shaft"} <= set(labels(text + "|", tmp_path))
    assert labels(text + "far, at: {|", tmp_path) == ["left", "right"]
    assert labels(text + "far, parameters: {|", tmp_path) == ["k"]
    assert labels(text + "far, parameters: {k: 3 |", tmp_path)[0] == "kN*m/rad"
    assert labels(text + "own, at: {|") == ["p"]
    assert "more.yaml" in labels("include: [|", tmp_path)


def test_an_item_of_a_list_begins_with_any_of_its_entries() -> None:
    start = "report:\n  title_block:\n    revisions:\n      - "
    assert labels(start + "|")[:3] == ["revision", "date", "description"]
    assert labels(start + "x|") == []
    assert "type" in labels("bench:\n  channels:\n    - |")
    assert labels("elements:\n  m: {type: spring, damping: |") == ["zeta with at"]  # no item of a list


@pytest.mark.parametrize(
    ("last", "nodes"),
    [("a", "[a, b]"), ("n9", "[n9, n10]"), ("shaft_z", "[shaft_z, ]"), ("crank", "[crank, ]"), ("c", "[c, d]")],
)
def test_an_element_takes_the_nodes_that_come_next(last: str, nodes: str) -> None:
    head = f"elements:\n  m: {{type: inertia, node: {last}, inertia: 1}}\n  s: "
    assert completed(f"{head}spr|", "spring with nodes, stiffness").endswith(f"nodes: {nodes}, stiffness: }}")
    assert completed(f"{head}ine|", "inertia with node, inertia").endswith(f"node: {last}, inertia: }}")
    assert completed(f"{head}{{type: spring, nod|}}", "nodes").endswith("nodes: [, ]}")
    assert completed(f"{head}gearbox|", "gearbox with input, output").endswith("input: , output: }")


def test_inputs_and_sensors_are_offered_as_a_whole() -> None:
    head = "elements:\n  m: {type: inertia, node: a, inertia: 1}\n  s: {type: spring, nodes: [a, b], stiffness: 1}\n"
    assert completed(f"{head}inputs:\n  T: t|", "torque of a").endswith("T: {torque: a}")
    assert labels(f"{head}sensors:\n  T: t|")[0] == "torque of s"


def test_a_parameter_is_offered_the_units_its_letter_stands_for() -> None:
    assert labels("parameters:\n  k_1: 13.3 k|")[0] == "kN*m/rad"
    assert labels("parameters:\n  J_1: 13.3 k|")[0] == "kg*m^2"


def test_bands_have_units() -> None:
    assert labels("report: {band: 0.3..40 |")[0] == "Hz"
    assert labels("report: {band: [0.3 |")[0] == "Hz"
    assert "rpm" in labels("speeds: {of: a, range: 300..750 |")


def test_nodes_of_used_parts_have_the_name_of_the_use() -> None:
    use = "use: {left: {part: half_shaft, at: {inner: d, road: e}}}\nelements: {m: {type: lock, node: "
    found = labels(use + "|")
    assert {"d", "e", "left.hub"} <= set(found)
    assert "left.inner" not in found
    assert "left.k" in labels(use + "d}, n: {type: spring, stiffness: 2 * lef|")


def test_lines_may_end_as_on_windows() -> None:
    text = "elements:\r\n  m: {type: lock, node: |}\r\n  n: {type: lock, node: q}\r\n"
    assert labels(text) == ["q"]


def test_channels_configurations_and_the_report() -> None:
    text = HEAD + "  shaft: {type: spring, nodes: [a, b], stiffness: k}\n"
    assert labels(text + "inputs: {T: {|") == ["torque", "angle"]
    assert labels(text + "sensors: {T: {torque: |") == ["disc", "shaft"]
    assert labels(text + "sensors: {T: {angle: |") == ["a", "b"]
    assert labels(text + "sensors: {T: {torque: shaft, at: |")[:2] == ["a", "b"]
    assert labels(text + "configurations:\n  II: {|")[:2] == ["k", "J"]
    assert labels(text + "configurations:\n  II: {shaft.st|")[0] == "shaft.stiffness"
    assert labels(text + "configurations: {II: {k: 3}, III: {k: 4}}\nreport: {configurations: [|") == ["II", "III"]
    assert labels(text + "sensors: {phi: {angle: a}}\nreport: {orders: [ph|") == ["phi"]
    channels = "sensors: {phi: {angle: a}}\ninputs: {T: {torque: a}}\nreport: {transfer_functions: [phi/"
    assert labels(text + channels + "|")[0] == "T"
    assert labels("bench:\n  |")[:2] == ["channels", "acquisition"]
    assert "linear chirp" in labels("bench: {excitation: {type: |")


@pytest.mark.parametrize(
    "text", ["# el|", "name: |", "name: 'el|", "elements: {a: {type: inertia}} # ty|", "a: >\n  ty|"]
)
def test_comments_and_free_text_are_left_alone(text: str) -> None:
    assert labels(text) == []


def readme_model() -> str:
    page = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    found = re.search(r"```yaml\n(torsionnet: 1\nname: motor and load\n.*?)```", page, re.DOTALL)
    assert found
    return found[1]


def test_the_first_model_of_the_readme_is_written_with_completion() -> None:
    wanted = readme_model()
    text, at, taken = "", 0, 0
    while at < len(wanted):
        found = next((one for one in completions(text, len(text)) if leads_on(text, one, wanted, at)), None)
        if found is None:
            text, at = text + wanted[at], at + 1
            continue
        begun = len(text) - found.span.start
        text = edited(text, [TextEdit(found.span, found.insert)])
        at += len(found.insert.strip()) - begun
        while at < len(wanted) and wanted[at] == " " and text[-1] in " \n":
            at += 1
        taken += 1
    model = tn.loads(text)
    assert model.definition.to_data() == tn.loads(wanted).definition.to_data()
    assert taken >= 30


def leads_on(text: str, option: Completion, wanted: str, at: int) -> bool:
    """Whether an option is what the model has next, apart from blanks and line ends."""
    begun = text[option.span.start :]
    insert = option.insert.strip()
    word = re.match(r"[\w.*/^]*", insert)
    rest = wanted[at - len(begun) :]
    follows = rest[len(insert) : len(insert) + 1]
    is_whole = insert[-1] in ":,]" or not re.match(r"[\w.*/^]", follows)
    return bool(word) and len(insert) > len(begun) and rest.startswith(insert) and is_whole


def tried_keys(name: str, most: int | None) -> tuple[int, list[str]]:
    """Number of keys of a model at whose cut they are offered, and the others, with names of new things left out."""
    text = MODELS[name].read_text(encoding="utf-8")
    document = compose(text, "")
    assert document.root is not None
    named = {id(one) for one in named_things(document.root)}
    keys = [one for one in keys_with_nodes(document.root, TextLines(text)) if id(one[3]) not in named]
    if most is not None and len(keys) > most:
        keys = random.Random(name).sample(keys, most)
    missed = []
    for start, end, key, _ in keys:
        cut = start + (end - start + 1) // 2
        if key not in [one.label for one in completions(text[:cut], cut, folder=MODELS[name].parent)]:
            missed.append(f"{name}:{text.count(chr(10), 0, start) + 1}: {key}")
    return len(keys) - len(missed), missed


def keys_with_nodes(node: LocatedNode, lines: TextLines) -> list[tuple[int, int, str, LocatedNode]]:
    found = []
    for key, one in node.entries.items():
        if one.key_place is not None:
            line, start, _, end = one.key_place
            found.append((lines.offset(line, start), lines.offset(line, end), str(key), one))
        found += keys_with_nodes(one, lines)
    return found


FREE = ("parameters", "elements", "inputs", "sensors", "excitations", "limits", "scenarios", "use", "parts")
"""Sections whose keys are names that the author invents."""


def named_things(root: LocatedNode) -> list[LocatedNode]:
    found = [one for section in FREE if section in root.entries for one in root.entries[section].entries.values()]
    for axis in root.entries["configurations"].entries.values() if "configurations" in root.entries else ():
        found += [axis, *(one for one in axis.entries.values() if isinstance(one.value, dict | None))]
    return found + [one for one in all_nodes(root) if one.key_place and is_number(one, root)]


def all_nodes(node: LocatedNode) -> list[LocatedNode]:
    return [node, *(inner for one in node.entries.values() for inner in all_nodes(one))]


def is_number(node: LocatedNode, root: LocatedNode) -> bool:
    """Whether the key of an entry is a number, or a number with unit, as of a table over the order or the torque."""
    keys = [str(key) for one in all_nodes(root) for key, inner in one.entries.items() if inner is node]
    return bool(keys) and keys[0][:1].isdigit()


def test_keys_are_offered_where_they_stand_in_the_library() -> None:
    found = [tried_keys(name, 12) for name in MODELS]
    offered_keys, missed = sum(one for one, _ in found), [key for _, keys in found for key in keys]
    assert offered_keys > 150
    assert offered_keys >= 0.95 * (offered_keys + len(missed)), missed


@pytest.mark.slow
def test_all_keys_are_offered_where_they_stand_in_the_library() -> None:
    found = [tried_keys(name, None) for name in MODELS]
    offered_keys, missed = sum(one for one, _ in found), [key for _, keys in found for key in keys]
    assert offered_keys > 1000
    assert offered_keys >= 0.95 * (offered_keys + len(missed)), missed


def try_offset(text: str, at: int) -> None:
    for cut in (text[:at], text):
        for option in completions(cut, at):
            assert 0 <= option.span.start <= at <= option.span.end <= len(cut)
            assert option.label
            assert option.insert


@pytest.mark.parametrize("name", MODELS)
def test_no_place_raises(name: str) -> None:
    text = MODELS[name].read_text(encoding="utf-8")
    for at in random.Random(name).sample(range(len(text) + 1), 8):
        try_offset(text, at)


@pytest.mark.slow
@pytest.mark.parametrize("name", FEW)
def test_none_of_many_places_raises(name: str) -> None:
    text = MODELS[name].read_text(encoding="utf-8")
    for at in range(0, len(text) + 1, campaigns.examples(11, 1)):
        try_offset(text, at)


@pytest.mark.parametrize("seed", range(2))
def test_no_broken_text_raises(seed: int) -> None:
    dice = random.Random(seed)
    texts = [path.read_text(encoding="utf-8") for path in MODELS.values()]
    for _ in range(30):
        chars = list(dice.choice(texts)[:2500])
        for _ in range(dice.randint(1, 15)):
            chars[dice.randrange(len(chars))] = dice.choice("{}[],:'\"\n\t-#&*!|>@% \x00\u2028\ud800abc?")
        try_offset("".join(chars), dice.randrange(len(chars)))


@pytest.mark.parametrize(
    "text",
    [
        "[" * 50_000,
        "{a: " * 20_000,
        "- " * 10_000,
        "a:\n" * 5_000,
        "a: [\n" * 5_000,
        "".join(" " * depth + "a:\n" for depth in range(800)),
        "".join(" " * depth + "a: [1]\n" for depth in range(400)),
        "".join(" " * depth + "a: [\n" for depth in range(400)),
        "elements: {" + "a: {type: spring, nodes: [a, b]}, " * 3_000,
        "name: " + "1.." * 20_000,
        "x" * 100_000,
    ],
)
def test_hostile_texts_take_bounded_time(text: str) -> None:
    before = time.process_time()
    for end in (len(text), len(text) // 2):
        completions(text, end)
        completions(text[:end], end)
    assert time.process_time() - before < 10


def test_completion_keeps_pace_with_typing() -> None:
    ship = MODELS["two_stroke_ship"].read_text(encoding="utf-8")
    at = ship.index("inertia:") + 4
    assert least_seconds(ship[:at] + ship[at + 3 :], at) < 0.15
    lines = [f"  e{i}: {{type: spring, nodes: [n{i}, n{i + 1}], stiffness: {i + 1} kN*m/rad}}\n" for i in range(2000)]
    large = "".join(["elements:\n", *lines])
    at = large.index("e1000") + len("e1000: {type: spring, nod")
    assert least_seconds(large, at) < 0.6


def least_seconds(text: str, at: int) -> float:
    found = []
    for _ in range(4):
        before = time.process_time()
        completions(text, at)
        found.append(time.process_time() - before)
    return min(found)


def test_completion_of_elements_loads_no_numpy() -> None:
    code = (
        "import sys\nfrom torsionnet.app.text.completion import completions\n"
        "text = 'elements: {m: {type: sp'\nassert completions(text, len(text))\n"
        "text = 'elements: {m: {type: inertia, inertia: 3 '\nassert completions(text, len(text))\n"
        "assert completions('', 0)\nassert 'numpy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=PATIENCE)


@pytest.mark.parametrize(
    "begun",
    [
        "parameters:\n  k: {value: 3 N*m/rad}\n  |\n",
        "parameters:\n  |\n  k: {value: 3 N*m/rad}\n",
        "elements:\n  a: {type: lock, node: x}\n  |",
        "inputs:\n  T|",
        "sensors: {a|",
        "scenarios:\n  |",
        "limits:\n  |",
    ],
)
def test_the_name_of_a_new_entry_is_free(begun: str) -> None:
    """The keys of the entry are offered within it, not in place of its name."""
    assert labels(begun) == []


@pytest.mark.parametrize("damping", ["{zeta: |", "{zeta: ze|", "{zeta: 2*z|"])
def test_a_parameter_with_the_name_of_the_key_is_offered(damping: str) -> None:
    begun = f"parameters: {{zeta: 0.1}}\nelements:\n  s: {{type: spring, nodes: [a, b], damping: {damping}"
    assert labels(begun) == ["zeta"]


def test_no_parameter_is_offered_for_its_own_value() -> None:
    assert labels("parameters:\n  k_2: 1\n  k_1: k|") == ["k_2"]
    assert labels("parameters: {k_2: 1, k_1: 2}\nconfigurations: {soft: {k_1: k|") == ["k_2"]
    assert labels("parts:\n  p:\n    parameters:\n      k_2: 1\n      k_1: k|") == ["k_2"]
    assert labels("parameters: {k_2: 1, k_1: 2}\nconfigurations: {gear: {soft: {k_1: k|") == ["k_2"]


ENGINE = (
    "excitations:\n  engine: {type: reciprocating_engine}\nelements:\n  box: {type: gear}\nconfigurations:\n  one: "
)


def test_an_alternative_changes_entries_of_excitations_too() -> None:
    assert "engine.misfire" in labels(f"{ENGINE}{{engine.mis|")
    assert "engine." in labels(f"{ENGINE}{{en|")
    assert "box." in labels(f"{ENGINE}{{b|")
    assert "engine.misfire" not in labels(f"{ENGINE}{{engine.misfire: [2], engine.|")


@pytest.mark.parametrize(("row", "unit"), [
    ("|", ""), ("[|", ""), ("[2 |", "Hz"), ("[2 Hz, 3 |", "N*m/rad"), ("[2 Hz, 3 N*m/rad, 1 |", "N*m*s/rad"),
    ("[2 Hz, 3 N*m/rad, 1 N*m*s/rad, 4 |", ""), ("[2 Hz, 3 N*m/rad, 1 N*m*s/rad, 4, 5 |", ""),
])  # fmt: skip
def test_units_of_a_cell_are_those_of_its_column(row: str, unit: str) -> None:
    """Behind the last column, and where a row is to begin, there is nothing to offer."""
    found = labels(f"elements:\n  s: {{type: tabulated_spring, nodes: [a, b], table: [[1 Hz, 2 N*m/rad, 1], {row}")
    assert found[:1] == ([unit] if unit else [])


@pytest.mark.parametrize(
    "value", ["4.14", "4", "-4", ".5", "4.", "1e", "1e3", "4k", "2*3", "k_1*2", "(k_1 + 2", "3 kN*m^2", "2 .. 4"]
)
def test_nothing_is_offered_right_behind_digits(value: str) -> None:
    """Enter there ends the line; it must not hang a name on the number."""
    names = "parameters:\n  k_1: 5\n  e_3: 5\n  k_14: 6\n"
    for place in (f"  tau: {value}|", f"  k_2: {{value: {value}|", f"  tau: {value}|  # ratio\n"):
        assert labels(names + place) == []
    for entry in ("stiffness", "nodes", "damping", "ratio"):
        assert labels(f"{names}elements:\n  s: {{type: spring, {entry}: {value}|") == []
    assert "k_1" in labels(f"{names}  tau: 4.14*k|")
