"""The public interface is what a stored list says, and documentation, examples and benchmarks use nothing else."""

import ast
import difflib
import importlib
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

import torsionnet as tn

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TIMED_INSIDE = {
    "batched_modes": "modes of many variants at once, without the study around them",
    "busy_machine": "threads of BLAS, set free",
    "cluster": "executors and chunks of a study",
    "frequency_response": "each method of elimination by itself",
    "motion_over_time": "the march of a motion without its compiled loop",
    "parts": "models written flat",
    "scale": "assembly and tables by themselves",
    "scheduler_load": "the executor of a cluster",
    "studies": "batches of variants without the study around them",
}
"""Benchmarks that time an inner part of the package by itself, and which; all others use what users use."""
PROGRAMS = sorted(
    [
        *(DOCS / "how_to").glob("*.md"),
        *DOCS.glob("*.md"),
        *DOCS.glob("tutorial*/*.md"),
        *(ROOT / "examples").glob("*.py"),
        *(path for path in (ROOT / "benchmarks").glob("*.py") if path.stem not in TIMED_INSIDE),
        ROOT / "README.md",
    ]
)
WITH_PYTHON = [path for path in PROGRAMS if path.suffix == ".py" or FENCE.search(path.read_text(encoding="utf-8"))]


@pytest.fixture(scope="module")
def names():
    sys.path.insert(0, str(DOCS))
    try:
        return importlib.import_module("public_names")
    finally:
        sys.path.remove(str(DOCS))


def test_signatures_are_those_decided_on(names):
    stored = names.SIGNATURES.read_text(encoding="utf-8").splitlines()
    now = names.signatures_text().splitlines()
    change = [line for line in difflib.unified_diff(stored, now, "stored", "now", n=0, lineterm="") if line[:2] != "@@"]
    assert not change, (
        "the public interface has changed. Lines with + only add to it: run `make signatures`, and say it in "
        "CHANGELOG.md. Lines with - take something from programs of users: keep the old name or parameter with "
        "`deprecated` (docs/stability.md), or wait for a major version.\n" + "\n".join(change[:60])
    )


def test_every_member_that_is_kept_back_exists(names):
    for cls, inner in names.INNER_MEMBERS.items():
        if cls is not object:
            assert [name for name in inner if not hasattr(cls, name)] == [], cls


def test_what_public_functions_return_is_public(names):
    """Classes of this package that stand alone as what a public method returns have a page, too."""
    public = {one.last for one in names.public_names()} | {"Self"}
    lines = names.signatures_text().splitlines()
    returned = {found[1]: line for line in lines if (found := re.search(r" -> ([A-Z]\w+)(?: classmethod)?$", line))}
    assert {name: line for name, line in returned.items() if name not in public | KNOWN_ELSEWHERE} == {}


KNOWN_ELSEWHERE = {"Any", "ComplexArray", "ExternalTorques", "Figure", "FloatArray", "Fraction", "Json", "None", "Path"}
"""Aliases of arrays and numbers, and classes of other packages."""


# Uses


def programs(path):
    text = path.read_text(encoding="utf-8")
    return [text] if path.suffix == ".py" else FENCE.findall(text)


def uses(text):
    """Modules of the package that a program imports from with the names it takes, and names it looks up in them."""
    modules = {}
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.partition(".")[0] == "torsionnet":
                    yield alias.name, None
                    modules[alias.asname or "torsionnet"] = tn
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "torsionnet":
            for alias in node.names:
                yield node.module, alias.name
                if isinstance(found := getattr(importlib.import_module(node.module), alias.name, None), ModuleType):
                    modules[alias.asname or alias.name] = found
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (module := module_of(node.value, modules)):
            yield module.__name__, node.attr


def module_of(node, modules):
    if isinstance(node, ast.Name):
        return modules.get(node.id)
    if isinstance(node, ast.Attribute) and (outer := module_of(node.value, modules)):
        found = getattr(outer, node.attr, None)
        return found if isinstance(found, ModuleType) else None
    return None


@pytest.mark.parametrize("path", WITH_PYTHON, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_programs_use_public_names(path, names):
    importable = {*names.public_packages()} - {"torsionnet.core.units"}
    wrong = []
    for program in programs(path):
        continued = "tn." in program and "import torsionnet as tn" not in program  # imported in an earlier block
        text = f"import torsionnet as tn\n{program}" if continued else program
        for module, name in uses(text):
            if module not in {*importable, "torsionnet.core.units"}:
                wrong.append(f"{module} is not public")
            elif name not in (None, "__version__") and name not in importlib.import_module(module).__all__:
                wrong.append(f"{module}.{name} is not public")
        wrong += [
            f"import tn.units instead of {found}"
            for found in re.findall(r"import.*core\.units|from.*core\.units", text)
        ]
    assert wrong == [], "write it with public names (docs/stability.md), or make the name public"


def test_a_program_with_inner_names_is_found():
    found = {*uses("import torsionnet as tn\nfrom torsionnet.solve import batch\ntn.plot.bode(tn.plot._inner)")}
    assert found >= {("torsionnet", "plot"), ("torsionnet.plot", "_inner"), ("torsionnet.solve", "batch")}


def test_benchmarks_of_inner_parts_exist():
    assert [name for name in TIMED_INSIDE if not (ROOT / "benchmarks" / f"{name}.py").exists()] == []
