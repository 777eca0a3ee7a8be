"""Table of the kinds of faults, each with an example that has it and with what mends the example.

The YAML files of the folder ``faults`` hold the table, one for each group. ``torsionnet explain`` and the page on
faults show it; whoever finds a fault only writes its kind.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files

from torsionnet.base.errors import UsageError, in_brackets
from torsionnet.model.files.located_yaml import compose

PAGE = "https://torsionnet.example/docs/stable/faults.html"
"""Page on all kinds of faults, with an anchor for each."""

GROUPS = {
    "syntax": "Text of a file",
    "entries": "Entries of a file, arguments of a call",
    "values": "Numbers, words and lists",
    "units": "Units",
    "expressions": "Expressions of parameters",
    "names": "Names",
    "drivetrain": "The drivetrain as a whole",
    "machinery": "Engines, loads and limits",
    "files": "Files and parts",
    "records": "Records and responses",
    "calculations": "Calculations",
    "programs": "Packages and other programs",
}
"""Titles of the groups of kinds; each group is a file of its name."""

RIG = """torsionnet: 1
elements:
  motor: {type: inertia, node: a, inertia: 2 kg*m^2}
  shaft: {type: spring, nodes: [a, b], stiffness: 3 kN*m/rad}
  drum: {type: inertia, node: b, inertia: 5 kg*m^2}
"""
"""Model to which the examples belong that have no elements."""


@dataclass(frozen=True)
class FaultKind:
    """Kind of a fault: what it means, an example that has it, the message there, and the changes that mend it.

    The example is a text of a ``model``, lines of ``python`` or of a ``shell``, with other ``files`` that these read.
    """

    name: str
    group: str
    means: str
    says: str
    mended: Mapping[str, str]
    model: str = ""
    python: str = ""
    shell: str = ""
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """Text of the example that has the fault, its files first."""
        parts = [f"# {name}\n{text}" for name, text in self.files.items()]
        return "\n".join([*parts, self.model or self.python or self.shell])

    @property
    def changed_lines(self) -> str:
        """Lines of the mended example that differ from those that have the fault."""
        compared = difflib.ndiff(self.text.splitlines(), self.repaired(self.text).splitlines())
        return "\n".join(line[2:] for line in compared if line.startswith("+ "))

    def repaired(self, text: str) -> str:
        """Text of the example with the changes that mend it."""
        for old, new in self.mended.items():
            text = text.replace(old, new)
        return text

    @property
    def explanation(self) -> str:
        """Explanation of the kind for the screen: its meaning, the example with its message, and the mended lines."""
        shown, mended = (_indented(text) for text in (self.text, self.changed_lines or "(left out)"))
        said = _indented(f"{self.says}{in_brackets(self.name)}")
        return f"{self.name}: {self.means}\n\n{shown}\n\nsays\n\n{said}\n\nand is mended by\n\n{mended}\n"


def _indented(text: str) -> str:
    return "\n".join(f"    {line}".rstrip() for line in text.rstrip().splitlines())


@cache
def fault_kinds() -> Mapping[str, FaultKind]:
    """All kinds of faults by name, group by group."""
    folder = files("torsionnet.app.text").joinpath("faults")
    kinds = {}
    for group in GROUPS:
        file = folder.joinpath(f"{group}.yaml")
        for name, entries in (compose(file.read_text(encoding="utf-8"), file.name).data or {}).items():
            kinds[name] = FaultKind(name, group, **entries)
    return kinds


def fault_kind(name: str) -> FaultKind:
    """Kind of faults of a name, which may stand in brackets; UsageError asks which was meant."""
    kinds, wanted = fault_kinds(), name.strip("[]")
    if wanted not in kinds:
        near = difflib.get_close_matches(wanted, kinds, 4) or [kind for kind in kinds if wanted in kind]
        hint = f"; did you mean {' or '.join(near)}?" if near else "; torsionnet explain lists them all"
        raise UsageError(f'no kind of fault is named "{wanted}"{hint}', kind="unknown-name")
    return kinds[wanted]


def fault_link(kind: str) -> str:
    """Address of the section on a kind of faults."""
    return f"{PAGE}#{kind}"
