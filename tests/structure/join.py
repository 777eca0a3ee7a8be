"""``make join OLD=... INTO=...``: join a module with the only one that imports it; without OLD and INTO, list
candidates.

OLD and INTO are paths below ``torsionnet``, and INTO is alone in importing OLD. Its constants go to the constants,
its definitions behind those of INTO, or before the first that needs one while it is imported; a function that is used
there alone gets an underscore.
Everything that names OLD names INTO then: package, tests, docs, the table of mutation. The sentences that OLD began with
are printed: what they say and INTO does not is for whoever joins to write down, as is whether the two are one thing at all.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import libcst as cst

from structure.modules import Module, modules_below
from structure.move import PACKAGE, ROOT, dotted, rewritten, texts

MOST_LINES = 250
"""Lines that two modules may have together."""
FUTURE = "from __future__ import annotations"
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


def candidates(modules: Sequence[Module]) -> Iterator[tuple[Module, Module]]:
    """Pairs of a module and the only one that imports it, in the same folder, at the top, and both short."""
    known = {module.name: module for module in modules}
    users: dict[str, set[str]] = {name: set() for name in known}
    for module in modules:
        for name in {found.name for found in module.imports} & known.keys() - {module.name}:
            users[name].add(module.name)
    for name, (user, *others) in ((name, sorted(found)) for name, found in users.items() if found):
        old, into = known[name], known[user]
        apart = old.path.parent != into.path.parent or "__" in old.path.stem + into.path.stem
        if others or apart or _lines(old) + _lines(into) >= MOST_LINES or old.layer_name == old.path.stem:
            continue
        if not _imported_later(old, into):
            yield old, into


def _lines(module: Module) -> int:
    return len(module.text.splitlines())


def _imported_later(old: Module, into: Module) -> bool:
    """Whether a module is imported in a function or for type checkers alone, to start up faster."""
    top = {line for node in _runtime(into.tree) for line in range(node.lineno, (node.end_lineno or 0) + 1)}
    return any(found.name == old.name and found.line not in top for found in into.imports)


def _is_import(node: ast.stmt) -> bool:
    return isinstance(node, ast.Import | ast.ImportFrom)


def _runtime(tree: ast.Module) -> list[ast.Import | ast.ImportFrom]:
    return [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]


def _type_blocks(tree: ast.Module) -> list[ast.If]:
    return [node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]


def _for_types(tree: ast.Module) -> list[ast.Import | ast.ImportFrom]:
    inside = (one for block in _type_blocks(tree) for one in block.body)
    return [one for one in inside if isinstance(one, ast.Import | ast.ImportFrom)]


def _body(tree: ast.Module) -> list[ast.stmt]:
    """Statements of a module behind docstring and imports."""
    rest = [node for node in tree.body if not _is_import(node) and node not in _type_blocks(tree)]
    return rest[1:] if rest and ast.get_docstring(tree) is not None else rest


def _bound(nodes: Iterable[ast.stmt]) -> set[str]:
    """Names that statements at the top of a module assign or define."""
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, _DEFINITIONS):
            found.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        else:
            found |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    return found


def _parts(module: Module) -> tuple[str, str]:
    """Source behind the imports with its comments: constants, and the rest."""
    lines, body = module.text.splitlines(keepends=True), _body(module.tree)
    top = [*_runtime(module.tree), *_type_blocks(module.tree)]
    late = {number for node in top for number in range(node.lineno, (node.end_lineno or 0) + 1)}
    start = _start(lines, body[0])
    split = next((_start(lines, node) for node in body if isinstance(node, _DEFINITIONS)), len(lines))
    kept = [(at, line) for at, line in enumerate(lines[start:], start) if at + 1 not in late]
    parts = ([line for at, line in kept if at < split], [line for at, line in kept if at >= split])
    return "".join(parts[0]).strip("\n") + "\n", "".join(parts[1]).strip("\n") + "\n"


def _start(lines: Sequence[str], node: ast.stmt) -> int:
    """First line of a statement, counted from 0, with its decorators and comments right above."""
    decorators: list[ast.expr] = getattr(node, "decorator_list", [])
    above = min([node.lineno, *(one.lineno for one in decorators)]) - 1
    while above and lines[above - 1].startswith("#"):
        above -= 1
    return above


def _needed_at_import(body: Sequence[ast.stmt], names: set[str]) -> ast.stmt | None:
    """First statement that needs one of the names while the module is imported, as a base, a decorator, a constant."""
    inside = {
        node.name: {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
        for node in body
        if isinstance(node, _DEFINITIONS)
    }
    for node in body:
        reached, new = set(names) - names, set(_evaluated(node))
        while new:
            reached |= new
            new = set().union(*(inside.get(name, set()) for name in new)) - reached
        if reached & names:
            return node
    return None


def _evaluated(node: ast.AST) -> Iterator[str]:
    """Names that are looked up when a statement is executed: not in functions, and not in annotations."""
    for field, value in ast.iter_fields(node):
        if field in {"annotation", "returns"} or (
            field == "body" and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        ):
            continue
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, ast.Name):
                yield one.id
            elif isinstance(one, ast.AST):
                yield from _evaluated(one)


def joined(old: Module, into: Module) -> str:
    """Source of the module that OLD and INTO become together; imports are left for ruff to sort.

    Raises
    ------
    SystemExit
        OLD is imported by a function, for types alone or under another name, or both give something to one name.
    """
    if _imported_later(old, into):
        raise SystemExit(f"{into.relative} does without {old.name} until it is used, which is quicker to start")
    ours = [node for node in _runtime(into.tree) if _comes_from(node, old)]
    if any(alias.asname not in (None, old.path.stem) for node in ours for alias in node.names):
        raise SystemExit(f"{into.relative} uses other names for what it imports from {old.name}")
    if any(not _is_import(one) for module in (old, into) for block in _type_blocks(module.tree) for one in block.body):
        raise SystemExit("there is more than imports for type checkers alone")
    there = (_bound(into.tree.body) | _bound(_for_types(into.tree))) - _bound(ours)
    brought = _bound([*_runtime(old.tree), *_for_types(old.tree)])
    if same := (_bound(_body(old.tree)) & there) | (brought & _bound(_body(into.tree))):
        raise SystemExit(f"both {old.relative} and {into.relative} say what {', '.join(sorted(same))} is")
    lines = into.text.splitlines(keepends=True)
    if any(_source(node) != old.name for node in ours):
        lines = [re.sub(rf"(?<![\w.]){old.path.stem}\.(?=[A-Za-z_])", "", line) for line in lines]
    body, constants, definitions = _body(into.tree), *_parts(old)
    needing = _needed_at_import(body, _bound(_body(old.tree)) | {old.path.stem})
    at = _start(lines, needing) if needing else len(lines)
    first = next((_start(lines, node) for node in body if isinstance(node, _DEFINITIONS)), len(lines))
    lines[at:at] = ["\n\n", definitions, "\n\n"]
    lines[min(first, at) : min(first, at)] = ["\n", constants, "\n\n"]
    for node in reversed(ours):
        kept = [alias.name for alias in node.names if f"{_source(node)}.{alias.name}" != old.name]
        others = (
            [f"from {_source(node)} import {', '.join(kept)}\n"] if kept and _source(node) not in ("", old.name) else []
        )
        lines[node.lineno - 1 : node.end_lineno] = others
    return _with_imports("".join(lines), old)


def _source(node: ast.Import | ast.ImportFrom) -> str:
    return (node.module or "") if isinstance(node, ast.ImportFrom) else ""


def _comes_from(node: ast.Import | ast.ImportFrom, old: Module) -> bool:
    names = [alias.name for alias in node.names]
    return old.name in (_source(node), *names, *(f"{_source(node)}.{name}" for name in names))


def _with_imports(text: str, old: Module) -> str:
    """Source with the imports of the other module added, those for type checkers in one block."""
    tree = ast.parse(text)
    there = _single(_runtime(tree))
    anyway = there | _single(_runtime(old.tree))
    types = (_single(_for_types(tree)) | _single(_for_types(old.tree))) - anyway
    lines = text.splitlines(keepends=True)
    docstring = tree.body[0].end_lineno or 0 if ast.get_docstring(tree) is not None else 0
    new = anyway - there - {FUTURE} | ({"from typing import TYPE_CHECKING"} if types else set())
    block = ["if TYPE_CHECKING:\n", *(f"    {line}\n" for line in sorted(types)), "\n"] if types else []
    at = max((node.end_lineno or 0 for node in _runtime(tree)), default=docstring)
    for old_block in reversed(_type_blocks(tree)):
        del lines[old_block.lineno - 1 : old_block.end_lineno]
    lines[at:at] = [*(f"{line}\n" for line in sorted(new)), "\n", *block]
    lines[docstring:docstring] = [f"{FUTURE}\n"] if FUTURE in anyway - there else []
    return "".join(lines)


def _single(nodes: Iterable[ast.Import | ast.ImportFrom]) -> set[str]:
    """Imports of one name each."""
    found: set[str] = set()
    for node in nodes:
        source = f"from {_source(node)} " if isinstance(node, ast.ImportFrom) else ""
        found |= {f"{source}import {ast.unparse(alias)}" for alias in node.names}
    return found


def inner(text: str, names: Iterable[str], elsewhere: str) -> str:
    """Source in which names that no other module uses begin with an underscore.

    Examples
    --------
    >>> both = "def half(x): return x / 2\\n\\ndef quarter(x): return half(half(x))"
    >>> print(inner(both, ["half", "quarter"], "from halves import quarter"))
    def _half(x): return x / 2
    <BLANKLINE>
    def quarter(x): return _half(_half(x))
    """
    tree = ast.parse(text)
    taken = _bound(tree.body) | {f"_{name}" for name in _local(tree)}
    alone = [name for name in names if not name.startswith("_") and f"_{name}" not in taken]
    alone = [name for name in alone if not re.search(rf"\b{name}\b", elsewhere)]
    return cst.parse_module(text).visit(_Underscores({name: f"_{name}" for name in alone})).code


def _local(tree: ast.Module) -> Iterator[str]:
    """Names that are also arguments, attributes or local variables."""
    for node in ast.walk(tree):
        if isinstance(node, ast.arg | ast.keyword):
            yield node.arg or ""
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            inside = [one for part in node.body for one in ast.walk(part)]
            yield from (one.id for one in inside if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store))
            yield from (one.name for one in inside if isinstance(one, _DEFINITIONS))


class _Underscores(cst.CSTTransformer):
    """Transformer that puts underscores before names, in the examples of docstrings too."""

    def __init__(self, names: Mapping[str, str]) -> None:
        super().__init__()
        self.names = names

    def leave_Name(self, original_node: cst.Name, updated_node: cst.Name) -> cst.Name:
        del original_node
        return updated_node.with_changes(value=self.names.get(updated_node.value, updated_node.value))

    def leave_SimpleString(self, original_node: cst.SimpleString, updated_node: cst.SimpleString) -> cst.SimpleString:
        del original_node
        lines = updated_node.value.splitlines(keepends=True)
        for at, line in enumerate(lines):
            if re.match(r"\s*(>>>|\.\.\.) ", line):
                lines[at] = re.sub(r"(?<![\w.])\w+", lambda found: self.names.get(found[0], found[0]), line)
        return updated_node.with_changes(value="".join(lines))


def join(old: str, into: str, root: Path = ROOT) -> str:
    """Join a module into another, rewrite all text that names it, and print its docstring."""
    known = {module.name: module for module in modules_below(root / PACKAGE)}
    one, other = (known.get(dotted(Path(PACKAGE) / name)) for name in (old, into))
    if one is None or other is None:
        raise SystemExit(f"there is no {PACKAGE}/{into if one else old}")
    saying = [module for module in known.values() if one.path.stem in module.text]
    users = {module.name for module in saying for found in module.imports if found.name == one.name}
    if users != {other.name}:
        raise SystemExit(f"{one.relative} is imported by {', '.join(sorted(users)) or 'none'}")
    names = {one.name: other.name}
    read = {path: path.read_text(encoding="utf-8") for path in texts(root) if path not in (one.path, other.path)}
    new = {path: rewritten(text, names, code=path.suffix in {".py", ".pyi"}) for path, text in read.items()}
    public = _bound(node for node in _body(one.tree) if isinstance(node, ast.FunctionDef))
    text = rewritten(joined(one, other), names, code=False)
    both = inner(text, sorted(public), "\n".join(_naming(other, new.values())))
    for path in (path for path in new if new[path] != read[path]):
        path.write_text(new[path], encoding="utf-8")
    other.path.write_text(both, encoding="utf-8")
    one.path.unlink()
    return ast.get_docstring(one.tree) or ""


def _naming(module: Module, found: Iterable[str]) -> list[str]:
    """Paths of the texts that name a module."""
    package, _, name = module.name.rpartition(".")
    dots, short = re.escape(module.name), rf"from {re.escape(package)} import[^()\n]*\b{name}\b"
    named = re.compile(rf"{dots}\b|{short}|import \([^)]*\b{name}\b")
    return [text for text in found if name in text and named.search(text)]


if __name__ == "__main__":
    match sys.argv[1:]:
        case []:
            for one, other in candidates(modules_below(ROOT / PACKAGE)):
                print(f"{one.relative} ({_lines(one)} lines) into {other.path.name} ({_lines(other)})")
        case [old, into]:
            print(join(old, into))
        case _:
            sys.exit(__doc__)
