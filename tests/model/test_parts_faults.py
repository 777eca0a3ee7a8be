"""What can be wrong with parts and their use: each fault at its line in the part, and where it is used."""

import re
from pathlib import Path

import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.model.files.reader import read_file, read_text

MODEL = """\
torsionnet: 1
name: car
parts:
  half:
    ports: [inner, road]
    parameters: {k: 9 kN*m/rad, J: 0.9 kg*m^2}
    elements:
      shaft: {type: spring, nodes: [inner, hub], stiffness: k}
      wheel: {type: inertia, node: hub, inertia: J}
      tyre: {type: spring, nodes: [hub, road], stiffness: 21 kN*m/rad}
parameters: {k_l: 8 kN*m/rad}
elements:
  cage: {type: inertia, node: cage, inertia: 1}
  car: {type: inertia, node: road, inertia: 120}
use:
  left: {part: half, at: {inner: cage, road: road}, parameters: {k: k_l}}
  right: {part: half, at: {inner: cage, road: road}}
"""


def errors(text, file="model.yaml", folder=None):
    return [fault for fault in read_text(text, file, folder)[1] if fault.severity == "error"]


def test_a_part_whose_ports_are_joined_has_its_fault_at_the_entry():
    ends = "shaft: {type: spring, nodes: [inner, road], stiffness: k}"
    text = MODEL.replace("shaft: {type: spring, nodes: [inner, hub], stiffness: k}", ends).replace(
        "right: {part: half, at: {inner: cage, road: road}}", "right: {part: half, at: {inner: cage, road: cage}}"
    )
    (fault,) = (one for one in errors(text) if one.kind == "same-node")
    assert fault.path == ("parts", "half", "elements", "shaft", "nodes", 1)
    assert "model.yaml:17:3: used here" in str(fault).splitlines()


def test_the_model_itself_is_sound():
    assert [str(fault) for fault in read_text(MODEL, "")[1] if fault.severity != "note"] == []


CASES = [  # old, new, line:column, kind
    ("right: {part: half,", "right: {part: half.yaml,", "17:17", "unknown-part"),
    ("right: {part: half,", "right: {part: halve,", "17:17", "unknown-part"),
    ("inner: cage, road: road}, parameters", "inner: cage}, parameters", "16:22", "missing-entry"),
    ("{part: half, at: {inner: cage, road: road}}", "{part: half}", "17:3", "missing-entry"),
    (
        "{inner: cage, road: road}}",
        "{inner: cage, road: road, rod: x}}",
        "17:53",
        "unknown-port",
    ),
    ("{k: k_l}", "{kk: k_l}", "16:66", "unknown-parameter"),
    ("{k: k_l}", "{k: k_m}", "16:69", "unknown-parameter"),
    ("{k: k_l}", "{k: [1, 2]}", "16:69", "wrong-form"),
    ("{k: k_l}", "{k: [1, 2]}, repeat: 3", "16:69", "wrong-count"),
    ("road: road}}", "road: [road, cage]}, repeat: 3}", "17:47", "wrong-count"),
    ("{k: k_l}", "{k: 3}, repeat: 2, chain: [inner, rod]", "16:99", "unknown-port"),
    ("{k: k_l}", "{k: 3}, chain: [inner, road]", "16:73", "missing-entry"),
    ("{k: k_l}", "{k: 3}, repeat: 0", "16:81", "out-of-range"),
    ("ports: [inner, road]", "ports: [inner, rood]", "5:20", "unknown-node"),
    (
        "  cage: {type: inertia",
        "  left: {type: inertia",
        "16:3",
        "repeated-name",
    ),
    ("right: {part", "a.b: {part", "17:3", "invalid-name"),
    ("parameters: {k_l: 8", "parameters: {left.J: 2, k_l: 8", "16:3", "repeated-name"),
]


@pytest.mark.parametrize(("old", "new", "place", "kind"), CASES)
def test_a_wrong_use_is_told_where_it_stands(old, new, place, kind):
    assert old in MODEL
    found = errors(MODEL.replace(old, new, 1))
    assert (place, kind) in [(f"{one.position.line}:{one.position.column}", one.kind) for one in found], found
    assert len(found) <= 2


def test_a_fault_inside_a_part_is_told_once_with_its_line_and_where_it_is_used():
    (fault,) = errors(MODEL.replace("stiffness: k}", "stiffness: kk}"))
    assert (fault.position.line, fault.kind, fault.meant) == (8, "unknown-parameter", "k")
    assert [position.line for position in fault.used_at] == [16]
    assert "model.yaml:16:3: used here" in str(fault)


IN_PART = """\
torsionnet: 1
name: prefix
parts:
  half:
    ports: [inner]
    parameters: {g: 1 kN*m/rad}
    elements:
      disc: {type: inertia, node: inner, inertia: 1}
      k: {type: spring, nodes: [inner, ground], stiffness: %s}
use:
  %s: {part: half, at: {inner: x}}
elements:
  J: {type: inertia, node: x, inertia: 1}
"""


@pytest.mark.parametrize("use", ["a", "data", "named", "g", "disc", "m", "left"])
@pytest.mark.parametrize(
    ("stiffness", "names", "kind"),
    [
        ("data.stiff", ' "data.stiff"$', "unknown-parameter"),
        ("2*gg", ' "gg"; .*"g"[?]$', "unknown-parameter"),
        ("-g", "^-g = -1000: ", "out-of-range"),
        ("g**2", r'^"g\*\*2" .*kg\^2\*m\^4\*s\^-4; ', "wrong-unit"),
    ],
)
def test_a_message_has_the_names_of_the_part_whatever_its_use_is_called(use, stiffness, names, kind):
    (fault,) = errors(IN_PART % (stiffness, use))
    assert re.search(names, fault.message)
    assert (fault.kind, fault.position.line, [one.line for one in fault.used_at]) == (kind, 9, [11])


def test_a_file_named_like_a_node_keeps_its_name(tmp_path):
    (tmp_path / "left.csv").write_text("size,stiffness [N*m/rad],colour\nA,1000,red\n", encoding="utf-8")
    text = IN_PART % ("1", "left")
    text = text.replace("stiffness: 1}", "catalogue: left.csv, size: A}")
    text = text.replace("inner: x", "inner: left").replace("node: x", "node: left")
    (note,) = [fault for fault in read_text(text, "m.yaml", tmp_path)[1] if "colour" in fault.message]
    assert '"colour" of left.csv' in note.message


STUB = "      stub: {type: spring, nodes: [hub, hubb], stiffness: 1}\n"


@pytest.mark.parametrize(("old", "new", "kind", "names"), [
    ("      wheel:", f"{STUB}      wheel:", "dead-end", 'stub .*"hubb"; .*"hub"[?]'),
    ("stiffness: k}", "stiffness: sqrt(-k)}", "incalculable-value", r'^sqrt\(-k\) .*"-k" .*-9000;'),
    ("stiffness: k}", "stiffness: k/J**2, referred_to: road}", "wrong-unit", r'^"k/J\*\*2" '),
    ("J: 0.9 kg*m^2}", "J: {value: 0.9, bounds: [1, 2]}}", "out-of-range", "^J = 0.9 .*1 to 2"),
    ("k: 9 kN*m/rad,", "k: 2*m, m: k,", "circular-definition", ": k -> m -> k"),
])  # fmt: skip
def test_messages_have_the_names_of_the_part(old, new, kind, names):
    found = read_text(MODEL.replace(old, new, 1).replace("{k: k_l}", "{}"), "m.yaml")[1]
    (fault,) = [fault for fault in found if fault.kind == kind]
    assert re.search(names, fault.message)
    assert fault.position.line < 13
    assert not [one for one in found if "left." in one.message or "right." in one.message]


def test_the_name_meant_in_a_part_is_that_of_the_part():
    (fault,) = errors(IN_PART % ("gg", "left"))
    assert (fault.about, fault.meant) == ("gg", "g")


def test_a_fault_of_reading_a_part_is_told_once():
    (fault,) = errors(MODEL.replace("stiffness: 21 kN*m/rad", "stiffness: 21 kg"))
    assert (fault.position.line, fault.used_at) == (10, ())


def test_a_fault_of_one_use_shows_that_use():
    (fault,) = errors(MODEL.replace("{k: k_l}", "{J: -1}"))
    assert fault.position.line == 9
    assert [position.line for position in fault.used_at] == [16]


def test_a_mass_cannot_be_put_on_ground_by_a_use():
    text = MODEL.replace("nodes: [inner, hub]", "nodes: [road, hub]").replace(
        "type: inertia, node: hub", "type: inertia, node: inner"
    )
    found = errors(text.replace("{inner: cage, road: road}}", "{inner: ground, road: road}}"))
    assert [(fault.position.line, [one.line for one in fault.used_at]) for fault in found] == [(9, [17])]
    assert "ground does not move" in found[0].message


def test_both_ends_of_an_element_on_one_node():
    text = MODEL.replace("nodes: [inner, hub]", "nodes: [inner, road]").replace(
        "inner: cage, road: road}}", "inner: road, road: road}}"
    )
    found = errors(text)
    assert (found[0].position.line, found[0].used_at[0].line) == (8, 17)
    assert "both ends" in found[0].message


@pytest.mark.parametrize(
    ("parts", "circle"),
    [
        ({"a": "a"}, "a -> a"),
        ({"a": "b", "b": "a"}, "a -> b -> a"),
        ({"a": "b", "b": "c", "c": "b"}, "b -> c -> b"),
    ],
)
def test_a_part_cannot_contain_itself(parts, circle):
    lines = [
        f"  {name}: {{ports: [p], elements: {{m: {{type: inertia, node: p, inertia: 1}}}}, use: {{u: {{part: {inner}, at: {{p: p}}}}}}}}"
        for name, inner in parts.items()
    ]
    text = "\n".join(["torsionnet: 1", "name: x", "parts:", *lines, "use: {top: {part: a, at: {p: n}}}"])
    (fault,) = errors(text)
    assert fault.kind == "circular-definition"
    assert f": {circle};" in fault.message
    assert fault.position.line == 3 + len(parts)
    assert fault.used_at[0].line == 4 + len(parts)


def files(tmp_path, **texts):
    for name, text in texts.items():
        path = tmp_path / f"{name.replace('__', '/')}.yaml"
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path / "model.yaml"


MASS = "torsionnet: 1\nports: [p]\nelements: {m: {type: inertia, node: p, inertia: 1}}\n"
TOP = "torsionnet: 1\nname: top\ninclude: [FILES]\nuse: {u: {part: mass, at: {p: n}}}\n"


def file_errors(path):
    return [fault for fault in read_file(path)[1] if fault.severity == "error"]


def test_a_model_with_ports_is_a_part_under_the_name_of_its_file(tmp_path):
    path = files(tmp_path, model=TOP.replace("FILES", "mass.yaml"), mass=MASS)
    assert list(tn.load(path).elements) == ["u.m"]


def test_a_file_of_parts_may_include_others(tmp_path):
    more = "torsionnet: 1\ninclude: [mass.yaml]\nparts: {pair: {ports: [a], use: {u: {part: mass, at: {p: a}}}}}\n"
    text = TOP.replace("FILES", "sub/more.yaml").replace("part: mass, at: {p: n}", "part: pair, at: {a: n}")
    path = files(tmp_path, model=text, sub__more=more, sub__mass=MASS)
    assert list(tn.load(path).elements) == ["u.u.m"]


@pytest.mark.parametrize(
    ("names", "texts", "place", "message"),
    [
        ("../mass.yaml", {}, "model.yaml:3:11", "out of the folder"),
        ("/etc/passwd", {}, "model.yaml:3:11", "out of the folder"),
        ("mas.yaml", {}, "model.yaml:3:11", '"mass.yaml"?'),
        ("model.yaml", {}, "model.yaml:3:11", "includes itself"),
        (
            "a.yaml",
            {"a": "torsionnet: 1\ninclude: [b.yaml]", "b": "torsionnet: 1\ninclude: [a.yaml]"},
            "b.yaml:2:11",
            "itself",
        ),
        (
            "mass.yaml, more.yaml",
            {"more": "torsionnet: 1\nparts:\n  mass: {ports: [p], elements: {}}"},
            "more.yaml:3:3",
            "two parts are named",
        ),
        ("a.yaml", {"a": "torsionnet: 1\nelements: {}"}, "model.yaml:3:11", "is a model without ports"),
        ("a.yaml", {"a": "[1, 2]"}, "model.yaml:3:11", "holds no parts"),
        ("a.yaml", {"a": "torsionnet: 1\nparts: {x: [}"}, "a.yaml:2:13", ""),
        ("a.yaml", {"a": "torsionnet: 1\nspeeds: {}\nparts: {}"}, "a.yaml:2:1", "a file of parts has"),
    ],
)
def test_a_wrong_include_is_told_where_it_stands(tmp_path, names, texts, place, message):
    path = files(tmp_path, model=TOP.replace("FILES", names), mass=MASS, **texts)
    found = [fault for fault in file_errors(path) if message in fault.message]
    assert found, file_errors(path)
    position = found[0].position
    assert f"{Path(position.file).name}:{position.line}:{position.column}" == place


def test_a_link_out_of_the_folder_is_refused(tmp_path):
    outside = files(tmp_path / "other", mass=MASS).parent / "mass.yaml"
    path = files(tmp_path / "here", model=TOP.replace("FILES", "mass.yaml"))
    (path.parent / "mass.yaml").symlink_to(outside)
    assert file_errors(path)[0].kind == "forbidden-file"


def test_a_fault_in_an_included_file_shows_both_places(tmp_path):
    path = files(tmp_path, model=TOP.replace("FILES", "mass.yaml"), mass=MASS.replace("inertia: 1}", "inertia: J}"))
    (fault,) = file_errors(path)
    assert (Path(fault.position.file).name, fault.position.line) == ("mass.yaml", 3)
    assert [(Path(one.file).name, one.line) for one in fault.used_at] == [("model.yaml", 4)]


def test_an_unused_part_is_remarked():
    text = MODEL.replace("part: half", "part: half_shaft").replace("inner: cage, road", "inner: cage, road")
    warnings = [fault for fault in read_text(text, "")[1] if fault.severity == "warning"]
    assert [fault.path for fault in warnings if fault.kind == "unused-name"] == [("parts", "half")]


def test_python_says_the_same():
    mass = tn.Drivetrain("mass", [tn.Inertia("m", node="p", inertia=1)])
    whole = tn.Drivetrain("whole", [tn.Inertia("m", node="n", inertia=1)])
    with pytest.raises(ModelError, match="has no ports"):
        whole.with_part("u", mass, at={"p": "n"})
    mass = tn.Drivetrain("mass", [tn.Inertia("m", node="p", inertia=1)], ports=["p"])
    with pytest.raises(ModelError, match=r"use\.u: .*missing-entry"):
        whole.with_part("u", mass, at={})
    with pytest.raises(ModelError, match=r"use\.u\.parameters\.k: .*unknown-parameter"):
        whole.with_part("u", mass, at={"p": "n"}, parameters={"k": 2})
    with pytest.raises(ModelError, match='"u" is used already'):
        whole.with_part("u", mass, at={"p": "n"}).with_part("u", "mass", at={"p": "n"})
    with pytest.raises(ModelError, match=r"ports\.0: .*unknown-node"):
        tn.Drivetrain("mass", [tn.Inertia("m", node="p", inertia=1)], ports=["q"])


def test_check_gives_both_places_to_programs(tmp_path, capsys):
    import json

    from torsionnet.app.cli.app import run

    path = tmp_path / "model.yaml"
    path.write_text(MODEL.replace("stiffness: k}", "stiffness: kk}"), encoding="utf-8")
    assert run(["check", "--json", str(path)]) == 1
    told = json.loads(capsys.readouterr().out)[0]["faults"]
    fault = next(one for one in told if one["severity"] == "error")
    assert (fault["position"]["line"], [one["line"] for one in fault["used_at"]]) == (8, [16])


def test_a_part_is_not_told_to_be_unused_where_its_use_cannot_be_read():
    text = MODEL.replace("right: {part: half,", "right: {part: planetary_stage, repeat: -2,").replace(
        "left: {part: half,", "left: {part: half, repeat: 0,"
    )
    assert {one.kind for one in read_text(text, "")[1]} >= {"out-of-range"}
    assert not [one for one in read_text(text, "")[1] if one.kind == "unused-name" and one.path[0] == "parts"]
