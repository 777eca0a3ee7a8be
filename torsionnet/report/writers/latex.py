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
    Equations,
    Facts,
    Formula,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Report,
    Section,
    TableBlock,
    TableGroup,
    Text,
    TitleTable,
)
from torsionnet.report.writers.blocks import CountedLabel
from torsionnet.report.writers.table_layout import (
    LONGEST_WORD,
    MATRIX_LETTERS,
    PAGE_LETTERS,
    SIZES,
    InlineWriter,
    Piece,
    TableLayout,
    is_matrix,
    signed_pieces,
)
from torsionnet.report.writers.templating import BesideWriter
from torsionnet.symbolic import symbol_names


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write a report as a LaTeX document with its figures, and return the paths."""
    return LatexWriter.write(report, path)


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
PIECE_LETTERS = 10
"""Number of letters after which a long word in a narrow column may break."""
LONG_WORD = 60
"""Number of letters of a word from which on LaTeX sets it smaller, such as a check sum."""
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


class LatexInline(InlineWriter):
    r"""Writer of the texts, formulas and numbers inside a line of LaTeX; a long word may break after its signs.

    In a narrow column every word may break after its signs, and long ones anywhere.

    Examples
    --------
    >>> print(LatexInline()("in water=dry,coupling=warm"))
    in water=\allowbreak{}dry,\allowbreak{}coupling=\allowbreak{}warm
    >>> print(LatexInline(narrow=True)("gear=V,clutch=open"))
    gear=\allowbreak{}V,\allowbreak{}clutch=\allowbreak{}open
    """

    def __init__(self, *, narrow: bool = False) -> None:
        self.narrow = narrow

    def text(self, text: str) -> str:
        return " ".join(_BREAK.join(map(escaped, self._pieces(word))) for word in text.split(" "))

    def _pieces(self, word: str) -> list[str]:
        if not self.narrow:
            return [word] if len(word) <= LONGEST_WORD else signed_pieces(word)
        pieces = []
        for piece in signed_pieces(word):
            size = PIECE_LETTERS if len(piece) > LONGEST_WORD else len(piece) or 1
            pieces += [piece[start : start + size] for start in range(0, len(piece), size)]
        return pieces

    def math(self, latex: str) -> str:
        return f"${latex}$"

    def terms(self, terms: tuple[str, ...]) -> str:
        return " ".join(f"${'{} ' if latex[:1] in ('+', '-', '=') else ''}{latex}$" for latex in terms)

    def strong(self, text: str) -> str:
        return rf"\textbf{{{escaped(text)}}}"

    def code(self, text: str) -> str:
        pieces = (escaped(piece).replace("--", "-{}-") for piece in re.split(r"(?<=[(,._/])", text))
        return rf"\texttt{{{_BREAK.join(pieces)}}}"

    def digits(self, digits: str, gap: str) -> str:
        if not digits[-1:].isdigit():
            return escaped(digits)
        phantom = rf"\phantom{{{gap}}}" if gap else ""
        return f"${digits}{phantom}$"

    def power(self, digits: str, exponent: str) -> str:
        return rf"${digits}\cdot10^{{{exponent}}}$"


inline, _narrow = LatexInline(), LatexInline(narrow=True)


def display_math(latex: str) -> str:
    """LaTeX of a formula on a line of its own: inner fractions in full size, room between rows of fractions."""
    large = re.sub(r"\\frac(?![a-z])", r"\\dfrac", latex)
    return large.replace(r" \\ ", r" \\[5pt] ") if r"\dfrac" in large and "matrix" in large else large


# Tables in LaTeX as ``longtable``, so that long ones break over pages with their head repeated.

TABLE_SIZES = (r"{\small", r"{\footnotesize\setlength{\tabcolsep}{3.5pt}", r"{\scriptsize\setlength{\tabcolsep}{3pt}")
"""Beginnings of groups in LaTeX for tables, by the sizes of letters: 9, 8 and 7 points."""


def table_latex(layout: TableLayout, continued: str = "(continued)") -> str:
    """LaTeX of a table with caption, head and notes; one that is too wide for the page goes on below."""
    block, lines = layout.block, []
    for place, piece in enumerate(layout.pieces):
        caption = rf"\caption*{{{escaped(continued)}}}" if place else rf"\caption{{{inline(block.caption)}}}"
        lines += _piece(layout.continued if place else block.groups, piece, caption, layout.page_letters)
    return "\n".join([*lines, *(rf"{{\footnotesize {inline(note)}\par}}" for note in block.foot_notes)])


def _piece(groups: Sequence[TableGroup], piece: Piece, caption: str, page_letters: float) -> list[str]:
    head = " & ".join(_heading(placed.lines, numeric=placed.numeric) for placed in piece)
    lines = [*_measured(piece, page_letters), rf"\begin{{longtable}}{{{_specification(piece)}}}"]
    lines += [rf"{caption}\\", r"\toprule", rf"{head} \\", r"\midrule", r"\endfirsthead"]
    lines += [r"\toprule", rf"{head} \\", r"\midrule", r"\endhead", r"\bottomrule", r"\endlastfoot"]
    for number, group in enumerate(groups):
        if group.title:
            lines += [r"\addlinespace"] if number else []
            lines.append(rf"\multicolumn{{{len(piece)}}}{{@{{}}l}}{{\textbf{{{inline(group.title)}}}}} \\*")
        for row in group.rows:
            cells = (_cell(row[placed.index], placed.column.decimals, placed.width) for placed in piece)
            # A row with a matrix needs some room below it.
            gap = "[9pt]" if any(map(is_matrix, row)) else ""
            lines.append(rf"{' & '.join(cells)} \\{gap}")
    return [*lines, r"\end{longtable}"]


def _specification(piece: Piece) -> str:
    """LaTeX of the widths of a ``longtable``'s columns.

    Each as measured before in its length, or as a share of the room that those leave.
    """
    broken = sum(placed.width for placed in piece if placed.width is not None)
    parts = []
    for place, placed in enumerate(piece):
        side = "left" if placed.numeric else "right"
        wide = length_name(place) if placed.width is None else rf"{placed.width / broken:.3f}\textroom"
        parts.append(rf">{{\ragged{side}\arraybackslash}}p{{{wide}}}")
    return "@{}" + "".join(parts) + "@{}"


def length_name(place: int) -> str:
    r"""Name of the LaTeX length that holds the width of a column.

    >>> length_name(0), length_name(27)
    ('\\widthA', '\\widthAB')
    """
    letters = chr(ord("A") + place % 26)
    return rf"\width{'A' * (place // 26)}{letters}"


def _measured(piece: Piece, page_letters: float) -> list[str]:
    """LaTeX lines that measure the columns that do not break, so that one run of pdfTeX is enough.

    What they leave of the line is the room of the columns whose texts break: letters counted are not quite their width.
    """
    lines = []
    left = [r"\linewidth", rf"{2 * (1 - len(piece))}\tabcolsep"]
    for place, placed in enumerate(piece):
        if placed.width is None:
            cells = (_cell(cell, placed.column.decimals, None) for cell in placed.column.cells)
            texts = dict.fromkeys([_heading(placed.lines, numeric=placed.numeric), *filter(None, cells)])
            lines.append(rf"\measured{{{length_name(place)}}}" + "".join(rf"\widen{{{text}}}" for text in texts))
            left.append(f"-{length_name(place)}")
    if broken := sum(placed.width for placed in piece if placed.width is not None):
        most = rf"{broken / page_letters:.3f}\linewidth"
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


def _cell(cell: Cell, decimals: int, width: float | None) -> str:
    if is_matrix(cell):
        return rf"\fitted{{{MATRIX_LETTERS / PAGE_LETTERS:.2f}\linewidth}}{{{display_math(inline(cell)[1:-1])}}}"
    text = (inline if width is None else _narrow).cell(cell, decimals)
    return text if isinstance(cell, NumberText) else display_math(text)


# Space on a page that a block needs at least in LaTeX, so that no heading stands alone at the end of a page.

HEADING_LINES, CAPTION_LINES, TABLE_HEAD_LINES = 3.5, 2.5, 2.0
"""Heights, in lines, of a heading with its room, of a caption, and of the head and foot of a LaTeX table."""
MOST_UNBROKEN_ROWS, ROWS_BELOW_HEADING = 14, 6
"""Largest number of rows of a LaTeX table on one page, and rows of a longer one that stay below its heading."""
LETTERS_PER_LINE, PARAGRAPH_LINES, OTHER_LINES = 100, 3, 2
"""Number of letters in a line of LaTeX, and of lines that a paragraph or another block needs at least."""
LINE_POINTS, PAGE_POINTS, MOST_LINES = 12.0, 494.0, 48.0
"""Height of a line and width of a page in points, and number of lines that a figure fills at most."""


def lines_needed(block: Block) -> float:
    """Height, in lines, that a block needs at least on the page on which it begins."""
    match block:
        case Section(blocks=blocks):
            return HEADING_LINES + (_beginning(blocks) if blocks else 0)
        case TableBlock(groups=groups):
            rows = [row for group in groups for row in group.rows]
            shown = rows if len(rows) <= MOST_UNBROKEN_ROWS else rows[:ROWS_BELOW_HEADING]
            lines = sum(max(map(_lines, row), default=1) for row in shown)
            heading = max((len(placed.lines) for placed in TableLayout(block).pieces[0]), default=1)
            return min(CAPTION_LINES + TABLE_HEAD_LINES + heading + lines, MOST_LINES)
        case Picture(figure=figure):
            width, height = (72 * float(size) for size in figure.get_size_inches())
            return min(height * min(1.0, PAGE_POINTS / width) / LINE_POINTS, MOST_LINES) + CAPTION_LINES
        case Paragraph():
            return PARAGRAPH_LINES
        case Formula() | Equations() | Facts():
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


LEVELS = ("section", "subsection", "subsubsection", "paragraph")
"""LaTeX commands of headings, from the highest level down."""
_RAGGED = r">{\raggedright\arraybackslash}"
FIELD_COLUMNS = r"|*{2}{" + _RAGGED + r"p{\cellof{0.17}}|" + _RAGGED + r"p{\cellof{0.329}}|}"
REVISION_COLUMNS = (
    r"|p{\cellof{0.11}}|p{\cellof{0.12}}|" + _RAGGED + r"p{\cellof{0.318}}|*{3}{" + _RAGGED + r"p{\cellof{0.15}}|}"
)
SIGNATURE_COLUMNS = r"|p{\cellof{0.17}}|" + _RAGGED + r"p{\cellof{0.329}}|p{\cellof{0.15}}|p{\cellof{0.349}}|"
"""Columns of the three tables of the title block, whose cells have their rule and gaps inside their share of a line."""


class LatexWriter(BesideWriter):
    """Writer of a report as a LaTeX document, which counts sections, tables, figures and formulas itself."""

    ending = ".tex"
    form = "pdf"
    images = (".pdf", ".png", ".jpg", ".jpeg")
    inline = inline

    def heading(self, block: Section, _number: str, level: int) -> str:
        title = inline(block.title)
        # The bookmark of a title with a formula is the section's name.
        shown = rf"\texorpdfstring{{{title}}}{{{escaped(block.name)}}}" if "$" in title else title
        return _room(block) + rf"\{LEVELS[min(level, 3)]}{{{shown}}}" + "\n\n"

    def paragraph(self, text: Text) -> str:
        return inline(text)

    def listing(self, items: Sequence[Text]) -> str:
        return _joined(r"\begin{itemize}", *(rf"\item {inline(item)}" for item in items), r"\end{itemize}")

    def facts(self, rows: Sequence[tuple[str, Text]]) -> str:
        begin = r"\begin{tabular}{@{}l" + _RAGGED + r"p{0.78\linewidth}@{}}"
        return _joined(begin, *(rf"{inline(word)} & {_shrunk(text)} \\" for word, text in rows), r"\end{tabular}")

    def remark(self, _kind: str, word: str, text: Text) -> str:
        return rf"\textbf{{{inline(word)}:}} {inline(text)}"

    def formula(self, latex: str, _number: str) -> str:
        shown = rf"\fitted{{0.93\linewidth}}{{{display_math(latex)}}}"
        return _joined(r"\begin{equation}", shown, r"\end{equation}")

    def equations(self, rows: Sequence[BreakableMath]) -> str:
        lines = (rf"\hangindent=2.5em\hangafter=1\noindent {display_math(inline(row))}" for row in rows)
        return _joined(r"{\raggedright", "\n\n".join(lines), r"\par}")

    def table(self, layout: TableLayout, _label: CountedLabel) -> str:
        size = TABLE_SIZES[SIZES.index(layout.size)]
        return _room(layout.block) + _joined(size, table_latex(layout, self.word("(continued)")), "}")

    def picture(self, block: Picture, _label: CountedLabel) -> str:
        caption = rf"\captionof{{figure}}{{{inline(block.caption)}}}"
        return _joined(r"\begin{center}", rf"\drawing{{{self.drawing(block)}}}", caption, r"\end{center}")

    def title_block(self, block: TitleTable) -> str:
        begin = r"{\small\setlength{\tabcolsep}{4pt}"
        begin += r"\newcommand{\cellof}[1]{\dimexpr#1\linewidth-2\tabcolsep-\arrayrulewidth\relax}%"
        whole = rf"\multicolumn{{3}}{{{_RAGGED}p{{\dimexpr0.828\linewidth-2\tabcolsep-2\arrayrulewidth\relax}}|}}"
        fields = []
        for row in block.rows:
            texts = [_shrunk(text) if len(row) > 1 else f"{whole}{{{_shrunk(text)}}}" for _, text in row]
            cells = [f"{inline(label)} & {text} " for (label, _), text in zip(row, texts, strict=True)]
            fields += ["&\n".join(cells), r"\\\hline"]
        revisions = [rf"{' & '.join(map(_shrunk, row))} \\\hline" for row in block.revisions]
        signatures = [
            rf"\rule[-2mm]{{0pt}}{{6.5mm}}{inline(done)} & {_shrunk(name)} & & \\\hline"
            for done, name in block.signatures
        ]
        return _joined(
            begin,
            *_ruled(FIELD_COLUMNS, fields),
            *_ruled(REVISION_COLUMNS, [_heads(block.revision_heads), *revisions]),
            *_ruled(SIGNATURE_COLUMNS, [_heads(block.signature_heads), *signatures]),
        ).removesuffix(r"\medskip") + "}"  # fmt: skip


def _joined(*lines: str) -> str:
    return "\n".join(lines)


def _ruled(columns: str, lines: Sequence[str]) -> list[str]:
    """Lines of a table of the title block."""
    return [rf"\begin{{tabular}}{{{columns}}}", r"\hline", *lines, r"\end{tabular}\par\medskip"]


def _heads(texts: Sequence[str]) -> str:
    return " & ".join(rf"\textbf{{{inline(text)}}}" for text in texts) + r" \\\hline"


def _room(block: Block) -> str:
    """LaTeX command that begins a new page if less is left of the page than the block needs."""
    return rf"\room{{{lines_needed(block):.0f}\baselineskip}}" + "\n"


def _shrunk(text: Cell) -> str:
    """LaTeX of a text with its long words in a smaller size."""
    return " ".join(
        rf"{{\footnotesize\texttt{{{word}}}}}" if len(word) > LONG_WORD and word.isalnum() else word
        for word in inline(text).split(" ")
    )
