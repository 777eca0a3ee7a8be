"""Where the cursor is in a text that is being written: expected by hand."""

from __future__ import annotations

import pytest

from torsionnet.app.text.cursor_context import CursorContext, cursor_context


def at_mark(marked: str) -> tuple[CursorContext, str]:
    """Context at the mark | of a text, and the word begun there."""
    at = marked.index("|")
    text = marked.replace("|", "")
    found = cursor_context(text, at)
    return found, text[found.word.start : found.word.end]


@pytest.mark.parametrize(
    ("marked", "path", "word"),
    [
        ("|", (), ""),
        ("tor|", (), "tor"),
        ("name: x\n|", (), ""),
        ("elements:\n  |", ("elements",), ""),
        ("elements:\n|", (), ""),
        ("elements:\n  mo|", ("elements",), "mo"),
        ("elements:\n  # note\n\n  m:\n\n    |", ("elements", "m"), ""),
        ("elements:\n  m:\n    type: x\n    no|", ("elements", "m"), "no"),
        ("elements:\n  m:\n    type: x\n  |", ("elements",), ""),
        ("elements:\n  m:\n    type: x\n |", ("elements",), ""),
        ("elements:\n  m: {type: x}\n    |", ("elements",), ""),
        ("elements:\n  m: {|", ("elements", "m"), ""),
        ("elements:\n  m: {type: x, no|de: a}", ("elements", "m"), "no"),
        ("elements:\n  m: {type: x,\n    no|", ("elements", "m"), "no"),
        ("elements:\n  m: {type: x,\n|", ("elements", "m"), ""),
        ("elements:\n  m: {type: x, nodes: [a\n  s: {ty|", ("elements", "s"), "ty"),
        ("elements:\n  m: {type: x\n    no|", ("elements", "m"), "no"),
        ("elements: {m: {type: x}, n: {no|", ("elements", "n"), "no"),
        ("a:\n- b\n- c: 1\n  d|", ("a", 1), "d"),
        ("a: [1, {b: 2, c|", ("a", 1), "c"),
        ("limits:\n  a: {x: 1}\n\n|", (), ""),
    ],
)
def test_a_key_is_written(marked: str, path: tuple[str | int, ...], word: str) -> None:
    found, begun = at_mark(marked)
    assert (found.path, found.is_key, begun, found.is_text) == (path, True, word, False)


@pytest.mark.parametrize(
    ("marked", "path", "word"),
    [
        ("name: fo|", ("name",), "fo"),
        ("name:|", ("name",), ""),
        ("elements:\n  m: |", ("elements", "m"), ""),
        ("elements:\n  m: {type: |", ("elements", "m", "type"), ""),
        ("elements:\n  m: {type: x, nodes: [a, |b]}", ("elements", "m", "nodes", 1), ""),
        ("elements:\n  m: {type: x, nodes: [a, b], stiffness: 3 kN|", ("elements", "m", "stiffness"), "3 kN"),
        ("elements:\n  m: {type: x, nodes: [a, b, stiffness: 3|", ("elements", "m", "stiffness"), "3"),
        ("elements:\n  m: {type: x\n    nodes: |", ("elements", "m", "nodes"), ""),
        ("a:\n  - type: x\n    b: |", ("a", 0, "b"), ""),
        ("a:\n- b\n- |", ("a", 1), ""),
        ("a:\n  x: [1,\n    2, |", ("a", "x", 2), ""),
        ("a: [[1, 2], [3, |", ("a", 1, 1), ""),
    ],
)
def test_a_value_is_written(marked: str, path: tuple[str | int, ...], word: str) -> None:
    found, begun = at_mark(marked)
    assert (found.path, found.is_key, begun, found.is_text) == (path, False, word, False)


@pytest.mark.parametrize(
    "marked",
    [
        "# a|",
        "a: 1 # b|",
        "a: 'b|",
        'a: {b: "c|',
        "a: |-\n  b|",
        "a: >\n  b|",
        "a: {b: [1] |",
        "a: {b: 1}|",
        "a: {b: 1} # {c|",
    ],
)
def test_no_word_of_a_model_is_written(marked: str) -> None:
    at = marked.rindex("|")
    assert cursor_context(marked[:at] + marked[at + 1 :], at).is_text


def test_layout_at_the_cursor() -> None:
    assert at_mark("a:\n    b|")[0].indent == 4
    assert at_mark("a: {b|")[0].is_flow
    assert not at_mark("a:\n  b|")[0].is_flow
    assert at_mark("a:\n- b|")[0].is_list_item
    assert at_mark("a: [b|")[0].is_list_item
    assert at_mark("a:|")[0].needs_blank
