"""The tutorials are true: every command on them, in the order of the page, prints what the page shows."""

import importlib
import sys
from pathlib import Path

import pytest
from support import campaigns

from torsionnet.base.errors import MissingExtraError
from torsionnet.report.writers.pdf import find_browser

DOCS = Path(__file__).parents[2] / "docs"
FIRST = ("torsionnet check", "torsionnet static", "torsionnet new")
"""What takes little time: the first steps of both pages."""
DEAR, FILM = ("torsionnet damper",), ("film.png",)
"""What takes half of the time is for the night, with the picture that comes of it."""


@pytest.fixture(scope="module")
def tutorials():
    sys.path.insert(0, str(DOCS))
    yield importlib.import_module("tutorial_steps")
    sys.path.remove(str(DOCS))


@pytest.fixture
def pages(tutorials):
    return {page.stem: page for page in tutorials.TUTORIALS}


def disagreements(printed):
    return [f"{done.typed.line}: exit code {done.code}\n{done.text}" for done in printed if not done.agrees]


def has_browser():
    try:
        find_browser()
    except MissingExtraError:
        return False
    return True


@pytest.mark.parametrize("name", ["tutorial_rig", "tutorial_ship"])
def test_first_steps_print_what_the_page_shows(tutorials, pages, name, tmp_path):
    printed = list(tutorials.run(pages[name], tmp_path, wanted=lambda line: line.startswith(FIRST)))
    assert len(printed) >= 2
    assert disagreements(printed) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tutorial_rig", "tutorial_ship"])
def test_all_steps_print_what_the_page_shows(tutorials, pages, name, tmp_path):
    pdf = has_browser() and (campaigns.many or name == "tutorial_rig")  # a browser starts for each
    changes = {} if pdf else {"changed": tutorials.as_html}
    left_out = () if campaigns.many else DEAR
    printed = list(tutorials.run(pages[name], tmp_path, wanted=lambda line: not line.startswith(left_out), **changes))
    assert disagreements(printed) == []
    shown = pages[name].read_text(encoding="utf-8").split(f"(generated/{name}_")[1:]
    pictures = {text.partition(")")[0] for text in shown} - {"sketch.svg"}
    assert pictures - set(left_out and FILM) <= {path.name for path in tmp_path.glob("*.png")}
    assert len(list(tmp_path.glob("*.pdf" if pdf else "*.html"))) == 1


def test_page_and_print_may_differ_in_blanks_rules_and_last_digits_only(tutorials):
    assert tutorials.same("a  b\n---- --\n 1.0000  -2e3\n", "a b\n---  ---\n1.0001 -2000\n")
    assert not tutorials.same("a 1.00\n", "a 1.01\n")
    assert not tutorials.same("a 1\n", "a 1\nb\n")
    assert not tutorials.same("a 1 Hz\n", "a 1 rpm\n")


def test_page_may_leave_out_lines_where_it_says_so(tutorials):
    assert tutorials.same("a\n...\n", "a\nb\nc\n")
    assert tutorials.same("a\n...\nd 4\n", "a\nb\nc\nd 4\n")
    assert not tutorials.same("a\n...\nd 4\n", "a\nb\nc\nd 5\n")
    assert not tutorials.same("a\n...\nd\n", "a\nd\ne\n")


def test_blocks_go_where_their_first_line_says(tutorials, tmp_path):
    for text in (
        "# m.yaml\na: 1\nb: 2\nc: 3\n",
        '# m.yaml, instead of the line "b:"\nb: 5\n',
        '# m.yaml, below the line "a:"\naa: 1\n',
        "# m.yaml, at its end\nd: 4\n",
    ):
        tutorials.write_block(tmp_path, text)
    assert (tmp_path / "m.yaml").read_text(encoding="utf-8") == "# m.yaml\na: 1\naa: 1\nb: 5\nc: 3\nd: 4\n"
    tutorials.write_block(tmp_path, '# m.yaml, instead of all from the line "b:" on\ne: 6\n')
    assert (tmp_path / "m.yaml").read_text(encoding="utf-8") == "# m.yaml\na: 1\naa: 1\ne: 6\n"
    with pytest.raises(ValueError, match="does not say where"):
        tutorials.write_block(tmp_path, "a: 1\n")
