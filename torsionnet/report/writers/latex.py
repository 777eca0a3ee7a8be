"""Writing of a report as a LaTeX document with its figures as PDF beside it; one run of pdfTeX makes the PDF.

Nothing refers to pages, and tables find their widths at once, so that a second run would change nothing.

LaTeX of the texts and numbers of a report. Special characters are escaped, and characters that pdfTeX cannot print are
spelt out.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

from torsionnet.report.document_tree import (
    Block,
    BreakableMath,
    Cell,
    Code,
    Equations,
    Facts,
    Formula,
    Inline,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Report,
    Section,
    Strong,
    TableBlock,
    Text,
    inlines,
)
from torsionnet.report.writers.latex_columns import (
    MATRIX_LETTERS,
    PAGE_LETTERS,
    Columns,
    is_matrix,
    length_name,
    table_pieces,
)
from torsionnet.report.writers.templating import TextFormat, figure_folder, figures_beside, render, write_beside
from torsionnet.symbolic import symbol_names

# LaTeX of the texts and numbers of a report.

SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
    "|": r"\textbar{}", '"': r"\textquotedbl{}", "`": r"\textasciigrave{}",
    "–": "--", "—": "---", "…": r"\ldots{}", "−": "$-$", "∞": r"$\infty$", "×": r"$\times$", "·": r"$\cdot$",
    "²": r"$^2$", "³": r"$^3$", "°": r"$^\circ$", "µ": r"$\mu$", "±": r"$\pm$", "\N{NO-BREAK SPACE}": "~",
    "‘": "`", "’": "'", "“": "``", "”": "''", "≤": r"$\le$", "≥": r"$\ge$", "→": r"$\to$",
}  # fmt: skip
"""LaTeX of characters with a meaning in LaTeX, and of some others, by character."""
GREEK = {
    unicodedata.lookup(f"GREEK {size} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}"): rf"$\{name}$"
    for name in sorted(symbol_names.GREEK)
    for size in ("CAPITAL" if name[0].isupper() else "SMALL",)
}
"""LaTeX of Greek letters by letter."""
LONGEST_WORD, PIECE_LETTERS = 20, 10
"""Largest number of letters of a word in one piece, and number of letters after which a longer one may break."""
_BREAK = r"\allowbreak{}"
FIRST_UNKNOWN_LETTER = 0x180
"""First code point of the letters that the LaTeX fonts (T1) may lack; those below they have, or compose."""


def escaped(text: str) -> str:
    r"""LaTeX that prints a text of the report as it stands.

    >>> print(escaped("<b>A & B</b> $x_1$ 100%"))
    \textless{}b\textgreater{}A \& B\textless{}/b\textgreater{} \$x\_1\$ 100\%
    """
    return "".join(map(_char, unicodedata.normalize("NFC", text)))


def _char(char: str) -> str:
    known = SPECIAL.get(char) or GREEK.get(char)
    if known:
        return known
    if char in "\n\t" or (char.isprintable() and ord(char) < 0x7F):
        return char
    if char.isalpha() and ord(char) < FIRST_UNKNOWN_LETTER:
        return char
    return rf"[U+{ord(char):04X}]"


def inline(cell: Cell) -> str:
    r"""LaTeX of a cell, caption or paragraph of a report; a long word may break after its signs.

    >>> print(inline("in water=dry,coupling=warm"))
    in water=\allowbreak{}dry,\allowbreak{}coupling=\allowbreak{}warm
    """
    return "".join(map(_part, inlines(cell)))


def breakable(part: Inline) -> str:
    r"""LaTeX of a part of a table's cell, which may break over lines in a narrow column.

    Words may also break after signs, and long ones anywhere.

    >>> print(breakable("gear=V,clutch=open"))
    gear=\allowbreak{}V,\allowbreak{}clutch=\allowbreak{}open
    """
    if not isinstance(part, str):
        return _part(part)
    return " ".join(_BREAK.join(map(escaped, _syllables(word))) for word in part.split(" "))


def _syllables(word: str) -> list[str]:
    found = []
    for piece in _signed(word):
        size = PIECE_LETTERS if len(piece) > LONGEST_WORD else len(piece) or 1
        found += [piece[start : start + size] for start in range(0, len(piece), size)]
    return found


def _signed(word: str) -> list[str]:
    return re.split(r"(?<=[=,/_+])(?=.)", word)


def _part(part: Inline) -> str:
    match part:
        case Math(latex):
            return f"${latex}$"
        case BreakableMath(parts):
            return " ".join(f"${'{} ' if latex[:1] in ('+', '-', '=') else ''}{latex}$" for latex in parts)
        case Strong(text):
            return rf"\textbf{{{escaped(text)}}}"
        case Code(text):
            pieces = (escaped(piece).replace("--", "-{}-") for piece in re.split(r"(?<=[(,._/])", text))
            return rf"\texttt{{{_BREAK.join(pieces)}}}"
        case NumberText():
            return number(part)
    words = ([word] if len(word) <= LONGEST_WORD else _signed(word) for word in part.split(" "))
    return " ".join(_BREAK.join(map(escaped, word)) for word in words)


def number(value: NumberText, decimals: int = 0) -> str:
    """LaTeX of a number in a report; a gap makes up for the decimals that others in its column have."""
    text = value.mantissa
    if not text[-1:].isdigit():
        return escaped(text)
    if value.exponent is not None:
        return rf"${text}\cdot10^{{{value.exponent}}}$"
    missing = decimals - value.decimals_shown
    gap = rf"\phantom{{{'' if value.decimals_shown else '.'}{'0' * missing}}}" if missing > 0 else ""
    return f"${text}{gap}$"


def display_math(latex: str) -> str:
    """LaTeX of a formula on a line of its own: inner fractions in full size, room between rows of fractions."""
    large = re.sub(r"\\frac(?![a-z])", r"\\dfrac", latex)
    return large.replace(r" \\ ", r" \\[5pt] ") if r"\dfrac" in large and "matrix" in large else large


# Tables in LaTeX as ``longtable``, so that long ones break over pages with their head repeated.


def table_latex(block: TableBlock, continued: str = "(continued)") -> str:
    """LaTeX of a table with caption, head and notes; one that is too wide for the page goes on below."""
    decimals = [block.decimals(index) for index in range(len(block.columns))]
    lines = []
    for place, columns in enumerate(table_pieces(block)):
        caption = rf"\caption*{{{escaped(continued)}}}" if place else rf"\caption{{{inline(block.caption)}}}"
        lines += _piece(block, columns, caption, decimals)
    return "\n".join([*lines, *(rf"{{\footnotesize {inline(note)}\par}}" for note in block.foot_notes)])


def _piece(block: TableBlock, columns: Columns, caption: str, decimals: Sequence[int]) -> list[str]:
    head = " & ".join(
        _heading(lines, numeric=block.columns[index].numeric)
        for index, lines in zip(columns.indices, columns.headings, strict=True)
    )
    lines = [rf"\begin{{longtable}}{{{columns.spec(block)}}}"]
    lines[:0] = _measured(block, columns, decimals)
    lines += [rf"{caption}\\", r"\toprule", rf"{head} \\", r"\midrule", r"\endfirsthead"]
    lines += [r"\toprule", rf"{head} \\", r"\midrule", r"\endhead", r"\bottomrule", r"\endlastfoot"]
    for number_, group in enumerate(block.groups):
        if group.title:
            lines += [r"\addlinespace"] if number_ else []
            lines.append(rf"\multicolumn{{{len(columns.indices)}}}{{@{{}}l}}{{\textbf{{{inline(group.title)}}}}} \\*")
        lines += [f"{_row(row, columns, decimals)} \\\\{_gap(row)}" for row in group.rows]
    return [*lines, r"\end{longtable}"]


def _measured(block: TableBlock, columns: Columns, decimals: Sequence[int]) -> list[str]:
    """LaTeX lines that measure the columns that do not break, so that one run of pdfTeX is enough.

    What they leave of the line is the room of the columns whose texts break: letters counted are not quite their width.
    """
    lines = []
    left = [r"\linewidth", rf"{2 * (1 - len(columns.indices))}\tabcolsep"]
    for place, (index, width, heading) in enumerate(
        zip(columns.indices, columns.widths, columns.headings, strict=True)
    ):
        if width is None:
            cells = (_cell(cell, decimals[index], None) for cell in block.column(index))
            texts = dict.fromkeys([_heading(heading, numeric=block.columns[index].numeric), *filter(None, cells)])
            lines.append(rf"\measured{{{length_name(place)}}}" + "".join(rf"\widen{{{text}}}" for text in texts))
            left.append(f"-{length_name(place)}")
    if broken := sum(width for width in columns.widths if width is not None):
        most = rf"{broken / PAGE_LETTERS:.3f}\linewidth"
        room = "".join(rf"\addtolength{{\textroom}}{{{length}}}" for length in left)
        lines.append(rf"\setlength{{\textroom}}{{0pt}}{room}\ifdim\textroom>{most}\setlength{{\textroom}}{{{most}}}\fi")
    return lines


def _heading(lines: tuple[Cell, ...], *, numeric: bool) -> str:
    shown = [rf"\textbf{{{inline(line)}}}" for line in lines]
    if len(shown) == 1:
        return shown[0]
    side = "r" if numeric else "l"
    stacked = r" \\ ".join(shown)
    return rf"\begin{{tabular}}[b]{{@{{}}{side}@{{}}}}{stacked}\end{{tabular}}"


def _gap(row: tuple[Cell, ...]) -> str:
    """LaTeX of the vertical room below a table row; a row with a matrix needs some."""
    return "[9pt]" if any(is_matrix(cell) for cell in row) else ""


def _row(row: tuple[Cell, ...], columns: Columns, decimals: Sequence[int]) -> str:
    cells = zip(columns.indices, columns.widths, strict=True)
    return " & ".join(_cell(row[index], decimals[index], width) for index, width in cells)


def _cell(cell: Cell, decimals: int, width: float | None) -> str:
    if isinstance(cell, NumberText):
        return number(cell, decimals)
    if is_matrix(cell):
        return rf"\fitted{{{MATRIX_LETTERS / PAGE_LETTERS:.2f}\linewidth}}{{{display_math(inline(cell)[1:-1])}}}"
    text = inline(cell) if width is None else "".join(map(breakable, inlines(cell)))
    return display_math(text)


# Space on a page that a block needs at least in LaTeX, so that no heading stands alone at the end of a page.

HEADING_LINES, CAPTION_LINES, TABLE_HEAD_LINES = 3.5, 2.5, 2.0
"""Heights, in lines, of a heading with its room, of a caption, and of the head and foot of a LaTeX table."""
MOST_UNBROKEN_ROWS, ROWS_BELOW_HEADING = 14, 6
"""Largest number of rows of a LaTeX table on one page, and rows of a longer one that stay below its heading."""
LETTERS_PER_LINE, PARAGRAPH_LINES, OTHER_LINES = 100, 3, 2
"""Number of letters in a line of LaTeX, and of lines that a paragraph or another block needs at least."""
LINE_POINTS, PAGE_POINTS, MOST_LINES = 12.0, 483.0, 48.0
"""Height of a line and width of a page in points, and number of lines that a figure fills at most."""


def room_command(block: Block) -> str:
    """LaTeX command that begins a new page if less is left of the page than the block needs."""
    return rf"\room{{{lines_needed(block):.0f}\baselineskip}}" + "\n"


def lines_needed(block: Block) -> float:
    """Height, in lines, that a block needs at least on the page on which it begins."""
    if isinstance(block, Section):
        return HEADING_LINES + (_beginning(block.blocks) if block.blocks else 0)
    if isinstance(block, TableBlock):
        rows = [row for group in block.groups for row in group.rows]
        lines = sum(
            max(map(_lines, row), default=1)
            for row in (rows if len(rows) <= MOST_UNBROKEN_ROWS else rows[:ROWS_BELOW_HEADING])
        )
        parts = table_pieces(block)
        head = TABLE_HEAD_LINES + max((len(heading) for heading in parts[0].headings), default=1)
        return min(CAPTION_LINES + head + lines, MOST_LINES)
    if isinstance(block, Picture):
        width, height = (72 * float(size) for size in block.figure.get_size_inches())
        return min(height * min(1.0, PAGE_POINTS / width) / LINE_POINTS, MOST_LINES) + CAPTION_LINES
    if isinstance(block, Paragraph):
        return PARAGRAPH_LINES
    if isinstance(block, (Formula, Equations, Facts)):
        return 2 * PARAGRAPH_LINES
    return OTHER_LINES


def _beginning(blocks: tuple[Block, ...]) -> float:
    """Height, in lines, of the first block, and of the next one's beginning if the first is a sentence on it."""
    first = lines_needed(blocks[0])
    if isinstance(blocks[0], Paragraph) and len(blocks) > 1 and not isinstance(blocks[1], Picture):
        first += min(lines_needed(blocks[1]), ROWS_BELOW_HEADING + CAPTION_LINES + TABLE_HEAD_LINES)
    return first


def _lines(cell: object) -> float:
    """Height of a table cell in lines: rows of a matrix, or lines of a text that breaks."""
    if isinstance(cell, Math) and "matrix" in cell.latex:
        return 1.3 * (cell.latex.count(r"\\") + 1) + 1
    text = "".join(part for part in cell if isinstance(part, str)) if isinstance(cell, tuple) else cell
    return 1.15 * (1 + len(text) // (LETTERS_PER_LINE // 2)) if isinstance(text, str) else 1.15


LONG_WORD = 60
"""Number of letters of a word from which on LaTeX sets it smaller, such as a check sum."""


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as a LaTeX document with its figures, and return the paths."""
    return write_beside(report, path, "pdf", latex_document(report, figure_folder(path).name))


def latex_document(report: Report, folder: str) -> str:
    """Text of the LaTeX document of a report; ``folder`` holds the figures."""
    return render(report, FORMAT, figures_beside(folder, "pdf"))


def _breakable(text: Text) -> str:
    """LaTeX of a text with its long words in a smaller size."""
    return " ".join(
        rf"{{\footnotesize\texttt{{{word}}}}}" if len(word) > LONG_WORD and word.isalnum() else word
        for word in inline(text).split(" ")
    )


FORMAT = TextFormat(
    ".tex",
    inline,
    {
        "display": display_math,
        "equation": lambda row: display_math(inline(row)),
        "breakable": _breakable,
        "text": inline,
        "room": room_command,
        "table": table_latex,
    },
    (".pdf", ".png", ".jpg", ".jpeg"),
)
"""File format LaTeX with the functions that turn the parts of a report into it."""
