"""Faults of a model text, each with its stretch and quick fixes, and the table of their kinds with examples.

Table of the kinds of faults, each with an example that has it and with what mends the example.

The YAML files of the folder ``faults`` hold the table, one for each group. ``torsionnet explain`` and the page on
faults show it; whoever finds a fault only writes its kind.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

from torsionnet.app.text.fixes.quick_fixes import quick_fixes
from torsionnet.app.text.fixes.syntax_fixes import syntax_fixes
from torsionnet.app.text.fixes.value_fixes import FaultPlace
from torsionnet.app.text.text_edits import TextFix, TextLines, TextSpan, WrittenText
from torsionnet.app.text.tolerant_reading import tolerant_document
from torsionnet.app.text.unstable_configurations import unstable_configurations
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.errors import UNKNOWN_NAMES, EntryPath, Fault, ModelError, Position, UsageError, in_brackets
from torsionnet.base.packages import gc_paused
from torsionnet.model.checks import names
from torsionnet.model.defining import define
from torsionnet.model.files.fault_places import located_faults, presentable_faults
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.part_includes import include_parts
from torsionnet.model.files.reader import read_text

# Faults of a model text, those of ``torsionnet check``, each with its stretch of the text and its quick fixes.

# Faults of the rest of a model text that is no sound YAML, without those that only follow from the break.

_MISPLACED = ("wrong-indentation", "stray-colon")
"""Kinds of breaks that leave it open to which section the entries around belong."""


@gc_paused()
def partial_faults(text: str, file: str, folder: Path | None, broken: Fault) -> list[Fault]:
    """Errors in the entries that a break of the YAML does not touch, in the order of the text.

    What may follow from the break is left out: missing sections, whatever its own entry lacks, and names that the
    text has more than once, as one of them may be their definition.
    """
    document = tolerant_document(text, file)
    if not isinstance(document.data, dict) or broken.position is None or "vary" in document.data:
        return []
    line = broken.position.line - 1
    home = _entry_at_line(document, line)
    if broken.kind == "missing-colon":  # it may be the name of a section, which then holds all that follows
        home = home[:1]
    lines = {line, _line_with_text(document, line, -1), _line_with_text(document, line, 1)}
    lost = _lost_sections(document, home) if broken.kind in _MISPLACED else set()
    return [
        fault
        for fault in located_faults(_certain_faults(document, text, folder), document)
        if fault.severity == "error"
        and fault.position is not None
        and fault.position.file == file
        and fault.position.line - 1 not in lines
        and len(fault.path) > 1
        and fault.path[: max(1, len(home))] != home
        and fault.path[0] not in lost
    ]


def _certain_faults(document: LocatedDocument, text: str, folder: Path | None) -> list[Fault]:
    """Faults that an entry has by itself, and those of names that the text has nowhere else."""
    with files_beside(folder):
        include_parts(document)
        definition, faults = define(document.data)
    for fault in (fault for check in names.CHECKS for fault in check(definition)):
        # The copies that a use makes have names with dots that no text has; a name that stands twice is defined there.
        word = rf"(?<!\w){re.escape(fault.about)}(?!\w)"
        if fault.kind in UNKNOWN_NAMES and "." not in fault.about and len(re.findall(word, text)) < 2:
            faults.append(fault)
    if definition.authored is not None:
        from torsionnet.model.parts.authored_model import at_written_places

        faults = at_written_places(definition, faults)
    return faults


def _lost_sections(document: LocatedDocument, home: EntryPath) -> set[str | int]:
    """Sections into which entries of unclear indentation may have slipped, that of the break and those around it."""
    keys = list(document.root.entries) if document.root else []
    place = keys.index(home[0]) if home else 0
    return set(keys[max(0, place - 1) : place + 2])


def _entry_at_line(document: LocatedDocument, line: int) -> EntryPath:
    """Path of the entry of a section, or of the section, in which a line lies."""
    path: EntryPath = ()
    node = document.root
    while node is not None and len(path) < 2:
        before = [(key, child) for key, child in node.entries.items() if child.key_place and child.key_place[0] <= line]
        if not before:
            return path
        key, node = max(before, key=lambda child: child[1].key_place or ())
        path = (*path, key)
    return path


def _line_with_text(document: LocatedDocument, line: int, step: int) -> int:
    """Number of the next line that is neither empty nor a comment."""
    line += step
    while 0 <= line < len(document.lines) and not document.lines[line].partition("#")[0].strip():
        line += step
    return line


MOST_RECOVERED = 500_000
"""Largest number of characters of a broken text whose unbroken rest is examined as well; it takes seconds."""
MOST_MENDED = 300
"""Largest number of faults of a text that get fixes; nobody reads more of them, and each takes a while."""
_FEWEST_MENDED = 20
"""Number of faults that get fixes in a text of any length; a fix may have to be tried by reading all of it again."""
_MOST_REREAD = 1_500_000
"""Number of characters read again for fixes, after which the faults that follow get none until others are mended."""


@dataclass(frozen=True)
class LocatedFault:
    """Fault of a model text with its stretch of the text and what mends it.

    A fault in a file that the text includes stands where the text names that file or uses its part.
    """

    fault: Fault
    span: TextSpan
    fixes: tuple[TextFix, ...] = ()


def text_faults(text: str, file: str = "", folder: Path | None = None) -> list[LocatedFault]:
    """Faults of a model text as ``torsionnet check`` finds them in a file, in the order of the text.

    Of a text that is no sound YAML ``check`` tells only where it breaks; here errors of the rest follow that do not
    depend on the break.

    Parameters
    ----------
    text : str
    file : str, optional
        Its name, for messages; of a ``.json`` file the fixes are JSON.
    folder : path, optional
        Where files that the text names lie.

    Examples
    --------
    >>> first = text_faults("torsionnet: 1\\nname: rig\\nelemnts: {}\\n")[0]
    >>> first.span, first.fault.message.partition(";")[0], first.fixes[0].title
    (TextSpan(start=24, end=31), 'unknown key "elemnts"', 'write "elements"')
    """
    return stretched_faults(text, read_text(text, file, folder, unstable_configurations)[1], file, folder)


def stretched_faults(text: str, faults: list[Fault], file: str = "", folder: Path | None = None) -> list[LocatedFault]:
    """Faults that reading a model text has found, each with its stretch and its fixes.

    For those who read the text themselves, for its definition; the rest is that of :func:`text_faults`.
    """
    lines = TextLines(text)
    if not any(fault.severity != "note" for fault in faults):
        return [_located(fault, lines, file) for fault in faults]
    try:
        document = compose(text.removeprefix("\ufeff"), file)
    except ModelError:
        is_short = len(text) <= MOST_RECOVERED
        rest = partial_faults(text.removeprefix("\ufeff"), file, folder, faults[-1]) if is_short else []
        located = [_located(fault, lines, file) for fault in presentable_faults([*faults, *rest])]
        return [
            replace(placed, fixes=syntax_fixes(placed.fault, placed.span, lines, file, len(rest)))
            if placed.fault in faults
            else placed
            for placed in located
        ]
    written = WrittenText(text, document, file.lower().endswith(".json"))
    placed_faults: list[LocatedFault] = []
    left = _MOST_REREAD
    for number, fault in enumerate(faults):
        placed = _located(fault, lines, file)
        is_here = placed.fault is fault and isinstance(document.data, dict)
        if fault.severity != "note" and is_here and number < (MOST_MENDED if left > 0 else _FEWEST_MENDED):
            place = FaultPlace(fault, placed.span, written, faults)
            placed = replace(placed, fixes=quick_fixes(place))
            part, _ = place.read_again
            left -= part.end - part.start
        placed_faults.append(placed)
    return placed_faults


def _located(fault: Fault, lines: TextLines, file: str) -> LocatedFault:
    """Fault with its stretch; the place in another file becomes that where this one uses or names it."""
    position = fault.position
    if position is not None and position.file != file:
        said = f"in {Path(position.file).name}, line {position.line}: {fault.message}"
        here = next((use for use in fault.used_at if use.file == file), None) or _naming(position, lines, file)
        fault = replace(fault, message=said, position=here)
        position = here
    return LocatedFault(fault, position_span(position, lines))


def _naming(position: Position, lines: TextLines, file: str) -> Position:
    """Position at which a text names the file, or the part of that name, in which a fault stands."""
    other = Path(position.file)
    names = (re.escape(other.name), rf"(?<=part: ){re.escape(other.stem)}", "(?<=include:)")
    naming = next((match for name in names if (match := re.search(rf"(?<!\w){name}(?!\w)", lines.text))), None)
    line, column = lines.place(naming.start() if naming else 0)
    return Position(file, line + 1, column + 1, column + 1 + max(1, len(naming[0]) if naming else 1))


def position_span(position: Position | None, lines: TextLines) -> TextSpan:
    """Stretch of a text that a fault's position marks; nothing at the beginning where there is none."""
    if position is None:
        return TextSpan(0, 0)
    # A byte order mark is no character of the model, but one of the text.
    mark = 1 if position.line == 1 and lines.text.startswith("\ufeff") else 0
    start = lines.offset(position.line - 1, position.column - 1 + mark)
    return TextSpan(start, max(start, lines.offset(position.line - 1, position.end_column - 1 + mark)))


# Table of the kinds of faults, each with an example that has it and with what mends the example.

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
