"""Faults of a model text, those of ``torsionnet check``, each with its stretch of the text and its quick fixes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from torsionnet.core.errors import Fault, Position
from torsionnet.model.files.reader import read_text
from torsionnet.text.text_edits import TextFix, TextLines, TextSpan
from torsionnet.text.unstable_configurations import unstable_configurations


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
    >>> first.span, first.fault.message.partition(";")[0]
    (TextSpan(start=24, end=31), 'unknown key "elemnts"')
    """
    lines = TextLines(text)
    faults = read_text(text, file, folder, unstable_configurations)[1]
    return [_located(fault, lines, file) for fault in faults]


def _located(fault: Fault, lines: TextLines, file: str) -> LocatedFault:
    """Fault with its stretch; the place in another file becomes that of its first use in this one."""
    position = fault.position
    if position is not None and position.file != file:
        here = next((use for use in fault.used_at if use.file == file), None)
        said = f"in {Path(position.file).name}, line {position.line}: {fault.message}"
        fault = replace(fault, message=said, position=here)
        position = here
    return LocatedFault(fault, position_span(position, lines))


def position_span(position: Position | None, lines: TextLines) -> TextSpan:
    """Stretch of a text that a fault's position marks; nothing at the beginning where there is none."""
    if position is None:
        return TextSpan(0, 0)
    # A byte order mark is no character of the model, but one of the text.
    mark = 1 if position.line == 1 and lines.text.startswith("\ufeff") else 0
    start = lines.offset(position.line - 1, position.column - 1 + mark)
    return TextSpan(start, max(start, lines.offset(position.line - 1, position.end_column - 1 + mark)))
