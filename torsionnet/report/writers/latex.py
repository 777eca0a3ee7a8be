r"""A report as a LaTeX document with its figures as PDF in a folder beside it; one run of pdfTeX makes the PDF.

Nothing refers to pages, and tables find their widths at once, so that a second run would change nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from torsionnet.core.atomic import write_text
from torsionnet.report.document_tree import (
    Block,
    Details,
    Equations,
    Facts,
    Formula,
    Listing,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    TableBlock,
)
from torsionnet.report.writers.figure_files import figure_folder, write_figures
from torsionnet.report.writers.latex_room import room
from torsionnet.report.writers.latex_table import table_latex
from torsionnet.report.writers.latex_text import displayed, escaped, inline

PREAMBLE = r"""\documentclass[10pt,a4paper]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{}
\usepackage[margin=20mm]{geometry}
\usepackage{amsmath,amssymb,array,booktabs,longtable,graphicx,textcomp}
\usepackage[labelfont=bf,singlelinecheck=false,font=small]{caption}
\usepackage[hidelinks]{hyperref}
\IfFileExists{bookmark.sty}{\usepackage{bookmark}}{\hypersetup{bookmarks=false}}
\setlength{\parindent}{0pt}
\setlength{\parskip}{4pt plus 1pt}
\setlength{\LTleft}{0pt}
\setlength{\LTright}{\fill}
\setlength{\tabcolsep}{5pt}
\renewcommand{\arraystretch}{1.15}
\emergencystretch=3em
\newsavebox{\drawn}
\newcommand{\drawing}[1]{\sbox{\drawn}{\includegraphics{#1}}%
  \ifdim\wd\drawn>\linewidth\sbox{\drawn}{\resizebox{\linewidth}{!}{\usebox{\drawn}}}\fi
  \ifdim\ht\drawn>0.86\textheight\resizebox{!}{0.86\textheight}{\usebox{\drawn}}\else\usebox{\drawn}\fi}
\newcommand{\fitted}[2]{\sbox{\drawn}{$\displaystyle #2$}%
  \ifdim\wd\drawn>#1\resizebox{#1}{!}{\usebox{\drawn}}\else\usebox{\drawn}\fi}
\newlength{\widest}
\newcommand{\measured}[1]{\ifdefined#1\else\newlength#1\fi\setlength#1{0pt}%
  \def\widen##1{\settowidth\widest{##1}\ifdim\widest>#1\setlength#1{\widest}\fi}}
\newcommand{\room}[1]{\par\penalty-100\begingroup\dimen0=\pagegoal\advance\dimen0-\pagetotal
  \ifdim\pagegoal<\maxdimen\ifdim\dimen0<#1\vfil\break\fi\fi\endgroup}
\allowdisplaybreaks
\pdfinfoomitdate=1
\pdftrailerid{}
"""
FACTS = r"@{}l>{\raggedright\arraybackslash}p{0.78\linewidth}@{}"
LONG = 60
"""Letters of a word that is set smaller, such as a check sum."""
LEVELS = ("section", "subsection", "subsubsection", "paragraph")


def write(report: Report, path: Path) -> tuple[Path, ...]:
    """Write the document and its figures."""
    figures = write_figures(report, path, "pdf")
    write_text(path, latex_document(report, figure_folder(path).name))
    return (path, *figures)


def latex_document(report: Report, folder: str) -> str:
    """The text of the document; ``folder`` holds the figures."""
    body = "\n\n".join(_section(section, 0, folder) for section in report.sections)
    title = escaped(report.title)
    notes = f"\n{inline(report.notes)}\n" if any(report.notes) else ""
    return (
        f"{PREAMBLE}\\hypersetup{{pdftitle={{{title}}}}}\n\\begin{{document}}\n"
        f"{{\\small {escaped(report.subtitle)}\\par}}\n{{\\LARGE\\bfseries\\raggedright {title}\\par}}\n\\medskip\n"
        f"{_facts(report.facts)}\n{notes}\n\\bigskip\\hrule\n{_contents(report)}\n\n{body}\n\\end{{document}}\n"
    )


def _contents(report: Report) -> str:
    """Links to the sections; without page numbers, which would take a second run."""
    lines = (
        rf"\hyperlink{{section.{number}}}{{\makebox[2em][l]{{{number}}}{inline(section.title)}}}"
        for number, section in enumerate(report.sections, 1)
    )
    return r"\section*{Contents}" + "\n" + "\\\\\n".join(lines) + "\n"


def _section(section: Section, level: int, folder: str) -> str:
    command = LEVELS[min(level, len(LEVELS) - 1)]
    title = inline(section.title)
    shown = rf"\texorpdfstring{{{title}}}{{{escaped(section.name)}}}" if "$" in title else title
    parts = (
        _section(block, level + 1, folder) if isinstance(block, Section) else _block(block, folder)
        for block in section.blocks
    )
    return "\n\n".join([rf"{room(section)}\{command}{{{shown}}}", *parts])


def _block(block: Block, folder: str) -> str:
    writers: dict[type, Callable[[Any], str]] = {
        Paragraph: lambda one: inline(one.text),
        Listing: _listing,
        Remark: lambda one: rf"\textbf{{{escaped(one.kind.capitalize())}:}} {inline(one.text)}",
        Formula: _formula,
        Equations: _equations,
        TableBlock: lambda one: f"{{\\small\n{table_latex(one)}\n}}",
        Picture: lambda one: _picture(one, folder),
        Details: lambda one: inline(one.instead),
        Facts: _facts,
    }
    lead = room(block) if isinstance(block, TableBlock) else ""
    return lead + writers[type(block)](block)


def _listing(block: Listing) -> str:
    points = "\n".join(rf"\item {inline(item)}" for item in block.items)
    return f"\\begin{{itemize}}\n{points}\n\\end{{itemize}}"


def _formula(block: Formula) -> str:
    """With its number; one as wide as the page is made smaller."""
    return f"\\begin{{equation}}\n\\fitted{{0.93\\linewidth}}{{{displayed(block.latex)}}}\n\\end{{equation}}"


def _equations(block: Equations) -> str:
    lead = r"\hangindent=2.5em\hangafter=1\noindent "
    rows = "\n\n".join(f"{lead}{displayed(inline(row))}" for row in block.rows)
    return f"{{\\raggedright\n{rows}\n\\par}}"


def _facts(facts: Facts) -> str:
    rows = "\n".join(rf"{escaped(word)} & {_breakable(inline(text))} \\" for word, text in facts.rows)
    return f"\\begin{{tabular}}{{{FACTS}}}\n{rows}\n\\end{{tabular}}"


def _breakable(text: str) -> str:
    """Long words in a smaller size."""
    return " ".join(
        rf"{{\footnotesize\texttt{{{word}}}}}" if len(word) > LONG and word.isalnum() else word
        for word in text.split(" ")
    )


def _picture(block: Picture, folder: str) -> str:
    file = rf"\drawing{{{folder}/{block.name}.pdf}}"
    return f"\\begin{{center}}\n{file}\n\\captionof{{figure}}{{{inline(block.caption)}}}\n\\end{{center}}"
