"""``make join PLAN=file``: join modules into files of one subject, and rewrite all text that names them.

A line of the plan is ``target = member member ... | First sentence.``; paths are below the folder that a line ``@folder``
above names, and the last part may be missing. The first member gives the docstring, what the others began with stands
above their parts, and in the docstring of the file if more follows on it. Members stand in the order in which they import
each other. A private function that two members define alike stays once; names that mean two things are refused, as are
circles of imports: both are for whoever joins to mend.
"""

from __future__ import annotations

import ast
import re
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from structure.measures import circles
from structure.modules import Module, modules_below
from structure.move import PACKAGE, ROOT, dotted, rewritten, texts

FUTURE = "from __future__ import annotations"
WIDTH = 118
"""Columns of a comment behind its sign."""


class Join(NamedTuple):
    """File to be made, the modules that it is made of, the main one first, and its first sentence if it is a new one."""

    target: str
    members: tuple[str, ...]
    sentence: str


def read_plan(text: str) -> list[Join]:
    """Files that a plan asks for.

    >>> read_plan("@motion\\ncourses = exact torques | Courses of torques.")
    [Join(target='torsionnet.motion.courses', members=('torsionnet.motion.exact', 'torsionnet.motion.torques'), \
sentence='Courses of torques.')]
    """
    folder, found = Path(PACKAGE), []
    for line in text.splitlines():
        if line.startswith("@"):
            folder = Path(PACKAGE) / line[1:].strip()
        elif line.strip():
            files, _, sentence = line.partition("|")
            target, _, members = files.partition("=")
            names = tuple(dotted(_plain(folder / member)) for member in members.split())
            found.append(Join(dotted(_plain(folder / target.strip())), names, sentence.strip()))
    return found


def _plain(path: Path) -> Path:
    """Path without ``..``."""
    parts: list[str] = []
    for part in path.parts:
        parts = parts[:-1] if part == ".." else [*parts, part]
    return Path(*parts)


@dataclass(frozen=True)
class Member:
    """Module that becomes part of a file, with ``inside``, the names of all modules of that file."""

    module: Module
    inside: frozenset[str]

    @cached_property
    def top(self) -> list[ast.Import | ast.ImportFrom]:
        """Imports when the module is."""
        return [node for node in self.module.tree.body if isinstance(node, ast.Import | ast.ImportFrom)]

    @cached_property
    def for_types(self) -> list[ast.If]:
        """Blocks for type checkers that hold imports alone."""
        return [
            node
            for node in self.module.tree.body
            if isinstance(node, ast.If)
            and ast.unparse(node.test) == "TYPE_CHECKING"
            and all(isinstance(one, ast.Import | ast.ImportFrom) for one in node.body)
        ]

    @cached_property
    def needs(self) -> set[str]:
        """Other members of the file that have to stand before this one."""
        return {source for node in self.top for source in _sources(node)} & self.inside - {self.module.name}

    @cached_property
    def defined(self) -> dict[str, str]:
        """Names that the module defines at its top, with the source of each."""
        found = {}
        for node in self.module.tree.body:
            for name in _bound(node):
                found[name] = ast.unparse(node)
        return found

    @cached_property
    def imports(self) -> dict[str, str]:
        """Imports of one name each from outside the file, by the name that they bind."""
        return _single(self.top, self.inside)

    @cached_property
    def type_imports(self) -> dict[str, str]:
        return _single((one for block in self.for_types for one in block.body), self.inside)

    def body(self, left_out: Iterable[str], renamed: Mapping[str, str]) -> str:
        """Source behind docstring and imports, without imports from the file and definitions that it has already."""
        tree, lines = self.module.tree, self.module.text.splitlines()
        gone = [*self.top, *self.for_types]
        if ast.get_docstring(tree) is not None:
            gone.append(tree.body[0])
        gone += [node for node in tree.body if set(_bound(node)) & set(left_out)]
        kept: dict[int, str] = {}
        elsewhere = [*self.top, *(one for block in self.for_types for one in block.body)]
        for node in ast.walk(tree):
            # A name that a function imports from the file is there anyway.
            if isinstance(node, ast.ImportFrom) and node not in elsewhere:
                inside = [alias for alias in node.names if _comes_from(node, alias) & self.inside]
                if inside:
                    rest = [ast.unparse(alias) for alias in node.names if alias not in inside]
                    gone.append(node)
                    if rest:
                        kept[node.lineno] = f"{' ' * node.col_offset}from {node.module} import {', '.join(rest)}"
        dropped = {number for node in gone for number in range(_first_line(node), (node.end_lineno or 0) + 1)}
        # What stands below a constant to describe it goes with it.
        for before, node in zip(tree.body, tree.body[1:], strict=False):
            if before in gone and set(_bound(before)) & set(left_out) and _is_text(node):
                dropped |= set(range(node.lineno, (node.end_lineno or 0) + 1))
        source = "\n".join(
            kept.get(number, line) for number, line in enumerate(lines, 1) if number not in dropped or number in kept
        )
        for name in self._module_names:
            source = re.sub(rf"(?<![\w.]){name}\.(?=[A-Za-z_])", "", source)
        for old, new in renamed.items():
            source = re.sub(rf"(?<![\w.\"'`]){old}\b(?!=[^=])", new, source)
        return source.strip("\n")

    @cached_property
    def _module_names(self) -> set[str]:
        """Names by which other modules of the file are used as modules."""
        nodes = [node for node in ast.walk(self.module.tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        whole = [(alias, f"{getattr(node, 'module', '')}.{alias.name}") for node in nodes for alias in node.names]
        return {alias.asname or alias.name for alias, name in whole if name.strip(".") in self.inside}

    @cached_property
    def faults(self) -> list[str]:
        """Imports from the file by other names, which a join cannot follow."""
        nodes = [node for node in ast.walk(self.module.tree) if isinstance(node, ast.ImportFrom)]
        return [
            f"{self.module.relative}:{node.lineno}: imports {alias.name} as {alias.asname}"
            for node in nodes
            for alias in node.names
            if node.module in self.inside and alias.asname not in (None, alias.name)
        ]


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _first_line(node: ast.stmt) -> int:
    return min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", []))])


def _sources(node: ast.Import | ast.ImportFrom) -> set[str]:
    return {source for alias in node.names for source in _comes_from(node, alias)}


def _comes_from(node: ast.Import | ast.ImportFrom, alias: ast.alias) -> set[str]:
    """Modules that one name of an import may be, or come from."""
    return {alias.name} if isinstance(node, ast.Import) else {node.module or "", f"{node.module}.{alias.name}"}


def _bound(node: ast.stmt) -> list[str]:
    """Names that a statement at the top of a module assigns or defines."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Assign | ast.AnnAssign | ast.For):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        return [one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)]
    return []


def _single(nodes: Iterable[ast.stmt], inside: frozenset[str]) -> dict[str, str]:
    found = {}
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            for alias in node.names:
                if not _comes_from(node, alias) & inside:
                    source = f"from {node.module} " if isinstance(node, ast.ImportFrom) else ""
                    found[alias.asname or alias.name] = f"{source}import {ast.unparse(alias)}"
    return found


def in_order(members: Sequence[Member]) -> list[Member]:
    """Members, each behind those that it needs; else in the order of the plan."""
    left, placed = list(members), []
    while left:
        waiting = {one.module.name for one in left}
        free = next((one for one in left if not one.needs & waiting), None)
        if free is None:
            raise SystemExit(f"{', '.join(sorted(waiting))} import each other")
        placed.append(free)
        left.remove(free)
    return placed


@dataclass(frozen=True)
class Joined:
    """Members of one file in their order, with the main one and the first sentence if it is new."""

    main: Member
    members: Sequence[Member]
    sentence: str

    @cached_property
    def repeated(self) -> dict[str, set[str]]:
        """By member, names that a member before it defines in the same words."""
        found: dict[str, set[str]] = {}
        there: dict[str, str] = {}
        for member in self.members:
            found[member.module.name] = {name for name, source in member.defined.items() if there.get(name) == source}
            there = member.defined | there
        return found

    @cached_property
    def faults(self) -> list[str]:
        """Names that mean two things, each with the modules."""
        homes: dict[str, dict[str, list[str]]] = {}
        for member in self.members:
            bound = member.defined | member.type_imports | member.imports
            for name, meaning in bound.items():
                homes.setdefault(name, {}).setdefault(meaning, []).append(member.module.path.stem)
        twice = [
            f"{self.main.module.relative}: {name} is two things, in {' and '.join(', '.join(of) for of in meanings.values())}"
            for name, meanings in homes.items()
            if len(meanings) > 1 and not name.startswith("_")
        ]
        return twice + [fault for member in self.members for fault in member.faults]

    @cached_property
    def renamed(self) -> dict[str, dict[str, str]]:
        """By member, private names that another member before it, or the main one, has for something else."""
        found: dict[str, dict[str, str]] = {}
        there: dict[str, str] = dict(self.main.defined)
        for member in self.members:
            found[member.module.name] = {
                name: f"_{member.module.path.stem}{name}"
                for name, source in member.defined.items()
                if name.startswith("_") and member is not self.main and there.get(name, source) != source
            }
            there = member.defined | there
        return found

    def text(self) -> str:
        doc = ast.get_docstring(self.main.module.tree, clean=False) or ""
        if self.sentence:
            doc = self.sentence + "".join(re.findall(r"\n\n.*", doc, re.DOTALL))
        rest = [
            "\n\n" + more.strip("\n")
            for member in self.members
            if member is not self.main
            for more in [ast.get_docstring(member.module.tree) or ""]
            if "\n\n" in more
        ]
        doc = doc.rstrip("\n") + "".join(rest)
        imports: dict[str, None] = {}
        types: dict[str, None] = {}
        for member in self.members:
            imports |= dict.fromkeys(member.imports.values())
            types |= dict.fromkeys(member.type_imports.values())
        types = {line: None for line in types if line not in imports}
        lines = [line for line in imports if line != FUTURE]
        block = ["if TYPE_CHECKING:", *(f"    {line}" for line in types), ""] if types else []
        end = "\n" if "\n" in doc else ""
        head = [f'"""{doc}{end}"""', "", FUTURE, "", *lines, "", *block]
        return "\n".join(head) + "\n\n" + "\n\n\n".join(self._parts()) + "\n"

    def _parts(self) -> Iterator[str]:
        for member in self.members:
            name = member.module.name
            source = member.body(self.repeated[name], self.renamed[name])
            if member is self.main and not self.sentence:
                yield source
            elif source:
                said = (ast.get_docstring(member.module.tree) or "").partition("\n\n")[0].replace("\n", " ")
                comment = textwrap.fill(said, WIDTH, initial_indent="# ", subsequent_indent="# ")
                yield f"{comment}\n\n{source}"


def join(plan: Sequence[Join], root: Path = ROOT) -> list[str]:
    """Join modules as planned and rewrite all text that names them; nothing is changed where there are faults.

    Returns
    -------
    list of str
        Faults.
    """
    modules = modules_below(root / PACKAGE)
    known = {module.name: module for module in modules}
    files, faults = {}, []
    for target, names, sentence in plan:
        if missing := [name for name in names if name not in known]:
            faults.append(f"{target}: there is no {', '.join(missing)}")
            continue
        members = [Member(known[name], frozenset(names)) for name in names]
        if target in known and target not in names:
            faults.append(f"{target}: there is such a file already")
        files[target] = Joined(members[0], in_order(members), sentence)
        faults += files[target].faults
    homes = {name: target for target, names, _ in plan for name in names if name != target}
    faults += [f"a circle of imports: {', '.join(part)}" for part in circles(modules, homes)]
    if faults:
        return faults
    written = {target: rewritten(file.text(), homes, code=True) for target, file in files.items()}
    gone = {known[name].path for _, names, _ in plan for name in names}
    for path in texts(root):
        if path not in gone:
            before = path.read_text(encoding="utf-8")
            after = rewritten(before, homes, code=path.suffix in {".py", ".pyi"})
            if after != before:
                path.write_text(after, encoding="utf-8")
    for path in gone:
        path.unlink()
    for target, text in written.items():
        (root / f"{target.replace('.', '/')}.py").write_text(text, encoding="utf-8")
    return []


if __name__ == "__main__":
    told = join(read_plan(Path(sys.argv[1]).read_text("utf-8")))
    sys.exit("\n".join(told) or 0)
