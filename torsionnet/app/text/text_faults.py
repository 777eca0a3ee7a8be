"""Faults of a model text, those of ``torsionnet check``, each with its stretch of the text and its quick fixes."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

from torsionnet.app.text.entry_edits import WrittenText
from torsionnet.app.text.fixes.quick_fixes import quick_fixes
from torsionnet.app.text.fixes.syntax_fixes import syntax_fixes
from torsionnet.app.text.partial_faults import partial_faults
from torsionnet.app.text.text_edits import TextFix, TextLines, TextSpan
from torsionnet.app.text.unstable_configurations import unstable_configurations
from torsionnet.base.errors import Fault, ModelError, Position
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.reader import presentable_faults, read_text

MOST_RECOVERED = 500_000
"""Largest number of characters of a broken text whose unbroken rest is examined as well; it takes seconds."""
MOST_MENDED = 300
"""Largest number of faults of a text that get fixes; nobody reads more of them, and each takes a while."""
_FEWEST_MENDED = 20
"""Number of faults that get fixes in a text of any length; each fix is tried by reading the whole text again."""
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


def stretched_faults(text: str, found: list[Fault], file: str = "", folder: Path | None = None) -> list[LocatedFault]:
    """Faults that reading a model text has found, each with its stretch and its fixes.

    For those who read the text themselves, for its definition; the rest is that of :func:`text_faults`.
    """
    lines = TextLines(text)
    if not any(fault.severity != "note" for fault in found):
        return [_located(fault, lines, file) for fault in found]
    try:
        document = compose(text.removeprefix("\ufeff"), file)
    except ModelError:
        is_short = len(text) <= MOST_RECOVERED
        rest = partial_faults(text.removeprefix("\ufeff"), file, folder, found[-1]) if is_short else []
        located = [_located(fault, lines, file) for fault in presentable_faults([*found, *rest])]
        return [
            replace(one, fixes=syntax_fixes(one.fault, one.span, lines, file, len(rest))) if one.fault in found else one
            for one in located
        ]
    written = WrittenText(text, document, file.lower().endswith(".json"))
    many = min(MOST_MENDED, max(_FEWEST_MENDED, _MOST_REREAD // max(1, len(text))))
    located = [_located(fault, lines, file) for fault in found]
    mended = [_with_fixes(*pair, written, found) for pair in zip(located[:many], found[:many], strict=True)]
    return [*mended, *located[many:]]


def _with_fixes(located: LocatedFault, fault: Fault, written: WrittenText, others: list[Fault]) -> LocatedFault:
    """Fault with its fixes, if it stands in this text and is more than a note."""
    if fault.severity == "note" or located.fault is not fault or not isinstance(written.document.data, dict):
        return located
    return replace(located, fixes=quick_fixes(fault, located.span, written, others))


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
    found = next((one for name in names if (one := re.search(rf"(?<!\w){name}(?!\w)", lines.text))), None)
    line, column = lines.place(found.start() if found else 0)
    return Position(file, line + 1, column + 1, column + 1 + max(1, len(found[0]) if found else 1))


def position_span(position: Position | None, lines: TextLines) -> TextSpan:
    """Stretch of a text that a fault's position marks; nothing at the beginning where there is none."""
    if position is None:
        return TextSpan(0, 0)
    # A byte order mark is no character of the model, but one of the text.
    mark = 1 if position.line == 1 and lines.text.startswith("\ufeff") else 0
    start = lines.offset(position.line - 1, position.column - 1 + mark)
    return TextSpan(start, max(start, lines.offset(position.line - 1, position.end_column - 1 + mark)))
