"""The rules of docs/architecture.md that a reader of one module cannot see: imports point down, and a few more."""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import pytest

PACKAGE = Path(__file__).parents[1] / "torsionnet"

LAYERS = (  # top to bottom: first name below torsionnet
    {"cli", "demo", "__main__"},
    {"document", "explore"},
    {"report", "interchange"},
    {"identification", "virtual"},
    {"sensitivity"},
    {"solve", "symbolics"},
    {"assembly"},
    {
        "bench",
        "outline",
        "overview",
        "drivetrain",
        "files",
        "checks",
        "kinematics",
        "definition",
        "parameters",
        "configurations",
        "channels",
        "operating_point",
        "speeds",
        "graph",
    },
    {"elements"},
    {"modal"},
    {"signals"},
    {
        "response",
        "units",
        "damping",
        "expressions",
        "elimination",
        "pivoting",
        "proportions",
        "collecting",
        "threads",
        "atomic",
        "errors",
        "foreign",
    },
)
HEIGHT = {name: -depth for depth, layer in enumerate(LAYERS) for name in layer}
TOP = 1  # torsionnet/__init__.py offers names from every layer

MAY_CALL_UP = {"drivetrain"}  # Drivetrain.modes() and its like: inside functions only
MAY_PLOT = {"report"}
MAY_PRINT = {"cli", "demo", "__main__"}
FORBIDDEN_CALLS = {"eval", "exec", "sympify", "parse_expr"}

MAX_LINES = 500
MAX_MEDIAN_LINES = 150


@dataclass(frozen=True)
class Import:
    module: str
    line: int
    in_function: bool


class Imports(ast.NodeVisitor):
    """Collects what a module imports at run time, under absolute names."""

    def __init__(self, package: tuple[str, ...], root: Path) -> None:
        self.package, self.root = package, root
        self.found: list[Import] = []
        self.depth = 0

    def visit_If(self, node: ast.If) -> None:
        if ast.unparse(node.test) in {"TYPE_CHECKING", "typing.TYPE_CHECKING"}:
            for statement in node.orelse:
                self.visit(statement)
        else:
            self.generic_visit(node)

    def visit_FunctionDef(self, node: ast.AST) -> None:
        self.depth += 1
        self.generic_visit(node)
        self.depth -= 1

    def visit_AsyncFunctionDef(self, node: ast.AST) -> None:
        self.visit_FunctionDef(node)

    def visit_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            self.add(alias.name, node)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        base = self.package[: len(self.package) - node.level + 1] if node.level else ()
        module = ".".join([*base, *([node.module] if node.module else [])])
        if module != "torsionnet":
            self.add(module, node)
            return
        for alias in node.names:  # `from torsionnet import solve` takes a module, `... import load` the top
            is_module = (self.root / alias.name).is_dir() or (self.root / f"{alias.name}.py").is_file()
            self.add(f"torsionnet.{alias.name}" if is_module else "torsionnet", node)

    def add(self, module: str, node: ast.stmt) -> None:
        self.found.append(Import(module, node.lineno, self.depth > 0))


@dataclass(frozen=True)
class Module:
    path: Path
    root: Path

    @property
    def relative(self) -> str:
        return self.path.relative_to(self.root.parent).as_posix()

    @property
    def layer_name(self) -> str:
        """First name below torsionnet; empty for torsionnet/__init__.py."""
        first = self.path.relative_to(self.root).parts[0].removesuffix(".py")
        return "" if first == "__init__" else first

    @property
    def tree(self) -> ast.Module:
        return ast.parse(self.path.read_text(encoding="utf-8"), filename=self.relative)

    @property
    def imports(self) -> list[Import]:
        visitor = Imports(self.path.relative_to(self.root.parent).parts[:-1], self.root)
        visitor.visit(self.tree)
        return visitor.found

    @property
    def calls(self) -> Iterator[tuple[str, int]]:
        """Each call with a plain dotted name: ("click.echo", line)."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
                yield ast.unparse(node.func), node.lineno


def modules_below(root: Path) -> list[Module]:
    return [Module(path, root) for path in sorted(root.rglob("*.py"))]


def height(name: str) -> int:
    return HEIGHT[name] if name else TOP


def upward_imports(module: Module) -> Iterator[str]:
    own = height(module.layer_name)
    for found in module.imports:
        first, *rest = found.module.split(".")
        if first != "torsionnet":
            continue
        target = rest[0] if rest else ""
        if target and target not in HEIGHT:
            yield f"{module.relative}:{found.line} imports {found.module}, which has no layer"
        elif height(target) > own and not (found.in_function and module.layer_name in MAY_CALL_UP):
            yield f"{module.relative}:{found.line} imports {found.module}, which is in a layer above"


def foreign_imports(module: Module, package: str) -> Iterator[str]:
    for found in module.imports:
        if found.module.split(".")[0] == package:
            yield f"{module.relative}:{found.line} imports {found.module}"


def printing(module: Module) -> Iterator[str]:
    yield from foreign_imports(module, "rich")
    for name, line in module.calls:
        if name in {"print", "click.echo", "click.secho", "sys.stdout.write", "sys.stderr.write"}:
            yield f"{module.relative}:{line} calls {name}"


def evaluation(module: Module) -> Iterator[str]:
    for name, line in module.calls:
        if name.split(".")[-1] in FORBIDDEN_CALLS or name in {"sympy.S", "sp.S"}:
            yield f"{module.relative}:{line} calls {name}"


MODULES = modules_below(PACKAGE)
each_module = pytest.mark.parametrize("module", MODULES, ids=lambda module: module.relative)


@each_module
def test_has_a_layer(module):
    assert not module.layer_name or module.layer_name in HEIGHT, f"give {module.relative} a place in LAYERS"


@each_module
def test_imports_point_down(module):
    if module.layer_name in HEIGHT:
        assert list(upward_imports(module)) == []


@each_module
def test_only_report_imports_matplotlib(module):
    if module.layer_name not in MAY_PLOT:
        assert list(foreign_imports(module, "matplotlib")) == []


@each_module
def test_only_the_command_line_prints(module):
    if module.layer_name not in MAY_PRINT:
        assert list(printing(module)) == []


@each_module
def test_text_is_never_evaluated(module):
    assert list(evaluation(module)) == []


@each_module
def test_module_is_short(module):
    length = len(module.path.read_text(encoding="utf-8").splitlines())
    assert length <= MAX_LINES


def test_half_of_the_modules_are_very_short():
    lengths = [len(module.path.read_text(encoding="utf-8").splitlines()) for module in MODULES]
    assert median(length for length in lengths if length) <= MAX_MEDIAN_LINES


def test_documentation_shows_the_same_layers():
    text = (PACKAGE.parent / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \d+ \|([^|]*)\|", text, flags=re.MULTILINE)
    assert [set(re.findall(r"`(\w+)`", row)) for row in rows] == list(LAYERS)


# The rules above say nothing if they cannot fail: a package that breaks each of them, and its allowed neighbours.


def a_module(tmp_path, name, source):
    path = tmp_path / "torsionnet" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / "torsionnet" / "solve").mkdir(exist_ok=True)
    path.write_text(source, encoding="utf-8")
    return Module(path, tmp_path / "torsionnet")


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("elements/gear.py", "from torsionnet.solve import modes"),
        ("elements/gear.py", "from torsionnet.solve.modes import modes"),
        ("elements/gear.py", "import torsionnet.solve.modes"),
        ("elements/gear.py", "from torsionnet import solve"),
        ("elements/gear.py", "from torsionnet import load"),
        ("elements/gear.py", "from .. import solve"),
        ("elements/gear.py", "from ..solve.modes import modes"),
        ("elements/__init__.py", "from ..solve import modes"),
        ("elements/gear.py", "def f():\n    from torsionnet.solve import modes"),
        ("elements/gear.py", "try:\n    from torsionnet.solve import modes\nexcept ImportError:\n    pass"),
        ("units.py", "from .elements import Gear"),
        ("units.py", "from torsionnet.nowhere import x"),
        ("drivetrain.py", "from torsionnet.solve import modes"),
        ("files/reader.py", "def f():\n    from torsionnet.solve import modes"),
        ("elements/gear.py", "if TYPE_CHECKING:\n    pass\nelse:\n    from torsionnet.solve import modes"),
    ],
)
def test_upward_import_is_found(tmp_path, name, source):
    assert len(list(upward_imports(a_module(tmp_path, name, source)))) == 1


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("solve/modes.py", "from torsionnet.elements import Gear\nfrom . import time\nfrom ..errors import SolveError"),
        ("elements/gear.py", "from .base import Element\nimport math\nfrom collections import abc"),
        ("elements/gear.py", "if TYPE_CHECKING:\n    from torsionnet.solve import Modes"),
        ("drivetrain.py", "class D:\n    def modes(self):\n        from torsionnet.solve import modes"),
        ("drivetrain/core.py", "def modes(self):\n    from ..solve import modes"),
        ("files/reader.py", "from torsionnet.drivetrain import Drivetrain"),
        ("__init__.py", "from torsionnet.cli import main"),
    ],
)
def test_other_imports_are_allowed(tmp_path, name, source):
    assert list(upward_imports(a_module(tmp_path, name, source))) == []


@pytest.mark.parametrize(
    ("rule", "source"),
    [
        (printing, "print('x')"),
        (printing, "import click\nclick.echo('x')"),
        (printing, "def f():\n    from rich.table import Table"),
        (evaluation, "eval('x')"),
        (evaluation, "exec('x')"),
        (evaluation, "import sympy\nsympy.sympify('x')"),
        (evaluation, "from sympy.parsing.sympy_parser import parse_expr\nparse_expr('x')"),
        (evaluation, "import sympy\nsympy.S('x')"),
        (lambda module: foreign_imports(module, "matplotlib"), "def f():\n    import matplotlib.pyplot as plt"),
    ],
)
def test_forbidden_thing_is_found(tmp_path, rule, source):
    assert len(list(rule(a_module(tmp_path, "solve/modes.py", source)))) == 1
