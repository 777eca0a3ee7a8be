"""Tables of the functions that a value passes on its way through the package, made by tracing it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from functools import cache
from importlib import import_module
from inspect import getdoc
from operator import attrgetter
from pathlib import Path

from page_parts import code, prose, table

ROLE = re.compile(r":\w+:(?=`)")
ROOT = Path(__file__).parents[1]


def walks_page() -> str:
    """Text with a folded table for each traced value."""
    return "\n".join(
        f":::{{dropdown}} {of[0].upper()}{of[1:]}: {len(met)} functions in {len({file for file, _ in met})} files\n"
        + table(["file", "function", "what it is"], [_row(file, name) for file, name in met])
        + ":::\n"
        for of, met in traced_values()
    )


@cache
def traced_values() -> list[tuple[str, list[tuple[str, str]]]]:
    """Description of a traced value, and file and name of every function on its way, from a fresh Python process."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests")])
    command = [sys.executable, "-m", "structure.hops", "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": paths})
    found: list[tuple[str, list[tuple[str, str]]]] = json.loads(done.stdout)
    return found


def _row(file: str, name: str) -> list[str]:
    return [code(file.removeprefix("/")), code(name.replace(".<locals>", "")), prose(_said_of(file, name))]


def _said_of(file: str, name: str) -> str:
    """First line of the docstring of a function; empty if it has none."""
    if "<locals>" in name or name.endswith("__"):
        return ""
    module = import_module("torsionnet" + file.removesuffix(".py").replace("/", "."))
    function = attrgetter(name)(module)
    function = getattr(function, "fget", None) or getattr(function, "func", None) or function
    if not getattr(function, "__doc__", None):
        return ""
    return ROLE.sub("", (getdoc(function) or "").partition("\n")[0])
