"""Steps of the tutorials: files that a reader writes and commands that he types, run in the order of the page.

``python docs/tutorial_steps.py`` runs the tutorials and writes what the commands print now into the pages; where a page
leaves out lines (``...``), it is only compared. ``write_pictures`` makes the pictures of the pages.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isclose
from pathlib import Path

from torsionnet.app.cli import main

DOCS = Path(__file__).parent
TUTORIALS = (DOCS / "tutorial_rig.md", DOCS / "tutorial_ship.md")
BLOCK = re.compile(r"^```(yaml|csv|console)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
WHERE = r"(?P<where>at its end|below|instead of)(?P<all> all from)?(?: the line \"(?P<line>[^\"]+)\")?"
HEAD = re.compile(rf"# (?P<name>[\w.]+)(?:, {WHERE}[^\n]*)?\n")
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
LEFT_OUT = "...\n"
NUMBERS_AGREE = 2e-3
"""Relative difference of a printed number from that of the page: what a fit moves by between processors is far less."""


@dataclass(frozen=True)
class Typed:
    """A command that the reader types, with what the page shows below it."""

    line: str
    shown: str


@dataclass(frozen=True)
class Printed:
    """A command that was run, with its exit code and what it printed on both streams."""

    typed: Typed
    code: int
    text: str

    @property
    def agrees(self) -> bool:
        """Whether the page shows what was printed; a verdict or an error that it shows has an exit code of its own."""
        told = {1: "error", 6: "incomplete"}.get(self.code, "never told")
        return (self.code == 0 or told in self.typed.shown) and same(self.typed.shown, self.text)


def steps(page: Path) -> Iterator[str | Typed]:
    """Files (text of their blocks) and commands of a page in their order, a command a block."""
    for language, text in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language != "console":
            yield text
            continue
        line, _, shown = text.removeprefix("$ ").partition("\n")
        if "$ torsionnet" in shown:
            raise ValueError(f"{page.name}: one command a block: {line}")
        yield Typed(line, shown)


def write_block(folder: Path, text: str) -> None:
    """Write a file as its block on the page says: all of it, lines at its end, below a line or instead of some."""
    head = HEAD.match(text)
    if head is None:
        raise ValueError(f"a block does not say where it belongs: {text[:60]!r}")
    path, block = folder / head["name"], text[head.end() :].splitlines(keepends=True)
    if head["where"] is None:
        path.write_text(text, encoding="utf-8")
        return
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    first = last = len(lines)
    if head["line"]:
        (at,) = (number for number, line in enumerate(lines) if line.strip().startswith(head["line"]))
        first = at + (head["where"] == "below")
        last = len(lines) if head["all"] else at + 1
    path.write_text("".join([*lines[:first], *block, *lines[last:]]), encoding="utf-8")


def run(
    page: Path,
    folder: Path,
    *,
    wanted: Callable[[str], bool] = lambda _: True,
    changed: Callable[[str], str] = lambda text: text,
) -> Iterator[Printed]:
    """Write the files of a page into a folder and run its commands there that are wanted, one after the other.

    ``changed`` changes a command and what is shown below it, as ``as_html`` does.
    """
    for step in steps(page):
        if isinstance(step, str):
            write_block(folder, step)
        elif wanted(step.line):
            done = Typed(changed(step.line), changed(step.shown))
            both = io.StringIO()
            with contextlib.chdir(folder), contextlib.redirect_stdout(both), contextlib.redirect_stderr(both):
                code = main(shlex.split(done.line)[1:])
            yield Printed(done, code, both.getvalue())


def as_html(text: str) -> str:
    """Command or answer with the report as HTML, which needs no browser, instead of PDF."""
    return text.replace(".pdf", ".html")


def same(shown: str, printed: str) -> bool:
    """Whether a page shows what was printed, but for spaces, rules, last digits and lines it leaves out."""
    words, place = tokens(printed), 0
    pieces = [tokens(piece) for piece in shown.split(LEFT_OUT)]
    for number, piece in enumerate(pieces):
        starts = [place] if number == 0 else range(place, len(words) - len(piece) + 1)
        found = next((start for start in starts if alike(piece, words[start : start + len(piece)])), None)
        if found is None:
            return False
        place = found + len(piece)
    return place == len(words) or not pieces[-1]


def tokens(text: str) -> list[str]:
    """Words of a text without the rules below the headings of tables."""
    return [word for word in text.split() if not re.fullmatch(r"-{2,}", word)]


def alike(one: list[str], other: list[str]) -> bool:
    """Whether words are the same, but for the last digits of numbers in them."""
    return len(one) == len(other) and all(
        a == b
        or (
            NUMBER.sub("#", a) == NUMBER.sub("#", b)
            and all(
                isclose(float(x), float(y), rel_tol=NUMBERS_AGREE)
                for x, y in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
            )
        )
        for a, b in zip(one, other, strict=True)
    )


def write_pictures(folder: Path) -> None:
    """Write the sketch and every picture that a command of a tutorial draws, named after its page."""
    import tutorial_sketch

    tutorial_sketch.write(folder / "tutorial_rig_sketch.svg")
    for page in TUTORIALS:
        with tempfile.TemporaryDirectory() as name:
            work = Path(name)
            for _ in run(page, work, wanted=draws_or_is_read_later):
                pass
            for picture in work.glob("*.png"):
                shutil.copy(picture, folder / f"{page.stem}_{picture.name}")


def draws_or_is_read_later(line: str) -> bool:
    return "--plot" in line or line.startswith(("torsionnet new", "torsionnet bench", "torsionnet fit"))


def update(page: Path) -> None:
    """Write what the commands of a page print into it, and print the commands that disagree."""
    text, new = page.read_text(encoding="utf-8"), []
    with tempfile.TemporaryDirectory() as name:
        for done in run(page, Path(name)):
            typed = done.typed
            if not done.agrees:
                sys.stdout.write(f"{page.name}: {typed.line}: exit code {done.code}\n{done.text}")
            before, text = text.split(f"$ {typed.line}\n{typed.shown}", 1)
            new += [before, f"$ {typed.line}\n", typed.shown if LEFT_OUT in typed.shown else plain(done.text)]
    page.write_text("".join([*new, text]), encoding="utf-8")


def plain(text: str) -> str:
    """Printed text without blanks at the ends of its lines."""
    return re.sub(r" +$", "", text, flags=re.MULTILINE)


if __name__ == "__main__":
    os.environ["MPLBACKEND"] = "Agg"
    for path in [Path(name) for name in sys.argv[1:]] or TUTORIALS:
        update(path)
