"""Rules of form that a reader of one module cannot see: imports point down, names occur once, and a few more."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from structure.floors import FLOORS, HEIGHT, height
from structure.measures import circles, doubled_classes
from structure.modules import Module
from structure.sentences import fragments


class Fault(NamedTuple):
    """Place that breaks a rule, as file:line, with what is wrong there and what mends it."""

    place: str
    what: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.place}: {self.what}; {self.remedy}"


MAY_PLOT = {"plot"}
MAY_PRINT = ("torsionnet/app/cli/", "torsionnet/__main__.py")
FORBIDDEN_CALLS = {"eval", "exec", "sympify", "parse_expr"}

SECTION_TYPES = (
    "torsionnet/model/definition.py", "torsionnet/model/checks/overrides.py", "torsionnet/model/parts/part.py", "torsionnet/bench/campaign/campaign_file.py"
)  # fmt: skip
"""Modules with the types of sections that rooms above own; what makes them comes by the table in model/sections.py."""
MAX_LINES = 600


def without_layer(module: Module) -> Iterator[Fault]:
    if module.layer_name and module.layer_name not in HEIGHT:
        yield Fault(f"{module.relative}:1", "has no layer", "enter it in LAYERS of tests/structure/floors.py")


def upward_imports(module: Module) -> Iterator[Fault]:
    if module.layer_name and module.layer_name not in HEIGHT:
        return  # without_layer tells it
    own = height(module.layer_name)
    for name, line, for_types in module.imports:
        first, *rest = name.split(".")
        if first != "torsionnet" or (for_types and module.relative in SECTION_TYPES):
            continue
        target = rest[0] if rest else ""
        place = f"{module.relative}:{line}"
        if target and target not in HEIGHT:
            yield Fault(place, f"imports {name}, which has no layer", "enter it in LAYERS of tests/structure/floors.py")
        elif height(target) > own:
            yield Fault(place, f"imports {name}, which is in a layer above", "move what both need into a layer below")


def upward_in_layer(module: Module) -> Iterator[Fault]:
    """Imports from a floor above in the same layer; what a folder's ``__init__`` offers may come from anywhere in it."""
    layer, *rest = module.path.relative_to(module.root).parts
    floors = FLOORS.get(layer, ())
    if rest == ["__init__.py"] or (own := _floor(floors, rest[:-1])) is None:
        return
    for name, line, _ in module.imports:
        package, *target = name.split(".")
        other = _floor(floors, target[1:-1]) if [package, *target[:1]] == ["torsionnet", layer] else None
        if other is not None and other > own:
            place = f"{module.relative}:{line}"
            yield Fault(place, f"imports {name}, which is on a floor above", "move what both need to a floor below")


def _floor(floors: tuple[str, ...], folders: list[str]) -> int | None:
    name = folders[0] if folders else ""
    return floors.index(name) if name in floors else None


def foreign_imports(module: Module, package: str, allowed: str) -> Iterator[Fault]:
    for name, line, for_types in module.imports:
        if name.split(".")[0] == package and not for_types:
            yield Fault(f"{module.relative}:{line}", f"imports {name}", f"only {allowed} may")


def plotting(module: Module) -> Iterator[Fault]:
    if module.layer_name not in MAY_PLOT:
        yield from foreign_imports(module, "matplotlib", "torsionnet/plot")


def printing(module: Module) -> Iterator[Fault]:
    if module.relative.startswith(MAY_PRINT):
        return
    allowed = "the command line"
    yield from foreign_imports(module, "rich", allowed)
    for name, line in module.calls:
        if name in {"print", "click.echo", "click.secho", "sys.stdout.write", "sys.stderr.write"}:
            yield Fault(f"{module.relative}:{line}", f"calls {name}", f"only {allowed} may")


def evaluation(module: Module) -> Iterator[Fault]:
    for name, line in module.calls:
        if name.split(".")[-1] in FORBIDDEN_CALLS or name in {"sympy.S", "sp.S"}:
            remedy = "texts become numbers by base/expressions alone"
            yield Fault(f"{module.relative}:{line}", f"calls {name}", remedy)


def data_from_prose(module: Module) -> Iterator[Fault]:
    """Quick fixes that read the sentence of a fault, instead of the fields in which it says the same."""
    if module.relative.startswith("torsionnet/app/text/fixes/"):
        for node in ast.walk(module.tree):
            if isinstance(node, ast.Attribute) and (
                node.attr == "message" or (node.attr == "text" and ast.unparse(node.value).endswith("fault"))
            ):
                remedy = "take its kind, about, meant or remedy"
                yield Fault(f"{module.relative}:{node.lineno}", f"reads {ast.unparse(node)}", remedy)


def untyped_entries(module: Module) -> Iterator[Fault]:
    """Entries whose type is, or holds, anything: mypy checks the others against their specifications."""
    for node in module.statements:
        made = node.value if isinstance(node, ast.AnnAssign) else None
        if isinstance(made, ast.Call) and ast.unparse(made.func) == "entry" and _is_anything(node.annotation):
            what = f"an entry has the type {ast.unparse(node.annotation)}"
            yield Fault(f"{module.relative}:{node.lineno}", what, "say what it holds")


def aliases_of_anything(module: Module) -> Iterator[Fault]:
    """Other names for Any, alone or among others: what is behind them has no type."""
    for node in module.tree.body:
        value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
        if isinstance(value, ast.Constant) and re.fullmatch(r"[\w\[\], |.]*\bAny\b[\w\[\], |.]*", str(value.value)):
            value = ast.parse(value.value, mode="eval").body
        if any(isinstance(one, ast.Name) and one.id == "Any" for one in _united(value)):
            yield Fault(f"{module.relative}:{node.lineno}", "gives Any another name", "say what it holds")


def _is_anything(annotation: ast.expr) -> bool:
    return any(isinstance(one, ast.Name) and one.id == "Any" for one in ast.walk(annotation))


def _united(node: ast.expr | None) -> Iterator[ast.expr | None]:
    """The members of a union, or the type alone."""
    if isinstance(node, ast.BinOp):
        yield from (*_united(node.left), *_united(node.right))
    else:
        yield node


def fragmentary_sentences(module: Module) -> Iterator[Fault]:
    """First sentences of docstrings that do not stand alone, for whoever sees them and nothing else."""
    for line, name, sentence in fragments(module):
        what = f'the docstring of {name} begins with a fragment, "{sentence}"'
        remedy = "say what is returned, with unit and shape, without what stands around it"
        yield Fault(f"{module.relative}:{line}", what, remedy)


def long_modules(module: Module) -> Iterator[Fault]:
    if (lines := len(module.text.splitlines())) > MAX_LINES:
        yield Fault(f"{module.relative}:{lines}", f"more than {MAX_LINES} lines", "divide it by subject")


def idle_dataclasses(module: Module) -> Iterator[Fault]:
    """Classes made dataclasses once more though they add no field; methods of each are compiled at every import."""
    for node in module.statements:
        if isinstance(node, ast.ClassDef) and node.bases and _is_bare_dataclass(node) and not _has_fields(node):
            remedy = "take away its decorator: it has the methods of its base"
            yield Fault(f"{module.relative}:{node.lineno}", f"the dataclass {node.name} adds no field", remedy)


def _is_bare_dataclass(declared: ast.ClassDef) -> bool:
    """Whether equality and the text are not made for the class itself."""
    options = [
        {f"{one.arg}={ast.unparse(one.value)}" for one in getattr(decorator, "keywords", ())}
        for decorator in declared.decorator_list
    ]
    return any({"eq=False", "repr=False"} <= given for given in options)


def _has_fields(declared: ast.ClassDef) -> bool:
    annotated = [one for one in declared.body if isinstance(one, ast.AnnAssign)]
    return any(not ast.unparse(one.annotation).startswith("ClassVar") for one in annotated)


OF_A_MODULE: tuple[Callable[[Module], Iterator[Fault]], ...] = (
    without_layer,
    upward_imports,
    upward_in_layer,
    plotting,
    printing,
    evaluation,
    data_from_prose,
    untyped_entries,
    aliases_of_anything,
    fragmentary_sentences,
    long_modules,
    idle_dataclasses,
)


# All modules beside each other


def import_circles(modules: list[Module]) -> Iterator[Fault]:
    for part in circles(modules):
        yield Fault(
            f"{part[0]}", f"imports {', '.join(part[1:])} and they it", "move what they share into a module below"
        )


def names_twice(modules: list[Module]) -> Iterator[Fault]:
    """Class names that occur twice."""
    for name in doubled_classes(modules):
        places = [module.relative for module in modules if name in module.public_classes]
        yield Fault(f"{places[0]}:1", f"{name} is also a class of {', '.join(places[1:])}", "rename one of them")


OF_ALL_MODULES = (import_circles, names_twice)


def package_faults(modules: list[Module]) -> Iterator[Fault]:
    """Faults of all rules on modules."""
    for rule in OF_A_MODULE:
        for module in modules:
            yield from rule(module)
    for rule_of_all in OF_ALL_MODULES:
        yield from rule_of_all(modules)


# Other files


def imports_of_tests(path: Path) -> Iterator[Fault]:
    """Imports of files of tests: what others need of them stands in tests/support."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if match := re.match(r"\s*(?:from|import) (?:tests\.)?(test_\w+)", line):
            remedy = "move what is shared into tests/support"
            yield Fault(f"{path.parent.name}/{path.name}:{number}", f"imports {match[1]}", remedy)


def faults_of_theory(docs: Path, modules: list[Module]) -> Iterator[Fault]:
    """Equations of the theory manual that are not numbered in order, and modules that pages name and there are not."""
    theory = docs / "theory"
    chapters = re.search(r":maxdepth: 1\n\n(.*?)```", (theory / "index.md").read_text(encoding="utf-8"), re.DOTALL)
    for chapter, name in enumerate(chapters[1].split() if chapters else (), 1):
        tags = _matches(theory / f"{name}.md", r"\\tag\{(\d+\.\d+)\}")
        for number, (place, tag) in enumerate(tags, 1):
            if tag != f"{chapter}.{number}":
                yield Fault(place, f"equation {tag} should be {chapter}.{number}", "number them in order")
    files = {module.path.relative_to(module.root) for module in modules}
    known = {part for path in files for part in _endings(path)}
    rooms = "|".join(HEIGHT)
    for page in sorted(docs.rglob("*.md")):
        # Other pages also name files of users.
        pattern = r"`([\w/]+(?:\.py|/))`" if page.parent == theory else rf"`((?:{rooms})/[\w/]*(?:\.py|/))`"
        for place, name in _matches(page, pattern):
            if not name.startswith("tests/") and name not in known:
                yield Fault(place, f"there is no {name}", "name the module as it is now")


def _matches(page: Path, pattern: str) -> Iterator[tuple[str, str]]:
    """Places and first groups of what a page has of a pattern."""
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        for match in re.finditer(pattern, line):
            yield f"{'/'.join(page.parts[-3:])}:{number}", match[1]


def _endings(path: Path) -> Iterator[str]:
    """Names by which a page may call a module: its path or the end of it; and its folder's."""
    parts = path.parts
    yield from ("/".join(parts[start:]) for start in range(len(parts)))
    yield f"{path.parent.as_posix()}/"
