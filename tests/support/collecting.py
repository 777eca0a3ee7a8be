"""Plugin: tests are collected without searches for garbage, and docstring examples without importing their modules."""

import ast
import gc
from functools import cached_property

import pytest
from _pytest.doctest import DoctestModule

_PROMPT = ">>> "


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Thousands of tests that all stay alive: to look again and again which are garbage takes a third of collecting."""
    gc.disable()
    try:
        return (yield)
    finally:
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
        return getattr(pytest.importorskip(self._name), name)


class Examples(DoctestModule):
    """Examples in the docstrings of a module, by its text; it is imported when the first of them runs."""

    def collect(self):
        for name in sorted(self.lines):
            yield Example.from_parent(self, name=name, runner=None, dtest=None)

    @cached_property
    def lines(self):
        """Where each of them begins, by its name."""
        tree = ast.parse(self.path.read_text(encoding="utf-8"))
        return dict(_examples(tree, _module_name(self.path), 0))

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


def _examples(node, name, line):
    """The name and the line, from 0, of each docstring with examples; doctest looks into classes, not into functions."""
    if _PROMPT in (ast.get_docstring(node, clean=False) or ""):
        yield name, line
    if not isinstance(node, ast.FunctionDef):
        for one in node.body:
            if isinstance(one, ast.ClassDef | ast.FunctionDef):
                yield from _examples(one, f"{name}.{one.name}", one.lineno - 1)
