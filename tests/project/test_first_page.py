"""The first page of the documentation shows what its model gives and leads to every task within two clicks."""

import re
from pathlib import Path

import pytest

from torsionnet.app.cli import main

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
INDEX = DOCS / "index.md"
FENCE = re.compile(r"^```(.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([\w/.-]+?)(?:\.md|\.rst)?(?:#[\w-]*)?\)")
TASKS = {
    "a drivetrain with a gear": r"type: gear\b",
    "modes": r"^torsionnet modes ",
    "a measured input": r"^torsionnet frf .*--input T_T",
    "a record to a response": r"^torsionnet estimate ",
    "a fit": r"^torsionnet fit ",
    "orders": r"^torsionnet orders ",
    "limits": r"^torsionnet limits ",
    "a report": r"^torsionnet report ",
    "a study": r"^torsionnet study ",
    "an own element": r"^class \w+\(Element\)",
    "a notebook": r"^rig\.modes\(\)$",
}
"""What a block of a page has that shows how the task is done."""


def text_of(name):
    path = DOCS / f"{name}.md"
    return path.read_text(encoding="utf-8") if path.exists() else ""


def clicks(name):
    """Pages to which links and tables of contents of a page lead, relative to docs."""
    text = text_of(name)
    found = LINK.findall(FENCE.sub("", text))
    for directive, lines in FENCE.findall(text):
        if directive == "{toctree}":
            found += re.findall(r"^[\w/]+$", lines, re.MULTILINE)
    folder = (DOCS / name).parent
    places = [(folder / one).resolve() for one in found]
    return {place.relative_to(DOCS).as_posix() for place in places if place.is_relative_to(DOCS)}


@pytest.fixture(scope="module")
def near():
    """Pages within two clicks of the first one."""
    first = clicks("index")
    return first.union(*map(clicks, first))


@pytest.mark.parametrize("task", TASKS)
def test_every_task_is_within_two_clicks(task, near):
    blocks = {name: [text for _, text in FENCE.findall(text_of(name))] for name in sorted(near)}
    shows = re.compile(TASKS[task], re.MULTILINE)
    assert [name for name, texts in blocks.items() if any(shows.search(text) for text in texts)]


def test_the_table_of_tasks_leads_to_pages_that_show_them():
    rows = [line for line in text_of("index").splitlines() if line.startswith("| ")]
    pages = [name for line in rows for name in LINK.findall(line)]
    assert all(text_of(name) or name == "gallery/index" for name in pages)
    shown = "\n".join(text for name in pages for _, text in FENCE.findall(text_of(name)))
    assert [task for task, shows in TASKS.items() if not re.search(shows, shown, re.MULTILINE)] == []


def test_pages_of_maintainers_stand_apart():
    contents = [lines for directive, lines in FENCE.findall(text_of("index")) if directive == "{toctree}"]
    apart = [lines for lines in contents if "architecture" in lines]
    assert len(apart) == 1
    assert set(re.findall(r"^[\w/]+$", apart[0], re.MULTILINE)) == {
        "architecture", "decisions/index", "benchmarks", "releasing"
    }  # fmt: skip


def test_model_and_modes_of_the_first_page_are_those_of_the_example(monkeypatch, capsys):
    files = ROOT / "examples" / "files"
    monkeypatch.chdir(files)
    model, modes = (text for language, text in FENCE.findall(text_of("index")) if language in ("yaml", "text"))
    assert model == (files / "model.yaml").read_text(encoding="utf-8")
    assert main(["modes", "model.yaml"]) == 0
    assert modes in capsys.readouterr().out
