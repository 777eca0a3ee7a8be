"""Counts of circular imports, doubled names and other properties of a package."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType

from structure.modules import Module, modules_below


def circles(modules: Iterable[Module], homes: Mapping[str, str] = MappingProxyType({})) -> list[list[str]]:
    """Groups of modules that import each other, the largest first; imports in functions count, too.

    ``homes`` are other modules in which some stand.
    """
    import networkx as nx

    graph: nx.DiGraph[str] = nx.DiGraph()
    known = {module.name for module in modules}
    for module in modules:
        own = homes.get(module.name, module.name)
        used = {homes.get(found.name, found.name) for found in module.imports if found.name in known}
        graph.add_edges_from((own, other) for other in used - {own})
    found = [sorted(part) for part in nx.strongly_connected_components(graph) if len(part) > 1]
    return sorted(found, key=len, reverse=True)


def doubled_files(modules: Iterable[Module]) -> list[str]:
    """File names that occur twice or more, apart from ``__init__`` and ``__main__``."""
    return _doubled(module.path.stem for module in modules if not module.path.stem.startswith("__"))


def doubled_classes(modules: Iterable[Module]) -> list[str]:
    """Public class names that occur twice or more."""
    return _doubled(name for module in modules for name in module.public_classes)


def _doubled(names: Iterable[str]) -> list[str]:
    return sorted(name for name, count in Counter(names).items() if count > 1)


def measures(package: Path) -> dict[str, str]:
    """Names and values of the counts that ``make structure`` prints."""
    modules = modules_below(package)
    around = circles(modules)
    numbers = {
        "code lines": sum(module.code_lines for module in modules),
        "files": len(modules),
        "files under 30 code lines, without __init__": sum(
            module.code_lines < 30 and module.path.stem != "__init__" for module in modules
        ),
        "files in import circles": sum(map(len, around)),
        "largest circle": max(map(len, around), default=0),
        "file names twice": len(doubled_files(modules)),
        "class names twice": len(doubled_classes(modules)),
        "classes named Row, Record, Table": sum(
            name.endswith(("Row", "Record", "Table")) for module in modules for name in module.public_classes
        ),
        "noqa": sum(module.text.count("# noqa") for module in modules),
        "lines with Any": sum(module.lines_with_any for module in modules),
    }
    lines = sum(len(module.text.splitlines()) for module in modules)
    once, private = private_functions(modules)
    shares = {
        "imports, % of lines": 100 * sum(module.import_lines for module in modules) / lines,
        "comments per 100 code lines, inside functions": 100
        * sum(module.comments_in_functions for module in modules)
        / numbers["code lines"],
        "private functions referenced once, %": 100 * once / max(private, 1),
    }
    counts = {name: f"{number:,}".replace(",", " ") for name, number in numbers.items()}
    return counts | {name: f"{share:.1f}" for name, share in shares.items()}


def private_functions(modules: Iterable[Module]) -> tuple[int, int]:
    """Number of names of private functions that the package says once but for their definitions, and of all."""
    defined: Counter[str] = Counter()
    said: Counter[str] = Counter()
    for module in modules:
        defined.update(
            node.name
            for node in module.statements
            if isinstance(node, ast.FunctionDef) and re.match("_[^_]", node.name)
        )
        said.update(re.findall(r"\w+", module.text))
    return sum(said[name] - count == 1 for name, count in defined.items()), len(defined)
