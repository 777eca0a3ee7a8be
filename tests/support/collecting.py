"""Plugin: tests are collected without searches for garbage, and docstring examples without importing their modules."""

import ast
import gc
import sys
import warnings
from functools import cached_property

import pytest
from _pytest.doctest import DoctestModule

HEAVY = {
    *("asammdf", "control", "dask", "distributed", "fmpy", "h5py", "jsonschema", "libcst", "lsprotocol", "matplotlib"),
    *("pandas", "pint", "pyarrow", "rota", "sksundae"),
    *(f"scipy.{part}" for part in ("integrate", "linalg", "optimize", "signal", "sparse", "special", "stats")),
}
"""Packages that take 0.1 to 1.2 s of the processor, in every process that collects tests: import them in the functions
that use them, write ``scipy.stats.norm`` for ``from scipy.stats import norm``, or take `OnDemand`."""
LOADED = pytest.StashKey[set[str]]()
"""Which of them collecting has loaded."""
_PROMPT = ">>> "


@pytest.hookimpl(wrapper=True)
def pytest_collection(session):
    """Thousands of tests that all stay alive: to look again and again which are garbage takes a third of collecting."""
    gc.disable()
    try:
        return (yield)
    finally:
        session.config.stash[LOADED] = HEAVY & set(sys.modules)
        gc.freeze()  # nor do collections while tests run look at them
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path, parent):
    collectors = yield
    ours = [one for one in collectors if not isinstance(one, DoctestModule)]
    if len(ours) < len(collectors) and _PROMPT in file_path.read_text(encoding="utf-8"):
        ours.append(Examples.from_parent(parent, path=file_path))
    return ours


class OnDemand:
    """Package that is imported when a test first uses it, and skips that test where it is missing."""

    def __init__(self, name):
        self._name = name

    def __getattr__(self, name):
        if name.startswith("_"):  # pytest asks all that a file defines whether it is a fixture
            raise AttributeError(name)
        with warnings.catch_warnings():  # those of other packages while they are imported are not ours
            warnings.simplefilter("ignore")
            package = pytest.importorskip(self._name)
        return getattr(package, name)


class Examples(DoctestModule):
    """Examples in the docstrings of a module, by its text; it is imported when the first of them runs."""

    def collect(self):
        for name in sorted(self.lines):
            yield Example.from_parent(self, name=name, runner=None, dtest=None)

    @cached_property
    def lines(self):
        """Where each of them begins, by its name."""
        tree = ast.parse(self.path.read_text(encoding="utf-8"))
        return dict(examples_in(tree, _module_name(self.path)))

    @cached_property
    def imported(self):
        """The same tests as pytest collects them from the imported module."""
        items = {item.name: item for item in super().collect()}
        assert items.keys() == self.lines.keys(), "doctest sees other examples in the module than in its text"
        return items


class Example(pytest.DoctestItem):
    """A docstring whose module is imported before it runs."""

    def setup(self):
        original = self.parent.imported[self.name]
        self.runner, self.dtest = original.runner, original.dtest
        super().setup()

    def reportinfo(self):
        return self.path, self.parent.lines[self.name], f"[doctest] {self.name}"


def _module_name(path):
    """Dotted from the first folder that is no package, as pytest imports it."""
    parts = [] if path.name == "__init__.py" else [path.stem]
    for folder in path.parents:
        if not (folder / "__init__.py").is_file():
            break
        parts.append(folder.name)
    return ".".join(reversed(parts))


def examples_in(node, name, line=0):
    """The name and the line, from 0, of each docstring with examples; doctest looks into classes, not into functions."""
    if _PROMPT in (ast.get_docstring(node, clean=False) or ""):
        yield name, line
    if not isinstance(node, ast.FunctionDef):
        for one in node.body:
            if isinstance(one, ast.ClassDef | ast.FunctionDef):
                yield from examples_in(one, f"{name}.{one.name}", one.lineno - 1)
