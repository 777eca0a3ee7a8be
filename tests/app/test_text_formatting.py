"""Layout of texts: what it makes of untidy ones, that nothing but layout changes, and that a second time changes nothing."""

import io
import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import campaigns
from support.broken_models import BASE, CASES

from torsionnet.app.text.layout import formatted
from torsionnet.app.text.text_edits import edited
from torsionnet.base.errors import ModelError
from torsionnet.model.files.located_yaml import compose

ROOT = Path(__file__).parents[2]
FILES = sorted([*ROOT.glob("library/**/*.yaml"), *ROOT.glob("tests/plants/*.yaml"), *ROOT.glob("examples/**/*.yaml")])


def tidy(text):
    return edited(text, formatted(text))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_files_of_the_library_are_laid_out_already(path):
    text = path.read_bytes().decode()
    assert formatted(text) == []


LAYOUTS = {
    "indentation of four": ("a:\n    b: 1\n    c:\n        d: 2\n", "a:\n  b: 1\n  c:\n    d: 2\n"),
    "indentation of one": ("a:\n b: 1\n c:\n  d: 2\n", "a:\n  b: 1\n  c:\n    d: 2\n"),
    "blanks in brackets": ("a: { b: 1 ,c:[ 1,2 ,  3 ] }\n", None),
    "blanks in a table": ("a: { b: 1 , c: [ 1,2 ,  3 ] }\n", "a: {b: 1, c: [1, 2, 3]}\n"),
    "blank before a colon": ("a : 1\nb: {c : 2}\n", "a: 1\nb: {c: 2}\n"),
    "blanks after a colon": ("a:    1\n", "a: 1\n"),
    "values below each other stay": ("ab: 1\nc:  2\n", "ab: 1\nc:  2\n"),
    "blanks at the end": ("a: 1  \nb: 2\t\n", "a: 1\nb: 2\n"),
    "last line": ("a: 1\nb: 2", "a: 1\nb: 2\n"),
    "empty lines stay": ("a: 1\n\n   \nb: 2\n\n", "a: 1\n\n\nb: 2\n\n"),
    "comments move along": (
        "# top\na:   # here\n    # above\n    b: 1   # beside\n    # below\nc: 2\n",
        "# top\na:   # here\n  # above\n  b: 1   # beside\n  # below\nc: 2\n",
    ),
    "a comment at no entry": ("a:\n  b: 1\n\n   # odd\nc: 2\n", "a:\n  b: 1\n\n# odd\nc: 2\n"),
    "lists": ("a:\n- 1\n-   b: 2\n    c: 3\n", "a:\n  - 1\n  - b: 2\n    c: 3\n"),
    "text of several lines": (
        "a:\n    b: >\n          two  \n          words\n    c: |\n      x\n        y\n",
        "a:\n  b: >\n    two  \n    words\n  c: |\n    x\n      y\n",
    ),
    "quoted text of several lines": ('a:\n    b: "one\n\n      two  \n      three"\n', 'a:\n  b: "one\n\n    two  \n    three"\n'),
    "brackets over several lines": (
        "a:\n    b: {c: 1,\n        d: 2,\n    }\n    e: [\n      1,\n    ]\n",
        "a:\n  b: {c: 1,\n      d: 2,\n  }\n  e: [\n    1,\n  ]\n",
    ),
    "tab in brackets": ("a: {b: 1,\n\tc: 2}\n", "a: {b: 1,\n  c: 2}\n"),
    "anchors": ("a: {b:  &x 1,c: *x }\n", "a: {b: &x 1, c: *x}\n"),
    "signs in quotes": ("a: {b: 'x ,y:z', c: \"p:q ,r\"}\n", "a: {b: 'x ,y:z', c: \"p:q ,r\"}\n"),
    "json": ('{"a":1,"b":[1,2]}', '{"a": 1, "b": [1, 2]}\n'),
    "returns": ("a:\r\n    b: 1  \r\nc: 2", "a:\r\n  b: 1\r\nc: 2\r\n"),
    "mark": ("\ufeffa:   1  \n", "\ufeffa: 1\n"),
    "digits and quotes": ("a: {b: 1.50, c: '2', d: 1e3, e: 0.10 kg*m^2}\n", "a: {b: 1.50, c: '2', d: 1e3, e: 0.10 kg*m^2}\n"),
    "nothing": ("", ""),
    "comments only": ("# a  \n", "# a  \n"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), LAYOUTS.values(), ids=LAYOUTS)
def test_layout(text, expected):
    if expected is None:
        assert formatted(text) == []  # c:[ is no entry, this is broken
        return
    assert tidy(text) == expected
    assert tidy(expected) == expected


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_data_stay_and_broken_texts_stay_as_they_are(case):
    try:
        before = compose(case.text, "")
    except ModelError:
        assert formatted(case.text) == []
        return
    new = tidy(case.text)
    assert compose(new, "").data == before.data
    assert tidy(new) == new


def bare(text):
    """What of a text is no layout: its signs without blanks."""
    return [line for line in ("".join(line.split()) for line in text.splitlines()) if line]


@st.composite
def layouts(draw):
    """Texts with the entries of a model in any layout."""
    out = io.StringIO()
    newline = draw(st.sampled_from(["\n", "\r\n"]))

    def blanks(least=0):
        return " " * draw(st.integers(least, 3))

    def flow(depth):
        if depth == 0 or draw(st.booleans()):
            return draw(st.sampled_from(["1", "0.50", "k_1", "3 kg*m^2", '"a, b: c"', "'x # y'", "2*(k + 1)"]))
        inner = [flow(depth - 1) for _ in range(draw(st.integers(0, 3)))]
        comma = f"{blanks()},{blanks()}" if draw(st.booleans()) else f",{newline}{' ' * 14}"
        if draw(st.booleans()):
            return "[" + blanks() + comma.join(inner) + blanks() + "]"
        pairs = [f"n{i}:{blanks(1)}{value}" for i, value in enumerate(inner)]
        return "{" + blanks() + comma.join(pairs) + blanks() + "}"

    def comment(column):
        if draw(st.integers(0, 3)) == 0:
            out.write(draw(st.sampled_from(["", "  ", " " * column + "# note", "   # odd  "])) + newline)

    def entries(column, depth):
        step = draw(st.integers(1, 4))
        for index in range(draw(st.integers(1, 3))):
            comment(column)
            out.write(f"{' ' * column}key{index}:")
            kind = draw(st.integers(0, 4)) if depth else 0
            if kind == 1:
                out.write(newline)
                entries(column + step, depth - 1)
            elif kind == 2:
                out.write(newline)
                dash = column + draw(st.integers(0, 3))
                for _ in range(2):
                    out.write(f"{' ' * dash}-{blanks(1)}{flow(1)}{newline}")
            elif kind == 3:
                out.write(f" {draw(st.sampled_from('|>'))}{newline}")
                for word in ("some", "  more"):
                    out.write(f"{' ' * (column + step)}{word}{newline}")
            else:
                out.write(f"{blanks(1)}{flow(2)}{draw(st.sampled_from(['', '  ', ' # c  ']))}{newline}")

    entries(0, 3)
    return out.getvalue().rstrip("\r\n") + draw(st.sampled_from(["", newline]))


@settings(max_examples=campaigns.examples(60, 3000), deadline=None)
@given(layouts())
def test_any_layout_becomes_one_that_stays(text):
    new = tidy(text)
    assert compose(new, "").data == compose(text, "").data
    assert tidy(new) == new
    assert bare(new) == bare(text)


@pytest.mark.parametrize("step", [211, pytest.param(3, marks=pytest.mark.nightly)])
def test_a_text_cut_anywhere_keeps_its_data(step):
    text = (ROOT / "library" / "wind_turbine_3mw.yaml").read_text(encoding="utf-8")
    for end in range(step - 1, len(text), step):
        new = tidy(text[:end])
        assert bare(new) == bare(text[:end])


def test_untidy_library_models_become_as_they_are():
    draw = random.Random(3)
    for path in draw.sample(FILES, campaigns.examples(3, len(FILES))):
        text = path.read_text(encoding="utf-8")
        wide = re.sub(r"(?m)^( *[\w.]+:) ?(\{.*)$", r"\1 \2  ", text)
        if '"' not in wide and "#" not in wide:
            wide = re.sub(r", (?=\w+: )", " ,   ", wide)
        wide = re.sub(r"(?m)^  (?=  |[^ ])", "   ", wide) if ">" not in wide else wide
        assert tidy(wide) == text, path.name


def test_the_base_of_the_broken_models_is_laid_out():
    assert formatted(BASE) == []


@pytest.mark.parametrize("text", ["---", "...", "null", "--- # nothing", "\ufeff---"])
def test_a_text_without_data_is_left_alone(text: str) -> None:
    assert formatted(text) == []


def test_the_bracket_that_opens_a_json_file_stays_at_the_margin() -> None:
    text = '{\n "name": "rig",\n "elements": {\n  "a": {"type": "lock"}\n }\n}\n'
    assert formatted(text) == []
