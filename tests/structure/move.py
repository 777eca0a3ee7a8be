"""``make move OLD=... NEW=...``: move a module or folder, and rewrite all text that names it.

OLD and NEW are paths below ``torsionnet``; OLD alone is a file with one such pair a line, all moved at once. Imports in the
package, tests, examples and benchmarks follow, as do dotted names and paths in texts, the table of mutation among them.
The folder that a module moves to has an ``__init__.py`` already: the one sentence on what it holds.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

import libcst as cst

ROOT = Path(__file__).parents[2]
PACKAGE = "torsionnet"
TEXTS = {".py", ".pyi", ".md", ".toml", ".rst", ".txt", ""}
"""Endings of files in which modules are named."""
DONE = "moved".join("__")
"""Before names that are new already, until all are; put together, so that this file can be rewritten, too."""


def moves(pairs: Iterable[tuple[str, str]], root: Path) -> dict[str, str]:
    """Dotted names of the modules to be moved and their new names, a folder with everything below it.

    Raises
    ------
    SystemExit
        What is to be moved is missing, the new place is taken, or its folder has no ``__init__.py``.
    """
    found: dict[str, str] = {}
    for old, new in pairs:
        source = root / PACKAGE / old
        target = root / PACKAGE / new
        alone = source.with_suffix(".py").is_file()
        files = [source.with_suffix(".py")] if alone else sorted(source.rglob("*.py"))
        if not files or not files[0].is_file():
            raise SystemExit(f"there is no {PACKAGE}/{old}")
        if not (target.parent / "__init__.py").is_file():
            raise SystemExit(f"write {(target.parent / '__init__.py').relative_to(root)} first: what does it hold?")
        if target.with_suffix(".py").exists() or (target / "__init__.py").exists():
            raise SystemExit(f"there is a {PACKAGE}/{new} already")
        for file in files:
            below = Path() if alone else file.relative_to(source)
            found[dotted(file.relative_to(root))] = dotted((target / below).relative_to(root))
    return found


def dotted(path: Path) -> str:
    """Dotted name of a module from its path."""
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


class _SplitImports(cst.CSTTransformer):
    """Transformer that changes ``from a import b`` of a module b that moves into an import from its new place."""

    def __init__(self, names: Mapping[str, str]) -> None:
        super().__init__()
        self.names = names

    def leave_SimpleStatementLine(
        self, original_node: cst.SimpleStatementLine, updated_node: cst.SimpleStatementLine
    ) -> cst.BaseStatement | cst.FlattenSentinel[cst.BaseStatement]:
        from libcst.helpers import get_full_name_for_node

        del original_node
        (statement, *others) = updated_node.body
        if others or not isinstance(statement, cst.ImportFrom) or isinstance(statement.names, cst.ImportStar):
            return updated_node
        base = get_full_name_for_node(statement.module) if statement.module else None
        moving = [alias for alias in statement.names if f"{base}.{alias.name.value}" in self.names]
        if not moving:
            return updated_node
        staying = [
            alias.with_changes(comma=cst.MaybeSentinel.DEFAULT) for alias in statement.names if alias not in moving
        ]
        lines = [updated_node.with_changes(body=[statement.with_changes(names=staying)])] if staying else []
        return cst.FlattenSentinel([*lines, *(self._line(f"{base}.{alias.name.value}", alias) for alias in moving)])

    def _line(self, old: str, alias: cst.ImportAlias) -> cst.SimpleStatementLine:
        package, _, name = self.names[old].rpartition(".")
        used = alias.evaluated_alias or alias.evaluated_name
        shown = name if used == name else f"{name} as {used}"
        line = cst.parse_statement(f"from {DONE}{package} import {shown}")
        assert isinstance(line, cst.SimpleStatementLine)
        return line


def rewritten(text: str, names: Mapping[str, str], *, code: bool, offered: Collection[str] = ()) -> str:
    """Text in which moved modules have their new names, dotted or as paths.

    ``offered`` are those whose name their package gives to something else: ``from torsionnet.plot import schematic`` is
    a function, whatever file it comes from.

    Examples
    --------
    >>> names = {"torsionnet.first.b": "torsionnet.first.c.b"}
    >>> print(rewritten("from torsionnet.first import a, b", names, code=True))
    from torsionnet.first import a
    from torsionnet.first.c import b
    >>> rewritten("see first/b.py", names, code=False)
    'see first/c/b.py'
    """
    plain = {old: new for old, new in names.items() if old not in offered}
    if not any(old.rpartition(".")[2] in text for old in names):
        return text
    packages = {old.rpartition(".")[::2] for old in plain}
    if code and any(name in text and f"from {package} import " in text for package, name in packages):
        text = cst.parse_module(text).visit(_SplitImports(plain)).code
    dots = {old: r"(?!\w)" if old in plain else r"(?=\.\w| import )" for old in names}
    text = _replaced(text, names, r"(?<![\w.])", dots).replace(DONE, "")
    paths = {old.replace(".", "/"): new.replace(".", "/") for old, new in names.items()}
    text = _replaced(text, paths, r"(?<![\w/])", dict.fromkeys(paths, r"(?![\w/])"))
    short = {old.partition("/")[2]: new.partition("/")[2] for old, new in paths.items()}
    return _replaced(text, short, r"(?<![\w/.])", {old: r"(?=\.py\b)" for old in short if "/" in old})


def _replaced(text: str, pairs: Mapping[str, str], before: str, after: Mapping[str, str]) -> str:
    """Text with all names replaced in one pass, the longest first, so that nothing is replaced twice."""
    words = "|".join(re.escape(old) + after[old] for old in sorted(after, key=len, reverse=True))
    return re.sub(f"{before}(?:{words})", lambda found: pairs[found[0]], text) if words else text


def move(pairs: Iterable[tuple[str, str]], root: Path = ROOT) -> None:
    """Rewrite everything that names the modules, and move their files by git."""
    names = moves(pairs, root)
    offered = [old for old in names if _is_offered(*old.rpartition(".")[::2], root)]
    for path in texts(root):
        before = path.read_text(encoding="utf-8")
        after = rewritten(before, names, code=path.suffix in {".py", ".pyi"}, offered=offered)
        if after != before:
            path.write_text(after, encoding="utf-8")
    for old, new in names.items():
        source, target = root / old.replace(".", "/"), root / new.replace(".", "/")
        if source.with_suffix(".py").is_file():
            source, target = source.with_suffix(".py"), target.with_suffix(".py")
        else:
            source, target = source / "__init__.py", target / "__init__.py"
        target.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(["git", "mv", str(source), str(target)], cwd=root, check=True)


def _is_offered(package: str, name: str, root: Path) -> bool:
    """Whether a package imports a name or has it in its table of public names."""
    tree = ast.parse((root / package.replace(".", "/") / "__init__.py").read_text(encoding="utf-8"))
    imported = (node for node in tree.body if isinstance(node, ast.ImportFrom))
    tables = (node for node in ast.walk(tree) if isinstance(node, ast.Dict))
    names = {alias.asname or alias.name for node in imported for alias in node.names}
    return name in names | {key.value for table in tables for key in table.keys if isinstance(key, ast.Constant)}


def texts(root: Path) -> Iterator[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=root, check=True, capture_output=True, text=True
    ).stdout
    for name in listed.splitlines():
        path = root / name
        if path.suffix in TEXTS and path.is_file() and not path.is_symlink():
            yield path


if __name__ == "__main__":
    match sys.argv[1:]:
        case [table]:
            move([tuple(line.split()) for line in Path(table).read_text("utf-8").splitlines() if line.strip()])
        case [old, new]:
            move([(old, new)])
        case _:
            sys.exit(__doc__)
