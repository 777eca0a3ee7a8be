"""Model files: exact numbers, round trips, the traps of YAML, the schema, the library and atomic writing."""

import itertools
import json
import os
import re
import signal
import stat
import subprocess
import sys
import threading
from dataclasses import MISSING
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from support.library_cases import library_cases
from support.models import EVERY_ELEMENT
from support.patience import PATIENCE

from torsionnet.base import atomic
from torsionnet.base.entries.spec import Renaming
from torsionnet.base.errors import ModelError
from torsionnet.drivetrain import Drivetrain, load, loads
from torsionnet.model.channels import ELEMENT_QUANTITIES
from torsionnet.model.elements import (
    ELEMENT_TYPES,
    Damper,
    Differential,
    Gear,
    HystereticSpring,
    Inertia,
    Lock,
    Planetary,
    RigidCoupling,
    Shaft,
    Spring,
    TabulatedSpring,
)
from torsionnet.model.files.library import library_entry, library_models
from torsionnet.model.files.located_yaml import PythonParser, compose, plain_value
from torsionnet.model.files.model_schema import json_schema
from torsionnet.model.files.reader import read_file, read_text
from torsionnet.model.files.writer import dump, scalar_text

LIBRARY = Path(__file__).parents[2] / "library"
HEAD = "torsionnet: 1\nname: m\n"
DISC = "elements: {disc: {type: inertia, node: a, inertia: J}}\n"


def value_of(text):
    """The exact SI value a parameter written as ``text`` gets."""
    return loads(f"{HEAD}parameters: {{J: {text}}}\n{DISC}").exact_values["J"]


# Numbers and words


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.1", Fraction(1, 10)),
        ("1e3", Fraction(1000)),
        ("1E-3", Fraction(1, 1000)),
        (".5", Fraction(1, 2)),
        ("5.", Fraction(5)),
        ("+2", Fraction(2)),
        ("0.1234567890123456789", Fraction(1234567890123456789, 10**19)),
        ("123456789012345678901", Fraction(123456789012345678901)),
        ("0.078 kg*m^2", Fraction(78, 1000)),
        ("'0.1'", Fraction(1, 10)),
        ('"0.1"', Fraction(1, 10)),
        ("1/3", Fraction(1, 3)),
    ],
)
def test_numbers_are_exact_as_written(text, value):
    assert value_of(text) == value
    assert isinstance(value_of(text), Fraction)


@pytest.mark.parametrize(
    "word", ["no", "off", "yes", "on", "3:1", "017", "0o17", "0x1F", "1_000", "2015-01-01", "=", "n"]
)
def test_words_of_yaml_1_1_stay_text(word):
    assert plain_value(word) == word
    assert compose(f"a: {word}", "f").data == {"a": word}


@pytest.mark.parametrize(("word", "value"), [("true", True), ("False", False), ("~", None), ("", None), ("null", None)])
def test_words_of_yaml_1_2(word, value):
    assert compose(f"a: {word}", "f").data == {"a": value}
    assert compose(f"a: '{word}'", "f").data == {"a": word}


@given(st.one_of(st.integers(), st.floats(allow_nan=False, allow_infinity=False)))
def test_numbers_read_back_exactly(number):
    back = plain_value(scalar_text(number))
    assert Fraction(str(back)) == Fraction(repr(number))


TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs",)), max_size=30)
WORDS = st.sampled_from(["no", "3:1", "12", "1e3", "0x1F", "null", "~", "", " a", "a ", "- a", "a: b", "a #b", "*a", "%", "<<", "=", "y", "-", "?", "1.", "2015-01-01", "a\nb", "[", "é", "\x85", "\u2028", "\\", '"'])  # fmt: skip


@given(TEXTS | WORDS)
def test_texts_read_back_under_both_versions_of_yaml(text):
    line = f"{{{scalar_text(text)}: [{scalar_text(text)}]}}"
    for parser in (None, PythonParser):
        assert compose(line, "f", parser).data == {text: [text]}
    assert yaml.safe_load(line) == {text: [text]}


def test_keys_are_text():
    assert compose("{1: a, true: b, null: c, 2.50: d}", "f").data == {"1": "a", "true": "b", "null": "c", "2.50": "d"}


def test_anchors_share_values():
    document = compose("a: &x {b: [1, 2]}\nc: *x\n", "f")
    assert document.data == {"a": {"b": [1, 2]}, "c": {"b": [1, 2]}}
    assert (document.position(("c",)).line, document.position(("c", "b", 1)).line) == (2, 1)


def test_positions_of_values_and_keys():
    document = compose("a:\n  b: {c: [1, 22]}\n  d:\n    - x\n", "f")

    def place(*path, **options):
        position = document.position(path, **options)
        return position.line, position.column, position.end_column

    assert place("a", "b", "c", 1) == (2, 14, 16)
    assert place("a", "b", "c") == (2, 10, 17)
    assert place("a", "b", "c", on_key=True) == (2, 7, 8)
    assert place("a") == (1, 1, 2)
    assert place("a", "d") == (3, 3, 4)
    assert place("a", "d", 0) == (4, 7, 8)
    assert place("a", "b", "gone", 7) == (2, 3, 4)
    assert place("gone") == (1, 1, 3)


# Round trips


WITH_FILES = {"mass_elastic"}
"""Types that name a file, which a text alone does not have; tests/io/test_mass_elastic.py takes them through files."""


def rich_model():
    """A model with every element type and every kind of entry.

    Most types have nodes of their own, which only dampers join: those with ratios would contradict each other's speeds.
    """
    elements = [
        Inertia("motor", node="a", inertia="J", description="rotor: 3 discs, #2 is no"),
        Spring("shaft_1", nodes=("a", "b"), stiffness="2*k", damping={"zeta": "z", "at": "8 Hz"}),
        Damper("oil", nodes=("b", "ground"), damping="4 Nms/rad"),
        HystereticSpring("rubber", nodes=("b", "c"), stiffness=1e-5, loss_factor={"psi": 0.6}),
        TabulatedSpring("bush", nodes=("b", "c"), table=[[1, 400, 2], ["20 Hz", "0.5 kN*m/rad", 1.2]]),
        RigidCoupling("meter", nodes=("c", "d"), enabled=False),
        RigidCoupling("bolt", nodes=("c", "d")),
        Gear("stage", nodes=("d", "e"), teeth=(17, -61), stiffness="1 MN*m/rad", damping={"Q": 50, "at": "1 kHz"}),
        Planetary("set", sun="e", ring="ground", carrier="f", ratio="62/28", planet_inertia=Fraction(1, 3)),
        Shaft("tube", nodes=("f", "g"), outer_diameter="70 mm", inner_diameter="D/2", length=1.5, segments=3),
        Differential("axle", cage="g", left="h", right="i", locked=True),
        Inertia("wheel", node="i", inertia="0.1234567890123456789"),
        Lock("brake", node="h", enabled=False),
    ]
    there = {element.kind for element in elements}
    others = [element.renamed(Renaming(f"{kind}_", {"ground": "ground"}))
              for kind, element in EVERY_ELEMENT.items() if kind not in there | WITH_FILES]  # fmt: skip
    nodes = {node for element in others for node in element.ports.values()} - {"ground"}
    elements += others + [Damper(f"oil_{node}", nodes=("a", node), damping=1) for node in sorted(nodes)]
    return Drivetrain(
        "no",
        elements,
        parameters={
            "J": {"value": "0.1 kg*m^2", "description": "motor's, fitted: yes", "bounds": [0.05, 0.2]},
            "k": "sqrt(2)*k_0",
            "k_0": 1e22,
            "z": 0.02,
            "D": "60 mm",
        },
        inputs={"y": {"torque": "a"}, "phi": {"angle": "i"}},
        sensors={"n": {"angle": "a"}, "T": {"torque": "stage", "at": "e"}, "w": {"twist": "rubber"}},
        configurations={
            "clutch": {"open": {"off": ["bolt"], "on": ["meter"]}, "closed": {}},
            "gear": {"3:1": {"k_0": "1e21"}},
        },
        operating_point={"speed": {"a": "1500 rpm"}, "torque": {"a": -80}},
        source="a, b & c",
        description="two\nlines, é, \x07 and a tab\t.",
    )


def test_every_element_type_survives_a_round_trip(tmp_path):
    rig = rich_model()
    assert {element.kind for element in rig.definition.elements.values()} == set(ELEMENT_TYPES) - WITH_FILES
    text = dump(rig.definition, tmp_path / "rich.yaml")
    assert (tmp_path / "rich.yaml").read_text(encoding="utf-8") == text
    back = load(tmp_path / "rich.yaml")
    assert back.definition.to_data() == rig.definition.to_data()
    assert back.exact_values == rig.exact_values
    assert dump(back.definition) == text
    assert yaml.safe_load(text)["name"] == "no"


@pytest.mark.few(7)
@pytest.mark.parametrize("name", library_cases())
def test_library_models_survive_a_round_trip(name):
    rig = load(name)
    assert loads(dump(rig.definition)) == rig
    assert loads(json.dumps(rig.definition.to_data(), indent="\t"), "rig.json") == rig


NAMES = st.sampled_from(["a", "y", "no", "off", "n2", "Null", "e1", "true"])
VALUES = st.one_of(st.floats(1e-12, 1e12), st.integers(1, 10**20), st.sampled_from(["p", "2*p", "0.1", "p/3"]))


@pytest.mark.slow
@settings(deadline=None)
@given(
    st.lists(st.tuples(NAMES, VALUES, st.booleans()), min_size=1, max_size=6, unique_by=lambda disc: disc[0]),
    TEXTS | WORDS,
)
def test_small_models_survive_a_round_trip(discs, title):
    elements = [Inertia(f"d_{node}", node=node, inertia=value) for node, value, _ in discs]
    elements += [Damper(f"c_{node}", nodes=(node, "ground"), damping=value, enabled=on) for node, value, on in discs]
    elements += [Spring(f"s_{x[0]}", nodes=(x[0], y[0]), stiffness=1) for x, y in itertools.pairwise(discs)]
    rig = Drivetrain(title, elements, {"p": 2}, inputs={"off": {"torque": discs[0][0]}}, description=title)
    back = loads(dump(rig.definition))
    assert back == rig
    assert back.exact_values == rig.exact_values


# Reading files


def test_loads_by_name_and_by_path():
    assert load("dmf_rig") == load(LIBRARY / "dmf_rig.yaml") == load(str(LIBRARY / "dmf_rig.yaml"))


def test_library_name_wins_over_a_folder_of_that_name(tmp_path, monkeypatch):
    (tmp_path / "dmf_rig").mkdir()
    monkeypatch.chdir(tmp_path)
    assert load("dmf_rig").name == "DMF test rig"


def test_published_values_of_the_rigs():
    dmf, amt = load("dmf_rig"), load("amt_rig")
    assert amt.configurations == ("II", "III", "IV", "V", "V_c_O_360")
    assert amt.configured("V_c_O_360").parameters["c_O"] == 360
    assert amt.exact_values["I_F"] == dmf.exact_values["I_2"] == Fraction(152, 1000)
    assert dmf.parameters["k_1"] == 13300
    assert not dmf.check()
    assert not amt.check()


def test_warnings_and_notes_come_with_places():
    definition, faults = read_text(f"{HEAD}parameters: {{J: 1, k: 2}}\n{DISC}", "m.yaml")
    assert definition is not None
    assert [(fault.severity, fault.position.line) for fault in faults] == [("note", 1), ("warning", 3)]


def test_what_only_follows_from_an_unreadable_entry_is_not_reported():
    text = (LIBRARY / "amt_rig.yaml").read_text(encoding="utf-8")
    for old, new in {
        "stiffness: k_1, damping: c_1": "stifness: k_1, damping: c_1",
        "{value: 0.46 kN*m/rad": "{value: 0.46 kN*m/rda",
        "gearbox:      {type: gear": "gearbox:      {type: gaer",
        "gearset:   ": "rotor:     ",
        "parameters:": "paramaters:",
        "node: primary, inertia": "node: [primary], inertia",
    }.items():
        faults = read_text(text.replace(old, new), "amt.yaml")[1]
        assert [fault.severity for fault in faults] == ["error"], faults


@pytest.mark.slow
def test_reading_imports_nothing_heavy():
    program = "import sys; from torsionnet.model.files.reader import read_file; assert read_file('amt_rig')[0]; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, text=True)
    heavy = {
        "numpy",
        "scipy",
        "sympy",
        "networkx",
        "matplotlib",
        "pint",
        "pydantic",
        "json",
        "torsionnet.model.files.model_schema",
    }
    assert not heavy & set(done.stdout.split())


def test_every_entry_is_counted():
    lines = (
        f"  s{i}: {{type: spring, nodes: [n{i}, n{i + 1}], stiffness: {i + 1} kN*m/rad}}\n"
        f"  i{i}: {{type: inertia, node: n{i}, inertia: 0.{i + 1} kg*m^2}}\n"
        for i in range(1000)
    )
    assert compose("elements:\n" + "".join(lines), "f").root.size == 10002


# Schema


@cache
def validator():
    import jsonschema

    return jsonschema.Draft202012Validator(json_schema())


def is_valid(text):
    return validator().is_valid(compose(text, "f").data)


def test_schema_is_a_schema():
    import jsonschema

    jsonschema.Draft202012Validator.check_schema(json_schema())


def test_good_models_fit_the_schema():
    for path in library_models().values():
        text = path.read_text(encoding="utf-8")
        assert text.startswith("# yaml-language-server: $schema=torsionnet.schema.json\ntorsionnet: 1\n")
        validator().validate(compose(text, "f").data)
        validator().validate(load(path).definition.to_data())
    validator().validate(rich_model().definition.to_data())


@pytest.mark.parametrize(
    "text",
    [
        "name: x\nelements: {a: {type: lock, node: a}}",
        "torsionnet: 2\nelements: {a: {type: lock, node: a}}",
        "torsionnet: 1",
        "torsionnet: 1\nelements: {}",
        "torsionnet: 1\nelements: {a: {type: lok, node: a}}",
        "torsionnet: 1\nelements: {a: {node: a}}",
        "torsionnet: 1\nelements: {a-b: {type: lock, node: a}}",
        "torsionnet: 1\nelements: {a: {type: inertia, node: a, inertia: true}}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\nsensor: {}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\nsensors: {x: {angel: a}}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\nsensors: {x: {angle: a, at: a}}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\nparameters: {x: {value: 1, unit: m}}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\nconfigurations: {gear: {I: {on: a}}}",
        "torsionnet: 1\nelements: {a: {type: lock, node: a}}\noperating_point: {speeds: {a: 1}}",
    ],
)
def test_broken_models_do_not_fit_the_schema(text):
    assert not is_valid(text)
    assert read_text(text, "f")[0] is None


SAMPLES = {element.kind: element for element in rich_model().definition.elements.values()}
SAMPLES |= {kind: EVERY_ELEMENT[kind] for kind in WITH_FILES}


def element_faults(entry):
    data = {"torsionnet": 1, "elements": {"x": entry}, "parameters": {"J": 1, "k": 1, "z": 0.1, "D": 0.05}}
    faults = read_text(json.dumps(data), "f.json")[1]
    return [
        fault.message for fault in faults if fault.severity == "error" and re.search("unknown key|needs", fault.message)
    ]


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
@pytest.mark.parametrize("quantity", ELEMENT_QUANTITIES)
def test_a_file_takes_every_sensor_of_an_element_that_can_be_asked_for(kind, quantity):
    element = EVERY_ELEMENT[kind]
    nodes = [*element.ports.values(), "x"]
    discs = [Inertia(f"J_{node}", node=node, inertia=1) for node in nodes]
    drive = Spring("drive", nodes=("x", nodes[0]), stiffness=50)
    if element.expanded() != (element,):
        pytest.skip("has no laws of its own: the elements that it stands for are asked")
    if quantity == "stress" and element.diameters is None:
        with pytest.raises(ModelError, match="has no diameter"):
            Drivetrain("rig", [element, drive, *discs], sensors={"y": {quantity: "e"}})
        return
    rig = Drivetrain("rig", [element, drive, *discs], sensors={"y": {quantity: "e"}})
    read = loads(rig.to_yaml())
    asked = rig.frequency_response(f"{quantity}(e)", "x", [3.0]).values
    assert read.frequency_response("y", "x", [3.0]).values.tolist() == asked.tolist()


def test_twist_of_one_port_is_the_angle_of_its_node():
    rig = loads(
        "{torsionnet: 1, elements: {disc: {type: inertia, node: a, inertia: 2}}, sensors: {y: {twist: disc}},"
        " inputs: {T: {torque: a}}}"
    )
    omega = 2 * np.pi * 5.0
    assert rig.frequency_response("y", "T", [5.0]).values.item() == pytest.approx(-1 / (2 * omega**2))


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
def test_schema_and_reader_agree_on_keys(kind):
    entry = SAMPLES[kind].to_data()
    required = [declared.name for declared in ELEMENT_TYPES[kind].declared() if declared.default is MISSING]
    variants = {"as it is": entry, "unknown key": {**entry, "nonsense": 1}, "wrong case": {**entry, "Type": kind}}
    variants |= {f"without {key}": {name: value for name, value in entry.items() if name != key} for key in required}
    for what, variant in variants.items():
        fits = validator().is_valid({"torsionnet": 1, "elements": {"x": variant}})
        assert fits == (not element_faults(variant)) == (what == "as it is"), what


def test_every_field_is_explained_in_the_schema():
    schema = json_schema()
    for kind, cls in ELEMENT_TYPES.items():
        described = schema["$defs"][f"element_{kind}"]
        assert described["description"]
        assert set(described["properties"]) == {"type", *(declared.name for declared in cls.declared())}
        assert all(entry.get("description") for entry in described["properties"].values())


# Library and atomic writing


@pytest.mark.slow
def test_library_entries_are_what_the_files_say():
    for name, path in library_models().items():
        rig = load(name)
        assert library_entry(path) == (rig.name, rig.source)
    assert list(library_models()) == sorted(library_models())


def test_library_entry_of_quoted_and_missing_texts(tmp_path):
    path = tmp_path / "m.yaml"
    path.write_text("name: 'two words'\nparameters: {}\n", encoding="utf-8")
    assert library_entry(path) == ("two words", "")


def test_atomic_write_replaces_and_keeps_permissions(tmp_path):
    path = tmp_path / "out.csv"
    atomic.write_text(path, "é\n")
    assert path.read_bytes() == "é\n".encode()
    mask = os.umask(0)
    os.umask(mask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask
    path.chmod(0o640)
    atomic.write_bytes(path, b"new")
    assert path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_atomic_write_follows_a_link(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    atomic.write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
@pytest.mark.parametrize("through_link", [False, True])
def test_a_pipe_gets_the_bytes_and_stays_a_pipe(tmp_path, through_link):
    pipe = path = tmp_path / "p.csv"
    os.mkfifo(pipe)
    if through_link:
        path = tmp_path / "link.csv"
        path.symlink_to(pipe)
    received = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_bytes()), daemon=True)
    reader.start()
    atomic.write_text(path, "a,b\n")
    reader.join(10)
    assert received == [b"a,b\n"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@pytest.mark.skipif(os.name == "nt", reason="Windows ends programs without a signal")
def test_told_to_end_it_leaves_no_temporary_file(tmp_path):
    path = tmp_path / "out.csv"
    program = (
        "import sys, time\nfrom torsionnet.base.atomic import atomic_replacement\n"
        "with atomic_replacement(sys.argv[1]) as temporary:\n"
        "    temporary.write_text('half')\n    print('writing', flush=True)\n    time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE) as running:
        assert running.stdout.readline().strip() == b"writing"
        assert len(list(tmp_path.iterdir())) == 1
        running.send_signal(signal.SIGTERM)
        assert running.wait(PATIENCE) == 128 + signal.SIGTERM
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("step", ["write_bytes", "replace"])
def test_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, step):
    path = tmp_path / "out.yaml"
    path.write_text("old")

    def fail(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, step, fail)
    with pytest.raises(OSError, match="No space left"):
        dump(load("dmf_rig").definition, path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_read_file_gives_the_definition():
    definition, faults = read_file("dmf_rig")
    assert definition.name == "DMF test rig"
    assert faults == []
