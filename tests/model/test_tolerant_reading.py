"""Model texts that are no sound YAML: what a person reads in them is read, and nothing is raised."""

from __future__ import annotations

import random
import re
import time
from pathlib import Path
from typing import Any

import pytest
from support import campaigns

from torsionnet.app.text import tolerant_reading
from torsionnet.app.text.tolerant_reading import tolerant_data, tolerant_document
from torsionnet.model.files.library import library_models, library_parts
from torsionnet.model.files.located_yaml import MOST_NODES, LocatedDocument, LocatedNode, compose

MODELS = library_models()
FEW = ("dmf_rig", "two_stroke_ship")


def text_of(name: str) -> str:
    return MODELS[name].read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("elements:\n  motor: {type: inertia, no", {"elements": {"motor": {"type": "inertia", "no": None}}}),
        ("a: {x: [1, 2\nb: 3", {"a": {"x": [1, 2]}, "b": 3}),
        ("a: {x: [1, 2, y: 3}\nb: 3", {"a": {"x": [1, 2], "y": 3}, "b": 3}),
        ("a: {x: 1 y: 2}\n", {"a": {"x": 1, "y": 2}}),
        ("a: {x: [1] y: {z: 2} w: 3}}\n", {"a": {"x": [1], "y": {"z": 2}, "w": 3}}),
        ("a:\n  x: 1\n  stiff", {"a": {"x": 1, "stiff": None}}),
        ("a:\n  x: 1\n  stiff\nb: 2", {"a": {"x": 1, "stiff": None}, "b": 2}),
        ("a:\n  x: 1\n  stiffness:\nb: [2", {"a": {"x": 1, "stiffness": None}, "b": [2]}),
        ("a:\n  x: {z: 1}\n    y: {z: 2\n  w: 3", {"a": {"x": {"z": 1}, "y": {"z": 2}, "w": 3}}),
        ("a:\n    x: {z: 1}\n  y: {z: 2}", {"a": {"x": {"z": 1}, "y": {"z": 2}}}),
        ("a:\n\tx: 1\n\ty: 2", {"a": {"x": 1, "y": 2}}),
        ("name: 'motor\nb: 2", {"name": "motor", "b": 2}),
        ('a: {name: "motor, x: 1}\nb: 2', {"a": {"name": "motor", "x": 1}, "b": 2}),
        ("name: motor: load\nb: 2", {"name": "motor: load", "b": 2}),
        ("a: @x\nb: *x\nc: !!int 3", {"a": "@x", "b": "*x", "c": "!!int 3"}),
        ("a:\n- x: 1\n  y\n- {z: 2", {"a": [{"x": 1, "y": None}, {"z": 2}]}),
        ("motor {type: lock, node: a}\nb: 2", {"motor": {"type": "lock", "node": "a"}, "b": 2}),
        ("a\x00: 1\nb: {c: \x1b2", {"a": 1, "b": {"c": 2}}),
        ("---\na: 1\n---\nb: 2", {"a": 1, "b": 2}),
        ("a: {x: 1, # a comment }\nb: 2", {"a": {"x": 1}, "b": 2}),
        ("a: {x: 1}\na: {x: 2\n", {"a": {"x": 1}}),
        ("a: |\n  text: {\nb: [1", {"a": "text: {\n", "b": [1]}),
        ("", None),
        ("}", None),
    ],
)
def test_what_a_person_reads_is_read(text: str, data: object) -> None:
    assert tolerant_document(text).data == data


@pytest.mark.parametrize("name", [*MODELS, *library_parts()])
def test_sound_text_is_read_as_ever(name: str) -> None:
    path = {**MODELS, **library_parts()}[name]
    text = path.read_text(encoding="utf-8")
    assert tolerant_document(text, "x.yaml") == compose(text, "x.yaml")
    assert tolerant_data(text) == compose(text, "").data


def leaves(node: LocatedNode) -> list[tuple[Any, ...]]:
    if not node.entries:
        # A text of several lines ends where the next entry begins, which stands elsewhere here.
        place = node.place if node.place[0] == node.place[2] else node.place[:2]
        return [(node.value, place, node.key_place)]
    return [(node.key_place,), *(leaf for one in node.entries.values() for leaf in leaves(one))]


@pytest.mark.parametrize("longest", [0, 30])
@pytest.mark.parametrize("name", MODELS)
def test_reading_by_indentation_finds_the_places_of_yaml(
    name: str, longest: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tolerant_reading, "_LONGEST_WHOLE", longest)
    text = re.sub(r"^(description|source):.*(\n  .*)*", r"\1: text", text_of(name), flags=re.MULTILINE)
    broken = tolerant_document(text + "\nlast: {a: 1")
    sound = compose(text, "")
    assert broken.faults
    assert broken.root is not None
    assert sound.root is not None
    assert {key: broken.data[key] for key in sound.data} == sound.data
    ends = [leaf for one in sound.root.entries.values() for leaf in leaves(one)]
    found = [leaf for key in sound.root.entries for leaf in leaves(broken.root.entries[key])]
    assert found == ends


def whole_elements(text: str, end: int) -> list[str]:
    """Names of the elements of a model that end before the line of an offset."""
    document = compose(text, "")
    assert document.root is not None
    line = text.count("\n", 0, end)
    return [str(name) for name, one in document.root.entries["elements"].entries.items() if last_line(one) < line]


def last_line(node: LocatedNode) -> int:
    inner = [last_line(one) for one in node.entries.values()]
    return max(inner) if inner else node.place[2]


def try_cut(text: str, end: int) -> None:
    document = tolerant_document(text[:end])
    wanted = whole_elements(text, end)
    elements = document.data.get("elements") if isinstance(document.data, dict) else None
    whole = compose(text, "").data["elements"]
    assert {name: whole[name] for name in wanted} == {name: (elements or {}).get(name) for name in wanted}


@pytest.mark.parametrize("name", MODELS)
def test_elements_before_a_cut_are_read(name: str) -> None:
    text = text_of(name)
    for end in random.Random(name).sample(range(len(text)), 12):
        try_cut(text, end)


@pytest.mark.slow
@pytest.mark.parametrize("name", FEW)
def test_elements_before_a_cut_are_read_in_many_places(name: str) -> None:
    text = text_of(name)
    whole = compose(text, "").data["elements"]
    ends = {line: whole_elements(text, text.find("\n", 0) if line == 0 else offset) for line, offset in starts(text)}
    for end in range(0, len(text), campaigns.examples(11, 1)):
        document = tolerant_document(text[:end])
        wanted = ends[text.count("\n", 0, end)]
        found = document.data.get("elements") if isinstance(document.data, dict) else None
        assert {one: whole[one] for one in wanted} == {one: (found or {}).get(one) for one in wanted}, end


def starts(text: str) -> list[tuple[int, int]]:
    return [(0, 0), *((number, one.end()) for number, one in enumerate(re.finditer("\n", text), 1))]


@pytest.mark.parametrize("seed", range(3))
def test_no_text_raises(seed: int) -> None:
    dice = random.Random(seed)
    texts = [text_of(name) for name in MODELS]
    for _ in range(40):
        chars = list(dice.choice(texts)[:3000])
        for _ in range(dice.randint(1, 20)):
            chars[dice.randrange(len(chars))] = dice.choice("{}[],:'\"\n\t-#&*!|>@% \x00\u2028\ud800abc?")
        text = "".join(chars)
        assert isinstance(tolerant_document(text), LocatedDocument)
        tolerant_data(text)


@pytest.mark.parametrize(
    "text",
    [
        "[" * 20_000,
        "{a: " * 10_000,
        "- " * 10_000,
        "a:\n" * 10_000,
        "".join(" " * depth + "a:\n" for depth in range(1500)),
        "".join(" " * depth + "a: [1]\n" for depth in range(400)),
        "".join(" " * depth + "a: [\n" for depth in range(400)),
        "'" * 50_000,
        "a: [\n" * 5_000,
        "a: *b\n" * 1_000,
        "&a [*a]",
        "a: [" + "1, " * (MOST_NODES // 4) + "{",
        "a: &a [1, 1, 1]\nb: &b [*a, *a, *a]\nc: [*b, *b, {\n",
    ],
)
def test_hostile_texts_take_bounded_time(text: str) -> None:
    before = time.process_time()
    tolerant_document(text)
    assert time.process_time() - before < 5


def test_a_broken_line_costs_few_readings() -> None:
    lines = [f"  e{i}: {{type: spring, nodes: [n{i}, n{i + 1}], stiffness: {i + 1} kN*m/rad}}\n" for i in range(1000)]
    sound = "".join(["elements:\n", *lines])
    lines[900] = "  e900: {type: spring, nodes: [a, b\n"
    broken = "".join(["elements:\n", *lines])
    assert tolerant_document(broken).data["elements"]["e900"] == {"type": "spring", "nodes": ["a", "b"]}
    assert len(tolerant_document(broken).data["elements"]) == 1000
    reading = min(seconds(sound) for _ in range(3))
    assert min(seconds(broken) for _ in range(3)) < 6 * reading


def seconds(text: str) -> float:
    before = time.process_time()
    tolerant_document(text)
    return time.process_time() - before


def test_places_in_broken_entries_are_those_of_the_text() -> None:
    text = "elements:\n  shaft: {type: spring nodes: [a, 'b, stiffness: 3}\n  next: {type: lock"
    document = tolerant_document(text)
    assert document.root is not None
    shown = {leaf[0]: cut(document, leaf[1]) for leaf in leaves(document.root) if len(leaf) == 3}
    assert shown == {"spring": "spring", "a": "a", "b": "'b", 3: "3", "lock": "lock"}


def cut(document: LocatedDocument, place: tuple[int, int, int, int]) -> str:
    line, start, _, end = place
    return document.lines[line][start:end]


def test_library_is_where_it_is_looked_for() -> None:
    assert all(isinstance(path, Path) for path in MODELS.values())
    assert set(FEW) <= set(MODELS)
