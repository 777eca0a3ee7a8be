"""Kinds of faults: each that the package writes stands in the table, each of the table is written, and none is missing.

``PYTHONPATH=tests python -m structure.kinds base model/files`` lists the places in these folders that lack a kind.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from structure.modules import Module, modules_below
from structure.rules import Fault

ROOT = Path(__file__).parents[2]
TABLE = ROOT / "torsionnet" / "app" / "text" / "faults"
MADE_OF_MESSAGES = {
    *("Fault", "EntryError", "UsageError", "UnitError", "ModelError", "DampingError", "SolveError", "ExpressionError"),
    *("TemplateFolderError", "CutOffError", "LooseMotionError", "CompilerError", "ClusterError", "FaultyValueError"),
    *("fault", "refusal"),
}
"""Faults and errors that are made of a message and a kind, and methods that make them; those of a missing package have theirs by their class."""
PASSED_ON = {"fault", "faults", "found", "wrong", "errors", "error"}
"""Names of variables that hold faults that were made elsewhere, and are only raised."""


def kinds_faults(modules: list[Module]) -> Iterator[Fault]:
    """Faults of the kinds of faults in all modules."""
    from torsionnet.app.text.text_faults import fault_kinds

    table = fault_kinds()
    written: set[str] = set()
    for module in modules:
        if not module.relative.startswith("torsionnet/app/text/fixes/"):
            written |= {one.value for one in ast.walk(module.tree) if _is_text(one) and one.value in table}  # type: ignore[attr-defined]
        for line, name in _given_kinds(module):
            if name not in table:
                remedy = "add it to a file of torsionnet/app/text/faults, or take another kind"
                yield Fault(f"{module.relative}:{line}", f"the kind of fault {name} is not in the table", remedy)
    from torsionnet.base.errors import UNKNOWN_NAMES

    for name in sorted(UNKNOWN_NAMES - table.keys()):
        yield Fault("torsionnet/base/errors.py", f"the kind of fault {name} is not in the table", "add it there")
    for name in sorted(table.keys() - written - UNKNOWN_NAMES):
        place = f"torsionnet/app/text/faults/{table[name].group}.yaml"
        yield Fault(place, f"no fault has the kind {name}", "leave it out, or give it to the faults that are meant")
    for module in modules:
        for line, source in without_kind(module):
            remedy = "give it one of the table, which torsionnet explain lists"
            yield Fault(f"{module.relative}:{line}", f"a fault has no kind: {source[:60]}", remedy)


def _given_kinds(module: Module) -> Iterator[tuple[int, str]]:
    """Line and word of each kind that is given to a fault, or compared with that of one."""
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Call):
            given = [one.value for one in node.keywords if one.arg == "kind"]
        elif isinstance(node, ast.Compare) and ast.unparse(node.left).endswith("fault.kind"):
            given = node.comparators
        else:
            continue
        for value in given:
            for one in ast.walk(value):
                if _is_text(one) and "-" in one.value:  # type: ignore[attr-defined]
                    yield one.lineno, one.value  # type: ignore[attr-defined]


def without_kind(module: Module) -> Iterator[tuple[int, str]]:
    """Line and source of each fault or error that is made of a message without its kind."""
    functions = [one for one in ast.walk(module.tree) if isinstance(one, ast.FunctionDef)]
    texts = {one.name for one in functions if one.returns is not None and "str" in ast.unparse(one.returns)}
    for node in ast.walk(module.tree):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name | ast.Attribute):
            continue
        name = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
        if (
            name not in MADE_OF_MESSAGES
            or ast.unparse(node.func).startswith("click.")
            or any(one.arg in ("kind", None) for one in node.keywords)
            or not node.args
        ):
            continue
        within = [one for one in functions if one.lineno <= node.lineno <= (one.end_lineno or 0)]
        is_note = any(isinstance(one, ast.Constant) and one.value == "note" for one in ast.walk(node))
        if not is_note and (name == "Fault" or _is_message(node.args[0], within[-1] if within else module.tree, texts)):
            yield node.lineno, f"{ast.unparse(node)}{_said(node.args[0], within[-1] if within else module.tree)}"


def _is_message(node: ast.expr, within: ast.AST, texts: Collection[str]) -> bool:
    """Whether what an error is made of is a message, no fault that was made elsewhere."""
    if isinstance(node, ast.Constant | ast.JoinedStr | ast.BinOp):
        return not isinstance(node, ast.Constant) or isinstance(node.value, str)
    if isinstance(node, ast.IfExp):
        return _is_message(node.body, within, texts) or _is_message(node.orelse, within, texts)
    if isinstance(node, ast.Call):
        return ast.unparse(node.func).rpartition(".")[2] in {
            "phrase",
            "str",
            "join",
            "format",
            "joined",
            "extended",
            *texts,
        }
    if isinstance(node, ast.Name):
        if node.id in PASSED_ON:
            return False
        given = [
            one.value
            for one in ast.walk(within)
            if isinstance(one, ast.Assign) and any(ast.unparse(to) == node.id for to in one.targets)
        ]
        return _is_message(given[-1], within, texts) if given else True
    return False


def _said(node: ast.expr, within: ast.AST) -> str:
    """Message behind the name of a variable, for the list."""
    given = [
        ast.unparse(one.value)
        for one in ast.walk(within)
        if isinstance(one, ast.Assign) and any(ast.unparse(to) == ast.unparse(node) for to in one.targets)
    ]
    return f" with {' | '.join(given)}" if given else ""


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def main(folders: Iterable[str]) -> None:
    """Print the places below folders of the package whose faults lack a kind."""
    for module in modules_below(ROOT / "torsionnet"):
        if module.relative.startswith(tuple(f"torsionnet/{one}" for one in folders)):
            for line, source in without_kind(module):
                print(f"{module.relative}:{line}\t{source}")


if __name__ == "__main__":
    main(sys.argv[1:])
