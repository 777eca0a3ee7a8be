"""Words of public arguments and of options: where each is used, and the page that lists them from ``words.yaml``."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache, cached_property
from inspect import Parameter, signature
from pathlib import Path
from typing import Any

import click
import yaml
from page_parts import code, table
from public_names import public_names

from torsionnet.app.cli.app import COMMANDS, app
from torsionnet.base.packages import LazyMethod

MOST_PLACES = 3
"""Places that are named in the table; of more it says how many."""
SOURCE = Path(__file__).parent / "words.yaml"
OF_ENTRIES = {
    *("Drivetrain.from_matrices", "Drivetrain.with_part", "report.make_report", "report.write_report", "study.define"),
    *("write_report",),
}
"""Functions whose arguments are entries of a section of a file, each with the name that it has there."""
PATHS, ARRAYS = {"str", "PathLike", "Path"}, {"ArrayLike", "FloatArray", "NDArray", "ComplexArray"}
CONTAINERS = {"Sequence", "Iterable", "Iterator", "Collection", "tuple", "list", "set", "Literal"}
KINDS = {
    **dict.fromkeys(("int", "float", "complex", "Number"), "number"),
    **dict.fromkeys(ARRAYS | {"NumberRows"}, "array"),
    **dict.fromkeys(PATHS | {"Channels", "Names"}, "text"),
    "bool": "flag",
    "Mapping": "mapping",
    "dict": "mapping",
}
"""Kinds of values that arguments take, by the names of types; of other types the name itself."""


def uses() -> Iterator[tuple[str, str, set[str]]]:
    """Words of arguments and options, each with where it is used and the kinds of values that it takes there."""
    for one in public_names():
        name = one.name.removeprefix("torsionnet.")
        members = one.members.items() if one.is_class else ()
        functions = [(f"{name}.{member}", value) for member, value in members]
        if not one.is_class and callable(one.value):
            functions = [(name, one.value)]
        for place, function in functions:
            if place not in OF_ENTRIES:
                yield from ((word, f"{place}()", kinds) for word, kinds in _arguments(function))
    for command in COMMANDS:
        for option in app.get_command(click.Context(app), command).params:  # type: ignore[union-attr]
            if isinstance(option, click.Option):
                word = max(option.opts, key=len).removeprefix("--").replace("-", "_")
                yield word, f"torsionnet {command}", {_option_kind(option)}


def _arguments(function: Any) -> Iterator[tuple[str, set[str]]]:
    """Names of the arguments of a public function or method, each with the kinds of values that it takes."""
    found = function.__get__(None) if isinstance(function, LazyMethod) else getattr(function, "__func__", function)
    if isinstance(function, property | cached_property) or not callable(found):
        return
    own = Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD
    for number, (name, one) in enumerate(signature(found).parameters.items()):
        if name in {"self", "cls"} or name.startswith("_") or (isinstance(function, LazyMethod) and not number):
            continue
        if one.kind not in own:
            yield name, kinds_of(str(one.annotation))


def kinds_of(annotation: str) -> set[str]:
    """Kinds of values that a type stands for, without containers and None.

    >>> sorted(kinds_of("str | Sequence[str] | None")), sorted(kinds_of("Mapping[str, float] | ArrayLike"))
    (['text'], ['array', 'mapping'])
    """
    return set(_kinds(ast.parse(annotation, mode="eval").body))


def _kinds(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.BinOp):
        yield from (*_kinds(node.left), *_kinds(node.right))
    elif isinstance(node, ast.Subscript):
        name = ast.unparse(node.value).rpartition(".")[2]
        inner = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if name == "type":
            yield "type"
        elif name in CONTAINERS:
            yield from (kind for one in inner for kind in _kinds(one))
        else:
            yield KINDS.get(name, name)
    elif isinstance(node, ast.Constant):
        yield from ["text"] * isinstance(node.value, str)
    else:
        name = ast.unparse(node).rpartition(".")[2]
        yield KINDS.get(name, name)


def _option_kind(option: click.Option) -> str:
    """Kind of value of an option: what stands behind it in the help, or flag, number, choice."""
    if option.is_flag:
        return "flag"
    if isinstance(option.type, click.Choice):
        return "choice"
    if option.metavar:
        return option.metavar
    name = option.type.name
    return "number" if name.startswith(("float", "integer")) else name


@cache
def words() -> dict[str, dict[str, Any]]:
    """Lines of ``words.yaml``: meaning, unit and kinds of values of each word."""
    return dict(yaml.safe_load(SOURCE.read_text(encoding="utf-8")))


def words_page() -> str:
    """Table of all words in use, with the places that use them, or how many do."""
    places: dict[str, list[str]] = {}
    for word, place, _ in uses():
        places.setdefault(word, []).append(place)
    rows = [
        [code(word), words()[word]["means"], str(words()[word].get("unit", "")), _shown(found)]
        for word, found in sorted(places.items())
        if word in words()
    ]
    return table(["word", "meaning", "unit", "used by"], rows)


def _shown(places: list[str]) -> str:
    if len(places) <= MOST_PLACES:
        return ", ".join(map(code, places))
    commands = sum(place.startswith("torsionnet ") for place in places)
    counts = (len(places) - commands, "functions"), (commands, "commands")
    return ", ".join(f"{count} {what}" for count, what in counts if count)


def faults() -> Iterator[tuple[str, str, str]]:
    """Place, fault and remedy of words that the table lacks, that have a second meaning, or that mean the same."""
    known = words()
    for word, place, kinds in uses():
        if word not in known:
            line = f"{word}: {{means: ..., unit: ..., takes: [{', '.join(sorted(kinds))}]}}"
            yield place, f"`{word}` is no word of docs/words.yaml", f"use a word that is there, or add: {line}"
        elif other := kinds - {*known[word]["takes"]}:
            taken = f"`{word}` takes {', '.join(sorted(other))} here, {', '.join(known[word]['takes'])} elsewhere"
            remedy = f'if it still means "{known[word]["means"]}", add that to `takes` in docs/words.yaml; else rename'
            yield place, taken, remedy
    lines = re.findall(r"^'?(\w+)'?:", SOURCE.read_text(encoding="utf-8"), re.MULTILINE)
    meanings = [one["means"] for one in known.values()]
    for word, one in known.items():
        if lines.count(word) > 1:
            yield "docs/words.yaml", f"`{word}` has two lines", "give the second meaning another word"
        if meanings.count(one["means"]) > 1:
            yield "docs/words.yaml", f"`{word}` means what another word does", "keep one of them"
