"""Faults of texts: those of the check with their stretches, errors beside a break of the YAML, fixes that mend."""

import random
import re
from pathlib import Path

import pytest
from support import campaigns
from support.broken_models import BASE, CASES

from torsionnet.app.cli.options import checked_model
from torsionnet.app.text.text_edits import edited
from torsionnet.app.text.text_faults import text_faults
from torsionnet.base.errors import ModelError
from torsionnet.model.files.library import library_models
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.reader import read_text

LIBRARY = {name: path.read_text(encoding="utf-8") for name, path in sorted(library_models().items())}
QUICK = [name for name in LIBRARY if name not in ("front_wheel_drive_car", "marine_medium_speed")]


def is_sound_yaml(text):
    try:
        compose(text.removeprefix("\ufeff"), "")
    except ModelError:
        return False
    return True


def errors(text, **where):
    return [one for one in text_faults(text, "model.yaml", **where) if one.fault.severity == "error"]


def messages(text, **where):
    return [one.fault.message for one in errors(text, **where)]


def marked(text):
    """The stretches of the errors."""
    return [text[one.span.start : one.span.end] for one in errors(text)]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_faults_are_those_of_the_check_at_their_places(case):
    found, checked = text_faults(case.text, "model.yaml"), read_text(case.text, "model.yaml")[1]
    if is_sound_yaml(case.text):
        assert [one.fault for one in found] == checked
    else:
        assert checked == [one.fault for one in found if one.fault in checked]
    lines = case.text.split("\n")
    for one in found:
        start = sum(len(line) + 1 for line in lines[: one.fault.position.line - 1]) + one.fault.position.column - 1
        assert one.span.start == start
        assert one.span.end <= len(case.text)


@pytest.mark.few(4)
@pytest.mark.parametrize("name", LIBRARY)
def test_faults_of_a_file_are_those_of_the_command_also_of_unstable_modes(name):
    path = library_models()[name]
    assert [one.fault for one in text_faults(LIBRARY[name], str(path), path.parent)] == checked_model(name)


def test_a_mode_that_grows_is_told():
    push = "  push: {type: controller, sense: {velocity: motor}, act: motor, law: 2}\ninputs:"
    told = [one.fault.message for one in text_faults(BASE.replace("inputs:", push)) if one.fault.severity == "warning"]
    assert any("push makes the" in one and "unstable" in one for one in told)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r", "\x85"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_stretches_fit_texts_with_marks_and_all_breaks(mark, newline):
    text = mark + BASE.replace("name:", "nam:").replace("angle: motor", "angle: motr").replace("\n", newline)
    assert marked(text) == ["nam", "motr"]
    first = mark + "torsionnt: 1" + BASE[len("torsionnet: 1") :].replace("\n", newline)
    assert "torsionnt" in marked(first)


def test_a_fault_of_an_included_file_stands_where_the_text_uses_it(tmp_path):
    part = "torsionnet: 1\nports: [a]\nelements:\n  disc: {type: inertia, node: a, inertia: 1 kg}\n"
    (tmp_path / "disc.yaml").write_text(part)
    text = BASE + "include: [disc.yaml]\nuse:\n  extra: {part: disc, at: {a: motor}}\n"
    (one,) = errors(text, folder=tmp_path)
    assert one.fault.message.startswith("in disc.yaml, line 4: ")
    assert text[one.span.start : one.span.end] in ("extra", "disc.yaml")
    assert one.fault.position.file == "model.yaml"
    assert one.fixes == ()
    (tmp_path / "disc.yaml").write_text(part.replace("[a]", "[a"))
    (one,) = [one for one in errors(text, folder=tmp_path) if "disc.yaml, line" in one.fault.message]
    assert text[one.span.start : one.span.end] == "disc.yaml"


BESIDE = {  # a break, and an error elsewhere that is told all the same
    "bracket": (("inertia: 2}", "inertia: 2"), ("0.1 kg*m^2", "0.1 kg*m"), '"0.1 kg*m" is not a value of inertia'),
    "list": (("[motor, wheel]", "[motor, wheel"), ("torque: motor", "torqe: motor"), 'unknown key "torqe"'),
    "quote": (("name: chain", 'name: "chain'), ("stiffness: k", "stiffness: kk"), 'no parameter is named "kk"'),
    "name of a node": (("inertia: 2}", "inertia: 2"), ("angle: motor", "angle: motr"), 'no node is named "motr"'),
    "missing entry": (("angle: motor}", "angle: motor"), (", inertia: 0.1 kg*m^2", ""), "inertia rotor needs inertia"),
}


@pytest.mark.parametrize(("broken", "wrong", "message"), BESIDE.values(), ids=BESIDE)
def test_errors_beside_a_break_are_told(broken, wrong, message):
    text = BASE.replace(*broken)
    assert not is_sound_yaml(text)
    assert len(errors(text)) == 1
    found = messages(text.replace(*wrong))
    assert len(found) == 2
    assert any(one.startswith(message) for one in found)


@pytest.mark.parametrize("between", ["", "\n", "  # of the shaft\n\n"])
def test_entries_next_to_a_break_may_follow_from_it(between):
    """Lines without text between them and the break are passed over, above as below."""
    wrong = "{type: inertai, node: b, inertia: 1 kg*m^2}"
    lines = [f"  a: {wrong}\n", f"  b: {wrong}\n", "  s: {type: spring, nodes: [a, b], stiffness: 1]\n", f"  c: {wrong}\n",
             f"  d: {wrong}\n"]  # fmt: skip
    found = messages(f"torsionnet: 1\nname: rig\nelements:\n{between.join(lines)}")
    assert sum(one.startswith('no element type is named "inertai"') for one in found) == 2


def test_what_follows_from_a_break_is_not_told():
    for case in CASES:
        if not is_sound_yaml(case.text) and len(case.text) < 1000:
            assert len(errors(case.text)) == 1, case.name


def test_a_sound_model_with_one_character_wrong_has_one_break_and_hardly_anything_that_follows():
    draw = random.Random(34)
    told, more = 0, []
    for _ in range(campaigns.examples(25, 1500)):
        name = draw.choice(QUICK)
        text = LIBRARY[name]
        place = draw.choice([place for place, char in enumerate(text) if char in "{}[]\",:'\n"])
        new = text[:place] + draw.choice(["", "{", "[", "\t", '"', "  " + text[place]]) + text[place + 1 :]
        if is_sound_yaml(new):
            continue
        told += 1
        if len(messages(new, folder=library_models()[name].parent)) != 1:
            more.append((name, place, new[place - 30 : place + 9]))
    assert told > 5
    assert len(more) <= told // 50, more  # a quote that is never closed may show far below its entry


def test_a_section_without_its_colon_is_the_only_fault():
    text = LIBRARY["dmf_rig"].replace("report:", "report{")
    (one,) = errors(text, folder=library_models()["dmf_rig"].parent)
    assert one.fault.kind == "missing-colon"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_fix_ends_its_fault_and_brings_no_other(case):
    found = text_faults(case.text, "model.yaml")
    for one in found:
        for fix in one.fixes:
            after = messages(edited(case.text, fix.edits))
            assert one.fault.message not in after, fix.title
            assert set(after) <= {other.fault.message for other in found}, fix.title


def test_a_comma_that_may_part_thousands_has_two_fixes():
    text = BASE.replace("1 kN*m/rad", "13,300 N*m/rad")
    (one,) = (one for one in text_faults(text, "model.yaml") if one.fault.kind == "ambiguous-number")
    assert [edited(text, fix.edits) for fix in one.fixes] == [
        text.replace(",300", number) for number in (".300", "300")
    ]


@pytest.mark.parametrize(("old", "name"), [("inertia: 2}", "inertia"), ("nodes: [motor, wheel], ", "nodes")])
def test_an_entry_without_value_is_named(old, name):
    text = BASE.replace(old, f"{name}:}}" if old.endswith("}") else f"{name}:, ")
    (one,) = text_faults(text, "model.yaml")
    assert (one.fault.kind, text[one.span.start]) == ("missing-value", ":")
    assert one.fault.message.startswith(f'"{name}" has no value')
    (fix,) = one.fixes
    (left,) = text_faults(edited(text, fix.edits), "model.yaml")
    assert left.fixes[0].title.startswith("write ")


MENDED = {  # what is wrong in BASE, the title of the first fix; the fix gives BASE back or what stands last
    "key": ("stiffness: k", "stiffnes: k", 'write "stiffness"', ""),
    "node": ("angle: motor", "angle: motr", 'write "motor"', ""),
    "element": ("torque: shaft", "torque: shft", 'write "shaft"', ""),
    "type": ("type: spring", "type: sprng", 'write "spring"', ""),
    "parameter in an expression": ("stiffness: k", "stiffness: 2*kk", 'write "k"', "stiffness: 2*k"),
    "unit misspelt": ("kN*m/rad", "kN*m/rd", 'write "rad"', ""),
    "wrong unit": ("0.1 kg*m^2", "0.1 kg*m", "write 0.1 kg*m^2", ""),
    "wrong unit in quotes": ("0.1 kg*m^2", "'0.1 kg*m'", "write '0.1 kg*m^2'", "'0.1 kg*m^2'"),
    "decimal comma in brackets": ("inertia: 2}", "inertia: 0,152 kg*m^2}", "write a decimal point", "0.152 kg*m^2}"),
    "decimal comma": ("1 kN*m/rad", "13,3 kN*m/rad", "write a decimal point", "13.3 kN*m/rad"),
    "comma that may be either": ("1 kN*m/rad", "13,300 N*m/rad", "write a decimal point", "13.300 N*m/rad"),
    "comma in brackets that may be either": ("inertia: 2}", "inertia: 1,520 kg*m^2}", "write a decimal point", "1.520 kg*m^2}"),
    "missing key": (", inertia: 0.1 kg*m^2", "", "insert inertia: 1 kg*m^2", ", inertia: 1 kg*m^2}"),
    "missing nodes": ("nodes: [motor, wheel], ", "", "insert nodes: [motor, wheel]", "stiffness: k, nodes: [motor, wheel]}"),
    "tab": ("  rotor:", "\trotor:", "indent with spaces", ""),
    "indentation": ("  shaft:", "   shaft:", "indent as the lines around", ""),
    "bracket": ("inertia: 2}", "inertia: 2", "close with }", ""),
    "list": ("[motor, wheel]", "[motor, wheel", "close with ]", ""),
    "opening bracket": ("shaft:   {", "shaft:   ", "insert {", ""),
    "quote": ("name: chain", 'name: "chain', 'close with "', 'name: "chain"'),
    "colon": ("vehicle: {", "vehicle {", 'write "vehicle: "', ""),
    "blank": ("vehicle: {", "vehicle:{", 'write "vehicle: "', ""),
    "text with a colon": ("name: chain", "name: chain: long", "put the text in quotes", 'name: "chain: long"'),
    "duplicate": ("vehicle:", "rotor:  ", "rename to rotor_2", "rotor_2:  "),
    "duplicate key": ("stiffness: k}", "stiffness: k, stiffness: 3}", 'delete this "stiffness"', ""),
    "version": ("torsionnet: 1\n", "", "insert torsionnet: 1", ""),
    "version without a value": ("torsionnet: 1\n", "torsionnet:\n", "write torsionnet: 1", ""),
    "blank among brackets": ("inputs:  {T_M: {torque: motor}}", "inputs:\n  T_M:{torque: motor}", 'write "T_M: "', "\n  T_M: {torque: motor}"),
    "truth": ("inertia: 2}", "inertia: 2, enabled: no}", "write false", "inertia: 2, enabled: false}"),
    "number as a name": ("name: chain", "name: 3", "put it in quotes", 'name: "3"'),
    "thousands": ("inertia: 2}", "inertia: 13 300 kg*m^2}", "write 13300", "inertia: 13300 kg*m^2}"),
    "cycles as speed": ("inputs:", "operating_point: {speed: {motor: 50 Hz}}\ninputs:", "write 3000 rpm", "motor: 3000 rpm}"),
    "product": ("stiffness: k", "stiffness: 2 k", "write 2*k", "stiffness: 2*k"),
    "misspelt key alone": ("inertia: 2}", "inert}", "write inertia: 1 kg*m^2", "inertia: 1 kg*m^2}"),
    "key alone": ("inertia: 2}", "inertia}", "write 1 kg*m^2", "inertia: 1 kg*m^2}"),
    "unused": ("  k: 1", "  c: 3\n  k: 1", 'delete "c"', ""),
    "misspelt definition": ("torque: motor", "torque: motr", 'write "motor"', ""),
    "line break": ("chain\nparameters:", "chain parameters:", "begin parameters on a line of its own", ""),
    "no colon": ("  k: 1", "  k 1", 'write "k: "', ""),
    "equals sign": ("  k: 1", "  k = 1", 'write "k: "', ""),
    "equals sign in brackets": ("stiffness: k", "stiffness = k", 'write "stiffness: "', ""),
    "no colon after type": ("type: spring", "type spring", 'write "type: "', ""),
    "no colon before brackets": ("T_M: {", "T_M {", "write a colon before the bracket", ""),
    "no brackets": ("[motor, wheel]", "motor, wheel", "write [motor, wheel]", ""),
    "parentheses": ("[motor, wheel]", "(motor, wheel)", "write [motor, wheel]", ""),
    "no blank behind a colon": ("stiffness: k", "stiffness:k", 'write "stiffness: "', ""),
    "no colon in brackets": ("stiffness: k", "stiffness k", 'write "stiffness: "', ""),
    "unit begun with a prefix": ("stiffness: k", "stiffness: 3 MN", "write 3 MN*m/rad", "stiffness: 3 MN*m/rad"),
    "two words": ("[motor, wheel]", "motor wheel", "write [motor, wheel]", ""),
    "hyphen": ("[motor, wheel]", "motor-wheel", "write [motor, wheel]", ""),
    "damper of one node": (
        "inputs:",
        "  drag: {type: damper, node: wheel, damping: 1}\ninputs:",
        "write nodes: [wheel, ground]",
        "  drag: {type: damper, nodes: [wheel, ground], damping: 1}",
    ),
    "word of a drawing": ("type: inertia, node: wheel", "type: cylinder, node: wheel", 'write "inertia"', ""),
    "semicolon": ("[motor, wheel]", "[motor; wheel]", "write [motor, wheel]", ""),
    "one node in brackets": ("node: wheel", "node: [wheel]", "write wheel", ""),
    "no indentation": (
        "  vehicle: {type: inertia, node: wheel, inertia: 2}",
        "  vehicle:\n  type: inertia\n  node: wheel\n  inertia: 2",
        'indent the entries of "vehicle"',
        "  vehicle:\n    type: inertia\n    node: wheel\n    inertia: 2",
    ),
    "character": ("chain", "ch\x01ain", "delete this character", ""),
}  # fmt: skip


@pytest.mark.parametrize(("right", "wrong", "title", "mended"), MENDED.values(), ids=MENDED)
def test_the_first_fix_is_what_was_meant(right, wrong, title, mended):
    text = BASE.replace(right, wrong, 1)
    assert text != BASE
    fixes = [fix for one in text_faults(text, "model.yaml") if one.fault.severity != "note" for fix in one.fixes]
    assert fixes[0].title == title
    new = edited(text, fixes[0].edits)
    assert mended in new if mended else new == BASE
    assert messages(new) == []


def test_the_message_of_a_key_run_together_with_its_value_names_what_is_missing():
    assert re.match('a blank .*"stiffness:"', *messages(BASE.replace("stiffness: k", "stiffness:k")))
    assert re.match('a colon .*"stiffness"', *messages(BASE.replace("stiffness: k", "stiffness k")))
    in_text = BASE.replace("stiffness: k", "stiffness: k, description: steel, length 3 m")
    assert "needs quotes" in messages(in_text)[0]


def test_the_number_of_a_share_is_not_made_one_of_damping():
    (fault,) = errors(BASE.replace("stiffness: k", "stiffness: k, damping: 1%"))
    assert "{zeta: 1%, at:" in fault.fault.message
    assert fault.fixes == ()


def test_a_shaft_that_is_given_by_its_stiffness_becomes_a_spring():
    text = BASE.replace("type: spring", "type: shaft")
    (fault,) = [one for one in errors(text) if one.fault.kind == "unknown-entry"]
    (fix,) = [fix for fix in fault.fixes if fix.title == "write type: spring"]
    assert edited(text, fix.edits) == BASE


def test_a_node_named_once_is_the_misspelt_one():
    text = BASE.replace("node: motor", "node: moto", 1)
    (fix,) = [fix for one in text_faults(text) for fix in one.fixes if fix.title == 'write "motor"']
    assert edited(text, fix.edits) == BASE


def test_a_number_without_unit_gets_the_likely_one():
    shaft = "type: shaft, nodes: [motor, wheel], outer_diameter: 480, length: 1 m"
    text = BASE.replace("type: spring, nodes: [motor, wheel], stiffness: k", shaft)
    titles = [fix.title for one in text_faults(text) for fix in one.fixes]
    assert "write 480 mm" in titles


def test_fixes_of_a_json_file_are_json():
    text = '{"torsionnet": 1, "elements": {"d": {"type": "inertia", "node": "a", "inertia": "2 kg"}, "s": {"type": "lock"}}}'
    for one in text_faults(text, "model.json"):
        if one.fault.severity == "error":
            text = edited(text, one.fixes[0].edits)
            break
    assert '"inertia": "2 kg*m^2"' in text
    fixes = [fix for one in text_faults(text, "model.json") for fix in one.fixes]
    assert '{"type": "lock", "node": "a"}' in edited(text, fixes[0].edits)


def test_parameters_are_not_deleted_while_their_use_may_be_unreadable():
    text = BASE.replace("stiffness: k", "stiffness: (k")
    assert [fix for one in text_faults(text) for fix in one.fixes if "delete" in fix.title] == []


def test_a_study_or_a_list_has_faults_without_fixes():
    assert errors("vary: {k: [1, 2]}\nmodel: x\n")[0].fixes == ()
    assert errors("- a\n- b\n")[0].fixes == ()
    assert errors("")[0].span.start == 0


@pytest.mark.parametrize("name", ["two_stroke_ship", "wind_turbine_3mw"])
@pytest.mark.parametrize("step", [97, pytest.param(5, marks=pytest.mark.nightly)])
def test_a_text_cut_anywhere_has_faults_within_it(name, step):
    text, folder = LIBRARY[name], library_models()[name].parent
    for end in range(step - 1, len(text), step):
        for one in text_faults(text[:end], "model.yaml", folder):
            assert 0 <= one.span.start <= one.span.end <= end
            assert one.fault.message
            for fix in one.fixes:
                assert edited(text[:end], fix.edits) != text[:end]


@pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.nightly)])
def test_fixes_of_a_text_that_is_being_written_bring_no_second_break(step):
    for end in range(step, len(BASE), step):
        text = BASE[:end]
        for one in errors(text):
            for fix in one.fixes:
                if not is_sound_yaml(text):
                    assert is_sound_yaml(edited(text, fix.edits)), (text[-40:], fix.title)


@pytest.mark.slow
def test_fixes_of_misspelt_library_models_bring_no_errors():
    draw = random.Random(5)
    offered = stayed = 0
    texts = campaigns.examples(120, 300)
    for _ in range(texts):
        name = draw.choice(QUICK)
        text, folder = LIBRARY[name], Path(library_models()[name]).parent
        word = draw.choice(list(re.finditer(r"[A-Za-z_]{4,}", text)))
        at = word.start() + draw.randrange(len(word[0]))
        text = text[:at] + text[at + 1 :]
        found = errors(text, folder=folder)
        for one in found:
            for fix in one.fixes:
                after = messages(edited(text, fix.edits), folder=folder)
                offered += 1
                # A name that is used several times is mended one by one.
                before = [each.fault.message for each in found].count(one.fault.message)
                stayed += after.count(one.fault.message) >= before or len(after) > len(found)
    assert offered > texts / 3
    # Measured: 3 % put in the nearest name that has another dimension, or a node that is locked.
    assert stayed <= 0.05 * offered


def test_fixes_of_many_faults_in_a_long_text_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each fix is tried on the whole text; with one for each of 1000 faults that takes minutes."""
    monkeypatch.setattr("torsionnet.app.text.text_faults._MOST_REREAD", 0)
    spring = "  s{}: {{type: spring, nodes: [a, b], stifness: 3 N*m/rad}}\n"
    text = "torsionnet: 1\nelements:\n" + "".join(map(spring.format, range(25)))
    mended = [bool(one.fixes) for one in text_faults(text) if "stifness" in one.fault.message]
    assert mended == [True] * 20 + [False] * 5


def test_a_fix_is_tried_on_its_entry_alone_and_edits_elsewhere_on_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """So all 200 faults of a text get fixes, and what a fix does to other entries still counts."""
    read: list[int] = []

    def noted(text: str, file: str) -> LocatedDocument:
        read.append(len(text))
        return compose(text, file)

    monkeypatch.setattr("torsionnet.app.text.fixes.value_fixes.compose", noted)
    wrong = "".join(f"  s{k}: {{type: spring, nodes: [a, b], stifness: 3 N*m/rad}}\n" for k in range(200))
    found = text_faults(f"torsionnet: 1\nelements:\n{wrong}")
    assert sum(bool(one.fixes) for one in found if "stifness" in one.fault.message) == 200
    assert sum(read) < 3 * len(wrong)
    twice = text_faults(BASE.replace("vehicle:", "rotor:  "), "model.yaml")
    assert max(read) > len(BASE) - 20
    assert any(one.fixes for one in twice)
