"""Counts of circular imports, doubled names and other properties of a package."""

from __future__ import annotations

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
        "files in import circles": sum(map(len, around)),
        "largest circle": max(map(len, around), default=0),
        "file names twice": len(doubled_files(modules)),
        "class names twice": len(doubled_classes(modules)),
        "noqa": sum(module.text.count("# noqa") for module in modules),
        "lines with Any": sum(module.lines_with_any for module in modules),
    }
    return {name: f"{number:,}".replace(",", " ") for name, number in numbers.items()}
