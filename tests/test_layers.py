"""The rules of docs/architecture.md that a reader of one module cannot see: imports point down, and a few more."""

import ast
import gc
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import pytest
from structure.floors import FLOORS, HEIGHT, height
from structure.measures import circles, doubled_classes, doubled_files
from structure.modules import Module, modules_below
from structure.sentences import fragments

PACKAGE = Path(__file__).parents[1] / "torsionnet"

MAY_PLOT = {"plot"}
MAY_PRINT = {"cli", "demo", "__main__"}
FORBIDDEN_CALLS = {"eval", "exec", "sympify", "parse_expr"}

MAX_LINES = 500
MAX_MEDIAN_LINES = 150
MAX_FILES = 35
"""Files that stand beside each other in a folder, without its ``__init__``."""

SAME_THING = {
    "a command, what it calls and what shows its result": {
        "bench",
        "campaign",
        "comparison",
        "critical_speeds",
        "damping",
        "equations",
        "excitations",
        "fit",
        "fits",
        "holzer",
        "identify_modes",
        "kinematics",
        "library",
        "limit_check",
        "limits",
        "mass_elastic",
        "mean_response",
        "modes",
        "operational_modes",
        "tracked_orders",
        "order_response",
        "orders",
        "parameters",
        "power_balance",
        "passage_response",
        "range_passage",
        "report",
        "schematic",
        "simplified",
        "simulate",
        "spectrogram",
        "stabilisation",
        "static_state",
        "study",
    },
}


def upward_imports(module: Module) -> Iterator[str]:
    if module.layer_name and module.layer_name not in HEIGHT:
        return  # told by test_every_module_has_a_layer
    own = height(module.layer_name)
    for name, line, _ in module.imports:
        first, *rest = name.split(".")
        if first != "torsionnet":
            continue
        target = rest[0] if rest else ""
        if target and target not in HEIGHT:
            yield f"{module.relative}:{line} imports {name}, which has no layer"
        elif height(target) > own:
            yield f"{module.relative}:{line} imports {name}, which is in a layer above"


def upward_in_layer(module: Module) -> Iterator[str]:
    """Imports from a floor above in the same layer; what a folder's ``__init__`` offers may come from anywhere in it."""
    layer, *rest = module.path.relative_to(module.root).parts
    floors = FLOORS.get(layer, ())
    if rest == ["__init__.py"] or (own := _floor(floors, rest[:-1])) is None:
        return
    for name, line, _ in module.imports:
        package, *target = name.split(".")
        other = _floor(floors, target[1:-1]) if [package, *target[:1]] == ["torsionnet", layer] else None
        if other is not None and other > own:
            yield f"{module.relative}:{line} imports {name}, which is on a floor above"


def _floor(floors: tuple[str, ...], folders: list[str]) -> int | None:
    name = folders[0] if folders else ""
    return floors.index(name) if name in floors else None


def full_folders(modules: list[Module]) -> Iterator[str]:
    beside = Counter(module.path.parent for module in modules if module.path.stem != "__init__")
    for folder, count in beside.items():
        if count > MAX_FILES:
            yield f"{folder.name} has {count} files, {MAX_FILES} at most: move what belongs together into a folder below"


def foreign_imports(module: Module, package: str) -> Iterator[str]:
    for name, line, for_types in module.imports:
        if name.split(".")[0] == package and not for_types:
            yield f"{module.relative}:{line} imports {name}"


def printing(module: Module) -> Iterator[str]:
    yield from foreign_imports(module, "rich")
    for name, line in module.calls:
        if name in {"print", "click.echo", "click.secho", "sys.stdout.write", "sys.stderr.write"}:
            yield f"{module.relative}:{line} calls {name}"


def evaluation(module: Module) -> Iterator[str]:
    for name, line in module.calls:
        if name.split(".")[-1] in FORBIDDEN_CALLS or name in {"sympy.S", "sp.S"}:
            yield f"{module.relative}:{line} calls {name}"


def untyped_entries(module: Module) -> Iterator[str]:
    """Entries whose type is, or holds, anything: mypy checks the others against their specifications."""
    for node in ast.walk(module.tree):
        made = node.value if isinstance(node, ast.AnnAssign) else None
        if isinstance(made, ast.Call) and ast.unparse(made.func) == "entry" and _is_anything(node.annotation):
            yield f"{module.relative}:{node.lineno} an entry has the type {ast.unparse(node.annotation)}"


def aliases_of_anything(module: Module) -> Iterator[str]:
    """Other names for Any, alone or among others: what is behind them has no type."""
    for node in module.tree.body:
        value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
        if isinstance(value, ast.Constant) and re.fullmatch(r"[\w\[\], |.]*\bAny\b[\w\[\], |.]*", str(value.value)):
            value = ast.parse(value.value, mode="eval").body
        if any(isinstance(one, ast.Name) and one.id == "Any" for one in _united(value)):
            yield f"{module.relative}:{node.lineno} gives Any another name"


def imports_of_tests(path: Path) -> Iterator[str]:
    """Imports of files of tests: what others need of them stands in tests/support."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if match := re.match(r"\s*(?:from|import) (?:tests\.)?(test_\w+)", line):
            yield f"{path.name}:{number} imports {match[1]}"


def _is_anything(annotation: ast.expr) -> bool:
    return any(isinstance(one, ast.Name) and one.id == "Any" for one in ast.walk(annotation))


def _united(node: ast.expr | None) -> Iterator[ast.expr | None]:
    """The members of a union, or the type alone."""
    if isinstance(node, ast.BinOp):
        yield from (*_united(node.left), *_united(node.right))
    else:
        yield node


MODULES = modules_below(PACKAGE)


def broken(rule, exempt=()):
    """What a rule finds in all modules but those of some layers."""
    return [text for module in MODULES if module.layer_name not in exempt for text in rule(module)]


@pytest.fixture(scope="module", autouse=True)
def parsed():
    """The syntax of all modules, which several tests go through; collecting garbage meanwhile doubles the time."""
    gc.disable()
    for module in MODULES:
        module.tree  # noqa: B018
    gc.enable()


def test_no_first_sentence_is_a_fragment():
    """Whoever sees a first sentence and nothing else knows what is returned, or what a thing is."""
    found = [line for module in MODULES for line in fragments(module)]
    assert found == [], "say what is returned, with unit and shape, without what stands around it"


def test_every_module_has_a_layer():
    without = [module.relative for module in MODULES if module.layer_name and module.layer_name not in HEIGHT]
    assert not without, f"enter them in LAYERS of tests/structure/floors.py: {without}"


def test_imports_point_down():
    assert broken(upward_imports) == []


def test_imports_point_down_in_a_layer():
    assert broken(upward_in_layer) == []


def test_no_folder_is_full():
    assert list(full_folders(MODULES)) == []


def test_only_plot_imports_matplotlib():
    assert broken(lambda module: foreign_imports(module, "matplotlib"), MAY_PLOT) == []


def test_only_the_command_line_prints():
    assert broken(printing, MAY_PRINT) == []


def test_text_is_never_evaluated():
    assert broken(evaluation) == []


def test_entries_have_types():
    assert broken(untyped_entries) == []


def test_any_has_no_other_names():
    assert broken(aliases_of_anything) == []


def test_no_file_imports_a_file_of_tests():
    folders = [PACKAGE.with_name(name) for name in ("tests", "docs", "benchmarks")]
    assert [text for folder in folders for path in folder.rglob("*.py") for text in imports_of_tests(path)] == []


def test_modules_are_short():
    long = [module.relative for module in MODULES if len(module.text.splitlines()) > MAX_LINES]
    assert not long, f"more than {MAX_LINES} lines: {long}"


def test_half_of_the_modules_are_very_short():
    lengths = [len(module.path.read_text(encoding="utf-8").splitlines()) for module in MODULES]
    assert median(length for length in lengths if length) <= MAX_MEDIAN_LINES


def test_no_modules_import_each_other():
    found = circles(MODULES)
    assert not found, f"import each other; move what both need into a module below: {found}"


def test_a_name_is_used_once():
    twice = set(doubled_files(MODULES)) - set.union(*SAME_THING.values())
    assert not twice, f"rename one of each, or enter it in SAME_THING: {twice}"
    classes = doubled_classes(MODULES)
    assert not classes, f"rename one of each: {classes}"


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
        ("model/gear.py", "from torsionnet.solve import modes"),
        ("model/gear.py", "from torsionnet.solve.modes.modes import modes"),
        ("model/gear.py", "import torsionnet.solve.modes.modes"),
        ("model/gear.py", "from torsionnet import solve"),
        ("model/gear.py", "from torsionnet import load"),
        ("model/gear.py", "from .. import solve"),
        ("model/gear.py", "from ..solve.modes import modes"),
        ("model/__init__.py", "from ..solve import modes"),
        ("model/gear.py", "def f():\n    from torsionnet.solve import modes"),
        ("model/gear.py", "try:\n    from torsionnet.solve import modes\nexcept ImportError:\n    pass"),
        ("core/units.py", "from ..model import Gear"),
        ("core/units.py", "from torsionnet.nowhere import x"),
        ("model/model.py", "class D:\n    def modes(self):\n        from torsionnet.solve import modes"),
        ("model/gear.py", "if TYPE_CHECKING:\n    from torsionnet.solve import Modes"),
        ("model/reader.py", "def f():\n    from torsionnet.solve import modes"),
        ("model/gear.py", "if TYPE_CHECKING:\n    pass\nelse:\n    from torsionnet.solve import modes"),
    ],
)
def test_upward_import_is_found(tmp_path, name, source):
    assert list(upward_imports(a_module(tmp_path, name, source))) != []


@pytest.mark.parametrize(
    ("name", "source"),
    [
        (
            "solve/modes/modes.py",
            "from torsionnet.model.elements import Gear\nfrom . import time\nfrom ..core import SolveError",
        ),
        ("model/gear.py", "from .base import Element\nimport math\nfrom collections import abc"),
        ("drivetrain.py", "class D:\n    def modes(self):\n        from torsionnet.solve import modes"),
        ("io/tors.py", "from torsionnet.drivetrain import Drivetrain"),
        ("__init__.py", "from torsionnet.cli import main"),
    ],
)
def test_other_imports_are_allowed(tmp_path, name, source):
    assert list(upward_imports(a_module(tmp_path, name, source))) == []


@pytest.mark.parametrize(
    ("name", "source", "allowed"),
    [
        ("solve/modes/cut_drivetrain.py", "from torsionnet.solve.running.orders import x", False),
        ("solve/modes/cut_drivetrain.py", "def f():\n    from torsionnet.solve.responses.grid import x", False),
        ("solve/modes/cut_drivetrain.py", "from torsionnet.solve.dynamic_stiffness.tape import x", True),
        ("solve/modes/cut_drivetrain.py", "from torsionnet.solve.modes.eigen import x", True),
        ("solve/__init__.py", "from torsionnet.solve.design.damper import x", True),
        ("plot/bode.py", "from torsionnet.plot.study.axes import x", False),
        ("plot/bode.py", "from torsionnet.plot.schematic.texts import x", True),
        ("plot/schematic/texts.py", "from torsionnet.plot.bode import x", False),
        ("model/element_base/laws.py", "from torsionnet.model.elements.gears import x", False),
        ("model/element_base/laws.py", "from torsionnet.model.checks.names import x", True),
    ],
)
def test_an_import_from_a_floor_above_is_found(tmp_path, name, source, allowed):
    assert (list(upward_in_layer(a_module(tmp_path, name, source))) == []) is allowed


def test_a_full_folder_is_found(tmp_path):
    modules = [a_module(tmp_path, f"solve/a{number}.py", "") for number in range(MAX_FILES)]
    assert list(full_folders([*modules, a_module(tmp_path, "solve/__init__.py", "")])) == []
    assert list(full_folders([*modules, a_module(tmp_path, "solve/b.py", "")])) == [
        "solve has 36 files, 35 at most: move what belongs together into a folder below"
    ]


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
        (untyped_entries, "class A:\n    x: Any = entry(Value('x', '1'))"),
        (untyped_entries, "class A:\n    x: tuple[str, Any] | None = entry(PAIR, None)"),
        (aliases_of_anything, "Number: TypeAlias = Any"),
        (aliases_of_anything, "Value = Any | None"),
        (aliases_of_anything, "Value: TypeAlias = 'dict[str, str] | Any'"),
        (lambda module: foreign_imports(module, "matplotlib"), "def f():\n    import matplotlib.pyplot as plt"),
    ],
)
def test_forbidden_thing_is_found(tmp_path, rule, source):
    assert len(list(rule(a_module(tmp_path, "solve/modes/modes.py", source)))) == 1


def test_an_import_of_a_file_of_tests_is_found(tmp_path):
    path = tmp_path / "test_one.py"
    path.write_text(
        "from support.one import x\nfrom test_two import y\ndef f():\n    import test_three\n", encoding="utf-8"
    )
    assert list(imports_of_tests(path)) == ["test_one.py:2 imports test_two", "test_one.py:4 imports test_three"]


def test_a_circle_is_found(tmp_path):
    package = tmp_path / "torsionnet"
    package.mkdir()
    (package / "one.py").write_text("def f():\n    from torsionnet.two import g\n", encoding="utf-8")
    (package / "two.py").write_text("if TYPE_CHECKING:\n    from torsionnet.one import f\n", encoding="utf-8")
    (package / "three.py").write_text("import torsionnet.one\nclass A: pass\nclass B: pass\n", encoding="utf-8")
    (package / "four.py").write_text('"""Text."""\n# a remark\nclass A:\n    x: Any = 1\n', encoding="utf-8")
    (package / "parts").mkdir()
    (package / "parts" / "__init__.py").write_text("from torsionnet.parts.first import x\n", encoding="utf-8")
    (package / "parts" / "first.py").write_text("from torsionnet.parts import second\n", encoding="utf-8")
    (package / "parts" / "second.py").write_text("", encoding="utf-8")
    found = [module for module in modules_below(package) if module.text]
    assert circles(found) == [["torsionnet.one", "torsionnet.two"], ["torsionnet.parts", "torsionnet.parts.first"]]
    assert doubled_classes(found) == ["A"]
    assert {module.path.stem: module.code_lines for module in found} == {
        "one": 1,
        "two": 1,
        "three": 2,
        "four": 2,
        "__init__": 0,
        "first": 0,
    }
    assert [module.lines_with_any for module in found if module.path.stem == "four"] == [1]


@pytest.mark.slow
def test_every_module_of_the_schematic_can_be_the_first_that_is_imported():
    """The package of the schematic and the function plot.schematic share a name, which only some orders forgive."""
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        for path in (PACKAGE / "plot" / "schematic").rglob("*.py")
    ]
    for name in names:
        done = subprocess.run(
            [sys.executable, "-c", f"import {name}"], capture_output=True, text=True, cwd=PACKAGE.parent, check=False
        )
        assert done.returncode == 0, (name, done.stderr)
