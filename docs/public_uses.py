"""Where public names are used: pages, examples and library models, which is the reason why a name is public.

A page uses a name in a program, or in a sentence with its package, as ``tn.load`` or ``signals.decimate``. An element
type is used as well where a model has its ``type:``, or a sentence names its kind. Pages on what is inside the package,
as those on its architecture and decisions, do not count, nor do the generated pages of the reference.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from public_names import public_names, signature_lines

from torsionnet.base.packages import TABLES
from torsionnet.model.elements import element_classes

ROOT = Path(__file__).resolve().parents[1]
NO_TASK = {"architecture", "benchmarks", "glossary", "reference", "releasing", "robustness", "stability"}
"""Pages about the package rather than about something to do with it."""
_FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+")
_TYPE = re.compile(r"\btype: (\w+)|(?<!`)`(\w+)`(?!`)")


@dataclass(frozen=True)
class Place:
    """Page or example with its title, and the link to it from the reference; no link where no page shows it."""

    title: str
    link: str = ""

    def __str__(self) -> str:
        return f"[{self.title}]({self.link})" if self.link else self.title


@cache
def uses_of_names() -> dict[str, tuple[Place, ...]]:
    """Places that use each public name, by the name that its page has; how-tos before examples and models."""
    known = {name: one.name for one in public_names() for name in (one.name, *one.others)}
    kinds = {cls.kind: f"torsionnet.{name}" for name, cls in element_classes().items()}
    found: dict[str, dict[Place, None]] = {}
    for place, text, is_program in _texts():
        named = names_in_program(text, {}) if is_program else names_on_page(text)
        names = {known[name] for name in named if name in known}
        names |= {kinds[kind] for match in _TYPE.finditer(text) if (kind := match[1] or match[2]) in kinds}
        for name in names:
            found.setdefault(name, {})[place] = None
    return {name: tuple(places) for name, places in found.items()}


@cache
def sources_of_results() -> dict[str, list[str]]:
    """Calls and fields from which programs get results, by the name of the class, as ``Drivetrain.modes``."""
    results = {one.name: one.last for one in public_names() if one.is_result}
    found: dict[str, list[str]] = {last: [] for last in results.values()}
    for line in signature_lines():
        source, _, annotation = line.rpartition(" -> ") if " -> " in line else line.partition(": ")
        shown = source.partition("(")[0]
        for name, last in results.items():
            shown = shown.replace(f"{name}.", f"{last}.")
        for last in found.keys() & {*re.findall(r"\b[A-Z]\w+", annotation)} - {shown.partition(".")[0]}:
            found[last].append(shown.removeprefix("torsionnet."))
    return {last: list(dict.fromkeys(sources)) for last, sources in found.items()}


def _texts() -> Iterator[tuple[Place, str, bool]]:
    """Texts with their places, and whether each is a program rather than a page."""
    docs = ROOT / "docs"
    pages = [
        *sorted((docs / "how_to").glob("*.md")),
        *sorted(docs.glob("*.md")),
        *sorted((docs / "theory").glob("*.md")),
    ]
    for path in pages:
        if path.stem not in NO_TASK:
            text = path.read_text(encoding="utf-8")
            yield Place(text.partition("\n")[0].lstrip("# "), path.relative_to(docs).as_posix()), text, False
    yield Place("README"), (ROOT / "README.md").read_text(encoding="utf-8"), False
    for path in sorted((ROOT / "examples").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if path.match("examples/plot_*.py"):
            title = (ast.get_docstring(ast.parse(text)) or path.stem).partition("\n")[0]
            yield Place(title, f"gallery/{path.stem}.rst"), text, True
        else:
            yield Place(f"examples/{path.relative_to(ROOT / 'examples').parts[0]}"), text, True
    for path in sorted((ROOT / "library").rglob("*.yaml")):
        yield Place(f"library: {path.stem}"), path.read_text(encoding="utf-8"), False


def names_on_page(text: str) -> set[str]:
    """Full names of what the programs of a page, and code in its sentences, name of the package."""
    meant = {"tn": "torsionnet", "torsionnet": "torsionnet", **_packages()}
    names: set[str] = set()
    for language, block in _FENCE.findall(text):
        if "python" in language:  # as "{code-block} python"
            names |= names_in_program(block, meant)
    for code in _CODE.findall(_FENCE.sub("", text)):
        for dotted in _DOTTED.findall(code):
            first, _, rest = dotted.partition(".")
            if first in meant:
                names |= _beginnings(f"{meant[first]}.{rest}")
    return names


def names_in_program(text: str, known: Mapping[str, str]) -> set[str]:
    """Full names of what a program imports from the package, or looks up in it.

    ``known``: what names mean that an earlier program of a page has imported.
    """
    try:
        tree = ast.parse(text)
    except SyntaxError:  # a block that shows a part of a program
        return set()
    meant, names = dict(known), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            meant |= {one.asname or "torsionnet": one.name for one in node.names if one.name.startswith("torsionnet")}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "torsionnet":
            for one in node.names:
                meant[one.asname or one.name] = f"{node.module}.{one.name}"
                names |= _beginnings(f"{node.module}.{one.name}")
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (dotted := _dotted(node, meant)):
            names |= _beginnings(dotted)
    return names


def _dotted(node: ast.expr, meant: Mapping[str, str]) -> str:
    """Full name of what a program looks up; empty for attributes of anything else."""
    if isinstance(node, ast.Name):
        return meant.get(node.id, "")
    if isinstance(node, ast.Attribute) and (outer := _dotted(node.value, meant)):
        return f"{outer}.{node.attr}"
    return ""


def _beginnings(dotted: str) -> set[str]:
    """Name with its attributes cut off one by one, from modules as they are imported."""
    parts = dotted.split(".")
    if len(parts) > 1 and (module := _packages().get(parts[1])):
        parts[:2] = module.split(".")
    return {".".join(parts[:end]) for end in range(2, len(parts) + 1)}


@cache
def _packages() -> dict[str, str]:
    """Modules that the package offers, by the last part of their names."""
    return {name: place for name, place in TABLES["torsionnet"].items() if ":" not in place}
