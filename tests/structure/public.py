"""Rules on the public interface: its stored lists, and that documents, examples and benchmarks use it and no more."""

from __future__ import annotations

import ast
import difflib
import importlib
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import torsionnet as tn
from structure.rules import Fault

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TIMED_INSIDE = {
    "batched_modes": "modes of many variants at once, without the study around them",
    "busy_machine": "threads of BLAS, set free",
    "cluster": "executors and chunks of a study",
    "frequency_response": "each method of elimination by itself",
    "motion_over_time": "the march of a motion without its compiled loop",
    "parts": "models written flat",
    "periodic_motion": "a Newton step of the condensed balance, beside one on all coordinates",
    "scale": "assembly and tables by themselves",
    "scheduler_load": "the executor of a cluster",
    "studies": "batches of variants without the study around them",
}
"""Benchmarks that time an inner part of the package by itself, and which; all others use what users use."""
KNOWN_ELSEWHERE = {"Any", "ComplexArray", "ExternalTorques", "Figure", "FloatArray", "Fraction", "Json", "None", "Path"}
"""Aliases of arrays and numbers, and classes of other packages."""
FIELDS = ROOT / "tests" / "output_fields.txt"


def interface_faults() -> Iterator[Fault]:
    """Faults of all rules on the public interface of the checkout."""
    sys.path.insert(0, str(DOCS))
    names = importlib.import_module("public_names")
    now = names.signatures_text().splitlines()
    yield from changed_signatures(names.SIGNATURES.read_text(encoding="utf-8").splitlines(), now)
    yield from (Fault(*one) for one in importlib.import_module("words_page").faults())
    yield from inner_results(now, {one.last for one in names.public_names()})
    used = importlib.import_module("public_uses")
    yield from unused_names((one.name for one in names.public_names() if not one.is_result), used.uses_of_names())
    yield from idle_results(used.sources_of_results())
    yield from missing_members(names.INNER_MEMBERS)
    yield from changed_fields(FIELDS.read_text(encoding="utf-8").splitlines(), output_fields())
    yield from overdue_names(tn.__version__)
    for name in TIMED_INSIDE:
        if not (ROOT / "benchmarks" / f"{name}.py").exists():
            yield Fault("tests/structure/public.py", f"there is no benchmark {name}", "take it from TIMED_INSIDE")
    for path in programs():
        yield from inner_uses(path.read_text(encoding="utf-8"), path.relative_to(ROOT), {*names.public_packages()})


def changed_signatures(stored: list[str], now: list[str]) -> Iterator[Fault]:
    """Lines of the stored list that are not true any more, and those that it lacks."""
    for tag, first, last, start, end in difflib.SequenceMatcher(None, stored, now, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        for number in range(first, last):
            remedy = "keep the old name or parameter with `deprecated` (docs/stability.md), or wait for a major version"
            what = f"gone from the public interface: {stored[number]}"
            yield Fault(f"tests/public_signatures.txt:{number + 1}", what, remedy)
        for line in now[start:end]:
            remedy = "make signatures, and say it in CHANGELOG.md"
            yield Fault(f"tests/public_signatures.txt:{first + 1}", f"new in the public interface: {line}", remedy)


def missing_members(inner: dict[type, set[str]]) -> Iterator[Fault]:
    for cls, names in inner.items():
        for name in sorted(names) if cls is not object else ():
            if not hasattr(cls, name):
                remedy = "take it from INNER_MEMBERS"
                yield Fault("docs/public_names.py", f"{cls.__name__} has no member {name}", remedy)


def inner_results(lines: Iterable[str], public: set[str]) -> Iterator[Fault]:
    """Public methods that return a class of this package alone which has no page."""
    for line in lines:
        match = re.search(r" -> ([A-Z]\w+)(?: classmethod)?$", line)
        if match and match[1] not in public | KNOWN_ELSEWHERE | {"Self"}:
            what = f"{line.partition('(')[0]} returns {match[1]}, which is not public"
            yield Fault("tests/public_signatures.txt", what, "enter it in RESULTS of docs/public_names.py")


def unused_names(names: Iterable[str], used: Collection[str]) -> Iterator[Fault]:
    """Public names that no page and no example needs."""
    for name in names:
        if name not in used:
            package, _, last = name.rpartition(".")
            remedy = "show the task that needs it on a page, or take it out of its package's table"
            yield Fault(
                f"{package.replace('.', '/')}/__init__.py", f"{last} stands on no page and in no example", remedy
            )


def idle_results(sources: Mapping[str, Sequence[str]]) -> Iterator[Fault]:
    """Results that no public name returns or holds."""
    for name, calls in sources.items():
        if not calls:
            yield Fault("docs/public_names.py", f"no public name returns {name}", "take it from RESULTS")


# What --json prints


def changed_fields(stored: list[str], now: set[str]) -> Iterator[Fault]:
    """Fields of --json that programs of users read and that went, and new ones, which are a promise."""
    known = [line for line in stored if not line.startswith("#")]
    for number, line in enumerate(stored, 1):
        if line in known and line not in now:
            yield Fault(f"tests/output_fields.txt:{number}", f"{line} is gone", "keep it to the next major version")
    for line in sorted(now.difference(known)):
        yield Fault("tests/output_fields.txt", f"{line} is new in what --json prints", "add this line: it is a promise")


def output_fields() -> set[str]:
    """Places of all fields that commands print with --json."""
    from torsionnet.app.cli.output import OUTPUTS, output_schema

    return {field for command in OUTPUTS for field in schema_fields(output_schema(command), command)}


def schema_fields(schema: dict[str, Any], place: str) -> Iterator[str]:
    """Places of all named entries in a JSON Schema."""
    for name, entry in schema.get("properties", {}).items():
        yield f"{place}.{name}"
        yield from schema_fields(entry, f"{place}.{name}")
    for part in ("items", "additionalProperties"):
        if isinstance(schema.get(part), dict):
            yield from schema_fields(schema[part], f"{place}[]")
    for choice in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("prefixItems", ())):
        yield from schema_fields(choice, place)


def overdue_names(version: str) -> Iterator[Fault]:
    from torsionnet.base import deprecation

    for one in deprecation.PENDING:
        if one.overdue(version):
            yield Fault("torsionnet", one.sentence, "remove it, say so in CHANGELOG.md, and make signatures")


# Uses


def programs() -> list[Path]:
    """Pages with programs, examples and benchmarks of what users use."""
    places = [
        *(DOCS / "how_to").glob("*.md"),
        *DOCS.glob("*.md"),
        *DOCS.glob("tutorial*/*.md"),
        *(ROOT / "examples").glob("*.py"),
        *(path for path in (ROOT / "benchmarks").glob("*.py") if path.stem not in TIMED_INSIDE),
        ROOT / "README.md",
    ]
    return sorted(places)


def inner_uses(text: str, path: Path, packages: set[str]) -> Iterator[Fault]:
    """Uses of names that are not public in a program, or in the programs of a page."""
    blocks = [(0, text)] if path.suffix == ".py" else [(match.start(1), match[1]) for match in FENCE.finditer(text)]
    for start, block in blocks:
        continued = "tn." in block and "import torsionnet as tn" not in block  # imported in an earlier block
        program = f"import torsionnet as tn\n{block}" if continued else block
        before = text[:start].count("\n") - continued
        for line, module, name in uses(program):
            place = f"{path.as_posix()}:{before + line}"
            remedy = "use public names (docs/stability.md), or make the name public"
            if module == "torsionnet.base.units":
                if re.search("import|from", program.splitlines()[line - 1]):
                    yield Fault(place, f"takes units from {module}", "import tn.units instead")
            elif module not in packages:
                yield Fault(place, f"{module} is not public", remedy)
            elif name not in (None, "__version__") and name not in importlib.import_module(module).__all__:
                yield Fault(place, f"{module}.{name} is not public", remedy)


def uses(text: str) -> Iterator[tuple[int, str, str | None]]:
    """Lines with modules of the package that a program imports from or looks up names in, and these names."""
    modules: dict[str, ModuleType] = {}
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.partition(".")[0] == "torsionnet":
                    yield node.lineno, alias.name, None
                    modules[alias.asname or "torsionnet"] = tn
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] == "torsionnet":
            for alias in node.names:
                yield node.lineno, node.module, alias.name
                if isinstance(got := getattr(importlib.import_module(node.module), alias.name, None), ModuleType):
                    modules[alias.asname or alias.name] = got
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (module := _module_of(node.value, modules)):
            yield node.lineno, module.__name__, node.attr


def _module_of(node: ast.expr, modules: dict[str, ModuleType]) -> ModuleType | None:
    if isinstance(node, ast.Name):
        return modules.get(node.id)
    if isinstance(node, ast.Attribute) and (outer := _module_of(node.value, modules)):
        got = getattr(outer, node.attr, None)
        return got if isinstance(got, ModuleType) else None
    return None
