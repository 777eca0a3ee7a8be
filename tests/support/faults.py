"""Kinds and places of the faults that a call has, and those of the examples in the table of faults."""

import os
import re
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import torsionnet as tn
from support.command_line import runner
from torsionnet.app.cli.app import app
from torsionnet.app.text.text_faults import RIG, FaultKind
from torsionnet.base.errors import EntryPath, Fault, TorsionnetError
from torsionnet.model.files.reader import read_text


def faults_of(call: Callable[[], Any]) -> list[tuple[str, EntryPath]]:
    """Kind and path of each fault with which a call is refused; empty where it is not.

    >>> faults_of(lambda: tn.loads("torsionnet: 1"))
    [('missing-entry', ())]
    """
    return [(one.kind, one.path) for one in raised_faults(call)]


def raised_faults(call: Callable[[], Any]) -> tuple[Fault, ...]:
    """Faults with which a call is refused; of an error without a fault its message and kind."""
    try:
        call()
    except (TorsionnetError, ValueError) as error:
        if not hasattr(error, "faults") and not isinstance(error, TorsionnetError):
            raise
        single = getattr(error, "fault", None) or Fault(str(error), kind=getattr(error, "kind", ""))
        return tuple(getattr(error, "faults", [single]))
    return ()


def placed_faults(call: Callable[[], Any]) -> list[str]:
    """Place and kind of each fault with which a call is refused; of one without a position its path."""
    return [f"{_place(one)} {one.kind}".strip() for one in raised_faults(call)]


def _place(fault: Fault) -> str:
    where = fault.position
    return f"{where.file}:{where.line}:{where.column}" if where else ".".join(map(str, fault.path))


_TOLD = re.compile(
    r"^(\S+:\d+:\d+): (?:(?:error|warning|note): .* \[([a-z-]+)\]|(used here|defined here))$", re.MULTILINE
)


def told_places(text: str) -> list[str]:
    """Places and kinds of the faults in a printed text, with the places that belong to them.

    >>> told_places("m.yaml:9:25: error: a part cannot contain itself [circular-definition]\\nm.yaml:3:1: used here")
    ['m.yaml:9:25 circular-definition', 'm.yaml:3:1 used here']
    """
    return [f"{place} {kind or beside}" for place, kind, beside in _TOLD.findall(text)]


def is_as_expected(fault: Fault, expected: str) -> bool:
    """Whether a fault has the kind that a case expects, and the words that it expects behind a colon.

    >>> is_as_expected(Fault('no node is named "x"', kind="unknown-node"), "unknown-node: x")
    True
    """
    kind, _, words = expected.partition(": ")
    return fault.kind == kind and words in fault.text


def model_text(text: str) -> str:
    """Whole text of a model in the table, of which the elements may be those of all examples."""
    return text if "torsionnet:" in text else f"torsionnet: 1\n{text}" if "elements:" in text else RIG + text


def example_faults(kind: FaultKind, *, mended: bool) -> list[tuple[str, str]]:
    """Kind and message of each fault of an example in the working folder, or of the mended example."""
    change = kind.repaired if mended else str
    for name, text in kind.files.items():
        Path(name).write_text(change(text), encoding="utf-8")
    if kind.shell:
        return _told(change(kind.shell))
    if kind.model:
        found = [one for one in read_text(model_text(change(kind.model)), "", Path())[1] if one.severity != "note"]
    else:
        names = {"tn": tn, "np": np, "Path": Path}
        pandas = sys.modules.get("pandas")
        with patch.dict(os.environ):
            found = [*raised_faults(lambda: exec(change(kind.python), names))]
        if pandas is not None:
            sys.modules["pandas"] = pandas
    return [(one.kind, one.text) for one in found]


def _told(command: str) -> list[tuple[str, str]]:
    """Kind and message of the faults that a command prints."""
    program, *words = shlex.split(command)
    assert program == "torsionnet"
    result = runner().invoke(app, words)  # type: ignore[no-untyped-call]
    told = re.findall(r"^(?:.*?: )?(?:[Ee]rror|warning): (.*) \[([a-z-]+)\]$", result.output, re.MULTILINE)
    return [(kind, message) for message, kind in told]
