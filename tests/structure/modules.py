"""Modules of the package in a folder, read without importing them."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple


class Import(NamedTuple):
    """Import statement: absolute name, line, and whether only type checkers see it."""

    name: str
    line: int
    for_types: bool


@dataclass(frozen=True)
class Module:
    """Source file of the package below ``root``, with its name, imports and calls."""

    path: Path
    root: Path

    @property
    def relative(self) -> str:
        return self.path.relative_to(self.root.parent).as_posix()

    @property
    def name(self) -> str:
        """Dotted name of the module; of a package its own."""
        parts = self.path.relative_to(self.root.parent).with_suffix("").parts
        return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)

    @property
    def layer_name(self) -> str:
        """First name of the module below the package; empty for its ``__init__``."""
        first = self.path.relative_to(self.root).parts[0].removesuffix(".py")
        return "" if first == "__init__" else first

    @cached_property
    def text(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text, filename=self.relative)

    @cached_property
    def statements(self) -> list[ast.AST]:
        """All statements, also those in functions and classes, without the expressions in them."""
        return [*_statements(self.tree)]

    @cached_property
    def imports(self) -> list[Import]:
        """All imports, in functions and for type checkers too."""
        package = self.path.relative_to(self.root.parent).parts[:-1]
        for_types = self._lines_for_types
        found = []
        for node in self.statements:
            names: list[str] = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = package[: len(package) - node.level + 1] if node.level else ()
                module = ".".join([*base, *([node.module] if node.module else [])])
                names = [name for alias in node.names for name in self._meant(module, alias.name)]
            found += [Import(name, node.lineno, node.lineno in for_types) for name in names]
        return found

    @property
    def _lines_for_types(self) -> set[int]:
        return {
            line
            for node in self.statements
            if isinstance(node, ast.If) and ast.unparse(node.test) in {"TYPE_CHECKING", "typing.TYPE_CHECKING"}
            for statement in node.body
            for line in range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)
        }

    def _meant(self, module: str, name: str) -> list[str]:
        """Modules that ``from a import b`` loads: a, unless that is a folder without code, and a.b if it is a module."""
        place = self.root.parent / module.replace(".", "/") / name
        if not (place.is_dir() or place.with_suffix(".py").is_file()):
            return [module]
        package = place.parent / "__init__.py"
        is_plain = package.is_file() and all(
            isinstance(one, ast.Expr) for one in ast.parse(package.read_text(encoding="utf-8")).body
        )
        return [f"{module}.{name}"] if is_plain else [module, f"{module}.{name}"]

    @cached_property
    def calls(self) -> list[tuple[str, int]]:
        """Calls with a plain dotted name, as ("click.echo", line)."""
        return [
            (ast.unparse(node.func), node.lineno)
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute)
        ]

    @property
    def has_functions(self) -> bool:
        """Whether the module has a function or method of its own."""
        return any(isinstance(node, ast.FunctionDef) for node in self.statements)

    @property
    def public_classes(self) -> list[str]:
        return [
            node.name for node in self.tree.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
        ]

    @property
    def code_lines(self) -> int:
        """Number of lines that are neither blank, nor docstring, nor comment, nor import."""
        lines = {
            number
            for token in tokenize.generate_tokens(io.StringIO(self.text).readline)
            if token.type not in _NO_CODE
            for number in range(token.start[0], token.end[0] + 1)
        }
        for node in ast.walk(self.tree):
            is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            if is_text or isinstance(node, ast.Import | ast.ImportFrom):
                lines -= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        return len(lines)

    @property
    def import_lines(self) -> int:
        nodes = [node for node in self.statements if isinstance(node, ast.Import | ast.ImportFrom)]
        return sum((node.end_lineno or node.lineno) - node.lineno + 1 for node in nodes)

    @property
    def comments_in_functions(self) -> int:
        """Number of comments inside functions, without those for linters and type checkers."""
        functions = [node for node in self.statements if isinstance(node, ast.FunctionDef)]
        inside = {line for node in functions for line in range(node.lineno, (node.end_lineno or 0) + 1)}
        return sum(
            token.type == tokenize.COMMENT and token.start[0] in inside and not re.match("# (noqa|type:)", token.string)
            for token in tokenize.generate_tokens(io.StringIO(self.text).readline)
        )

    @property
    def lines_with_any(self) -> int:
        """Number of lines that contain ``Any``."""
        return len({node.lineno for node in ast.walk(self.tree) if isinstance(node, ast.Name) and node.id == "Any"})


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Statements below a node, without the expressions in them, which are ten times as many."""
    for block in ("body", "orelse", "finalbody", "handlers", "cases"):
        for one in getattr(node, block, ()):
            yield one
            yield from _statements(one)


_NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


def modules_below(root: Path) -> list[Module]:
    """All modules of the package in ``root``."""
    return [Module(path, root) for path in sorted(root.rglob("*.py"))]
