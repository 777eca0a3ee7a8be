"""Rules on the texts of reports: each is listed, stands in the code, and is said in every language."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from structure.modules import Module
from structure.rules import Fault

TEXTS = "torsionnet/report/texts.yaml"
NOT_REPLACED = {
    ("measurement_plan", " over speed with its limits and measured half ranges"),
    ("responses", "Hz"), ("modes_by_configuration", "Hz"), ("responses", "Hz"), ("conclusion", "Hz"), ("formulas", "--tf "),
    # for those who cannot see the figure
    ("responses", "Test over model of "), ("modes_by_configuration", "Mode shapes of "), ("responses", "Bode plot of "),
    ("elements", " elements between the nodes "), ("elements", "Schematic of "),
    # joined to what the author or another part of the program wrote
    ("elements", " frequencies, "), ("elements", " rows, "), ("elements", " rows of "), ("elements", "; … and "), ("elements", "table of "),
    ("natural_frequencies", "in "),
    ("installation", "Without "), ("installation", "of "), ("resonances", " x "), ("resonances", "Hz"), ("equations_and_kinematics", "input "), ("modes_by_configuration", "spread over many, at most "), ("modes_by_configuration", "\xa0% in "),
    ("elements", "; changed for this report"),
    ("resonances", " modes, "), ("resonances", " crossings"), ("limits_and_passage", " over speed with its limits"),
    ("forced_response", "Orders of "), ("forced_response", "Half range of "), ("excitations", "Hz"),
    ("excitations", " bar "),
}  # fmt: skip
"""Strings that look like a text of a report and cannot be replaced; the page about templates says so."""
LOOKS = re.compile(r"[A-Z][a-z]+( .*)?|[ ,;:].*[a-z]{2}.*|.*[a-z] $", re.DOTALL)
"""What looks like a text: a capital at its beginning, a space at an edge, or a sign before words."""


def words_faults(root: Path, modules: Iterable[Module]) -> Iterator[Fault]:
    """Faults of all rules on the texts of reports of a checkout."""
    from torsionnet.report.plan.report_plan import LANGUAGES
    from torsionnet.report.wording import replaceable_texts

    texts = [text for texts in replaceable_texts().values() for text in texts]
    for language in sorted({*LANGUAGES} - {"en"}):
        place = f"torsionnet/report/words/{language}.yaml"
        yield from untranslated(place, (root / place).read_text(encoding="utf-8"), texts)
    yield from unlisted(modules, texts)


def untranslated(place: str, file: str, texts: Iterable[str]) -> Iterator[Fault]:
    """Texts of a report that a file of words lacks, those it has of none, and words that join otherwise."""
    from torsionnet.model.files.located_yaml import compose

    document = compose(file, place)
    said: Mapping[str, str] = document.data["texts"]
    end, wanted = len(file.splitlines()), [*texts]
    for text in wanted:
        if text not in said:
            remedy = f"add a line to this file: {text}: ..."
            yield Fault(f"{place}:{end}", f'no words for "{text}" of a report', remedy)
    for text, words in said.items():
        line = f"{place}:{document.position(('texts', text)).line}"
        if text not in wanted:
            yield Fault(line, f'no report says "{text}"', "take the line away")
        elif (text[:1] == " ", text[-1:] == " ") != (words[:1] == " ", words[-1:] == " "):
            remedy = "they join it to what is inserted before or behind"
            yield Fault(line, f'"{words}" has not the spaces at its ends that "{text}" has', remedy)


def unlisted(modules: Iterable[Module], texts: Iterable[str]) -> Iterator[Fault]:
    """Strings of a report's sections that look like a text and are not listed among those that can be replaced."""
    from torsionnet.base.phrases import PLACEHOLDER

    listed = [*texts]
    known = {*listed, *(piece for text in listed for piece in PLACEHOLDER.split(text)[::2])}
    for module in modules:
        for line, text in strings(module) if "/report/sections/" in module.relative else ():
            is_text = LOOKS.fullmatch(text) and "\\" not in text
            if is_text and text not in known and (module.path.stem, text) not in NOT_REPLACED:
                remedy = f"add it to {TEXTS}, and to torsionnet/report/words/de.yaml in German"
                yield Fault(f"{module.relative}:{line}", f'the text "{text}" of a report is not listed', remedy)


def strings(module: Module) -> Iterator[tuple[int, str]]:
    """Lines with the strings of a module, those of formatted ones in pieces, without docstrings."""
    from torsionnet.base.phrases import FORMATTED

    documentation = {id(node.value) for node in ast.walk(module.tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documentation:
            for piece in FORMATTED.split(node.value)[::3]:
                yield node.lineno, piece
